// Buttons and the mapping of the scene into the device's space, in the loop: who is pushed where, by what energy.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "device/backends/devices.h"
#include "tests/device/loop_runs.h"
#include "tests/paths/sampled_plants.h"

namespace forceshade::device {
namespace {

using namespace testing;
using glm::dvec3;

LoopSettings unlimited(std::uint64_t samples) {
    LoopSettings settings;
    settings.samples = samples;
    settings.limits = no_limits();
    return settings;
}

Reading pressed(const dvec3& place, std::uint32_t buttons) {
    return {Answer::fresh, place, false, buttons};
}

TEST(Mapping, QuarterTurnsAreExact) {
    constexpr double kQuarter = std::numbers::pi / 2;
    EXPECT_EQ(turn_about(2, kQuarter) * dvec3(1, 0, 0), dvec3(0, 1, 0));
    EXPECT_EQ(turn_about(0, kQuarter) * dvec3(0, 1, 0), dvec3(0, 0, 1));
    EXPECT_EQ(turn_about(1, -kQuarter) * dvec3(1, 0, 0), dvec3(0, 0, 1));
    EXPECT_EQ(turn_about(1, 4 * kQuarter), glm::dmat3(1));
    EXPECT_NEAR((turn_about(2, 0.5) * dvec3(1, 0, 0)).y, std::sin(0.5), 1e-15);
    Mapping mapping;
    mapping.turn = turn_about(2, kQuarter);
    mapping.scale = 2;
    EXPECT_EQ(mapping_text(mapping), "origin at (0, 0, 0) mm, scene's x, y, z along the device's y, -x, z; 2 m of the "
                                     "scene in a metre of the device: springs feel 2 times as stiff");
}

// A plane that faces along the device's y: the hand that goes in against y is pushed out along y.
TEST(Mapping, TurnsForcesBackAndLeavesThemTheirSize) {
    LoopSettings settings = unlimited(50);
    settings.mapping = {{0.1, 0.2, 0.3}, turn_about(0, -std::numbers::pi / 2), 2};
    ASSERT_EQ(settings.mapping.turn * dvec3(0, 0, 1), dvec3(0, 1, 0));
    ScriptedDevice device([](std::uint64_t) { return at(0.1, 0.2 - 1e-3, 0.3); }, 60);
    const LoopRun run = run_fast(device, prepared_scene(kPlane), settings);
    EXPECT_NEAR(run.samples[10].probe.z, -2e-3, 1e-15) << "scaled";
    EXPECT_LT(glm::length(device.forces[10] - dvec3(0, 2, 0)), 1e-9) << "1 N/mm, 2 mm deep";
    EXPECT_LT(glm::length(run.samples[10].commanded - dvec3(0, 0, 2)), 1e-9) << "logged in the scene's axes";
}

// Whatever the mapping, the energy is that of what the hand felt along its own way.
TEST(Mapping, TheEnergyIsTheHands) {
    LoopSettings settings = unlimited(2000);
    settings.mapping = {{0.01, -0.02, 0.005}, turn_about(2, 0.7) * turn_about(0, 2.1), 3};
    std::vector<dvec3> places;
    for (int i = 0; i < 2000; ++i) {
        const double turn = 0.01 * i;
        places.push_back(settings.mapping.origin + settings.mapping.turn * dvec3(3e-3 * std::sin(turn),
                                                                                 2e-3 * std::cos(0.3 * turn),
                                                                                 -1e-3 * (1 + std::sin(1.7 * turn))));
    }
    ScriptedDevice device([&](std::uint64_t i) { return pressed(places[i], 0); }, 2100);
    const LoopRun run =
        run_fast(device, prepared_scene("[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n"), settings);
    double energy = 0, gross = 0;
    for (std::size_t i = 1; i < 2000; ++i) {
        const double work = glm::dot(device.forces[i - 1], places[i] - places[i - 1]);
        energy += work;
        gross += std::abs(work);
    }
    EXPECT_GT(gross, 1e-3);
    EXPECT_NEAR(run.samples.back().energy, energy, 1e-12 * gross);
    double law = 0; // in the scene, where ways are three times as long
    for (std::size_t i = 1; i < 2000; ++i)
        law += glm::dot(run.samples[i - 1].force, run.samples[i].probe - run.samples[i - 1].probe);
    EXPECT_NEAR(law, 3 * energy, 1e-9 * gross) << "the power's sign is right";
}

// A wall well below the limit of sampled stability that a scale of 2 takes above it; the controller sees the hand's.
TEST(Mapping, ThePassivityControllerSeesTheStiffnessThatIsFelt) {
    const forceshade::testing::Plant& plant = forceshade::testing::kPlants[0];
    const PreparedCase scene = prepared_scene(
        forceshade::testing::pressed_scene(plant, 0.525 * plant.limit, 0.505, "", "max_force = \"10 N\"\n"));
    const auto run = [&](double scale, bool passivity) {
        const auto sim = make_sim(scene, 1000);
        LoopSettings settings = unlimited(22500);
        settings.mapping.scale = scale;
        settings.limits.passivity = passivity ? kPassiveDamping : 0;
        return run_fast(*sim, scene, settings);
    };
    const LoopRun plain = run(1, false), free = run(2, false), damped = run(2, true);
    EXPECT_LT(swing(plain.samples, 0.9, 1), 0.05 * swing(plain.samples, 0, 0.1));
    EXPECT_GT(swing(free.samples, 0.9, 1), 3 * swing(free.samples, 0, 0.1));
    EXPECT_LT(swing(damped.samples, 0.9, 1), swing(damped.samples, 0, 0.1));
    EXPECT_LT(damped.counts.largest_energy, 0.01 * free.counts.energy);
}

// Speed and workspace are the hand's: what a scale makes of them does not matter.
TEST(Mapping, SpeedAndWorkspaceAreTheDevices) {
    LoopSettings settings = unlimited(400);
    settings.limits.max_speed = 1;
    settings.limits.low = dvec3(-0.05);
    settings.limits.high = dvec3(0.05);
    settings.mapping.scale = 10;
    const auto go = [](std::uint64_t i) { return at(1e-4 * double(i), 0, -1e-4); }; // 0.1 m/s, to 40 mm
    ScriptedDevice device(go, 500);
    EXPECT_EQ(run_fast(device, prepared_scene(kPlane), settings).counts.with(kTooFast), 0u);
    settings.mapping.scale = 0.1;
    ScriptedDevice fast([](std::uint64_t i) { return at(2e-3 * double(i), 0, -1e-4); }, 500);
    const LoopRun run = run_fast(fast, prepared_scene(kPlane), settings);
    EXPECT_GT(run.counts.with(kTooFast), 380u);
    EXPECT_GT(run.counts.with(kOutside), 370u);
}

TEST(Buttons, AreInTheSampleAndTheStatus) {
    ScriptedDevice device([](std::uint64_t i) { return pressed({0, 0, -1e-3}, i < 20 ? 0u : 6u); }, 100);
    const LoopRun run = run_fast(device, prepared_scene(kPlane), unlimited(40));
    EXPECT_EQ(run.samples[19].buttons, 0u);
    EXPECT_EQ(run.samples[20].buttons, 6u);
    EXPECT_EQ(button_bit(2) | button_bit(3), 6u);
}

TEST(Buttons, WithoutTheDeadMansThereIsNoForce) {
    ScriptedDevice device(
        [](std::uint64_t i) {
            const bool fails = i == 600; // and with it what the buttons are
            Reading reading = pressed({0, 0, -1e-3}, i >= 100 && (i < 400 || i >= 450) ? 2u : 1u);
            reading.answer = fails ? Answer::failed : Answer::fresh;
            return reading;
        },
        1000);
    LoopSettings settings = unlimited(800);
    settings.limits.ramp = 0.2;
    settings.dead_man = 2;
    const LoopRun run = run_fast(device, prepared_scene(kPlane), settings);
    for (std::size_t i = 0; i < 800; ++i) {
        const bool held = i >= 100 && (i < 400 || i >= 450) && i != 600;
        ASSERT_EQ((run.samples[i].flags & kDeadMan) != 0, !held) << i;
        ASSERT_TRUE(held || device.forces[i] == dvec3(0)) << i;
    }
    EXPECT_NEAR(device.forces[399].z, 1, 1e-9);
    EXPECT_LT(device.forces[450].z, 0.011) << "it comes up as after a fault";
    EXPECT_GT(device.forces[450].z, 0);
    EXPECT_LT(device.forces[601].z, 0.011);
    EXPECT_EQ(kSampleFlagNames[17], "dead_man");
    EXPECT_EQ(kSampleFlagNames[18], "clutched");
}

// With the clutch held the probe stays and nothing is displayed; then the hand's place is where the probe is.
TEST(Buttons, TheClutchLetsTheHandMoveAlone) {
    const auto x_of = [](std::uint64_t i) { return 1e-5 * double(i); };
    ScriptedDevice device(
        [&](std::uint64_t i) {
            return pressed({x_of(i), 0, i < 300 ? -1e-3 : i < 500 ? 5e-3 : 4.5e-3}, i >= 200 && i < 400 ? 1u : 0u);
        },
        1000);
    LoopSettings settings = unlimited(800);
    settings.limits.ramp = 0.2;
    settings.limits.max_speed = kUnknown;
    settings.clutch = 1;
    settings.mapping.scale = 2;
    const LoopRun run = run_fast(device, prepared_scene(kPlane), settings);
    const LiveSample &before = run.samples[199], &held = run.samples[399], &after = run.samples[400];
    EXPECT_EQ(held.probe, before.probe);
    EXPECT_LT(glm::length(after.probe - before.probe), 1e-15) << "the path goes on where it was";
    EXPECT_NEAR(run.samples[450].probe.x - after.probe.x, 2 * (x_of(450) - x_of(400)), 1e-15);
    EXPECT_NEAR(run.samples[600].probe.z - after.probe.z, -2 * 0.5e-3, 1e-15);
    for (std::size_t i = 200; i < 400; ++i) {
        ASSERT_EQ(device.forces[i], dvec3(0)) << i;
        ASSERT_EQ(run.samples[i].flags & kZeroForceFlags, kClutched) << i;
    }
    EXPECT_GT(device.forces[400].z, 0);
    EXPECT_LT(device.forces[400].z, 0.02) << "it comes up as after a fault";
    EXPECT_EQ(after.path, before.path);
    for (std::size_t i = 201; i < 400; ++i)
        ASSERT_EQ(run.samples[i].energy, run.samples[201].energy) << "what moves alone is given nothing";
}

TEST(Buttons, ASimulatedHandHoldsWhatItIsTold) {
    const auto held = parse_held_buttons("1@0.5 s..3 s, 12@10 ms..20 ms");
    ASSERT_EQ(held.size(), 2u);
    EXPECT_EQ(held[1].button, 12u);
    EXPECT_EQ(held[1].from, 0.01);
    EXPECT_EQ(held[0].until, 3);
    for (const char* const wrong : {"1", "0@1 s..2 s", "33@1 s..2 s", "1@1..2", "1@1 s", "a@1 s..2 s", "1@1 s..2 N"})
        EXPECT_THROW(parse_held_buttons(wrong), UsageError) << wrong;
    const PreparedCase prepared = prepared_scene(kPlane);
    const auto sim = make_sim(prepared, 1000, 0, held);
    EXPECT_EQ(sim->facts().buttons, 12u);
    for (int i = 0; i < 600; ++i) {
        const std::uint32_t buttons = sim->read().buttons;
        ASSERT_EQ(buttons, (i >= 500 ? 1u : 0u) | (i >= 10 && i < 20 ? 1u << 11 : 0u)) << i;
        sim->write(dvec3(0));
    }
    EXPECT_EQ(make_sim(prepared, 1000)->facts().buttons, 0u);
}

} // namespace
} // namespace forceshade::device
