// Error against time: places that a hand touches, errors there, volumes, and what paired rounds say for sure.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <random>
#include <thread>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "host/clock.h"
#include "host/study/error_time/error_time.h"
#include "host/study/error_time/volumes.h"
#include "host/threads.h"
#include "host/touch/force_at.h"
#include "host/touch/force_errors.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"

namespace forceshade::study::error_time {
namespace {

using testing::says;

Extents few() {
    return {{4, 64}, {8}, {0.8e-3, 0.4e-3}, 400, 60, 3, 6, 1};
}

std::unique_ptr<Engine> cpu_engine(unsigned threads = 0) {
    EngineOptions options;
    options.cpu = true;
    options.threads = threads;
    return make_engine(options);
}

const Variant& variant_named(const Subject& subject, const std::string& name) {
    return *std::ranges::find_if(subject.variants, [&](const Variant& one) { return one.name == name; });
}

TEST(ForceErrors, CountWhatIsMissedAndWhatShouldNotBe) {
    const std::vector<glm::dvec3> truth{{0, 0, 2}, {0, 0, 1}, {0, 0, 0}, {0, 0, 1}};
    const std::vector<glm::dvec3> found{{0, 0, 1}, {0, 0, 0}, {0, 0.5, 0}, {1, 0, 1}};
    const ForceErrors errors = force_errors(found, truth, 0.5);
    EXPECT_EQ(errors.places, 4u);
    EXPECT_EQ(errors.missed, 1u);
    EXPECT_EQ(errors.phantom, 1u);
    EXPECT_EQ(errors.one_sided_share(), 0.5);
    EXPECT_NEAR(errors.direction.largest, 45, 1e-12);
    EXPECT_EQ(errors.size.largest, 0.5) << "of the size alone, and only where both have a force";
    EXPECT_NEAR(errors.size.median, std::sqrt(2) - 1, 1e-12);
    EXPECT_EQ(errors.local.largest, 1) << "over the force there";
    EXPECT_EQ(errors.local.median, 1);
    EXPECT_EQ(errors.typical.largest, 2) << "over the typical force";
    EXPECT_TRUE(std::isnan(force_errors({}, {}, 1).direction.rms));
}

TEST(ForceErrors, SummaryIsOfRanks) {
    std::vector<double> values(100);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = double(99 - i);
    const Summary summary = summary_of(values);
    EXPECT_EQ(summary.median, 49);
    EXPECT_EQ(summary.p95, 94);
    EXPECT_EQ(summary.largest, 99);
    EXPECT_NEAR(summary.rms, std::sqrt(99 * 199 / 6.0), 1e-12);
}

// Depths as a hand's: as many between 0.02 and 0.2 mm as between 0.2 and 2 mm, everywhere on the surface.
TEST(TouchedPlaces, AreLogUniformInDepthAndUniformOverTheSurface) {
    for (const Subject& subject : own_subjects(few())) {
        std::size_t shallow = 0, left = 0;
        for (const TouchPlace& place : subject.places) {
            EXPECT_GE(place.depth, 0.02e-3);
            EXPECT_LE(place.depth, 2e-3);
            shallow += place.depth < 0.2e-3;
            left += place.at.x < 0;
            EXPECT_NE(subject.force(place), glm::dvec3(0));
            TouchPlace above = place;
            above.at += (place.depth + 1e-6) * place.normal;
            EXPECT_EQ(subject.force(above), glm::dvec3(0)) << "depth is from the surface";
        }
        const auto count = double(subject.places.size());
        EXPECT_EQ(subject.places.size(), 400u);
        EXPECT_NEAR(double(shallow), count / 2, 3 * std::sqrt(count / 4));
        EXPECT_NEAR(double(left), count / 2, 3 * std::sqrt(count / 4));
    }
}

TEST(TouchedPlaces, HaveTheKindOfWhatIsMetThere) {
    const Subject bump = own_subjects(few()).front();
    const Variant &coarse = variant_named(bump, "4 facets, none"), &fine = variant_named(bump, "64 facets, none");
    KindOf of_coarse(bump, coarse), of_fine(bump, fine);
    const auto at = [](double x, double z, double depth) { return TouchPlace{{x, 0, z - depth}, {0, 0, 1}, depth}; };
    EXPECT_EQ(of_coarse(at(13.5e-3, 0, 1e-3)), Kind::flat);
    EXPECT_EQ(of_coarse(at(13.5e-3, 0, 0.03e-3)), Kind::boundary);
    EXPECT_EQ(of_coarse(at(12.7e-3, 0, 1e-3)), Kind::rim);
    const double top = 15.24e-3 - std::sqrt(15.24e-3 * 15.24e-3 - 12.7e-3 * 12.7e-3);
    EXPECT_EQ(of_coarse(at(0, top, 1e-3)), Kind::edge) << "of four facets two meet at the top";
    EXPECT_EQ(of_coarse(at(1e-3, top, 1e-3)), Kind::facet);
    EXPECT_EQ(of_fine(at(0, top, 1e-3)), Kind::edge);
    SharedPlaces shared = shared_places(bump, few(), 0);
    const KindPlaces all = places_of(bump, coarse, shared, few(), 0);
    for (const Kind kind : kKinds)
        EXPECT_GE(std::ranges::count(all.kinds, kind), 30) << name_of(kind);
    for (std::size_t i = 0; i < all.at.size(); ++i)
        if (all.at[i].depth < 0) {
            EXPECT_EQ(all.kinds[i], Kind::boundary);
            EXPECT_EQ(bump.force(all.at[i]), glm::dvec3(0));
        }
}

// A look-up that is good at two millimetres is not where contact begins.
TEST(TouchedPlaces, ShowWhatALookUpDoesWhereContactBegins) {
    const Subject bump = own_subjects(few()).front();
    const Variant& shaded = variant_named(bump, "64 facets, reference");
    const TurnedGrid grid(bump.low, bump.high, 0.4e-3, glm::dvec3(0));
    const Volume<float, float, 3> volume(grid.grid, sampled(*shaded.prepared, grid));
    SharedPlaces shared = shared_places(bump, few(), 0);
    const KindPlaces all = places_of(bump, shaded, shared, few(), 0);
    std::vector<glm::dvec3> found[2], truth[2];
    for (std::size_t i = 0; i < all.at.size(); ++i) {
        const bool shallow = all.kinds[i] == Kind::boundary;
        if (!shallow && (all.kinds[i] != Kind::facet || all.at[i].depth < 1e-3))
            continue;
        found[shallow].emplace_back(volume.trilinear(reference::Vector<float>(all.at[i].at)));
        truth[shallow].push_back(bump.force(all.at[i]));
    }
    EXPECT_LT(force_errors(found[0], truth[0], 1).local.p95, 0.02);
    EXPECT_GT(force_errors(found[1], truth[1], 1).local.p95, 0.5);
}

// Of a mesh the distance and what is above the nearest point: no force outside, and a plane is read without an error.
TEST(LookUps, OfDepthsHaveNoForceAboveAMesh) {
    const Subject mesh = own_subjects(few()).back();
    for (const char* shading : {"none", "mean_value"}) {
        const Variant& law = variant_named(mesh, std::string("8 cells, ") + shading);
        const TurnedGrid grid(mesh.low, mesh.high, 0.4e-3, glm::dvec3(0.3), turn_and_tilt(0.5, 0.08, 1));
        const Volume<float, float, 4> volume(grid.grid, sampled_depths(*law.prepared, grid));
        StaticForce<double> exact(*law.prepared);
        std::size_t near = 0;
        for (const TouchPlace& place : mesh.places) {
            const auto read = volume.trilinear(reference::Vector<float>(grid.in_grid(place.at)));
            const glm::dvec3 force = exact.force(exact.input(place));
            EXPECT_NEAR(std::max(0.0F, read.x) * mesh.stiffness, reference::length(force), 0.05) << shading;
            const glm::dvec3 direction(read.y, read.z, read.w);
            near += touches(force) && angle_between(direction, force) < 3 * kDegree;
            TouchPlace above = place;
            above.at += (place.depth + 0.2e-3) * place.normal;
            EXPECT_LT(volume.trilinear(reference::Vector<float>(grid.in_grid(above.at))).x, 0) << shading;
        }
        EXPECT_GT(near, mesh.places.size() * 3 / 5) << shading;
    }
}

// A narrow band gives what the whole volume gives where a hand is; an adaptive one of as many bytes errs less.
TEST(Bricks, GiveTheForceWhereAHandIs) {
    const Subject bump = own_subjects(few()).front();
    const Variant& shaded = variant_named(bump, "64 facets, reference");
    const float deepest = float(bump.stiffness * bump.scale.deepest);
    const CaseLaw<float> law(*shaded.prepared);
    double of_whole = 0, of_adaptive = 0;
    for (const double turn : {0.0, 0.4, 0.8}) {
        const TurnedGrid grid(bump.low, bump.high, 0.1e-3, glm::dvec3(turn), turn_and_tilt(turn, turn / 20, 1));
        const std::vector<float> forces = sampled(*shaded.prepared, grid);
        const double bytes = double(sizeof(float) * forces.size());
        const Volume<float, float, 3> whole(grid.grid, forces);
        const NarrowBand band(grid.grid, forces, 2 * deepest);
        const AdaptiveVolume adaptive(
            grid.grid, [&](const glm::dvec3& at) { return law.at(grid.in_world(at)).force; }, 2 * deepest, bytes);
        for (const TouchPlace& place : bump.places) {
            const reference::Vector<float> at(grid.in_grid(place.at)), force = whole.trilinear(at);
            EXPECT_EQ(band(at), force);
            const glm::dvec3 truth = bump.force(place);
            of_whole += std::pow(reference::length(glm::dvec3(force) - truth), 2);
            of_adaptive += std::pow(reference::length(glm::dvec3(adaptive(at)) - truth), 2);
        }
        EXPECT_LT(band.bytes(), 0.8 * bytes);
        EXPECT_LE(adaptive.bytes(), bytes);
        EXPECT_GT(adaptive.bytes(), 0.95 * bytes);
        EXPECT_EQ(band(reference::Vector<float>(glm::dvec3(0, 0, 7e-3))), reference::Vector<float>(0.0F));
    }
    EXPECT_LT(of_adaptive, 0.8 * of_whole);
}

// The cylinder's force at a place, and a trilinear look-up in samples of it at an offset: the same numbers by other
// code. Nothing depends on y.
glm::dvec3 cylinder_force(double x, double z) {
    const double half = 0.0127, radius = 0.01524, foot = std::sqrt(radius * radius - half * half);
    const bool over = std::abs(x) < half;
    const double depth = (over ? std::sqrt(radius * radius - x * x) - foot : 0) - z;
    if (depth <= 0)
        return glm::dvec3(0);
    const double sine = over ? x / radius : 0;
    return 1000 * depth * glm::dvec3(sine, 0, std::sqrt(1 - sine * sine));
}

glm::dvec3 looked_up(const glm::dvec3& at, double spacing, const glm::dvec2& offset, double turn) {
    const auto turned = [](double x, double y, double angle) {
        return glm::dvec2(std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y);
    };
    const glm::dvec2 flat = turned(at.x, at.y, -turn) / spacing + offset.x;
    const glm::dvec3 place(flat, at.z / spacing + offset.y), first = glm::floor(place);
    glm::dvec3 sum(0);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 sample = first + glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2);
        const glm::dvec3 share = 1.0 - glm::abs(place - sample);
        const double x = turned((sample.x - offset.x) * spacing, (sample.y - offset.x) * spacing, turn).x;
        sum += share.x * share.y * share.z * cylinder_force(x, (sample.z - offset.y) * spacing);
    }
    return sum;
}

