// The loop's own business: its ways to end, its clock, its guard, new laws, and the room for its samples.
#include <chrono>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "device/loop/clock.h"
#include "host/explore/path_law.h"
#include "tests/device/scripted_device.h"

namespace forceshade::device {
namespace {

using namespace testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const char* const kPlane = "[force]\nstiffness = \"1 N/mm\"\n";

// In a plane of 1 N/mm, a millimetre deep.
Reading deep(std::uint64_t) {
    return at(0, 0, -1e-3);
}

LoopSettings real_time(double rate, std::optional<std::uint64_t> samples = {}) {
    LoopSettings settings;
    settings.rate = rate;
    settings.samples = samples;
    settings.limits.ramp = 0;
    settings.limits.late = kUnknown; // a test's machine may be busy
    return settings;
}

// A loop on a device until it ends, all samples kept.
LoopRun run_through(BackEnd& device, const LoopSettings& settings, std::size_t room = 1 << 14) {
    SampleRing ring(room);
    LiveLoop loop(device, make_live_law(prepared_scene(kPlane)), settings, &ring);
    loop.start();
    loop.join();
    const auto kept = ring.look();
    return {{kept.begin(), kept.end()}, loop.counts(), loop.end()};
}

void expect_forceless_end(const ScriptedDevice& device) {
    ASSERT_FALSE(device.forces.empty());
    EXPECT_EQ(device.forces.back(), glm::dvec3(0));
}

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
        LiveLoop loop(device, make_live_law(prepared_scene(kPlane)), real_time(1000), nullptr);
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
    expect_forceless_end(device);
}

TEST(LiveLoop, ADeviceThatIsGoneIsWaitedForAndThenGivenUp) {
    for (const Answer answer : {Answer::failed, Answer::held})
        for (const std::uint64_t fine : {0u, 100u}) {
            if (answer == Answer::held && fine > 0)
                continue; // it may rest
            ScriptedDevice device(
                [&](std::uint64_t tick) {
                    return tick < fine ? deep(tick) : Reading{answer, glm::dvec3(kNan), false};
                },
                20000);
            const LoopRun run = run_fast(device, prepared_scene(kPlane), 20000, no_limits());
            EXPECT_EQ(run.end, LoopEnd::device_gone);
            EXPECT_NEAR(double(device.forces.size()), 5000.0 + double(fine), 3) << "5 s of patience";
            for (std::size_t i = fine; i < device.forces.size(); ++i)
                ASSERT_EQ(device.forces[i], glm::dvec3(0)) << i;
            EXPECT_EQ(run.counts.waiting > 0, fine == 0);
        }
    ScriptedDevice deaf(deep, 20000);
    deaf.takes_forces = false;
    EXPECT_EQ(run_fast(deaf, prepared_scene(kPlane), 20000, no_limits()).end, LoopEnd::device_gone);
}

TEST(LiveLoop, WaitsForTheFirstPosition) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            return tick < 10   ? Reading{Answer::held, glm::dvec3(0), false}
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

// Whatever goes wrong at sample 100 is without force at once, and what is logged is where the law was asked.
TEST(LiveLoop, FaultsOfADeviceAreWithoutForceAtOnce) {
    const std::vector<std::pair<std::uint32_t, Reading>> faults{
        {kBadPosition, {Answer::fresh, {kNan, 0, -1e-3}, false}},
        {kBadPosition, {Answer::fresh, {0, kUnknown, -1e-3}, false}},
        {kBadPosition, {Answer::fresh, {0, 0, -1e200}, false}},
        {kFailed, {Answer::failed, {0, 0, -1e-3}, false}},
        {kTooFast, {Answer::fresh, {0, 0.5, -1e-3}, false}},
        {kTooFast | kOutside, {Answer::fresh, {0, 0, -9}, false}}};
    for (const auto& [expected, fault] : faults) {
        ScriptedDevice device([&](std::uint64_t tick) { return tick == 100 ? fault : deep(tick); }, 1000);
        SafetyLimits limits;
        limits.max_force = 3;
        limits.low = glm::dvec3(-1);
        limits.high = glm::dvec3(1);
        const LoopRun run = run_fast(device, prepared_scene(kPlane), 400, limits);
        EXPECT_GT(device.forces[99].z, 0.4);
        EXPECT_EQ(device.forces[100], glm::dvec3(0)) << expected;
        EXPECT_EQ(run.samples[100].happened & kForceless, expected);
        EXPECT_LT(device.forces[120].z, 0.11) << "it comes up slowly";
        EXPECT_GT(device.forces[399].z, 0.9);
        for (const LiveSample& sample : run.samples)
            EXPECT_TRUE(std::isfinite(sample.probe.x + sample.probe.y + sample.probe.z + sample.force.z));
    }
}

TEST(LiveLoop, AStalePositionIsWithoutForce) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            return tick < 100 ? deep(tick) : Reading{Answer::held, {0, 0, -1e-3}, false};
        },
        1000);
    SafetyLimits limits = no_limits();
    limits.stale = 0.0105;
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 200, limits);
    EXPECT_NEAR(device.forces[109].z, 1, 1e-12) << "10 ms old";
    for (std::size_t i = 110; i < 200; ++i)
        ASSERT_EQ(device.forces[i], glm::dvec3(0)) << i;
    EXPECT_EQ(run.counts.happened[6], 90u);
}

