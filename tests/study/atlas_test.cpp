// The limit over mass, grip, damping, rate, delay, depth, quanta and friction, and kicks without damping, against other
// code.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "host/study/stability/stability.h"

namespace forceshade::study {
namespace {

struct Atlas {
    LoopSurface surface;
    std::vector<LeastLimit> limits;
    std::vector<AtlasPoint> points;
};

const Atlas& atlas(const std::string& name) {
    static std::map<std::string, Atlas> all;
    if (!all.contains(name)) {
        const std::vector<LoopSurface> surfaces = own_surfaces();
        Atlas one{*std::ranges::find(surfaces, name, &LoopSurface::name), {}, {}};
        one.limits = least_limits(one.surface, rest_places(one.surface, 60), settings_of(one.surface, true));
        one.points = atlas_of(one.surface, one.limits, false);
        all[name] = one;
    }
    return all[name];
}

// Of a plane the limit is K_crit, whatever the hand's mass, grip and so on.
TEST(StabilityAtlas, IsTheClosedFormOnAPlane) {
    for (const AtlasPoint& point : atlas("plane").points) {
        const LoopCell& cell = point.least.cell;
        ASSERT_TRUE(point.least.limit);
        if (point.quantity == "lag") {
            const double b = damping_of(cell.hand);
            const double unheld = b / cell.lag + b * b / cell.hand.mass; // where the sample is short against the lag
            EXPECT_TRUE(cell.lag < 0.01 || std::abs(*point.least.limit / unheld - 1) < 0.1) << cell.lag;
            continue;
        }
        EXPECT_NEAR(*point.least.limit / critical_stiffness(cell.hand.mass, cell.hand.damping + cell.hand.grip_damping,
                                                            1 / cell.rate, cell.hand.delay_samples),
                    1, 2e-4)
            << point.quantity << " " << point.value;
    }
    EXPECT_EQ(atlas("plane").points.size(), 6U * 13 + 7) << "no engine, no quanta";
}

TEST(SteppedLimits, AreThoseOfTheLinearLoop) {
    for (const char* name : {"plane", "textured plane", "shaded bump of 2 facets", "mesh"}) {
        const Atlas& one = atlas(name);
        const LeastLimit& worst = *worst_of(one.limits);
        const SteppedLimit found = stepped_limit(one.surface, worst, own_path_law(one.surface));
        EXPECT_EQ(found.end, LimitEnd::within);
        EXPECT_NEAR(found.limit / *worst.limit, 1, 0.01) << name;
    }
}

TEST(SteppedLimits, SayWhereThereIsNone) {
    const LoopSurface& plane = atlas("plane").surface;
    LeastLimit there = *worst_of(atlas("plane").limits);
    const auto end_of = [&](const MakePathForce& make) { return stepped_limit(plane, there, make).end; };
    EXPECT_EQ(end_of([](double) { return [](const glm::dvec3&) { return glm::dvec3(0); }; }), LimitEnd::no_force);
    const MakePathForce twitches = [](double stiffness) { // a tenth of a millimetre aside, every other sample
        return [=, updates = 0](const glm::dvec3& at) mutable {
            return stiffness * glm::dvec3(++updates % 2 * 1e-4, 0, -at.z);
        };
    };
    EXPECT_EQ(end_of(twitches), LimitEnd::below);
    there.cell.rate = 1e6; // K_crit is 2.4e7 N/m
    there.cell.hand.damping = 10;
    there.cell.hand.grip_stiffness = 3000;
    EXPECT_EQ(end_of(own_path_law(plane)), LimitEnd::above);
}

// On a shaded slope it is where the force turns away faster than the grip holds: as stiff as the grip times what the
// shape makes of it, whatever the mass.
TEST(StabilityAtlas, OfAShadedSlopeIsTheGrips) {
    const Atlas& shaded = atlas("shaded bump of 2 facets");
    const LeastLimit& worst = *worst_of(shaded.limits, shaded.surface.name, {}, PlaceKind::slope);
    const double share = *worst.limit / worst.cell.hand.grip_stiffness;
    for (const AtlasPoint& point : shaded.points) {
        if (point.least.place.kind != PlaceKind::slope)
            continue;
        if (point.quantity == "mass") {
            EXPECT_NEAR(*point.least.limit / *worst.limit, 1, 3e-4) << point.value << " kg";
        }
        if (point.quantity == "grip" && point.value < 1000) {
            EXPECT_NEAR(*point.least.limit / point.value / share, 1, 1e-3) << point.value << " N/m";
        }
    }
}

// With time in samples and force in b / T a loop has the groups b T / m, k_g T / b and the delay: loops alike in these
// have one K T / b.
TEST(StabilityAtlas, DependsOnItsGroupsAlone) {
    for (const char* name : {"shaded bump of 2 facets", "height map of a dip"})
        for (const AtlasPoint& point : atlas(name).points) {
            LoopCell other = point.least.cell;
            other.rate *= 3;
            other.hand.mass *= 0.7;
            const double damping = damping_of(other.hand) * 2.1; // b T / m stays
            other.hand.damping = damping;
            other.hand.grip_damping = 0;
            other.hand.grip_stiffness *= 2.1 * 3; // k_g T / b stays
            other.lag /= 3;
            const AtlasPoint alike{least_of(atlas(name).surface, {&point.least.place}, other), "", 0};
            EXPECT_NEAR(alike.mass_group() / point.mass_group(), 1, 1e-12);
            EXPECT_NEAR(alike.grip_group() / point.grip_group(), 1, 1e-12);
            EXPECT_NEAR(alike.limit_group() / point.limit_group(), 1, 5e-4) << name << " " << point.quantity;
        }
}

// Under a shaded crest the grip gives way at K d = k_g (R^2 - x^2) / R, of bumps of two radii at depths of two decades.
TEST(StabilityAtlas, OverDepthIsThatOfTheGripAndTheRadius) {
    std::size_t held = 0;
    double least = 1, most = 0; // d / R
    for (const auto& [name, radius] :
         {std::pair("shaded bump of 2 facets", 0.01524), std::pair("height map of a bump", 0.0254)})
        for (const AtlasPoint& point : atlas(name).points) {
            if (point.quantity != "depth" || point.least.hold.name != "down" ||
                point.least.place.kind == PlaceKind::flat)
                continue;
            const double depth = point.value, x = point.least.place.at.x, grip = point.least.cell.hand.grip_stiffness;
            const double gives = grip * (radius * radius - x * x) / radius / depth;
            if (std::abs(x) > 0.0127 || gives > 0.8 * point.least.wall)
                continue; // beside the foot; held by the damping
            EXPECT_NEAR(*point.least.limit / gives, 1, 2e-3) << name << ' ' << depth;
            EXPECT_NEAR(*grip_limit(point.least.cell.hand, point.least.hold, point.least.place.force_around()) / gives,
                        1, 2e-3);
            EXPECT_NEAR(point.depth_group() / (depth / radius), 1, 2e-3);
            EXPECT_NEAR(point.balance_group(), 1 - x * x / (radius * radius), 3e-3);
            least = std::min(least, depth / radius);
            most = std::max(most, depth / radius);
            ++held;
        }
    EXPECT_GE(held, 5U);
    EXPECT_GT(most / least, 2);
}

// A mass on a wall whose force is held over each sample and late, at a grip's spring and with a damper, in steps of a
// hundredth of a sample, no exact map. Friction is a constant force against the speed.
struct WallLoop {
    double mass = 0.1, friction = 0, stiffness = 1000, grip = 0, damping = 0, quantum = 0;
    std::size_t delay = 0;
    double period = 1e-3;