// Of a look-up over places of this test alone: the angle to the true force, RMS, deg, where a probe is up to 0.1 mm
// from the rim (along the surface under which it is); and the share of the places up to 0.05 mm above the surface that
// have a force.
struct NearTheSurface {
    double rim, phantom;
};

NearTheSurface near_the_surface(double spacing, const glm::dvec2& offset, double turn) {
    constexpr double kRadius = 0.01524, kHalf = 0.0127, kRing = 1e-4;
    std::mt19937_64 random(1996);
    const auto draw = [&](double low, double high) { return std::lerp(low, high, double(random() >> 11) / 0x1p53); };
    const auto surface = [&](double x) { // z, and the normal
        const double rise = std::sqrt(std::max(kRadius * kRadius - x * x, 0.0));
        const bool over = x < kHalf;
        return std::pair(over ? rise - std::sqrt(kRadius * kRadius - kHalf * kHalf) : 0,
                         over ? glm::dvec3(x, 0, rise) / kRadius : glm::dvec3(0, 0, 1));
    };
    double squares = 0, all = 0, forces = 0;
    while (all < 300) {
        const double x = draw(kHalf - 3e-4, kHalf + kRing), depth = 2e-5 * std::pow(100, draw(0, 1));
        const auto [z, normal] = surface(x);
        const glm::dvec3 at = glm::dvec3(x, draw(-2e-3, 2e-3), z) - depth * normal;
        if (!(std::abs(at.x - kHalf) < kRing * normal.z))
            continue;
        const glm::dvec3 force = cylinder_force(at.x, at.z), found = looked_up(at, spacing, offset, turn);
        if (force == glm::dvec3(0) || found == glm::dvec3(0))
            continue;
        const double angle = std::acos(std::min(1.0, glm::dot(force, found) / glm::length(force) / glm::length(found)));
        squares += angle * angle;
        ++all;
    }
    for (int i = 0; i < 300; ++i) {
        const double x = draw(0, 14.7e-3), depth = 2e-5 * std::pow(2.5, draw(0, 1));
        const auto [z, normal] = surface(x);
        const glm::dvec3 at = glm::dvec3(x, 0, z) + 5e-5 * (depth - 2e-5) / 3e-5 * normal;
        forces += looked_up(at, spacing, offset, turn) != glm::dvec3(0);
    }
    return {std::sqrt(squares / all) / kDegree, forces / 300};
}

