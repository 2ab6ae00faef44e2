// Loops of the study of stability: closed forms, places, limits, swings and diagrams.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/scene/study.h"
#include "host/study/stability/stability.h"
#include "host/touch/force_at.h"
#include "host/touch/force_errors.h"
#include "host/touch/own_surfaces.h"
#include "host/touch/places.h"
#include "tests/io/folder.h"
#include "tests/paths/sampled_plants.h"

namespace forceshade::study {
namespace {

using testing::kPlants;
using testing::Plant;
using testing::says;

TEST(LinearLoop, PassiveWithHalfASampleAndItsDelay) {
    EXPECT_DOUBLE_EQ(passive_stiffness(1, 1e-3, 0), 2000);
    EXPECT_DOUBLE_EQ(passive_stiffness(1, 1e-3, 1), 2000.0 / 3);
}

HandSpec bare_hand(double mass, double damping, std::uint64_t delay = 0) {
    HandSpec hand;
    hand.mass = mass;
    hand.damping = damping;
    hand.grip_stiffness = hand.grip_damping = 0;
    hand.delay_samples = delay;
    return hand;
}

TEST(LinearLoop, IsTheClosedFormOnAWall) {
    for (const Plant& plant : kPlants) {
        EXPECT_NEAR(wall_limit(bare_hand(plant.mass, plant.damping), 1 / plant.period) / plant.limit, 1, 1e-4);
        EXPECT_NEAR(wall_limit(bare_hand(plant.mass, plant.damping, 1), 1 / plant.period) / plant.limit_late, 1, 1e-4);
    }
    // b / (T (1/2 + delay)) where damping takes many samples
    EXPECT_NEAR(wall_limit(bare_hand(10, 1, 4), 1000) / passive_stiffness(1, 1e-3, 4), 1, 1e-2);
}

// Whether a mass on a wall goes further out: its command held over each sample, the force following it with a time
// constant, in steps of a hundredth of a sample.
bool swings_out(double mass, double damping, double stiffness, double period, double lag) {
    const int fine = 100, samples = 30000;
    const double step = period / fine;
    double place = 1, speed = 0, force = 0, early = 0, late = 0;
    for (int i = 0; i < samples && std::abs(place) < 1e6; ++i) {
        const double given = -stiffness * place;
        for (int j = 0; j < fine; ++j) { // midpoint rule
            const double middle_force = force + (given - force) * step / (2 * lag),
                         middle_speed = speed + (force - damping * speed) / mass * step / 2;
            speed += (middle_force - damping * middle_speed) / mass * step;
            place += middle_speed * step;
            force += (given - middle_force) * step / lag;
        }
        double& most = i < samples / 2 ? early : late;
        if (i > samples / 4)
            most = std::max(most, std::abs(place));
    }
    return late > early;
}

TEST(LinearLoop, ALateForceOfTheDeviceLowersTheLimit) {
    // Routh & Hurwitz, where the force is not held: K < b / lag + b^2 / m.
    for (const double lag : {0.003, 0.02})
        EXPECT_NEAR(wall_limit(bare_hand(0.1, 2), 1e5, lag) / (2 / lag + 40), 1, 3e-3) << lag;
    EXPECT_NEAR(wall_limit(bare_hand(0.1, 2), 1000, 1e-7) / wall_limit(bare_hand(0.1, 2), 1000), 1, 1e-3);
    for (const double lag : {2e-4, 2e-3, 2e-2}) {
        const double limit = wall_limit(bare_hand(0.1, 2), 1000, lag);
        EXPECT_FALSE(swings_out(0.1, 2, 0.98 * limit, 1e-3, lag)) << lag;
        EXPECT_TRUE(swings_out(0.1, 2, 1.02 * limit, 1e-3, lag)) << lag;
    }
}

// `slope` is -dF/dp per N/m of K, of the plane x-z. N/m above which its pair of complex modes grows where the force is
// not held but continuous: b^2 sigma / (m omega^2).
double flutter_stiffness(const glm::dmat3& slope, double mass, double damping) {
    const double xx = slope[0][0], xz = slope[2][0], zx = slope[0][2], zz = slope[2][2]; // columns first
    const double sigma = (xx + zz) / 2, square = xx * zz - xz * zx - sigma * sigma;
    EXPECT_GT(square, 0);
    return damping * damping * sigma / (mass * square);
}

// The laws' table: a slope of 50 deg, pressed to 0.131 of the radius, flutters at 71 N/m, held over 1 ms at 69.
TEST(LinearLoop, ShadedDipFlutters) {
    const double s = std::sin(50 * kDegree), c = std::cos(50 * kDegree), deep = 0.131;
    glm::dmat3 slope(0); // columns first
    slope[0] = {deep, 0, -deep * s / c};
    slope[2] = {s, 0, c};
    const HandSpec hand = bare_hand(0.1, 1);
    const Hold down{"down", {0, 0, 1}};
    EXPECT_NEAR(flutter_stiffness(slope, 0.1, 1), 71, 0.5);
    EXPECT_NEAR(linear_limit(hand, 1000, down, {slope}).value(), 69, 0.5);
    EXPECT_NEAR(linear_limit(hand, 1e4, down, {slope}).value(), flutter_stiffness(slope, 0.1, 1), 0.5);
    EXPECT_FALSE(grows(hand, 1000, down, {slope}, 65));
    EXPECT_TRUE(grows(hand, 1000, down, {slope}, 75));
}

// A spring alone in line with a wall is a softer wall.
TEST(LinearLoop, ThroughASpringIsThatOfBothInLine) {
    const glm::dvec3 up(0, 0, 1);
    for (const std::uint64_t delay : {0, 1, 3}) {
        const HandSpec bare = bare_hand(0.1, 1, delay);
        const double wall = wall_limit(bare, 1000);
        const ForceAround force{glm::outerProduct(up, up), up};
        EXPECT_NEAR(linear_limit(coupled(bare, 3 * wall, 0), 1000, pressed_along(up), force).value() / (1.5 * wall), 1,
                    1e-3);
        EXPECT_FALSE(linear_limit(coupled(bare, 0.99 * wall, 0), 1000, pressed_along(up), force));
        // A damper holds more than a spring, up to where it jerks itself.
        EXPECT_TRUE(grows(coupled(bare, 2 * wall, 0), 1000, pressed_along(up), force, 1e6));
        EXPECT_FALSE(grows(coupled(bare, 2 * wall, 3), 1000, pressed_along(up), force, 1e6));
        EXPECT_TRUE(grows(coupled(bare, wall, 300), 1000, pressed_along(up), force, 1e6));
    }
}

const LoopSurface& own(const std::string& name) {
    static const std::vector<LoopSurface> surfaces = own_surfaces();
    return *std::ranges::find(surfaces, name, &LoopSurface::name);
}

const std::vector<RestPlace>& places_on(const std::string& name) {
    static std::map<std::string, std::vector<RestPlace>> places;
    if (!places.contains(name))
        places[name] = rest_places(own(name), 60);
    return places[name];
}

TEST(RestPlaces, AreWhereTheShapeHasThem) {
    std::map<PlaceKind, int> counts;
    const double half = 0.0127; // m
    for (const RestPlace& place : places_on("bump of 2 facets")) {
        ++counts[place.kind];
        const double x = place.at.x;
        if (place.kind == PlaceKind::flat) {
            EXPECT_GT(std::abs(place.at.x), half);
        }
        if (place.kind == PlaceKind::slope) {
            EXPECT_NEAR(angle_between(place.force, glm::dvec3(0, 0, 1)) / kDegree, 28.22, 0.01) << x;
        }
        if (place.kind == PlaceKind::edge) {
            EXPECT_NEAR(place.at.x, 0, 1e-6);
            EXPECT_NEAR(place.jump / kDegree, 2 * 28.22, 0.01);
        }
        if (place.kind == PlaceKind::foot) {
            EXPECT_NEAR(std::abs(place.at.x), half, 1e-6);
            EXPECT_NEAR(place.jump / kDegree, 28.22, 0.01);
        }
        if (!jumps(place.kind)) {
            EXPECT_NEAR(glm::length(place.force) / place.depth, 1, 1e-3) << name_of(place.kind) << " at " << x;
        }
    }
    EXPECT_GT(counts[PlaceKind::flat], 10);
    EXPECT_GT(counts[PlaceKind::slope], 100);
    EXPECT_GE(counts[PlaceKind::edge], 3);
    EXPECT_GE(counts[PlaceKind::foot], 4);
    EXPECT_EQ(counts[PlaceKind::crest] + counts[PlaceKind::hollow], 0) << "its facets are planes";
}

// S = [[d, s], [-d s / c, c]] with d the depth over R, s and c of the slope x / R.
TEST(RestPlaces, KnowHowTheForceChanges) {
    const double radius = own("height map of a dip").prepared.one.scene.surface.map.radius;
    int slopes = 0;
    for (const RestPlace& place : places_on("height map of a dip")) {
        if (place.kind != PlaceKind::slope)
            continue;
        ++slopes;
        const double s = std::abs(place.at.x) / radius, c = std::sqrt(1 - s * s), deep = place.depth / radius;
        EXPECT_NEAR(place.slope[0][0], deep, 1e-3 * deep);
        EXPECT_NEAR(std::abs(place.slope[2][0]), s, 1e-6);
        EXPECT_NEAR(std::abs(place.slope[0][2]), deep * s / c, 1e-5);
        EXPECT_NEAR(place.slope[2][2], c, 1e-6);
    }
    EXPECT_GT(slopes, 50);
}

// On the crest of a texture, d deep, the force pushes aside as K_t d H (2 pi / L)^2 for each metre: what the grip
// holds.
TEST(LeastLimits, OfATextureAreTheGrips) {
    const LoopSurface& textured = own("textured plane");
    const std::vector<LeastLimit> limits =
        least_limits(textured, places_on("textured plane"), settings_of(textured, true));
    for (const double depth : {0.001, 0.002}) {
        const double aside = depth * 1e-5 * std::pow(2 * std::numbers::pi / 0.002, 2);
        EXPECT_NEAR(*worst_of(limits, "textured plane", depth)->limit * aside / textured.hand.grip_stiffness, 1, 0.01);
    }
}

TEST(LeastLimits, AreThoseOfTheSteppedLoop) {
    for (const char* name : {"plane", "textured plane", "shaded bump of 2 facets", "height map of a bump",
                             "shaded mesh", "morgenbesser mesh"}) {
        const std::vector<LeastLimit> limits = least_limits(own(name), places_on(name), settings_of(own(name), true));
        const LeastLimit& worst = *worst_of(limits);
        EXPECT_NEAR(simulated_limit(own(name), worst).value() / *worst.limit, 1, 2e-3) << name;
    }
}

// Pressed down on a shaded cylinder at x, a hand gives way where the grip's spring k holds less than the turning force
// takes: K d = k (R^2 - x^2) / R, whatever the damping and the rate (by hand, from the static balance).
TEST(LeastLimits, OnAShadedSlopeAreTheGrips) {
    const double R = 0.0254, depth = 2e-3;
    const double x = 0.0107;
    for (const double grip : {50.0, 200.0, 400.0}) {
        LoopSurface surface;
        surface.prepared = own_case({.shaded = true, .radius = R, .facets = 4096, .stiffness = 1});
        surface.deepest = 2e-3;
        ContactForce force(surface.prepared, surface.scale());
        const double normal = std::sqrt(R * R - x * x) / R, foot = std::sqrt(R * R - 0.0127 * 0.0127);
        const glm::dvec3 at(x, 0, std::sqrt(R * R - x * x) - foot - depth);
        glm::dmat3 slope(0); // of the cylinder, not of a facet
        const double rise = -x / R / normal, turn = -x / (R * R) / normal;
        slope[0] = -glm::dvec3(rise * x / R + depth / R, 0, rise * normal + depth * turn);
        slope[2] = glm::dvec3(x / R, 0, normal);
        EXPECT_NEAR(glm::length(force({at}) / depth - glm::dvec3(x / R, 0, normal)), 0, 1e-3);
        HandSpec hand;
        hand.grip_stiffness = grip;
        const double limit = linear_limit(hand, 1000, pressed_along({0, 0, 1}), {slope}).value();
        EXPECT_NEAR(limit / (grip * (R * R - x * x) / R / depth), 1, 0.01) << grip;
        EXPECT_NEAR(*grip_limit(hand, pressed_along({0, 0, 1}), {slope}) / (grip * (R * R - x * x) / R / depth), 1,
                    1e-9);
        EXPECT_NEAR(*grip_limit(hand, pressed_along({x / R, 0, normal}), {slope}) / (grip * R / depth), 1, 1e-9);
        // On all sides: the lower root K of k^2 + k K (S_xx + S_zz) + K^2 det S = 0 above 0.
        const double trace = slope[0][0] + slope[2][2], det = slope[0][0] * slope[2][2] - slope[2][0] * slope[0][2];
        const double root = grip * (-trace - std::sqrt(trace * trace - 4 * det)) / (2 * det);
        EXPECT_NEAR(*grip_limit(hand, {"on all sides", glm::dvec3(0)}, {slope}) / root, 1, 1e-9);
        EXPECT_FALSE(grip_limit(hand, pressed_along({0, 0, 1}), wall_place().force_around()));
    }
}

TEST(LeastLimits, OfAnyPressAreNoMoreThanThoseOfADenseSearch) {
    for (const char* name : {"shaded bump of 2 facets", "shaded bump of 8 facets"}) {
        const LoopSurface& bump = own(name);
        LoopCell late{bump.hand, bump.rate, 1}, quick{bump.hand, 4 * bump.rate, 1};
        late.hand.delay_samples = 1;
        const auto limits = least_limits(bump, places_on(bump.name), {{bump.hand, bump.rate, 1}, late, quick}, true);
        std::size_t rows = 0;
        for (const LeastLimit& one : limits) {
            if (one.place.kind != PlaceKind::slope)
                continue;
            ASSERT_TRUE(one.any_press);
            ++rows;
            double least = std::numeric_limits<double>::infinity();
            for (int degrees = -115; degrees <= 115; degrees += 5) {
                const double angle = degrees * kDegree;
                const glm::dvec3 along(std::sin(angle), 0, std::cos(angle));
                for (const RestPlace& place : places_on(bump.name))
                    if (place.kind == one.place.kind && place.depth == one.place.depth &&
                        supports(along, place.force, place.slope))
                        least = std::min(least, linear_limit(one.cell.hand, one.cell.rate, pressed_along(along),
                                                             place.force_around())
                                                    .value_or(least));
            }
            EXPECT_LE(one.any_press->limit, 1.01 * least);
            EXPECT_LE(one.any_press->limit, *one.limit);
        }
        EXPECT_EQ(rows, 4U * 3);
    }
}

// K at which the balance of the shaded bump's force and of the grip's spring turns, the least over places under `depth`
// and over presses: where det(K S + G) = 0, S from the force d (x / R, sqrt(1 - x^2 / R^2)) by hand, G = k_g (1 - p
// p^T).
double least_balance(double radius, double half, double depth, double grip) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 4000; ++i) {
        const double x = half * i / 4000, rise = std::sqrt(radius * radius - x * x), up = rise / radius;
        const double aside = x / radius, falls = -x / rise;
        const double xx = -(falls * aside + depth / radius), xz = aside, zz = up;
        const double zx = -(falls * up - depth * x / (radius * rise)), turning = xx * zz - xz * zx;
        for (double degrees = -115; degrees <= 115; degrees += 0.5) {
            const double px = std::sin(degrees * kDegree), pz = std::cos(degrees * kDegree);
            const double along = px * (xx * px + xz * pz) + pz * (zx * px + zz * pz);
            if (px * aside + pz * up < 0.2 || along < 0.2 || !(turning < 0))
                continue;
            const double mixed = grip * (xx * (1 - pz * pz) + zz * (1 - px * px) + (xz + zx) * px * pz);
            least = std::min(least, std::max(0.0, -mixed / turning));
        }
    }
    return least;
}

