// The loop's own business: its ways to end, its clock, new laws, and the room for its samples.
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "device/loop/sample.h"
#include "tests/device/loop_runs.h"

namespace forceshade::device {
namespace {

using namespace testing;

TEST(LiveLoop, EveryTickRunsAndIsLogged) {
    ScriptedDevice device(deep, 3000, false);
    const LoopRun run = run_through(device, real_time(5000, 2000));
    EXPECT_EQ(run.end, LoopEnd::done);
    ASSERT_EQ(run.samples.size(), 2000u);
    EXPECT_EQ(run.counts.samples, 2000u);
    for (std::size_t i = 0; i < run.samples.size(); ++i) {
        ASSERT_EQ(run.samples[i].tick, i);
        ASSERT_TRUE(i == 0 || run.samples[i].time > run.samples[i - 1].time);
        ASSERT_GE(run.samples[i].late, 0);
        ASSERT_GE(run.samples[i].time, double(i) / 5000) << "no sample runs before it is due";
    }
    EXPECT_EQ(run.counts.late.count(), 2000u);
    EXPECT_EQ(run.counts.jitter.count(), 1999u);
    EXPECT_EQ(device.forces.size(), 2001u);
    EXPECT_NEAR(device.forces[1999].z, 1, 1e-12);
    expect_forceless_end(device);
}

TEST(LiveLoop, WhoeverStopsItTheDeviceIsLeftWithoutForce) {
    ScriptedDevice device(deep, 100000, false);
    {
        LiveLoop loop(device, make_probe_law(prepared_scene(kPlane)), real_time(1000), nullptr);
        loop.start();
        while (loop.status().samples < 20)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        EXPECT_EQ(loop.end(), LoopEnd::running);
        EXPECT_NEAR(loop.status().force, 1, 1e-12);
        EXPECT_NEAR(loop.status().depth, 1e-3, 1e-12);
    } // as an exception would
    EXPECT_GT(device.forces.size(), 20u);
    expect_forceless_end(device);
}

TEST(LiveLoop, EndsWithTheRecording) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            return tick < 50 ? deep(tick) : Reading{Answer::ended, glm::dvec3(0), false};
        },
        200);
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 1000, no_limits());
    EXPECT_EQ(run.end, LoopEnd::recording_over);
    EXPECT_EQ(run.samples.size(), 50u);
    EXPECT_EQ(run.counts.waiting, 0u);
    expect_forceless_end(device);
}

TEST(LiveLoop, APathThatBeginsMarksThatTheForceIsDropped) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            return Reading{Answer::fresh, {0, 0, -1e-3}, tick == 0 || tick == 400};
        },
        1000);
    SafetyLimits limits;
    limits.max_force = 3;
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 800, limits);
    EXPECT_NEAR(device.forces[399].z, 1, 1e-9);
    EXPECT_LT(device.forces[400].z, 0.01);
    for (std::size_t i = 0; i < 800; ++i) {
        ASSERT_EQ((run.samples[i].flags & kNewPath) != 0, i == 400) << i;
        ASSERT_EQ(run.samples[i].path, i < 400 ? 0u : 1u) << i;
    }
    EXPECT_EQ(kSampleFlagNames[16], "new_path");
}

TEST(LiveLoop, WaitsForTheFirstPosition) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            return tick < 10   ? Reading{Answer::repeated, glm::dvec3(0), false}
                   : tick < 20 ? Reading{Answer::fresh, glm::dvec3(kNan), false}
                               : deep(tick);
        },
        200);
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 100, no_limits());
    EXPECT_EQ(run.counts.waiting, 20u);
    ASSERT_EQ(run.samples.size(), 80u);
    EXPECT_EQ(run.samples.front().tick, 20u);
    for (std::size_t i = 0; i < 20; ++i)
        EXPECT_EQ(device.forces[i], glm::dvec3(0));
}