// The error of a look-up depends on where its grid lies: a number that were that of one grid would move with it.
TEST(LookUps, HaveTheErrorsThatTheirGridsHaveWhereverTheyLie) {
    Extents extents{{64}, {8}, {0.2e-3}, 1500, 200, 1, 10};
    const std::vector<Subject> subjects = own_subjects(extents);
    const Subject& bump = subjects.front();
    const Variant& shaded = variant_named(bump, "64 facets, reference");
    const auto engine = cpu_engine();
    std::vector<Method> methods;
    add_methods(methods, bump, shaded, 0, {*engine, *engine});
    std::erase_if(methods,
                  [](const Method& one) { return one.family != "look-up, trilinear" || one.precision != "f32"; });
    ASSERT_EQ(methods.size(), 1u);
    KnownPlaces known;
    add_errors(methods, bump, shaded, extents, {*engine, *engine}, known);
    EXPECT_EQ(methods[0].errors->by_draw.size(), extents.draws);
    const Interval found =
        *over_draws(*methods[0].errors, [](const MethodErrors& one) { return one.shared.typical.rms; });

    double typical = 0;
    for (const TouchPlace& place : bump.places)
        typical += reference::dot(cylinder_force(place.at.x, place.at.z), cylinder_force(place.at.x, place.at.z));
    std::vector<double> all;
    double aligned = 0;
    for (int i = 0; i <= 40; ++i) {
        const double x = std::fmod(0.618034 * i, 1),
                     z = std::fmod(0.754878 * i, 1); // the first: samples on rim and plane
        double square = 0;
        for (const TouchPlace& place : bump.places) {
            const glm::dvec3 off =
                looked_up(place.at, 0.2e-3, i == 0 ? glm::dvec2(0.5, 0) : glm::dvec2(x, z), i == 0 ? 0 : 0.7 * i) -
                cylinder_force(place.at.x, place.at.z);
            square += reference::dot(off, off);
        }
        (i == 0 ? aligned : all.emplace_back()) = std::sqrt(square / typical);
    }
    std::ranges::sort(all);
    EXPECT_LT(found.low, all[20]);
    EXPECT_GT(found.high, all[20]);
    EXPECT_NEAR(found.median / all[20], 1, 0.25);
    EXPECT_LT(aligned, 0.5 * all[20]) << "samples on the rim and on the plane are the exception";

    const auto median_of = [&](const auto& number) { return over_draws(*methods[0].errors, number)->median; };
    std::vector<double> rims, phantoms;
    for (int i = 1; i <= 40; ++i) {
        const glm::dvec2 offset(std::fmod(0.618034 * i, 1), std::fmod(0.754878 * i, 1));
        const NearTheSurface near = near_the_surface(0.2e-3, offset, 0.7 * i);
        rims.push_back(near.rim);
        phantoms.push_back(near.phantom);
    }
    std::ranges::sort(rims);
    std::ranges::sort(phantoms);
    EXPECT_NEAR(median_of([](const MethodErrors& one) { return one.of(Kind::rim).direction.rms; }) / rims[20], 1, 0.25);
    EXPECT_NEAR(median_of([](const MethodErrors& one) { return one.of(Kind::boundary).phantom_share(); }), phantoms[20],
                0.05);
}

