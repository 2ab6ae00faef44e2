// The live loop feels what the oracle's paths feel, bit for bit.
#include <cmath>

#include <gtest/gtest.h>

#include "device/backends/devices.h"
#include "host/field/case_law.h"
#include "host/paths/scene_paths.h"
#include "host/reference/elementary.h"
#include "host/reference/field.h"
#include "tests/device/scripted_device.h"
#include "tests/places.h"

namespace forceshade::device {
namespace {

using namespace testing;

const char* const kBump = "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n";
const char* const kCylinder = "[surface]\nkind = \"cylinder_bump\"\n";
const char* const kMap =
    "[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nheight = \"3 mm\"\nradius = \"8 mm\"\n"
    "[force]\nshading = \"height_map\"\n[texture]\nstiffness = \"0.2 N/mm\"\nfunction = \"sine\"\n"
    "width = \"2 mm\"\nheight = \"0.1 mm\"\n";

std::string spot(const std::string& shading) {
    return std::string("[surface]\nkind = \"mesh\"\nfile = \"") + in_source("tests/data") +
           "/spot.obj\"\ntransform = { scale = 0.05, rotate = [\"90 deg\", \"0 deg\", \"0 deg\"] }\n[force]\nshading = "
           "\"" +
           shading + "\"\n";
}

template <typename T> void expect_bits(const PreparedCase& prepared, const LoopRun& run) {
    const auto probe = std::make_unique<CaseProbe<T>>(prepared);
    std::size_t in_contact = 0, path = 0;
    for (const LiveSample& sample : run.samples) {
        if (std::exchange(path, sample.path) != sample.path)
            probe->begin_path();
        const auto felt = probe->at(sample.probe).contact;
        in_contact += felt.facet != layout::kNoFacet;
        ASSERT_EQ(sample.force, glm::dvec3(felt.force)) << sample.tick;
        ASSERT_EQ(sample.proxy, glm::dvec3(felt.proxy)) << sample.tick;
        ASSERT_EQ(sample.depth, double(felt.depth)) << sample.tick;
        ASSERT_EQ(sample.facet, felt.facet) << sample.tick;
    }
    EXPECT_GT(in_contact, run.samples.size() / 4);
}

TEST(LiveBits, EqualThoseOfThePathLaw) {
    for (const std::string& scene : {std::string(kBump), std::string(kCylinder), std::string(kMap), spot("none"),
                                     spot("morgenbesser"), spot("mean_value")})
        for (const Precision precision : {Precision::f32, Precision::f64}) {
            const PreparedCase prepared = prepared_scene(scene, precision);
            const auto hand = make_sim(prepared, 1000);
            const LoopRun run = run_fast(*hand, prepared, 3000, SafetyLimits{});
            ASSERT_EQ(run.samples.size(), 3000u);
            if (precision == Precision::f32)
                expect_bits<float>(prepared, run);
            else
                expect_bits<double>(prepared, run);
        }
}

TEST(LiveBits, OfTheSimulatedHandEqualThoseOfAClosedLoop) {
    for (const char* const hand : {"", "coulomb = \"0.05 N\"\n", "quantisation = \"0.03 mm\"\n", "delay_samples = 1\n",
                                   "coupling = { stiffness = \"2 N/mm\", damping = \"1 N s/m\" }\n",
                                   "[friction]\nstatic_coefficient = 0.5\ndamping = \"0.1 N s/m\"\n",
                                   "coupling.stiffness = \"2 N/mm\"\n[friction]\n"}) {
        const PreparedCase prepared =
            prepared_scene(std::string(kBump) +
                           "[paths]\ncount = 1\nsteps = 2500\nloop = \"closed\"\ndepth = \"30 mm\"\n"
                           "tremor = { amplitude = \"0.1 mm\" }\n[hand]\n" +
                           hand);
        ScenePaths<double> paths(prepared);
        layout::PathInput<double> input = paths.input();
        input.features.channels = layout::kChannelForce | layout::kChannelPosition;
        const auto sim = make_sim(prepared, 1000);
        SafetyLimits limits = no_limits();
        limits.max_force = sim->facts().max_force;
        const LoopRun run = run_fast(*sim, prepared, 2500, limits);
        ASSERT_EQ(run.samples.size(), 2500u);
        std::size_t compared = 0;
        reference::evaluate_paths<double>(
            input, {},
            [&](const layout::PathChunk<double>& chunk) {
                for (std::size_t step = 0; step < chunk.step_count; ++step, ++compared) {
                    const LiveSample& sample = run.samples[chunk.step_first + step];
                    ASSERT_EQ(sample.probe, reference::vector_at(chunk.position, step)) << sample.tick;
                    ASSERT_EQ(sample.commanded, reference::vector_at(chunk.force, step)) << sample.tick;
                }
            },
            [](std::size_t, std::span<const layout::PathMetrics<double>>) {});
        EXPECT_EQ(compared, 2500u);
        EXPECT_GT(run.counts.flags[0], 0u) << "the hand presses harder than the device displays";
    }
}

TEST(LiveBits, APathOfAMeshBeginsAnewWhereTheRecordingSaysSo) {
    const PreparedCase prepared = prepared_scene(spot("none"));
    const auto hand = make_sim(prepared, 1000);
    std::vector<glm::dvec3> places;
    for (const LiveSample& sample : run_fast(*hand, prepared, 1000, SafetyLimits{}).samples)
        places.push_back(sample.probe);
    ScriptedDevice device(
        [&](std::uint64_t tick) {
            return Reading{Answer::fresh, places[(tick * 7) % places.size()], tick % 100 == 0};
        },
        0);
    const LoopRun run = run_fast(device, prepared, 1000, SafetyLimits{});
    EXPECT_EQ(run.samples.back().path, 9u);
    EXPECT_EQ(run.counts.paths, 10u);
    expect_bits<double>(prepared, run);
}

TEST(LiveBits, AHandThatFallsOffBeginsAgain) {
    const PreparedCase prepared = prepared_scene(
        spot("none") + "[paths]\nlength = \"0.3 m\"\npress = \"1 N\"\nspeed = \"300 mm/s\"\nbound = \"50 mm\"\n");
    const auto hand = make_sim(prepared, 1000);
    const LoopRun run = run_fast(*hand, prepared, 20000, SafetyLimits{});
    EXPECT_GT(run.samples.back().path, 3u);
    std::uint32_t path = 0;
    for (const LiveSample& sample : run.samples) {
        if (sample.path != path) {
            ASSERT_EQ(sample.probe, run.samples.front().probe);
        }
        path = sample.path;
        ASSERT_LT(sample.flags & kZeroForceFlags, 1u) << sample.tick;
    }
}

} // namespace
} // namespace forceshade::device
