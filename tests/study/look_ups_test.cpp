// Errors of volumes and of meshes wherever their samples and cells lie.
#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "host/study/error_time/error_time.h"
#include "host/study/error_time/volumes.h"
#include "host/touch/force_at.h"
#include "host/touch/force_errors.h"
#include "tests/study/subjects.h"

namespace forceshade::study::error_time {
namespace {

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
        EXPECT_GT(near, mesh.places.size() * 11 / 20) << shading;
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

} // namespace
} // namespace forceshade::study::error_time