// The interval of a number holds what other places and grids give.
TEST(LookUps, HaveIntervalsThatHoldTheNumbersOfOtherDraws) {
    const auto engine = cpu_engine();
    const auto found = [&](std::uint64_t first_draw) {
        Extents extents{{64}, {8}, {0.4e-3}, 1000, 150, 1, 11};
        extents.first_draw = first_draw;
        const std::vector<Subject> subjects = own_subjects(extents);
        const Subject& bump = subjects.front();
        const Variant& shaded = variant_named(bump, "64 facets, reference");
        std::vector<Method> methods;
        add_methods(methods, bump, shaded, 0, {*engine, *engine});
        std::erase_if(methods, [](const Method& one) {
            return one.family != "direct" && (one.family != "look-up, trilinear" || one.precision != "f32");
        });
        KnownPlaces known;
        add_errors(methods, bump, shaded, extents, {*engine, *engine}, known);
        std::vector<Interval> numbers;
        for (const Method& method : methods) {
            numbers.push_back(*rms_over_draws(*method.errors, &ForceErrors::typical));
            numbers.push_back(*rms_over_draws(*method.errors, &ForceErrors::direction));
            numbers.push_back(
                *over_draws(*method.errors, [](const MethodErrors& one) { return one.of(Kind::rim).direction.rms; }));
            numbers.push_back(*over_draws(
                *method.errors, [](const MethodErrors& one) { return one.of(Kind::boundary).phantom_share(); }));
        }
        return numbers;
    };
    const std::vector<Interval> here = found(0);
    ASSERT_EQ(here.size(), 12U);
    for (std::uint64_t seed = 100; seed <= 800; seed += 100) {
        const std::vector<Interval> there = found(seed);
        for (std::size_t i = 0; i < here.size(); ++i) {
            EXPECT_LE(here[i].low, there[i].median) << seed << ", number " << i;
            EXPECT_GE(here[i].high, there[i].median) << seed << ", number " << i;
        }
    }
}