TEST(LeastLimits, OfAnyPressIsWhereTheStaticBalanceTurns) {
    const LoopSurface& bump = own("shaded bump of 2 facets");
    double found = std::numeric_limits<double>::infinity();
    for (const LeastLimit& one : least_limits(bump, places_on(bump.name), {{bump.hand, bump.rate, 1}}, true))
        if (one.any_press && one.place.depth == bump.deepest)
            found = std::min(found, one.any_press->limit);
    EXPECT_NEAR(found / least_balance(kOwnRadius, kOwnHalfWidth, bump.deepest, bump.hand.grip_stiffness), 1, 0.01);
}

TEST(LeastLimits, AreNoMoreThanAnyPlaces) {
    const LoopSurface& map = own("height map of a bump");
    const std::vector<LeastLimit> limits = least_limits(map, places_on(map.name), settings_of(map, true));
    const double least = worst_of(limits)->limit.value();
    EXPECT_LT(least, 0.9 * worst_of(limits)->wall) << "a shaded slope bears less than a wall";
    for (const RestPlace& place : places_on(map.name)) {
        if (!jumps(place.kind)) {
            for (const Hold& hold : usual_holds(place.force, place.slope)) {
                EXPECT_FALSE(grows(map.hand, map.rate, hold, place.force_around(), 0.999 * least)) << hold.name;
            }
        }
    }
}

