// The check of a device: each of its steps fails where what it looks at is broken. By a stub of Force Dimension's
// library whose device is held by a soft hand.
#include <chrono>
#include <thread>

#include <nlohmann/json.hpp>

#include "device/session/session.h"
#include "tests/device/scripted_device.h"
#include "tests/device/stub_library.h"

namespace forceshade::device::testing {
namespace {

class DeviceChecks : public ::testing::Test {
protected:
    DeviceChecks() { stub_.place(0.001, 0.002, 0.003); }

    CheckGuide held() const {
        CheckGuide guide;
        guide.held = true;
        return guide;
    }
    DeviceCheck check(const CheckGuide& guide, const std::string& device = "dhd") {
        SessionOptions options;
        options.device = device;
        options.mapping = mapping_;
        options.limits.late = 0.1; // a test's machine may be busy
        return check_device(options, prepared_scene("[force]\nstiffness = \"" + stiffness_ + "\"\n"), guide);
    }
    static const CheckStep& step(const DeviceCheck& check, const std::string& name) {
        for (const CheckStep& one : check.steps)
            if (one.name == name)
                return one;
        throw std::runtime_error("no step " + name);
    }
    static void expect_step(const DeviceCheck& check, const std::string& name, CheckResult result,
                            const std::vector<std::string>& words = {}) {
        const CheckStep& one = step(check, name);
        EXPECT_EQ(one.result, result) << check_text(check);
        expect_words(one.found + one.advice, words);
        EXPECT_TRUE(result == CheckResult::passed || result == CheckResult::absent || !one.advice.empty())
            << name << " says what to do";
    }
    // After the words that ask for a button, it is pressed for a moment.
    CheckGuide with_a_press(long mask) {
        CheckGuide guide = held();
        guide.print = [this, mask](const std::string& text) {
            if (text.starts_with("Press"))
                finger_ = std::jthread([this, mask] {
                    std::this_thread::sleep_for(std::chrono::milliseconds(100));
                    stub_.press(mask);
                    std::this_thread::sleep_for(std::chrono::milliseconds(100));
                    stub_.press(0);
                });
        };
        return guide;
    }