TEST(LiveLoop, AForceThatTheDeviceRefusedComesUpAnew) {
    SafetyLimits limits;
    limits.max_force = 3;
    LoopSettings settings;
    settings.real_time = false;
    settings.limits = limits;
    settings.samples = 300;
    SampleRing ring(512);
    std::uint64_t count = 0;
    ScriptedDevice* asked = nullptr;
    ScriptedDevice deaf_once(
        [&](std::uint64_t tick) {
            asked->takes_forces = ++count != 201;
            return deep(tick);
        },
        1000);
    asked = &deaf_once;
    LiveLoop loop(deaf_once, make_live_law(prepared_scene(kPlane)), settings, &ring);
    loop.start();
    loop.join();
    EXPECT_EQ(ring.look()[200].happened & kForceless, kFailed);
    EXPECT_NEAR(deaf_once.forces[199].z, 1, 1e-9);
    EXPECT_LT(deaf_once.forces[201].z, 0.011);
}

TEST(LiveLoop, SuspendedItDisplaysNothing) {
    ScriptedDevice device(deep, 100000, false);
    LoopSettings settings = real_time(1000);
    LiveLoop loop(device, make_live_law(prepared_scene(kPlane)), settings, nullptr);
    loop.start();
    const auto come_to = [&](std::uint64_t samples) {
        while (loop.status().samples < samples)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    come_to(10);
    loop.suspend(true);
    const std::uint64_t from = loop.status().samples + 2;
    come_to(from + 10);
    const std::uint64_t to = loop.status().samples;
    loop.suspend(false);
    come_to(to + 20);
    loop.stop();
    loop.join();
    for (std::size_t i = from; i < to; ++i)
        ASSERT_EQ(device.forces[i], glm::dvec3(0));
    EXPECT_GT(device.forces[device.forces.size() - 2].z, 0);
}

TEST(LiveLoop, TheWatchdogTakesTheForceOfALoopThatIsStuck) {
    std::atomic<int> rests_meanwhile = 0;
    ScriptedDevice* seen = nullptr;
    ScriptedDevice device(
        [&](std::uint64_t tick) {
            if (tick == 100) {
                sleep_until(now() + kSecond / 2);
                rests_meanwhile = seen->rests.load();
            }
            return deep(tick);
        },
        100000, false);
    seen = &device;
    LoopSettings settings = real_time(1000, 800);
    settings.limits.late = 50;
    const LoopRun run = run_through(device, settings);
    EXPECT_GE(rests_meanwhile, 1);
    ASSERT_EQ(run.samples.size(), 800u) << "none is skipped";
    EXPECT_NE(run.samples[100].happened & kOverrun, 0u);
    EXPECT_EQ(run.samples[100].happened & kOwnOverrun, 0u) << "it did not compute";
    for (std::size_t i = 101; i < 500; ++i) {
        ASSERT_NE(run.samples[i].happened & kTooLate, 0u) << i;
        ASSERT_EQ(run.samples[i].commanded, glm::dvec3(0)) << i;
    }
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
    EXPECT_NE(run.samples[50].happened & kOwnOverrun, 0u);
    EXPECT_EQ(run.samples[49].happened & kOwnOverrun, 0u);
    EXPECT_EQ(run.counts.happened[13], 1u);
}

TEST(LiveLoop, ANewLawHoldsFromTheNextSampleOnAndBeginsAPath) {
    ScriptedDevice device(deep, 100000, false);
    SampleRing ring(1 << 14);
    LiveLoop loop(device, make_live_law(prepared_scene(kPlane)), real_time(2000), &ring);
    loop.start();
    const auto further = [&] {
        const std::uint64_t from = loop.status().samples;
        while (loop.status().samples < from + 10)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    for (const char* const stiffness : {"2", "3", "4"}) {
        further();
        const std::uint32_t before = loop.status().laws;
        loop.offer(make_live_law(prepared_scene(std::string("[force]\nstiffness = \"") + stiffness + " N/mm\"\n")));
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

TEST(LiveLoop, SamplesWithoutRoomAreCounted) {
    ScriptedDevice device(deep, 10, false);
    const LoopRun run = run_through(device, real_time(10000, 500), 64);
    EXPECT_EQ(run.samples.size(), 64u);
    EXPECT_EQ(run.counts.lost, 436u);
    EXPECT_EQ(run.counts.samples, 500u);
}

} // namespace
} // namespace forceshade::device