// The least is at the border of the box, 1201 N/m by other code.
TEST(LeastLimits, OfSearchedPlacesAreNoMoreThanThoseOfManyMore) {
    const LoopSurface& mesh = own("shaded mesh");
    const auto least = [&](const std::vector<RestPlace>& places) {
        return worst_of(least_limits(mesh, places, {{mesh.hand, mesh.rate, 1}}))->limit.value();
    };
    const double searched = least(searched_places(mesh, 40, Searched::of_each_kind));
    EXPECT_NEAR(searched, 1201, 5);
    EXPECT_LE(searched, least(rest_places(mesh, 300)));
    EXPECT_GT(least(rest_places(mesh, 40)), 1.05 * searched) << "drawn places alone";
}

// On a plane the wall's limit alone counts; on a curved one less, and less still where it is felt enlarged.
TEST(SceneLimits, NameWhatTheyLeaveOut) {
    const auto text_of = [](const std::string& surface, const std::string& hand) {
        return scene_limits(
                   CasePreparation().prepare(parse_scene("[surface]\nkind = \"bump\"\nradius = \"600 mil\"\n" +
                                                             surface + "\n[paths]\npress = \"1 N\"\n[hand]\n" + hand,
                                                         "scene.toml")))
            .text();
    };
    const std::string steps = "quantisation = \"10 um\"\ncoulomb = \"0.003 N\"\n";
    EXPECT_TRUE(says(text_of("facets = 2", ""), "turns inwards (by 28 deg)"));
    EXPECT_FALSE(says(text_of("facets = 1", ""), "turns inwards"));
    EXPECT_TRUE(says(text_of("facets = 1", steps), "; above 600 N/m friction does not hold a step"));
    EXPECT_FALSE(says(text_of("facets = 1", ""), "hold a step"));
}