// The nearest of a cylinder's triangles between equal arcs, turned and moved: the same numbers by other code.
double direction_error(const Subject& subject, double turn, const glm::dvec2& moved) {
    constexpr double kRadius = 0.01524, kHalf = 0.0127;
    const double depth = std::sqrt(kRadius * kRadius - kHalf * kHalf);
    const glm::dvec2 cell(kRadius * std::asin(kHalf / kRadius) / 4, kHalf / 4); // of 8 cells
    const auto vertex = [&](double i, double j) {
        const glm::dvec2 at = (glm::dvec2(i, j) + moved) * cell;
        const double along = (std::cos(turn) * at.x - std::sin(turn) * at.y) / kRadius;
        return glm::dvec3(kRadius * std::sin(along), std::sin(turn) * at.x + std::cos(turn) * at.y,
                          kRadius * std::cos(along) - depth);
    };
    std::vector<std::array<glm::dvec3, 3>> triangles;
    for (int i = -8; i < 8; ++i)
        for (int j = -8; j < 8; ++j) {
            const glm::dvec3 a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
    double squares = 0, met = 0;
    for (const TouchPlace& place : subject.places) {
        double nearest = 1;
        glm::dvec3 outwards(0);
        for (const auto& corners : triangles) {
            const glm::dvec3 up = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
            const double height = glm::dot(up, place.at - corners[0]);
            const glm::dvec3 foot = place.at - height * up;
            bool within = height < 0 && -height < nearest;
            for (std::size_t k = 0; k < 3; ++k)
                within = within && glm::dot(glm::cross(up, corners[(k + 1) % 3] - corners[k]), foot - corners[k]) >= 0;
            if (within) {
                nearest = -height;
                outwards = up;
            }
        }
        if (nearest == 1) // in front of a facet, or its foot is on an edge
            continue;
        const double angle = glm::degrees(angle_between(outwards, subject.force(place)));
        squares += angle * angle;
        ++met;
    }
    return std::sqrt(squares / met);
}

// A number that were that of one tessellation would move with it.
TEST(Meshes, HaveTheErrorsThatTheirTessellationsHave) {
    Extents extents{{64}, {8}, {}, 500, 0, 1, 101};
    const Subject mesh = own_subjects(extents).back();
    const Variant& flat = variant_named(mesh, "8 cells, none");
    const auto engine = cpu_engine();
    std::vector<Method> methods;
    add_methods(methods, mesh, flat, 0, {*engine, *engine});
    KnownPlaces known;
    add_errors(methods, mesh, flat, extents, {*engine, *engine}, known);
    const Interval found = *rms_over_draws(*methods[0].errors, &ForceErrors::direction);
    std::vector<double> all;
    for (int i = 0; i < 101; ++i)
        all.push_back(direction_error(mesh, 0.7 * i, {std::fmod(0.618034 * i, 1), std::fmod(0.754878 * i, 1)}));
    std::ranges::sort(all);
    EXPECT_GT(all[50], found.low);
    EXPECT_LT(all[50], found.high);
    EXPECT_NEAR(found.median / all[50], 1, 0.1);
    EXPECT_GT(found.high / found.low, 1.2) << "of one tessellation alone the number is not the study's";
}

TEST(TouchedPlaces, OfAGodObjectAreReachedFromAbove) {
    const Subject mesh = own_subjects(few()).back();
    const Variant& flat = variant_named(mesh, "8 cells, none");
    const std::vector<glm::dvec3> found = forces_by(ProxyForce<double>(*flat.prepared, mesh.scale), mesh.places),
                                  direct = forces_by(StaticForce<double>(*flat.prepared), mesh.places);
    std::vector<glm::dvec3> truth;
    for (const TouchPlace& place : mesh.places)
        truth.push_back(mesh.force(place));
    const ForceErrors of_proxy = force_errors(found, truth, 1), of_direct = force_errors(direct, truth, 1);
    EXPECT_NEAR(of_proxy.direction.rms, of_direct.direction.rms, 0.2 * of_direct.direction.rms);
    EXPECT_EQ(of_proxy.missed, of_direct.missed) << "facets of 8 cells lie up to 0.1 mm below the cylinder";
}

// A volume of a function of the place, and a place within.
template <typename Function> glm::dvec3 read(const Function& function, bool cubic, const glm::dvec3& at) {
    const GridSpec grid = volume_grid({0, 0, 0}, {1, 1, 1}, 0.25, glm::dvec3(0.3));
    std::vector<double> forces;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        for (std::size_t j = 0; j < grid.size[1]; ++j)
            for (std::size_t i = 0; i < grid.size[0]; ++i) {
                const glm::dvec3 origin(grid.origin[0], grid.origin[1], grid.origin[2]);
                const glm::dvec3 force = function(origin + grid.spacing[0] * glm::dvec3(i, j, k));
                forces.insert(forces.end(), {force.x, force.y, force.z});
            }
    const Volume<double, double, 3> volume(grid, std::move(forces));
    return cubic ? volume.tricubic(at) : volume.trilinear(at);
}

TEST(Volume, TrilinearIsExactForProductsTricubicForSquares) {
    const auto expect_near = [](const glm::dvec3& one, const glm::dvec3& other) {
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(one[i], other[i], 1e-13);
    };
    const auto product = [](const glm::dvec3& p) { return glm::dvec3(p.x * p.y * p.z, 1 - p.x, p.y + 2 * p.z); };
    const auto square = [](const glm::dvec3& p) { return glm::dvec3(p.x * p.x, p.y * p.y - p.z, p.z * p.z * p.x); };
    for (const glm::dvec3& at : {glm::dvec3(0.1, 0.2, 0.33), {0.99, 0.01, 0.5}, {0.25, 0.75, 1}}) {
        expect_near(read(product, false, at), product(at));
        expect_near(read(product, true, at), product(at));
        expect_near(read(square, true, at), square(at));
        EXPECT_GT(std::abs(read(square, false, {0.1, 0.2, 0.33}).x - 0.01), 1e-3);
    }
}

// Rounds that a machine slows down and speeds up at random, all methods alike.
Times times_of(const std::vector<double>& seconds, std::size_t rounds = 31) {
    Random draw(3);
    std::vector<Round> all;
    for (std::size_t i = 0; i < rounds; ++i) {
        const double load = draw(1, 3);
        Round round;
        for (const double one : seconds)
            round.push_back(load * one * draw(0.97, 1.03));
        all.push_back(round);
    }
    return {all, 0};
}

TEST(PairedRounds, TellApartWhatTheMachinesLoadWouldHide) {
    const Times times = times_of({1, 1.1, 1.001});
    const Interval ratio = times.ratio(1, 0);
    EXPECT_GT(ratio.low, 1);
    EXPECT_LT(ratio.low, 1.1);
    EXPECT_GT(ratio.high, 1.1 * 0.98);
    EXPECT_TRUE(times.is_cheaper(0, 1));
    EXPECT_FALSE(times.is_cheaper(1, 0));
    EXPECT_FALSE(times.is_cheaper(0, 2) || times.is_cheaper(2, 0)) << "a tie";
    EXPECT_EQ(times.ratio(1, 1).high, 1);
}

TEST(PairedRounds, NameTiesOfTheCheapest) {
    const Cheapest cheapest = cheapest_of(times_of({1, 1.1, 1.0005, 2}), {0, 1, 2, 3});
    EXPECT_TRUE(cheapest.method == 0 || cheapest.method == 2);
    EXPECT_EQ(cheapest.ties, std::vector<std::size_t>{2 - cheapest.method});
    EXPECT_EQ(cheapest_of(times_of({1, 1.1}), {1}).ties.size(), 0u);
}

TEST(PairedRounds, FrontHasWhatIsCheaperForSure) {
    const Times times = times_of({1, 2, 2.001, 4, 3});
    //                           error: 8, 4, 5 (tied with 4), 1, none
    EXPECT_EQ(front_of(times, {0, 1, 2, 3, 4}, {8, 4, 5, 1, NAN}), (std::vector<std::size_t>{3, 1, 0}));
    EXPECT_EQ(front_of(times, {0, 1}, {1, 2}), std::vector<std::size_t>{0}) << "closer and cheaper";
    EXPECT_EQ(front_of(times, {0, 1}, {1.001, 1}), std::vector<std::size_t>{0}) << "dearer, and hardly closer";
}

TEST(PairedRounds, SayHowSureAFrontIs) {
    const Times times = times_of({1, 2, 2.001, 4});
    const std::vector<double> shares = front_shares(times, {0, 1, 2, 3}, {{8}, {4, 5.5}, {5}, {1}});
    EXPECT_DOUBLE_EQ(shares[0], 1);
    EXPECT_DOUBLE_EQ(shares[3], 1);
    EXPECT_GT(shares[1], 0.3) << "tied in time, and closer in one of two draws";
    EXPECT_LT(shares[1], 0.9);
    EXPECT_GT(shares[2], 0.3);
    EXPECT_LT(shares[2], 0.9);
}

// Where facets are few the field has errors that shading over many does not have; a stroke has what is true beside it.
TEST(Sections, ShowWhereAWayErrsAndWhatAStrokeFeels) {
    const std::vector<Subject> subjects = own_subjects(few());
    const auto method_of = [&](const std::string& name) {
        Method method;
        method.name = name;
        method.subject = &subjects.front();
        method.variant = &variant_named(subjects.front(), name);
        method.forces = [&, variant = method.variant](std::span<const TouchPlace> at) {
            return forces_by(StaticForce<double>(*variant->prepared), at);
        };
        return method;
    };
    const Method coarse = method_of("4 facets, none"), fine = method_of("64 facets, reference");
    const Method* const methods[] = {&coarse, &fine};
    const std::vector<Table> tables = section_tables(methods);
    std::map<std::string, double> largest, deep;
    for (std::size_t row = 0; row < tables[0].rows.size(); ++row) {
        const std::string method = tables[0].word(row, "way");
        const double error = tables[0].needed(row, "local_max_1");
        EXPECT_GE(error, 1e-4);
        largest[method] = std::max(largest[method], error);
        if (tables[0].needed(row, "height_mm") == -2)
            deep[method] = std::max(deep[method], error);
    }
    EXPECT_GT(deep[coarse.name], 0.2) << "the direction is wrong however deep";
    EXPECT_LT(deep[fine.name], 0.01);
    EXPECT_GT(largest[fine.name], 0.05) << "a chord lies 1.8 um below its arc, 0.02 mm over the probe";
    std::size_t planes = 0;
    for (std::size_t row = 0; row < tables[1].rows.size(); ++row)
        if (tables[1].word(row, "way") == kSmoothShape && std::abs(tables[1].needed(row, "x_mm")) > 13) {
            EXPECT_NEAR(tables[1].needed(row, "force_N"), tables[1].word(row, "component") == "along x" ? 0 : 0.5,
                        1e-3);
            ++planes;
        }
    EXPECT_GT(planes, 20u) << "0.5 mm below the plane beside the bump, 1 N/mm";
}

// A loop that is sampled and held has an error of first order in its period. On a plane every loop comes to rest where
// spring and press are in balance, whatever its rate.
TEST(LoopRuns, ErrByTheirPeriodAndNotWhereTheyRest) {
    const auto engine = cpu_engine(1);
    const std::vector<Subject> subjects = own_subjects({{1, 64}, {16}, {0.8e-3}, 100, 20, 1, 1, 1});
    const auto error = [&](const std::vector<LoopRun>& runs, double rate, Precision precision) {
        const auto found =
            std::ranges::find_if(runs, [&](const LoopRun& r) { return r.rate == rate && r.precision == precision; });
        return *found;
    };
    const auto runs = loop_runs("mesh", variant_named(subjects.back(), "16 cells, mean_value"), *engine, 1);
    for (const double rate : {1000.0, 2000.0, 4000.0}) {
        const double ratio =
            error(runs, rate, Precision::f64).position_error / error(runs, 2 * rate, Precision::f64).position_error;
        EXPECT_GT(ratio, 1.6) << rate;
        EXPECT_LT(ratio, 2.6) << rate;
        EXPECT_NEAR(error(runs, rate, Precision::f32).force_error / error(runs, rate, Precision::f64).force_error, 1,
                    0.01);
    }
    // Across a rim: first order at half of the instants; where one crosses earlier than the other both differ by the
    // whole turn, for a time of first order, of which the RMS is the root.
    const auto rims = loop_runs("bump", variant_named(subjects.front(), "64 facets, reference"), *engine, 1);
    for (const double rate : {1000.0, 2000.0, 4000.0}) {
        const LoopRun coarse = error(rims, rate, Precision::f64), fine = error(rims, 2 * rate, Precision::f64);
        EXPECT_GT(coarse.median_error / fine.median_error, 1.7) << rate;
        EXPECT_LT(coarse.median_error / fine.median_error, 2.6) << rate;
        EXPECT_NEAR(coarse.force_error / fine.force_error, std::sqrt(2.0), 0.25) << rate;
    }
    const auto flat = loop_runs("plane", variant_named(subjects.front(), "1 facets, none"), *engine, 1);
    for (const LoopRun& run : flat) {
        EXPECT_LT(run.force_error, 5e-3) << run.rate;
        EXPECT_GT(run.seconds, 0);
    }
}

// Of waits: ranks, each method its own, with the numbers in order; and what a loop sleeps through is no method's time.
TEST(AsMetTimes, AreOfSingleEvaluationsInTurns) {
    std::vector<Method> methods(2);
    std::vector<std::size_t> numbers;
    methods[0].once = [&](std::size_t number) {
        numbers.push_back(number);
        return number == 7 ? 9e-6 : 1e-6;
    };
    methods[1].once = [](std::size_t) { return 5e-6; };
    const Clock::time_point start = Clock::now();
    AsMetTimes times(methods, {0, 1});
    times.measure(15, 2);
    times.measure(5, 1);
    const std::vector<AsMet> met = times.result();
    EXPECT_GT(seconds_since(start), 3 * 20 / kLoopRate - 2e-3) << "three take turns, a tick each";
    ASSERT_EQ(met.size(), 3U);
    EXPECT_EQ(met[0].method, AsMet::kControl);
    EXPECT_NEAR(met[1].loop.median.median, 1e-6, 1e-12);
    EXPECT_NEAR(met[1].loop.median.high, 1e-6, 1e-12);
    EXPECT_NEAR(met[1].loop.worst, 9e-6, 1e-12);
    EXPECT_NEAR(met[1].cold.worst, 1e-6, 1e-12) << "number 7 is not among them";
    EXPECT_NEAR(met[2].loop.median.median, 5e-6, 1e-12);
    EXPECT_EQ(numbers.size(), 2U + 20 + 3) << "once more each time, to make volumes";
    EXPECT_EQ(numbers[23], 19U);
    EXPECT_EQ(numbers[24], 2U);
}

TEST(Crowding, IsSeenWhereOtherWorkWantsTheCores) {
    std::atomic<bool> done = false;
    std::vector<std::jthread> others;
    for (unsigned i = 0; i < 2 * most_threads(); ++i)
        others.emplace_back([&] {
            while (!done) {
            }
        });
    std::vector<double> crowding;
    for (int i = 0; i < 5; ++i)
        crowding.push_back(crowding_of_cores());
    done = true;
    EXPECT_GT(quantile(crowding, 0.5), 1.25);
    const Times times({}, 0);
    EXPECT_TRUE((Measured{{}, {}, times}.steady()));
    EXPECT_FALSE((Measured{{}, {}, times, {1, 1, 1}, bootstrap_median(crowding)}.steady()));
}

TEST(AsMetTimes, AreTakenInOrdersThatDiffer) {
    std::vector<std::size_t> first = shuffled(20, 1);
    EXPECT_EQ(first, shuffled(20, 1));
    EXPECT_NE(first, shuffled(20, 2));
    std::ranges::sort(first);
    for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_EQ(first[i], i);
}

TEST(AsMetTimes, SayNothingWhereTheControlWaits) {
    AsMet control{AsMet::kControl, {{0.1e-6, 0.1e-6, 0.1e-6}, 2e-6, 4e-6, 5e-6}, {}, 1000, 10};
    EXPECT_FALSE(was_busy({control}));
    control.loop.p99 = 2e-5;
    EXPECT_TRUE(was_busy({control}));
    control.loop = {{2e-6, 2e-6, 2e-6}, 3e-6, 4e-6, 4e-6};
    EXPECT_TRUE(was_busy({control}));
}

TEST(AsMetTimes, AreOfEachLawsFinestVolume) {
    const auto engine = cpu_engine(1);
    Extents extents = few();
    extents.cells = {16};
    const std::vector<Subject> subjects = own_subjects(extents);
    std::vector<Method> methods;
    for (const Subject& subject : subjects)
        for (const Variant& variant : subject.variants)
            add_methods(methods, subject, variant, 0, {*engine, *engine});
    std::size_t volumes = 0, proxies = 0;
    for (const std::size_t i : met_methods(methods)) {
        EXPECT_TRUE(!methods[i].spacing || *methods[i].spacing == 0.4e-3) << methods[i].name;
        EXPECT_TRUE(methods[i].variant->shading != "none" || !methods[i].spacing) << methods[i].name;
        volumes += methods[i].spacing.has_value();
        proxies += methods[i].family == "god-object";
        EXPECT_GT(methods[i].once(0), 0);
    }
    EXPECT_EQ(volumes, 6U + 6);
    EXPECT_EQ(proxies, 4U) << "shaded and unshaded";
}

// A whole run on a scene whose smooth shape is not known.
class SceneErrorTime : public ::testing::Test {
protected:
    StudyData run(const std::string& scene) {
        StudyOptions options;
        options.folder = folder_ / "error-time";
        options.quick = true;
        options.engine.cpu = true;
        options.scene = parse_scene(scene, "test", folder_.path());
        StudyRun run("error-time", options);
        return study_error_time(run);
    }

    testing::Folder folder_;
};

TEST_F(SceneErrorTime, NamesNothingTheCheapestWithoutATruth) {
    const StudyData data =
        run("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nheight = \"2 mm\"\nradius = \"3 mm\"\n"
            "[force]\nshading = \"height_map\"\n[grid]\nsize = [24, 16, 16]\n"
            "origin = [\"-12 mm\", \"-8 mm\", \"-3 mm\"]\nspacing = [\"1 mm\", \"1 mm\", \"0.4 mm\"]\n");
    EXPECT_TRUE(says(data.notes.front(), "threads ran or waited on the machine")) << "times depend on its load";
    EXPECT_TRUE(data.table("cheapest").rows.empty());
    ASSERT_FALSE(data.findings.empty());
    EXPECT_LE(data.findings.size(), 6u);
    for (const Finding& finding : data.findings) {
        EXPECT_FALSE(says(finding.place, "bump")) << finding.text;
        EXPECT_FALSE(says(finding.text + finding.interval, "nan"));
        EXPECT_FALSE(says(finding.text + finding.interval, "inf"));
    }
    for (const auto& row : data.table("ways").rows)
        EXPECT_EQ(std::get<std::string>(row[data.table("ways").index("against")]),
                  "height_map shading in double precision");
}

TEST_F(SceneErrorTime, NeedsASurfaceInItsGrid) {
    EXPECT_THROW(run("[grid]\nsize = [8, 8, 8]\norigin = [\"0 mm\", \"0 mm\", \"50 mm\"]\nspacing = \"1 mm\"\n"),
                 UsageError);
}

} // namespace
} // namespace forceshade::study::error_time
