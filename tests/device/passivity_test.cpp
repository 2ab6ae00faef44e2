// The simulated hand at the edge of what sampled stability allows (shaders/README.md), without and with the passivity
// controller.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "device/backends/devices.h"
#include "tests/device/scripted_device.h"
#include "tests/paths/sampled_plants.h"

namespace forceshade::device {
namespace {

using namespace testing;

using forceshade::testing::kPlants;
using forceshade::testing::Plant;

LoopRun run_for(const Plant& plant, double share, const SafetyLimits& limits) {
    const PreparedCase prepared = prepared_scene(
        forceshade::testing::pressed_scene(plant, share * plant.limit, 1.01, "", "max_force = \"10 N\"\n"));
    const double rate = 1 / plant.period;
    const auto sim = make_sim(prepared, rate);
    const double decay = plant.mass / plant.damping; // s: of its speed
    return run_fast(*sim, prepared, static_cast<std::uint64_t>(150 * decay * rate), limits, rate);
}

TEST(LiveStability, SettlesBelowTheLimitAndCyclesAboveIt) {
    for (const Plant& plant : std::span(kPlants).first(4)) { // the others' forces are larger than a device's
        const LoopRun below = run_for(plant, 0.95, no_limits()), above = run_for(plant, 1.05, no_limits());
        EXPECT_LT(swing(below.samples, 0.9, 1), 0.05 * swing(below.samples, 0, 0.1)) << plant.limit;
        EXPECT_GT(swing(above.samples, 0.9, 1), 3 * swing(above.samples, 0, 0.1)) << plant.limit;
        EXPECT_GT(above.counts.energy, 10 * std::abs(below.counts.energy)) << "what drives it";
    }
}

TEST(LiveStability, ThePassivityControllerKeepsItBounded) {
    for (const Plant& plant : std::span(kPlants).first(4)) { // the others' forces are larger than a device's
        SafetyLimits limits = no_limits();
        limits.passivity = kPassiveDamping;
        const LoopRun free = run_for(plant, 1.05, no_limits()), damped = run_for(plant, 1.05, limits);
        EXPECT_LT(swing(damped.samples, 0.9, 1), swing(damped.samples, 0, 0.1)) << plant.limit;
        EXPECT_GT(damped.counts.damped, 0);
        // What the hand has been given does not grow: not beyond what a sample or two may give before it is taken back.
        const std::size_t half = damped.samples.size() / 2;
        double first = -kUnknown, second = -kUnknown;
        for (std::size_t i = 0; i < damped.samples.size(); ++i)
            (i < half ? first : second) = std::max(i < half ? first : second, damped.samples[i].energy);
        EXPECT_LE(second, first) << plant.limit;
        EXPECT_LT(second, 0.01 * free.counts.energy) << plant.limit;
    }
}

// A wall that is stable by far, felt through a device that tells its position in steps of 30 um: over one sample a step
// looks like a speed.
TEST(LiveStability, ThePassivityControllerMakesNoBuzzOfAResolution) {
    for (const double rate : {1000.0, 4000.0}) {
        const PreparedCase prepared = prepared_scene(
            "[force]\nstiffness = \"1 N/mm\"\n[paths]\nlength = \"0 m\"\npress = \"1 N\"\nstart_depth = \"1.015 mm\"\n"
            "tremor = { amplitude = \"0.1 mm\" }\n[hand]\nquantisation = \"30 um\"\nmax_force = \"10 N\"\n");
        const auto sim = make_sim(prepared, rate);
        SafetyLimits limits = no_limits();
        limits.passivity = kPassiveDamping;
        const LoopRun run = run_fast(*sim, prepared, static_cast<std::uint64_t>(20 * rate), limits, rate);
        EXPECT_LT(run.counts.largest_energy, 1e-3) << rate;
        double largest = 0; /* N: change of the force within a sample */
        for (std::size_t i = 1; i < run.samples.size(); ++i)
            largest = std::max(largest, std::abs(run.samples[i].commanded.z - run.samples[i - 1].commanded.z));
        EXPECT_LT(largest, 0.5) << rate;
    }
}

// What a device displays of a scene, with the limits that are on by default and a hand of [hand].
LoopRun displayed(const std::string& scene, double seconds, double rate, bool fade = true) {
    const PreparedCase prepared = prepared_scene(scene);
    const auto sim = make_sim(prepared, rate);
    SafetyLimits limits;
    limits.fade = fade;
    limits.max_force = 8.5; // as the device has it
    return run_fast(*sim, prepared, static_cast<std::uint64_t>(seconds * rate), limits, rate);
}

// A wall of 20 N/mm at 1 kHz swings between nothing and the device's 8.5 N for as long as it is pressed.
TEST(LiveStability, AForceThatDrivesAnOscillationFadesOut) {
    for (const auto& [stiffness, rate] :
         {std::pair(20.0, 1000.0), {6.5, 1000.0}, {8.0, 1000.0}, {50.0, 1000.0}, {30.0, 4000.0}, {80.0, 4000.0}}) {
        const std::string scene =
            fmt::format("[force]\nstiffness = \"{} N/mm\"\n[paths]\nlength = \"0 m\"\npress = \"1 N\"\n"
                        "start_depth = \"-1 mm\"\n",
                        stiffness);
        const LoopRun felt = displayed(scene, 2, rate, false), run = displayed(scene, 2, rate);
        EXPECT_GT(swing(felt.samples, 0.8, 1), 0.1e-3) << stiffness;
        EXPECT_EQ(felt.counts.with(kUnstable), 0u);
        const auto marked = [](const LiveSample& sample) { return (sample.flags & kUnstable) != 0; };
        const auto found = std::ranges::find_if(run.samples, marked);
        ASSERT_NE(found, run.samples.end()) << stiffness;
        EXPECT_LT(found->time, 1) << stiffness << ": in contact since about 0.2 s, at 14 Hz or faster";
        for (auto sample = found; sample != run.samples.end() && marked(*sample); ++sample)
            if (sample->time - found->time > 0.021) {
                EXPECT_EQ(sample->commanded, glm::dvec3(0)) << stiffness << " at " << sample->time;
            }
    }
}

// Nothing that holds is taken for an oscillation: a wall that rings below its limit, taps, quick strokes over a shaded
// bump, which gives energy, and over a stiff texture, which swings.
TEST(LiveStability, AForceThatAHandHoldsIsNotFaded) {
    const std::string bump = "[surface]\nradius = \"600 mil\"\nfacets = 8\n[force]\nshading = \"reference\"\n";
    for (const std::string& scene :
         {std::string(
              "[force]\nstiffness = \"4 N/mm\"\n[paths]\nlength = \"0 m\"\npress = \"2 N\"\nstart_depth = \"-1 mm\"\n"),
          std::string("[paths]\nkind = \"taps\"\nspeed = \"60 mm/s\"\ndepth = \"5 mm\"\n"),
          bump + "[paths]\nspeed = \"200 mm/s\"\npress = \"2 N\"\n",
          bump + "[paths]\nspeed = \"20 mm/s\"\npress = \"1 N\"\n",
          bump + "[texture]\nfunction = \"sine\"\nstiffness = \"0.5 N/mm\"\nwidth = \"2 mm\"\nheight = \"0.2 mm\"\n"
                 "[paths]\nspeed = \"100 mm/s\"\npress = \"1 N\"\n"}) {
        const LoopRun run = displayed(scene, 10, 1000);
        EXPECT_GT(run.counts.in_contact, run.counts.samples / 10) << scene;
        EXPECT_EQ(run.counts.with(kUnstable), 0u) << scene;
    }
}

} // namespace
} // namespace forceshade::device