TEST(SceneLimits, SayWhetherASceneIsStable) {
    const auto limits_of = [](const std::string& text, double scale = 1) {
        return scene_limits(CasePreparation().prepare(parse_scene(text, "scene.toml")), 1000, 8.5, scale);
    };
    const SceneLimits plane = limits_of("surface = {facets = 1}\nforce.stiffness = \"6 N/mm\"");
    EXPECT_DOUBLE_EQ(plane.wall, critical_stiffness(0.1, 3, 1e-3, 0));
    EXPECT_NEAR(plane.limit() / plane.wall, 1, 1e-4);
    EXPECT_EQ(plane.warning(), "");
    EXPECT_NE(limits_of("surface = {facets = 1}\nforce.stiffness = \"6.1 N/mm\"").warning(), "");
    const std::string shaded = "surface = {facets = 64}\nforce = {shading = \"reference\", stiffness = \"1 N/mm\"}";
    const SceneLimits bump = limits_of(shaded);
    EXPECT_LT(bump.limit(), 0.25 * bump.wall);
    EXPECT_EQ(bump.least->place.kind, PlaceKind::slope);
    EXPECT_TRUE(bump.stable());
    EXPECT_FALSE(limits_of(shaded, 1.2 * bump.limit() / 1000).stable());
    EXPECT_EQ(limits_of("hand = {damping = \"0 N s/m\", grip_damping = \"0 N s/m\"}\nsurface.facets = 1").limit(), 0);
}

