// What the loop does when a device, or time, is not as it should be.
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "device/loop/sample.h"
#include "tests/device/loop_runs.h"

namespace forceshade::device {
namespace {

using namespace testing;

TEST(LiveLoop, ADeviceThatIsGoneIsWaitedForAndThenGivenUp) {
    for (const Answer answer : {Answer::failed, Answer::repeated})
        for (const std::uint64_t fine : {0u, 100u}) {
            if (answer == Answer::repeated && fine > 0)
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

TEST(LiveLoop, ADeviceIsNotGoneBecauseTheProcessStoodStill) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            if (tick != 20)
                return deep(tick);
            sleep_until(now() + kSecond);
            return Reading{};
        },
        0, false);
    LoopSettings settings = real_time(1000, 1100);
    settings.patience = 0.5;
    EXPECT_EQ(run_through(device, settings).end, LoopEnd::done);
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
        EXPECT_EQ(run.samples[100].flags & kZeroForceFlags, expected);
        EXPECT_LT(device.forces[120].z, 0.11) << "it comes up slowly";
        EXPECT_GT(device.forces[399].z, 0.9);
        for (const LiveSample& sample : run.samples)
            EXPECT_TRUE(std::isfinite(sample.probe.x + sample.probe.y + sample.probe.z + sample.force.z));
    }
}

TEST(LiveLoop, AStalePositionIsWithoutForce) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            return tick < 100 ? deep(tick) : Reading{Answer::repeated, {0, 0, -1e-3}, false};
        },
        1000);
    SafetyLimits limits = no_limits();
    limits.stale = 0.0105;
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 200, limits);
    EXPECT_NEAR(device.forces[109].z, 1, 1e-12) << "10 ms old";
    for (std::size_t i = 110; i < 200; ++i)
        ASSERT_EQ(device.forces[i], glm::dvec3(0)) << i;
    EXPECT_EQ(run.counts.flags[6], 90u);
}

TEST(LiveLoop, AForceThatTheDeviceRefusedComesUpAnew) {
    SafetyLimits limits;
    limits.max_force = 3;
    std::uint64_t count = 0;
    ScriptedDevice* asked = nullptr;
    ScriptedDevice deaf_once(
        [&](std::uint64_t tick) {
            asked->takes_forces = ++count != 201;
            return deep(tick);
        },
        1000);
    asked = &deaf_once;
    const LoopRun run = run_fast(deaf_once, prepared_scene(kPlane), 300, limits);
    EXPECT_EQ(run.samples[200].flags & kZeroForceFlags, kFailed);
    EXPECT_EQ(run.samples[200].commanded, glm::dvec3(0)) << "what was not taken was not displayed";
    EXPECT_NEAR(deaf_once.forces[199].z, 1, 1e-9);
    EXPECT_LT(deaf_once.forces[201].z, 0.011);
}

TEST(LiveLoop, AForceThatIsWithheldIsNoneAndTheDeviceIsNotGone) {
    ScriptedDevice* asked = nullptr;
    ScriptedDevice device(
        [&](std::uint64_t tick) {
            asked->reason = tick >= 300 && tick < 9000 ? "switched off by its button" : nullptr;
            return deep(tick);
        },
        20000);
    asked = &device;
    SafetyLimits limits;
    limits.max_force = 3;
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 10000, limits);
    EXPECT_EQ(run.end, LoopEnd::done) << "longer than the 5 s of patience with a device that is gone";
    EXPECT_NEAR(device.forces[299].z, 1, 1e-9);
    for (std::size_t i = 300; i < 9000; ++i) {
        ASSERT_EQ(device.forces[i], glm::dvec3(0)) << i;
        ASSERT_EQ(run.samples[i].flags & kZeroForceFlags, kWithheld) << i;
    }
    EXPECT_LT(device.forces[9000].z, 0.011) << "it comes up slowly";
    EXPECT_NEAR(device.forces[9999].z, 1, 1e-9);
    EXPECT_EQ(run.counts.flags[14], 8700u);
}