    // After a kick, m. With a quantum the hand presses midway between two of them.
    bool rests_after(double kick, int samples) const {
        const int fine = 100;
        const double step = period / fine;
        double place = kick, speed = 0, early = 0, late = 0;
        std::vector<double> forces(delay, 0.0);
        for (int i = 0; i < samples; ++i) {
            const double seen =
                quantum > 0 ? (std::floor(place / quantum + 1e-9) + 0.5) * quantum : place; // of the rest's place
            forces.push_back(-stiffness * seen);
            const double force = forces[forces.size() - 1 - delay];
            for (int j = 0; j < fine; ++j) {
                const double driven = force - grip * place - damping * speed;
                const double pull = std::abs(speed) > 0           ? driven - std::copysign(friction, speed)
                                    : std::abs(driven) > friction ? driven - std::copysign(friction, driven)
                                                                  : 0;
                const double next = speed + pull / mass * step;
                speed = speed * next < 0 ? 0 : next;
                place += speed * step;
            }
            double& most = i < samples / 4 ? early : late;
            if (i < samples / 4 || i >= samples - samples / 4)
                most = std::max(most, quantum > 0 ? std::abs(speed) : std::abs(place));
            if (std::abs(place) > 20 * kick)
                return false;
        }
        return quantum > 0 ? late == 0 : late < 0.9 * early;
    }
};

bool dies_out(double mass, double friction, double stiffness, double kick, double sample_time, bool is_late) {
    return WallLoop{.mass = mass, .friction = friction, .stiffness = stiffness, .delay = is_late, .period = sample_time}
        .rests_after(kick, 4000);
}

LoopCell cell_of(const WallLoop& loop) {
    LoopCell cell;
    cell.hand.mass = loop.mass;
    cell.hand.damping = loop.damping;
    cell.hand.grip_damping = 0;
    cell.hand.grip_stiffness = loop.grip;
    cell.hand.coulomb = loop.friction;
    cell.hand.quantisation = loop.quantum;
    cell.hand.delay_samples = loop.delay;
    cell.stiffness = loop.stiffness;
    return cell;
}

const Hold kAllSides{"on all sides", glm::dvec3(0)};

// A held force feeds what nothing damps: with the grip's spring alone no stiffness is stable.
TEST(StabilityAtlas, WithoutDampingIsZero) {
    const RestPlace wall = wall_place();
    for (const double stiffness : {30.0, 1000.0}) {
        WallLoop loop{.stiffness = stiffness, .grip = 500};
        EXPECT_FALSE(loop.rests_after(1e-3, 40000)) << stiffness;
        EXPECT_TRUE(grows(cell_of(loop).hand, 1000, kAllSides, wall.force_around(), stiffness));
        EXPECT_EQ(linear_limit(cell_of(loop).hand, 1000, kAllSides, wall.force_around()), 0.0);
        loop.damping = 0.6 * stiffness * 1e-3; // more than K T / 2
        EXPECT_TRUE(loop.rests_after(1e-3, 40000)) << stiffness;
    }
}

TEST(RoundedLimit, IsWhereFrictionHoldsAQuantum) {
    for (const double friction : {0.005, 0.02}) {
        WallLoop loop{.friction = friction, .damping = 3, .quantum = 1e-5};
        const double limit = rounded_limit(cell_of(loop), 1e-3);
        EXPECT_NEAR(limit, 2 * friction / 1e-5, 1e-9 * limit);
        loop.stiffness = 0.97 * limit;
        EXPECT_TRUE(loop.rests_after(1e-3, 3000)) << friction;
        loop.stiffness = 1.03 * limit;
        EXPECT_FALSE(loop.rests_after(1e-3, 3000)) << friction;
    }
}

// Where friction holds any quantum it adds to the damping, the less the larger the kick.
TEST(RoundedLimit, HasFrictionsDescribingFunction) {
    for (const double kick : {3e-4, 1e-3}) {
        WallLoop loop{.friction = 0.5, .damping = 3, .quantum = 1e-6};
        const double limit = rounded_limit(cell_of(loop), kick);
        EXPECT_GT(limit, 1.5 * critical_stiffness(0.1, 3, 1e-3, 0));
        loop.quantum = 0;
        loop.stiffness = 0.92 * limit;
        EXPECT_TRUE(loop.rests_after(kick, 4000)) << kick;
        loop.stiffness = 1.08 * limit;
        EXPECT_FALSE(loop.rests_after(kick, 4000)) << kick;
    }
}

TEST(FrictionBasin, IsWhereKicksTurn) {
    const double mass = 0.1, friction = 0.05, period = 1e-3;
    for (const bool late : {false, true})
        for (const double stiffness : {500.0, 1000.0, late ? 1700.0 : 8000.0}) {
            const double basin = friction_basin(mass, friction, stiffness, period, late);
            EXPECT_TRUE(dies_out(mass, friction, stiffness, 0.85 * basin, period, late)) << stiffness;
            EXPECT_FALSE(dies_out(mass, friction, stiffness, 1.15 * basin, period, late)) << stiffness;
        }
}

// Harmonic balance, late and with the grip's spring, too, within 3 %.
TEST(FrictionBasin, IsThatOfAGripAndOfLateForces) {
    const RestPlace wall = wall_place();
    for (const std::size_t delay : {0U, 1U, 2U})
        for (const double grip : {0.0, 500.0, 3000.0}) {
            const WallLoop loop{.friction = 0.02, .stiffness = 3000, .grip = grip, .delay = delay};
            const double basin = friction_basin(cell_of(loop), wall, kAllSides);
            EXPECT_TRUE(loop.rests_after(0.97 * basin, 6000)) << delay << ' ' << grip;
            EXPECT_FALSE(loop.rests_after(1.03 * basin, 6000)) << delay << ' ' << grip;
        }
}

// On a facet of slope t, along x and z: K times the depth straight down, friction on each axis, the grip along x alone.
bool slope_rests(const LoopCell& cell, double tilt, double kick) {
    const int fine = 100, samples = 6000;
    const double step = 1 / cell.rate / fine, force_per = cell.stiffness;
    glm::dvec2 place(0, -kick), speed(0);
    const glm::dvec2 normal(std::sin(tilt), std::cos(tilt));
    std::vector<glm::dvec2> forces(cell.hand.delay_samples, glm::dvec2(0));
    double early = 0, late = 0;
    for (int i = 0; i < samples; ++i) {
        forces.push_back(-force_per * (glm::dot(place, normal) / normal.y) * normal);
        const glm::dvec2 held = forces[forces.size() - 1 - cell.hand.delay_samples];
        for (int j = 0; j < fine; ++j)
            for (int axis = 0; axis < 2; ++axis) {
                const double driven = held[axis] - (axis == 0 ? cell.hand.grip_stiffness * place.x : 0);
                const bool moves = speed[axis] != 0 || std::abs(driven) > cell.hand.coulomb;
                const double against = speed[axis] != 0 ? speed[axis] : driven;
                const double next =
                    moves ? speed[axis] + (driven - std::copysign(cell.hand.coulomb, against)) / cell.hand.mass * step
                          : 0;
                speed[axis] = speed[axis] * next < 0 ? 0 : next;
                place[axis] += speed[axis] * step;
            }
        double& most = i < samples / 4 ? early : late;
        if (i < samples / 4 || i >= samples - samples / 4)
            most = std::max(most, glm::length(speed));
        if (glm::length(place) > 30 * kick)
            return false;
    }
    return late < 0.9 * early;
}

TEST(FrictionBasin, OfSteppedSlopesIsThatOfOtherCode) {
    const Atlas& bump = atlas("bump of 2 facets");
    std::size_t slopes = 0;
    for (const BasinRow& row : basins_of(bump.surface, bump.limits, true)) {
        if (row.there.place.kind != PlaceKind::slope || row.there.hold.name != "down")
            continue;
        ++slopes;
        ASSERT_TRUE(row.stepped);
        const double tilt = std::atan2(std::abs(row.there.place.force.x), row.there.place.force.z);
        EXPECT_NEAR(tilt, 28.2243 * std::numbers::pi / 180, 1e-3);
        EXPECT_TRUE(slope_rests(row.there.cell, tilt, 0.97 * *row.stepped)) << row.there.cell.hand.delay_samples;
        EXPECT_FALSE(slope_rests(row.there.cell, tilt, 1.03 * *row.stepped)) << row.there.cell.hand.delay_samples;
        EXPECT_NEAR(*row.stepped / row.foreseen, 1, 0.06) << row.there.cell.hand.delay_samples;
    }
    EXPECT_EQ(slopes, 6U) << "with and without grip";
    for (const BasinRow& row : basins_of(atlas("plane").surface, atlas("plane").limits, false))
        EXPECT_NEAR(row.stepped.value() / row.foreseen, 1, 0.015) << row.there.cell.hand.delay_samples;
}

Engine& cpu_engine() {
    static const std::unique_ptr<Engine> engine = [] {
        EngineOptions options;
        options.cpu = true;
        return make_engine(options);
    }();
    return *engine;
}

// Quanta and friction stepped by an engine, from a kick of a millimetre.
TEST(StabilityAtlas, OfQuantaIsThatOfTheEnginesLoops) {
    const Atlas& plane = atlas("plane");
    std::size_t stepped = 0;
    for (const AtlasPoint& point : atlas_of(plane.surface, plane.limits, true, &cpu_engine())) {
        const HandSpec& hand = point.least.cell.hand;
        if (point.quantity != "quantum" && point.quantity != "friction")
            continue;
        ASSERT_TRUE(point.least.simulated) << point.quantity << ' ' << point.value;
        EXPECT_NEAR(point.friction_group(), hand.coulomb / (3 * hand.quantisation * 1000), 1e-9);
        EXPECT_NEAR(*point.least.simulated / *point.least.limit, 1, 0.03) << point.quantity << ' ' << point.value;
        const double still = 2 * hand.coulomb / hand.quantisation; // Abbott & Okamura; Diolaiti et al.
        if (still < 3000) {
            EXPECT_NEAR(*point.least.simulated / still, 1, 0.01) << point.quantity << ' ' << point.value;
        }
        ++stepped;
    }
    EXPECT_EQ(stepped, 10U);
}

// A mesh's facet is a wall: its stepped loops, along the mesh, have K_crit for a limit.
TEST(StabilityAtlas, OfAMeshsFacetIsStepped) {
    std::size_t stepped = 0;
    for (const AtlasPoint& point : atlas("mesh").points)
        if (point.least.simulated && point.quantity != "lag" && point.least.place.kind == PlaceKind::slope) {
            const LoopCell& cell = point.least.cell;
            EXPECT_NEAR(*point.least.simulated / critical_stiffness(cell.hand.mass, damping_of(cell.hand),
                                                                    1 / cell.rate, cell.hand.delay_samples),
                        1, 0.01)
                << point.quantity << ' ' << point.value;
            ++stepped;
        }
    EXPECT_GE(stepped, 8U);
}

// What differs by more than 1 % is in the table, and nothing else.
TEST(SteppedChecks, ListWhatDiffersByMoreThanAPercent) {
    const Atlas& plane = atlas("plane");
    LoopResults results;
    results.surfaces = {plane.surface};
    results.limits = plane.limits;
    LeastLimit& worst = *std::ranges::find(results.limits, true, &LeastLimit::own);
    worst.simulated = 1.005 * *worst.limit;
    StudyData data;
    const auto disagreements = [&] {
        data = {};
        add_loops(data, results);
        return data.table("loop_disagreements").rows;
    };
    EXPECT_TRUE(disagreements().empty());
    EXPECT_NE(data.notes.back().find("Of 1 limits that were stepped 0 differ"), std::string::npos) << data.notes.back();
    worst.any_press = HoldLimit{100, kAllSides, worst.place, 97};
    ASSERT_EQ(disagreements().size(), 1U);
    EXPECT_NE(data.notes.back().find("Of 2 limits that were stepped 1 differ"), std::string::npos);
    const Table& table = data.table("loop_disagreements");
    EXPECT_EQ(table.rows[0][0].text(), "limit of any press");
    results.basins = {{worst, 1e-6, {}}}; // never found
    EXPECT_EQ(disagreements().size(), 2U);
}

TEST(FrictionBasin, IsThatOfTheEnginesLoops) {
    const Atlas& plane = atlas("plane");
    const LeastLimit& deep = *worst_of(plane.limits, "plane", plane.surface.deepest);
    std::size_t beyond = 0, within = 0;
    for (const DiagramLoop& loop : basin_diagram(cpu_engine(), plane.surface, deep.place, true)) {
        const double basin = friction_basin(0.1, 0.05, loop.cell.stiffness, 1e-3, 0);
        if (std::abs(loop.kick / basin - 1) < 0.15)
            continue;
        EXPECT_EQ(loop.outcome.state == LoopState::stable, loop.kick < basin)
            << loop.cell.stiffness << " N/m, " << loop.kick << " m";
        (loop.kick < basin ? within : beyond) += 1;
    }
    EXPECT_GT(within, 50U);
    EXPECT_GT(beyond, 20U);
}

} // namespace
} // namespace forceshade::study