TEST(SceneLimits, SayWhetherABristleIsStable) {
    const auto limits_of = [](const std::string& text, double scale = 1) {
        return scene_limits(CasePreparation().prepare(parse_scene("surface.facets = 1\n" + text, "scene.toml")), 1000,
                            8.5, scale);
    };
    EXPECT_TRUE(limits_of("friction.stiffness = \"5.9 N/mm\"").stable());
    EXPECT_EQ(limits_of("friction.stiffness = \"5.9 N/mm\"").warning(), "");
    const SceneLimits stiff = limits_of("friction.stiffness = \"10 N/mm\"");
    EXPECT_FALSE(stiff.stable());
    EXPECT_FALSE(stiff.safe) << "a coupling is for the surface's stiffness";
    EXPECT_TRUE(says(stiff.warning(), "the bristle of [friction] is a spring of 1e+04 N/m along the surface, where "
                                      "that hand comes to rest below 6030 N/m; a lower friction.stiffness would hold"));
    EXPECT_FALSE(limits_of("friction.stiffness = \"4 N/mm\"", 2).stable()) << "two metres of the scene in one";
    EXPECT_TRUE(limits_of("friction.stiffness = \"10 N/mm\"\nhand.coupling.stiffness = \"1 N/mm\"").stable());
}

