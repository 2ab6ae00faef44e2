// The limit over mass, grip, damping, rate and delay, and kicks without damping, against other code.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

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
    EXPECT_EQ(atlas("plane").points.size(), 5U * 13 + 7);
}

MakePathForce law_of(const LoopSurface& surface) {
    return [&surface](double stiffness) {
        return [probe = std::make_shared<CaseProbe<double>>(surface.prepared), stiffness](const glm::dvec3& at) {
            return stiffness * glm::dvec3(probe->at(at).contact.force);
        };
    };
}

TEST(SteppedLimits, AreThoseOfTheLinearLoop) {
    for (const char* name : {"plane", "textured plane", "shaded bump", "mesh"}) {
        const Atlas& one = atlas(name);
        const LeastLimit& worst = *worst_of(one.limits);
        const SteppedLimit found = stepped_limit(one.surface, worst, law_of(one.surface));
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
    there.cell.rate = 1e6; // K_crit is 6e6 N/m
    there.cell.hand.grip_stiffness = 3000;
    EXPECT_EQ(end_of(law_of(plane)), LimitEnd::above);
}

// On a shaded slope it is where the force turns away faster than the grip holds: as stiff as the grip times what the
// shape makes of it, whatever the mass.
TEST(StabilityAtlas, OfAShadedSlopeIsTheGrips) {
    const Atlas& shaded = atlas("shaded bump");
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
    for (const char* name : {"shaded bump", "map of a dip"})
        for (const AtlasPoint& point : atlas(name).points) {
            LoopCell other = point.least.cell;
            other.rate *= 3;
            other.hand.mass *= 0.7;
            const double damping = damping_of(other.hand) * 2.1; // b T / m stays
            other.hand.damping = damping;
            other.hand.grip_damping = 0;
            other.hand.grip_stiffness *= 2.1 * 3; // k_g T / b stays
            other.lag /= 3;
            const AtlasPoint alike{least_limits(atlas(name).surface, {point.least.place}, {other}).front(), "", 0};
            EXPECT_NEAR(alike.mass_group() / point.mass_group(), 1, 1e-12);
            EXPECT_NEAR(alike.grip_group() / point.grip_group(), 1, 1e-12);
            EXPECT_NEAR(alike.limit_group() / point.limit_group(), 1, 5e-4) << name << " " << point.quantity;
        }
}

// A mass on a wall, held over each sample, with friction as a constant force against its speed: in steps of a hundredth
// of a sample, no exact map.
bool dies_out(double mass, double friction, double stiffness, double kick, double sample_time, bool is_late) {
    const int fine = 100;
    const double step = sample_time / fine;
    double place = kick, speed = 0, early = 0, late = 0, before = 0;
    const int samples = 4000;
    for (int i = 0; i < samples; ++i) {
        const double newest = -stiffness * place, force = is_late ? before : newest;
        before = newest;
        for (int j = 0; j < fine; ++j) {
            const double pull = std::abs(speed) > 0          ? force - std::copysign(friction, speed)
                                : std::abs(force) > friction ? force - std::copysign(friction, force)
                                                             : 0;
            const double next = speed + pull / mass * step;
            speed = speed * next < 0 ? 0 : next;
            place += speed * step;
        }
        double& most = i < samples / 4 ? early : late;
        most = std::max(most, std::abs(place));
        if (std::abs(place) > 20 * kick)
            return false;
    }
    return late < 0.9 * early;
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

TEST(FrictionBasin, IsThatOfTheEnginesLoops) {
    EngineOptions options;
    options.cpu = true;
    const std::unique_ptr<Engine> engine = make_engine(options);
    const Atlas& plane = atlas("plane");
    const LeastLimit& deep = *worst_of(plane.limits, "plane", plane.surface.deepest);
    std::size_t beyond = 0, within = 0;
    for (const MapLoop& loop : basin_map(*engine, plane.surface, deep.place, true)) {
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