TEST(LiveLoop, ComputingForTooLongIsItsOwnFault) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            const std::int64_t begin = computed_so_far();
            while (tick == 50 && computed_so_far() - begin < kSecond / 50) {
            }
            return deep(tick);
        },
        1000, false);
    const LoopRun run = run_through(device, real_time(1000, 100));
    EXPECT_NE(run.samples[50].flags & kOwnOverrun, 0u);
    EXPECT_EQ(run.samples[49].flags & kOwnOverrun, 0u);
    EXPECT_EQ(run.counts.flags[13], 1u);
}

// A page or a network that is slow is not waited for, not even as fast as possible, and takes nothing from the log.
TEST(LiveLoop, OnlyTheLogIsWaitedFor) {
    ScriptedDevice device(deep, 1000);
    LoopSettings settings;
    settings.real_time = false;
    settings.samples = 500;
    SampleRing log(512), unread(4), read(512);
    LiveLoop loop(device, make_probe_law(prepared_scene(kPlane)), settings, &log, {&unread, &read});
    loop.start();
    loop.join();
    EXPECT_EQ(loop.counts().lost, 0u);
    EXPECT_EQ(log.look().size(), 500u);
    ASSERT_EQ(unread.look().size(), 4u);
    EXPECT_EQ(unread.look().back().tick, 3u);
    ASSERT_EQ(read.look().size(), 500u);
    EXPECT_EQ(read.look().back().force, log.look().back().force);
}

TEST(LiveLoop, ANewLawHoldsFromTheNextSampleOnAndBeginsAPath) {
    ScriptedDevice device(deep, 100000, false);
    SampleRing ring(1 << 14);
    LiveLoop loop(device, make_probe_law(prepared_scene(kPlane)), real_time(2000), &ring);
    loop.start();
    const auto further = [&] {
        const std::uint64_t from = loop.status().samples;
        while (loop.status().samples < from + 10)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    for (const char* const stiffness : {"2", "3", "4"}) {
        further();
        const std::uint32_t before = loop.status().laws;
        loop.offer(make_probe_law(prepared_scene(std::string("[force]\nstiffness = \"") + stiffness + " N/mm\"\n")));
        while (loop.status().laws == before)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        EXPECT_EQ(loop.status().law_path, before + 1);
    }
    further();
    loop.stop();
    loop.join();
    std::uint32_t path = 0;
    for (const LiveSample& sample : ring.look()) {
        ASSERT_TRUE(sample.path == path || sample.path == path + 1);
        path = sample.path;
        ASSERT_NEAR(sample.force.z, 1.0 + path, 1e-12);
    }
    EXPECT_EQ(path, 3u);
    EXPECT_EQ(loop.counts().paths, 4u);
}

// A surface that rises above the probe does not throw it out.
TEST(LiveLoop, TheForceOfANewLawComesUpAnew) {
    LiveLoop* felt = nullptr;
    ScriptedDevice device(
        [&](std::uint64_t tick) {
            if (tick == 300)
                felt->offer(make_probe_law(prepared_scene("[force]\nstiffness = \"2 N/mm\"\n")));
            return deep(tick);
        },
        1000);
    LoopSettings settings;
    settings.real_time = false;
    settings.samples = 600;
    LiveLoop loop(device, make_probe_law(prepared_scene(kPlane)), settings, nullptr);
    felt = &loop;
    loop.start();
    loop.join();
    EXPECT_NEAR(device.forces[300].z, 1, 1e-9);
    for (std::size_t i = 301; i < 500; ++i) {
        ASSERT_LE(device.forces[i].z, 0.01 * double(i - 300) + 1e-9) << i;
        ASSERT_GT(device.forces[i].z, 0) << i;
    }
    EXPECT_NEAR(device.forces[520].z, 2, 1e-9);
}

TEST(LiveLoop, SamplesWithoutRoomAreCounted) {
    ScriptedDevice device(deep, 10, false);
    const LoopRun run = run_through(device, real_time(10000, 500), 64);
    EXPECT_EQ(run.samples.size(), 64u);
    EXPECT_EQ(run.counts.lost, 436u);
    EXPECT_EQ(run.counts.samples, 500u);
}

} // namespace
} // namespace forceshade::device