TEST(CouplingLimits, AreWhereSteppedLoopsBeginToGrow) {
    for (const char* name : {"plane", "shaded bump of 2 facets", "height map of a dip"}) {
        const std::vector<CouplingRow> rows = couplings_on(own(name), places_on(name));
        EXPECT_EQ(rows.size(), 9u) << name;
        EXPECT_EQ(rows.back().scene, 1e7) << name;
        for (const CouplingRow& row : rows)
            EXPECT_TRUE(row.foreseen.value_or(true)) << name << ' ' << row.which << ' ' << row.scene;
    }
    const double passive = passive_stiffness(3, 1e-3, 0);
    const HandSpec& hand = own("plane").hand;
    EXPECT_NEAR(safe_coupling(hand, 1000, 1e5, places_on("plane"))->stiffness, 1e5 * passive / (1e5 - passive), 1e-6);
    EXPECT_GT(displayed_stiffness(1e5, stiffest_coupling(hand, 1000, 1e5, places_on("plane"))->stiffness), 4 * passive);
    EXPECT_FALSE(safe_coupling(hand, 1000, 1e5, {}));
}

// A spring alone makes a softer scene of the same shape: what is offered is felt as what rests by itself, and no more.
TEST(CouplingLimits, GoAsDeepAsTheHandPresses) {
    const auto limits_of = [](double stiffness, double coupling) {
        return scene_limits(CasePreparation().prepare(
            parse_scene(fmt::format("surface.facets = 64\nforce = {{shading = \"reference\", stiffness = \"{} N/m\"}}\n"
                                    "hand.coupling.stiffness = \"{} N/m\"\npaths = {{press = \"8 N\"}}",
                                    stiffness, coupling),
                        "scene.toml")));
    };
    const SceneLimits stiff = limits_of(1e4, 0);
    ASSERT_TRUE(stiff.safe);
    const double felt = displayed_stiffness(1e4, *stiff.safe);
    EXPECT_TRUE(limits_of(0.98 * felt, 0).stable()) << felt;
    EXPECT_TRUE(limits_of(1e4, 0.98 * *stiff.safe).stable());
    const double alone = limits_of(felt, 0).limit(); // N/m
    EXPECT_EQ(limits_of(1e4, 1e4 * 1.1 * alone / (1e4 - 1.1 * alone)).stable(), limits_of(1.1 * alone, 0).stable());
}

TEST(CouplingLimits, OfASceneWithNothingToTouchAreThoseOfAWall) {
    const auto limits_of = [](const std::string& coupling) {
        return scene_limits(CasePreparation().prepare(parse_scene(
            "surface.facets = 64\nforce.stiffness = \"100 N/mm\"\npaths.length = \"10 mm\"\npaths.press = \"1 N\"\n" +
                coupling,
            "scene.toml")));
    };
    EXPECT_TRUE(limits_of("hand.coupling.stiffness = \"100 N/m\"").stable());
    const SceneLimits harsh = limits_of("hand.coupling = { stiffness = \"5 N/mm\", damping = \"400 N s/m\" }");
    EXPECT_FALSE(harsh.stable());
    EXPECT_TRUE(says(harsh.warning(), "without damper"));
}

TEST(CouplingLimits, AreOfferedWhereASceneIsUnstable) {
    const auto limits_of = [](const std::string& coupling) {
        return scene_limits(CasePreparation().prepare(
            parse_scene("surface.facets = 1\nforce.stiffness = \"1000 N/mm\"\n[hand]\n" + coupling, "scene.toml")));
    };
    const SceneLimits bare = limits_of("");
    ASSERT_TRUE(bare.safe);
    EXPECT_TRUE(says(bare.warning(), "hand.coupling.stiffness = \"5976 N/m\""));
    const SceneLimits held = limits_of("coupling.stiffness = \"5976 N/m\"\n");
    EXPECT_TRUE(held.stable()) << held.text();
    EXPECT_TRUE(says(held.text(), "displayed as 5940 N/m"));
    EXPECT_FALSE(limits_of("coupling.stiffness = \"6200 N/m\"\n").stable());
}

Engine& engine() {
    static const std::unique_ptr<Engine> one = make_engine(EngineOptions{});
    return *one;
}

// Closer to a jump of the direction than a kick, the other side's force takes the probe away.
TEST(LargestKick, IsLessBesideAJump) {
    const LoopSurface& bump = own("shaded bump of 2 facets");
    LeastLimit inside = *worst_of(least_limits(bump, places_on(bump.name), settings_of(bump, true))), beside = inside;
    for (const RestPlace& place : places_on(bump.name))
        if (place.kind == PlaceKind::slope && place.depth == bump.deepest)
            (place.edge_distance ? beside : inside).place = place;
    ASSERT_TRUE(beside.place.edge_distance);
    EXPECT_LT(largest_kick(bump, beside).value(), 2 * *beside.place.edge_distance);
    EXPECT_EQ(largest_kick(bump, inside).value(), 100e-6);
}