    StubLibrary stub_{"FORCESHADE_DHD_LIBRARY", kDhdStub};
    Mapping mapping_;
    std::string stiffness_ = "1 N/mm";
    std::jthread finger_;
};

TEST_F(DeviceChecks, PassASoundDevice) {
    stub_.hand(1);
    mapping_.turn = turn_about(2, 1.0); // the scene's axes are checked, whatever the device's
    mapping_.scale = 3;
    const DeviceCheck checked = check(with_a_press(2));
    EXPECT_TRUE(checked.passed()) << check_text(checked);
    expect_step(checked, "axes", CheckResult::passed, {"+x 1.0 mm", "-z 1.0 mm"});
    expect_step(checked, "watchdog", CheckResult::passed, {"moved back from 1.0 mm to 0.0 mm"});
    expect_step(checked, "button", CheckResult::passed, {"button 2"});
    EXPECT_EQ(stub_.force(), glm::dvec3(0));
    const auto json = check_json(checked);
    EXPECT_EQ(json["passed"], true);
    EXPECT_EQ(json["device"]["name"], "omega.3 (serial number 417)");
    EXPECT_EQ(json["steps"].size(), 7u);
}

TEST_F(DeviceChecks, FailAnInvertedAxisAndTheRefusalOfAWatchdog) {
    stub_.hand(3);
    stub_.fail("dhdSetWatchdog");
    CheckGuide guide = held();
    guide.entered = [] { return true; }; // who never waits, moves nowhere and presses nothing
    const DeviceCheck checked = check(guide);
    EXPECT_FALSE(checked.passed());
    expect_step(checked, "calibration", CheckResult::passed);
    expect_step(checked, "rest", CheckResult::passed);
    expect_step(checked, "axes", CheckResult::failed, {"pushed along +z it moved ", " mm along -z", "inverted"});
    expect_step(checked, "watchdog", CheckResult::failed, {"refuses a watchdog"});
    expect_step(checked, "workspace", CheckResult::failed, {"the scene needs x -15 to 15", "--origin"});
    expect_step(checked, "button", CheckResult::absent, {"says the person who holds it"});
    EXPECT_EQ(check_json(checked)["passed"], false);
}

// On a wall the default hand comes to rest below 6030 N/m, and a scale makes a scene as much stiffer.
TEST_F(DeviceChecks, FailAStiffnessAtWhichTheHandDoesNotComeToRest) {
    expect_step(check({}), "stability", CheckResult::passed, {"1000 N/m"});
    mapping_.scale = 8;
    expect_step(check({}), "stability", CheckResult::failed, {"8000 N/m", "lower force.stiffness"});
    mapping_.scale = 1;
    stiffness_ = "20 N/mm";
    expect_step(check({}), "stability", CheckResult::failed, {"20000 N/m", "--rate"});
}

TEST_F(DeviceChecks, FailAxesThatAreSwapped) {
    stub_.hand(2);
    const DeviceCheck checked = check(with_a_press(1));
    expect_step(checked, "axes", CheckResult::failed, {"pushed along +x it moved ", " mm along -y", "--rotate"});
    expect_step(checked, "watchdog", CheckResult::passed);
}

TEST_F(DeviceChecks, FailAForceThatStaysOn) {
    stub_.hand(4);
    expect_step(check(with_a_press(1)), "watchdog", CheckResult::failed, {"from", "the force stays on"});
}

TEST_F(DeviceChecks, LetGoOfAProbeThatRunsAwayAndPushNoMore) {
    stub_.hand(5);
    Folder folder;
    stub_.record(folder / "record");
    const DeviceCheck checked = check(with_a_press(1));
    expect_step(checked, "axes", CheckResult::failed, {"+x", "ran away"});
    expect_step(checked, "watchdog", CheckResult::skipped);
    std::vector<Recorded> pushes = recorded(folder / "record");
    std::erase_if(pushes, [](const Recorded& one) { return !one.is_push(); });
    ASSERT_FALSE(pushes.empty());
    EXPECT_LT(pushes.back().time - pushes.front().time, 0.35) << "of the 0.4 s of a push";
}

TEST_F(DeviceChecks, FailADeviceThatDoesNotYieldOrIsOutOfPlace) {
    mapping_.origin = {0.11, 0, 0};
    const DeviceCheck checked = check(with_a_press(4));
    expect_step(checked, "axes", CheckResult::failed, {"less than 0.3 mm along +x, -x, +y", "more lightly"});
    expect_step(checked, "watchdog", CheckResult::skipped, {"did not yield"});
    expect_step(checked, "workspace", CheckResult::failed, {"the device states x -230 to 10"});
    expect_step(checked, "button", CheckResult::passed, {"button 3"});
}

TEST_F(DeviceChecks, PushNothingWithoutPositionsCalibrationOrAHand) {
    for (const auto& [fault, failed, words] :
         {std::tuple("nan", "rest", "without a valid position"), {"uncalibrated", "calibration", "not calibrated"}}) {
        stub_.call<void()>("stub_reset")();
        stub_.hand(1);
        if (fault == std::string("nan"))
            stub_.fail(fault, 100); // it told one when it was opened
        else
            stub_.fail(fault);
        const DeviceCheck checked = check(with_a_press(1));
        expect_step(checked, failed, CheckResult::failed, {words});
        expect_step(checked, "axes", CheckResult::skipped);
        expect_step(checked, "watchdog", CheckResult::skipped);
        EXPECT_FALSE(checked.passed());
    }
    stub_.call<void()>("stub_reset")();
    const DeviceCheck alone = check({});
    for (const char* const name : {"axes", "watchdog", "button"})
        expect_step(alone, name, CheckResult::skipped, {"--yes"});
    EXPECT_FALSE(alone.passed());
    EXPECT_EQ(stub_.force(), glm::dvec3(0));
}

TEST_F(DeviceChecks, EndWithADeviceThatIsGone) {
    stub_.fail("dhdGetPosition", 200);
    const DeviceCheck checked = check(held());
    expect_step(checked, "device", CheckResult::failed, {"is gone", "communication error"});
}

TEST_F(DeviceChecks, PassASimulatedHandByItself) {
    std::string presses = "sim:1@0 s..7 s"; // and once a second: the steps before take longer on a busy machine
    for (int second = 8; second < 60; second += 2)
        presses += fmt::format(",1@{} s..{} s", second, second + 1);
    const DeviceCheck checked = check(held(), presses);
    EXPECT_TRUE(checked.passed()) << check_text(checked);
    expect_step(checked, "button", CheckResult::passed);
}

} // namespace
} // namespace forceshade::device::testing