TEST(LiveLoop, ASampleThatTheDeviceTookTooLateSaysSo) {
    ScriptedDevice device(deep, 100000, false);
    device.slow_write = 101;
    LoopSettings settings = real_time(1000, 400);
    settings.limits.late = 0.09;
    settings.limits.ramp = 0.1;
    const LoopRun run = run_through(device, settings);
    const LiveSample& late = run.samples[100];
    EXPECT_NE(late.flags & kTooLate, 0u);
    EXPECT_GT(late.commanded.z, 0.5) << "what was sent";
    EXPECT_LT(run.samples[101].commanded.z, 0.02) << "and what follows comes up anew";
}

TEST(LiveLoop, APathThatBeginsWithoutAPositionBeginsWithTheNext) {
    ScriptedDevice device(
        [](std::uint64_t question) {
            Reading reading = at(question == 50 ? NAN : 0, 0, -1e-3);
            reading.begins_path = question == 50;
            return reading;
        },
        1000);
    const LoopRun run = run_fast(device, prepared_scene(kPlane), 100, no_limits());
    EXPECT_EQ(run.samples[50].path, 0u);
    EXPECT_EQ(run.samples[51].path, 1u);
    EXPECT_NE(run.samples[51].flags & kNewPath, 0u);
    EXPECT_EQ(run.samples[99].path, 1u);
}

TEST(LiveLoop, AForceThatTheDeviceLetGoOfComesUpFromZero) {
    // At 100 Hz a sample may be 200 ms late; the device lets go of its force after 50 ms.
    ScriptedDevice device(
        [](std::uint64_t question) {
            if (question == 100)
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
            return at(0, 0, -1e-3);
        },
        1000, false);
    device.lets_go_after(0.05);
    LoopSettings settings = real_time(100, 120);
    settings.limits.late = 0.2;
    settings.limits.ramp = 0.5;
    const LoopRun run = run_through(device, settings);
    EXPECT_NE(run.samples[100].flags & kTooLate, 0u);
    EXPECT_EQ(run.samples[100].commanded, glm::dvec3(0));
    EXPECT_LT(run.samples[101].commanded.z, 0.1 * run.samples[101].force.z);
}

TEST(LiveLoop, SuspendedItDisplaysNothing) {
    ScriptedDevice device(deep, 100000, false);
    LoopSettings settings = real_time(1000);
    LiveLoop loop(device, make_probe_law(prepared_scene(kPlane)), settings, nullptr);
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
    settings.limits.late = 0.05;
    const LoopRun run = run_through(device, settings);
    EXPECT_GE(rests_meanwhile, 1);
    ASSERT_EQ(run.samples.size(), 800u) << "none is skipped";
    EXPECT_NE(run.samples[100].flags & kOverrun, 0u);
    EXPECT_EQ(run.samples[100].flags & kOwnOverrun, 0u) << "it did not compute";
    for (std::size_t i = 100; i < 500; ++i) { // the one that was held up between its position and its force, too
        ASSERT_NE(run.samples[i].flags & kTooLate, 0u) << i;
        ASSERT_EQ(run.samples[i].commanded, glm::dvec3(0)) << i;
    }
}

// Nobody's device is given an hour's samples at once.
TEST(LiveLoop, AProcessThatStoodStillTakesUpItsTimeWhereItWakes) {
    ScriptedDevice device(
        [](std::uint64_t tick) {
            if (tick == 100)
                sleep_until(now() + kSecond);
            return deep(tick);
        },
        100000, false);
    LoopSettings settings = real_time(1000, 300);
    settings.limits.late = 0.05;
    settings.standstill = 0.3;
    const LoopRun run = run_through(device, settings);
    ASSERT_EQ(run.samples.size(), 300u);
    EXPECT_GT(run.counts.standstill, 0.9);
    EXPECT_GT(run.samples[101].time - run.samples[99].time, 0.9) << "times leap";
    EXPECT_GT(run.samples[299].time - run.samples[102].time, 0.19) << "and go on at the rate";
    EXPECT_NE(run.samples[101].flags & kTooLate, 0u);
}

} // namespace
} // namespace forceshade::device