// A sampled relay answers half a sample late in the mean, and a whole one at most: where grip and surface are soft
// beside 2 b / T, its describing function lets half a jump D swing by 4 D T / (pi b), and twice that at most.
TEST(EdgeSwings, AreThoseOfASampledRelay) {
    const LoopSurface& bump = own("bump of 2 facets");
    const double damping = bump.hand.damping + bump.hand.grip_damping;
    int feet = 0;
    for (const EdgeSwing& one : edge_swings(engine(), bump, places_on("bump of 2 facets"))) {
        if (one.place.kind != PlaceKind::foot || one.stiffness != 1000)
            continue;
        ++feet;
        const double half_jump = one.stiffness * one.place.depth * std::sin(one.place.jump / 2);
        EXPECT_EQ(one.outcome.state, LoopState::limit_cycle);
        const double mean = 4 * half_jump / (std::numbers::pi * damping * bump.rate);
        EXPECT_GT(one.outcome.swing, 0.5 * mean);
        EXPECT_LT(one.outcome.swing, 2.1 * mean);
    }
    EXPECT_EQ(feet, 4);
}

LoopCell damped(const LoopSurface& surface, double damping, double stiffness) {
    LoopCell cell{surface.hand, surface.rate, stiffness};
    cell.hand.damping = damping;
    cell.hand.grip_damping = 0;
    return cell;
}

const RestPlace& first_place(const std::string& surface, PlaceKind kind) {
    return *std::ranges::find(places_on(surface), kind, &RestPlace::kind);
}

// Of couplings over three decades of stiffness and damping the linearised loop tells which come to rest.
TEST(CouplingMap, IsAsTheLinearisedLoopForesees) {
    const std::vector<DiagramLoop> loops =
        coupling_diagram(engine(), own("plane"), first_place("plane", PlaceKind::flat), true);
    std::size_t rests = 0, otherwise = 0;
    for (const DiagramLoop& loop : loops) {
        const bool stable = loop.outcome.state == LoopState::stable;
        rests += stable;
        otherwise += stable != loop.foreseen;
    }
    EXPECT_EQ(loops.size(), 128u);
    EXPECT_GT(rests, 40u);
    EXPECT_LT(rests, 90u);
    EXPECT_LE(otherwise, 2u);
}

TEST(Loops, MeshIsTheWallOfItsFacet) {
    const LoopSurface& mesh = own("mesh");
    const LoopCell cell = damped(mesh, 10, 1);
    const double limit = wall_limit(cell.hand, cell.rate);
    LoopRun run;
    run.patience = 120;
    run.disturbance = 0.01;
    // Of a facet next to the crest: under the edges of steeper ones the probe slips to the next.
    const auto away = std::ranges::find_if(places_on("mesh"), [](const RestPlace& place) {
        return place.kind == PlaceKind::slope && std::abs(place.force.x) < 0.2 * place.force.z;
    });
    const auto outcomes =
        run_cells(engine(), mesh, *away, {damped(mesh, 10, 0.95 * limit), damped(mesh, 10, 1.15 * limit)}, run);
    EXPECT_EQ(outcomes[0].state, LoopState::stable);
    EXPECT_NE(outcomes[1].state, LoopState::stable);
}

TEST(Loops, StatesOfThePlane) {
    const LoopSurface& plane = own("plane");
    const RestPlace& place = places_on("plane")[2]; // 1 mm deep
    const double limit = wall_limit(damped(plane, 5, 1).hand, plane.rate);
    LoopRun run;
    std::vector<LoopCell> cells{damped(plane, 5, 0.98 * limit), damped(plane, 5, 1.1 * limit),
                                damped(plane, 5, 3 * limit)};
    const auto bare = run_cells(engine(), plane, place, cells, run);
    EXPECT_EQ(bare[0].state, LoopState::stable);
    EXPECT_EQ(bare[1].state, LoopState::limit_cycle);
    EXPECT_EQ(bare[2].state, LoopState::unstable);
    run.disturbance = 0.5;
    for (LoopCell& cell : cells) {
        cell.stiffness = 2000; // 2 f_c / quantum of the first
        cell.hand.quantisation = 5e-5;
    }
    cells[0].hand.coulomb = 1.02 * 0.05;
    cells[1].hand.coulomb = 0.98 * 0.05;
    const auto rounded = run_cells(engine(), plane, place, cells, run);
    EXPECT_EQ(rounded[0].state, LoopState::stable);
    EXPECT_EQ(rounded[1].state, LoopState::quantisation_cycle);
    EXPECT_EQ(rounded[2].state, LoopState::quantisation_cycle);
}

PreparedCase prepared(const std::string& text) {
    return CasePreparation().prepare(parse_scene(text, "scene.toml"));
}

LoopResults results_of(const LoopSurface& surface) {
    LoopResults results;
    results.surfaces = {surface};
    const std::vector<RestPlace> places = rest_places(surface, 20);
    results.limits = least_limits(surface, places, settings_of(surface, true));
    const LeastLimit& worst = *worst_of(results.limits);
    results.diagrams = damping_diagram(engine(), surface, worst, true);
    for (DiagramLoop& loop : rounding_diagram(engine(), surface, worst.place, true))
        results.diagrams.push_back(std::move(loop));
    results.curves = curves_over(results.diagrams, worst);
    return results;
}

const char* const kWall = "[surface]\nkind = \"bump\"\n[force]\nstiffness = \"500 N/m\"\n[hand]\nmass = \"0.2 kg\"\n"
                          "grip_stiffness = \"0 N/m\"\ndamping = \"9 N s/m\"\ngrip_damping = \"1 N s/m\"\n"
                          "[paths]\npress = \"0.25 N\"\nrate = \"2000 Hz\"\n";

TEST(SceneStability, AreTheScenesOwn) {
    const LoopSurface surface = scene_surface(prepared(kWall));
    EXPECT_EQ(surface.stiffness, 500);
    EXPECT_EQ(surface.rate, 2000);
    EXPECT_EQ(surface.hand.mass, 0.2);
    const LoopResults results = results_of(surface);
    ASSERT_NE(worst_of(results.limits), nullptr);
    EXPECT_NEAR(*worst_of(results.limits)->limit / 40167.4, 1, 1e-3) << "K_crit of 0.2 kg and 10 N s/m at 2 kHz";
    const std::vector<Finding> findings = loop_findings(results);
    ASSERT_FALSE(findings.empty());
    EXPECT_LE(findings.size(), 6U);
    EXPECT_TRUE(says(findings[0].text, "its own 500 N/m is 0.0124 times that"));
    for (const Finding& finding : findings) {
        EXPECT_FALSE(says(finding.text, "nan"));
        EXPECT_FALSE(finding.place.empty() || finding.condition.empty() || finding.figure.empty()) << finding.name;
    }
}

// Where closed forms hold, loops do as they say, but for those next to the limit.
TEST(LoopMaps, DoWhatIsForeseen) {
    const LoopResults results = results_of(scene_surface(prepared(kWall)));
    std::size_t wrong = 0, near = 0;
    for (const DiagramLoop& loop : results.diagrams) {
        const bool rests = loop.outcome.state == LoopState::stable;
        const double limit = wall_limit(loop.cell.hand, loop.cell.rate);
        near += loop.diagram == "damping" && std::abs(loop.cell.stiffness / limit - 1) < 0.02;
        wrong += loop.diagram == "damping" ? rests != loop.foreseen : loop.foreseen && !rests;
    }
    EXPECT_LE(wrong, near);
    EXPECT_FALSE(results.curves.empty());
}

TEST(SceneStability, RefuseWhatIsNoLoop) {
    const std::string paths = "[paths]\npress = \"1 N\"\n";
    const std::string dead = "[hand]\ndamping = \"0 N s/m\"\ngrip_damping = \"0 N s/m\"\n";
    EXPECT_THROW(scene_surface(prepared("[surface]\nkind = \"bump\"\n" + dead + paths)), UsageError);
    EXPECT_THROW(scene_surface(prepared("[surface]\nkind = \"bump\"\n[force]\nstiffness = \"0 N/m\"\n" + paths)),
                 UsageError);
    const LoopSurface air =
        scene_surface(prepared("[surface]\nkind = \"bump\"\n[grid]\nsize = [8, 8, 8]\norigin = [\"0 m\", \"0 m\", \"1 "
                               "m\"]\nspacing = [\"1 mm\", \"1 mm\", \"1 mm\"]\n"));
    EXPECT_THROW(rest_places(air, 10), UsageError);
}

} // namespace
} // namespace forceshade::study
