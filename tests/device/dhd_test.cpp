// Force Dimension's devices, by a stub of their library: axes, units, every call failing in turn, no force at the end.
#include <cmath>
#include <thread>

#include "device/backends/devices.h"
#include "tests/device/stub_library.h"

namespace forceshade::device::testing {
namespace {

using glm::dvec3;

class Dhd : public ::testing::Test {
protected:
    static std::string refusal(const std::string& index = "") {
        return message_of<DeviceAbsent>([&] { open_dhd(index); });
    }

    StubLibrary stub_{"FORCESHADE_DHD_LIBRARY", kDhdStub};
};

TEST_F(Dhd, TellsWhatItIs) {
    const auto device = open_dhd("");
    EXPECT_EQ(device->facts().name, "omega.3 (serial number 417)");
    EXPECT_EQ(device->facts().software, "DHD SDK 3.17.6.1");
    EXPECT_EQ(device->facts().max_force, 8);
    EXPECT_FALSE(device->facts().simulated);
    EXPECT_EQ(device->error_text(), nullptr);
    stub_.most_force(-1); // no limit is set: the maker's own for an omega
    EXPECT_EQ(open_dhd("")->facts().max_force, 12);
    EXPECT_EQ(find_dhd().devices.size(), 1u);
    EXPECT_EQ(find_dhd().place, kDhdStub);
}

// The vendor's x points to the user, y to the right, z up; ours x to the right, y away from the user, z up.
TEST_F(Dhd, TurnsItsAxesIntoTheWorlds) {
    const auto device = open_dhd("");
    stub_.place(0.01, 0, 0);
    EXPECT_EQ(device->read().position, dvec3(0, -0.01, 0)) << "nearer to the user";
    stub_.place(0, 0.01, 0);
    EXPECT_EQ(device->read().position, dvec3(0.01, 0, 0)) << "to the right";
    stub_.place(0.01, 0.02, 0.03);
    const Reading reading = device->read();
    EXPECT_EQ(reading.answer, Answer::fresh);
    EXPECT_EQ(reading.position, dvec3(0.02, -0.01, 0.03));
    EXPECT_TRUE(device->write({1, 0, 0}));
    EXPECT_EQ(stub_.force(), dvec3(0, 1, 0));
    EXPECT_TRUE(device->write({0, 1, 0}));
    EXPECT_EQ(stub_.force(), dvec3(-1, 0, 0)) << "away from the user";
    EXPECT_TRUE(device->write({1, 2, 3}));
    EXPECT_EQ(stub_.force(), dvec3(-2, 1, 3));
}

TEST_F(Dhd, TellsItsButtons) {
    const auto device = open_dhd("");
    EXPECT_EQ(device->facts().buttons, 32u);
    EXPECT_EQ(device->read().buttons, 0u);
    stub_.press(5);
    EXPECT_EQ(device->read().buttons, 5u);
    stub_.fail("time guard");
    stub_.press(4);
    EXPECT_EQ(device->read().answer, Answer::repeated);
    EXPECT_EQ(device->read().buttons, 4u) << "of now, even if the position is not";
}

TEST_F(Dhd, IsRefusedWhereUnitsCannotBeMetresAndNewtons) {
    stub_.place(30, 0.02, 0.01);
    expect_words(refusal(), {"omega.3", "(30, 0.02, 0.01)", "metres"});
    stub_.place(0.03, -20, 0.01);
    expect_words(refusal(), {"(0.03, -20, 0.01)"});
    stub_.place(0.03, 0.02, 10);
    expect_words(refusal(), {"(0.03, 0.02, 10)"});
    stub_.place(0.01, std::nan(""), 0.03);
    expect_words(refusal(), {"nan"});
    stub_.place(0.01, 0.02, 0.03);
    stub_.most_force(8000);
    expect_words(refusal(), {"8000 N", "200 N"});
    stub_.most_force(0.001);
    expect_words(refusal(), {"0.001 N"});
    EXPECT_EQ(stub_.calls("dhdClose"), 6);
}

TEST_F(Dhd, IsChosenByItsIndex) {
    stub_.devices(2);
    EXPECT_NO_THROW(open_dhd("1"));
    EXPECT_EQ(stub_.calls("dhdOpenID"), 1);
    EXPECT_NO_THROW(open_dhd("0"));
    expect_words(refusal("2"), {"no Force Dimension device 2", "2 connected"});
    for (const char* index : {"x", "-1", "1x", "1.0", " 1", "128", "99999999999"})
        EXPECT_THROW(open_dhd(index), UsageError) << index;
    stub_.devices(0);
    expect_words(refusal(), {"DHD SDK 3.17.6.1", "0 devices", "udev", kDhdStub});
    EXPECT_EQ(find_dhd().devices.size(), 0u);
}

TEST_F(Dhd, IsAbsentWhenWhatItNeedsFailsAtOpening) {
    const std::map<std::string, std::string> calls{{"dhdGetDeviceCount", "no driver found"},
                                                   {"dhdOpen", "device in use"},
                                                   {"dhdGetStatus", "communication error"},
                                                   {"dhdGetPosition", "communication error"}};
    for (const auto& [call, words] : calls) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(call.c_str());
        expect_words(refusal(), {words});
        EXPECT_EQ(stub_.calls("dhdClose"), call.starts_with("dhdGet") && call != "dhdGetDeviceCount" ? 1 : 0) << call;
        EXPECT_EQ(stub_.forces(), 0) << call;
    }
}

TEST_F(Dhd, DoesWithoutWhatItCanDoWithout) {
    for (const char* call : {"dhdGetSystemName", "dhdGetSystemType", "dhdGetSerialNumber", "dhdGetMaxForce",
                             "dhdEnableExpertMode", "dhdDisableExpertMode", "dhdSetWatchdog", "dhdStop", "dhdClose"}) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(call);
        const auto device = open_dhd("");
        EXPECT_EQ(device->read().answer, Answer::fresh) << call;
        EXPECT_TRUE(device->write({0, 0, 1})) << call;
        EXPECT_EQ(stub_.force(), dvec3(0, 0, 1)) << call;
    }
    const StubLibrary old("FORCESHADE_DHD_LIBRARY", kDhdStubOld);
    const auto device = open_dhd("");
    EXPECT_EQ(device->facts().name, "Force Dimension device");
    EXPECT_EQ(device->facts().max_force, kUnknown);
    EXPECT_EQ(device->facts().buttons, 0u);
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_EQ(old.force(), dvec3(0, 0, 1));
}

TEST_F(Dhd, OfALaterTypeHasTheArmOfItsFamily) {
    stub_.fail("sigma.3");
    const auto device = open_dhd("");
    EXPECT_EQ(device->facts().high, dvec3(0.15));
    EXPECT_EQ(device->facts().max_force, 8) << "that the device states";
}

TEST_F(Dhd, TellsOfCallsThatFailInMidLoopAndGoesOnWhenTheyDo) {
    const auto device = open_dhd("");
    EXPECT_TRUE(device->write({0, 0, 1}));
    stub_.fail("dhdGetPosition", 1, 3);
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(device->read().answer, Answer::failed);
    EXPECT_STREQ(device->error_text(), "communication error");
    EXPECT_EQ(device->read().answer, Answer::fresh);
    stub_.fail("dhdSetForce", 1, 3);
    for (int i = 0; i < 3; ++i)
        EXPECT_FALSE(device->write({0, 0, 2}));
    EXPECT_TRUE(device->write({0, 0, 2}));
    EXPECT_EQ(stub_.force(), dvec3(0, 0, 2));
}

TEST_F(Dhd, TakesNoForceUntilForcesCanBeEnabled) {
    const auto device = open_dhd("");
    stub_.fail("dhdEnableForce", 1, 2);
    EXPECT_FALSE(device->write({0, 0, 1}));
    EXPECT_FALSE(device->write({0, 0, 1}));
    EXPECT_STREQ(device->error_text(), "force cannot be enabled");
    EXPECT_EQ(stub_.force(), dvec3(0));
    EXPECT_TRUE(device->write({0, 0, 1}));
}

TEST_F(Dhd, HandsOnAPositionThatIsNoNumber) {
    const auto device = open_dhd("");
    stub_.place(std::nan(""), 0, 0);
    const Reading reading = device->read();
    EXPECT_EQ(reading.answer, Answer::fresh);
    EXPECT_TRUE(std::isnan(reading.position.y));
}

TEST_F(Dhd, TellsAnOldPositionFromANewOne) {
    const auto device = open_dhd("");
    EXPECT_EQ(device->read().position, dvec3(0.02, -0.01, 0.03));
    stub_.place(0, 0, 0);
    stub_.fail("time guard", 1, 1);
    const Reading held = device->read();
    EXPECT_EQ(held.answer, Answer::repeated);
    EXPECT_EQ(held.position, dvec3(0.02, -0.01, 0.03));
    EXPECT_EQ(device->read().answer, Answer::fresh);
    stub_.fail("saturation");
    EXPECT_TRUE(device->write({0, 0, 1})) << "the motors' limit is no failure";
}

TEST_F(Dhd, SaysWhenItsMotorsGiveLess) {
    const auto device = open_dhd("");
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_FALSE(device->saturated());
    stub_.fail("saturation", 1, 1);
    EXPECT_TRUE(device->write({0, 0, 8}));
    EXPECT_TRUE(device->saturated());
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_FALSE(device->saturated());
}

TEST_F(Dhd, GivesNoTorqueToAWristOrAGripperWithMotors) {
    for (const char* part : {"has a wrist", "has a gripper"}) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(part);
        const auto device = open_dhd("");
        EXPECT_EQ(stub_.order(), part == std::string_view("has a gripper") ? "emulate 1;" : "");
        EXPECT_TRUE(device->write({0, 0, 1}));
        EXPECT_EQ(stub_.order(), "no torque;force 0 0 0;enable 1;no torque;force 0 0 1;") << part;
        device->halt();
        EXPECT_EQ(stub_.order(), "no torque;force 0 0 0;") << part;
        EXPECT_EQ(device->facts().remark, "");
    }
    stub_.call<void()>("stub_reset")();
    stub_.fail("has a gripper");
    stub_.fail("dhdEmulateButton");
    expect_words(open_dhd("")->facts().remark, {"gripper", "button"});
}

// After a hang the device may still hold the force of before it.
TEST_F(Dhd, WritesZeroBeforeItEnablesForces) {
    const auto device = open_dhd("");
    EXPECT_EQ(stub_.call<int()>("stub_watchdog")(), 255);
    stub_.order();
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_EQ(stub_.order(), "force 0 0 0;enable 1;force 0 0 1;");
    EXPECT_TRUE(device->write({0, 0, 10}));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    stub_.order();
    EXPECT_FALSE(device->write({0, 0, 5})) << "it comes up from zero";
    EXPECT_EQ(stub_.order(), "force 0 0 0;enable 1;force 0 0 0;");
    EXPECT_EQ(device->withheld(), nullptr);
}

TEST_F(Dhd, TellsTheLoopOfABiteBeforeItDisplaysAForceAgain) {
    const auto device = open_dhd("");
    EXPECT_TRUE(device->write({0, 0, 1}));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(device->read().answer, Answer::fresh);
    ASSERT_NE(device->withheld(), nullptr) << "so that the force comes up as after a fault";
    expect_words(device->withheld(), {"watchdog"});
    EXPECT_TRUE(device->write({0, 0, 0}));
    device->read();
    EXPECT_EQ(device->withheld(), nullptr);
    EXPECT_TRUE(device->write({0, 0, 1}));
}

TEST_F(Dhd, LeavesForcesOffThatTheUserSwitchedOff) {
    const auto device = open_dhd("");
    const auto press = stub_.call<void()>("stub_press");
    EXPECT_TRUE(device->write({0, 0, 1}));
    press();
    for (const int pause : {60, 300, 0}) { // ms: the watchdog bites, too
        std::this_thread::sleep_for(std::chrono::milliseconds(pause));
        device->read();
        EXPECT_FALSE(device->write({0, 0, 1}));
        EXPECT_EQ(stub_.force(), dvec3(0));
        ASSERT_NE(device->withheld(), nullptr);
        expect_words(device->withheld(), {"button"});
        EXPECT_TRUE(device->write({0, 0, 0})) << "it is there, and takes what it can";
    }
    EXPECT_EQ(stub_.calls("dhdEnableForce"), 1);
    press();
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
    device->read();
    EXPECT_EQ(device->withheld(), nullptr);
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_EQ(stub_.calls("dhdEnableForce"), 1);
}

TEST_F(Dhd, SwitchesOnOnlyWhatNobodyElseSwitchedOff) {
    const auto switch_off = stub_.call<void(int)>("stub_switch_off");
    for (const auto& [cause, words] : {std::pair{1, "button"},
                                       {2, "too fast"},
                                       {4, "another program"},
                                       {5, "forces are off"},
                                       {6, "dead-man"},
                                       {0, "does not say why"}}) {
        stub_.call<void()>("stub_reset")();
        const auto device = open_dhd("");
        EXPECT_TRUE(device->write({0, 0, 1}));
        switch_off(cause);
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        EXPECT_FALSE(device->write({0, 0, 1})) << words;
        ASSERT_NE(device->withheld(), nullptr) << words;
        expect_words(device->withheld(), {words});
        EXPECT_EQ(stub_.calls("dhdEnableForce"), 1) << words;
    }
    stub_.call<void()>("stub_reset")();
    stub_.call<void()>("stub_press")(); // before we began
    const auto device = open_dhd("");
    EXPECT_TRUE(device->write({0, 0, 1}));
    switch_off(4);
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    EXPECT_FALSE(device->write({0, 0, 1}));
    EXPECT_EQ(stub_.calls("dhdEnableForce"), 0);
}

TEST_F(Dhd, SwitchesForcesOnAtTheStartUnlessAHandSwitchedThemOff) {
    const auto switch_off = stub_.call<void(int)>("stub_switch_off");
    for (const auto& [cause, enabled] :
         {std::pair{0, true}, {2, false}, {3, true}, {4, true}, {1, false}, {6, false}}) {
        stub_.call<void()>("stub_reset")();
        switch_off(cause); // before we began
        const auto device = open_dhd("");
        EXPECT_EQ(device->write({0, 0, 1}), enabled) << cause;
        EXPECT_EQ(stub_.calls("dhdEnableForce"), enabled) << cause;
    }
}

TEST_F(Dhd, DisplaysNoForceUntilItIsReady) {
    for (const auto& [state, words] : {std::pair{"uncalibrated", "not calibrated"},
                                       {"no power", "no power"},
                                       {"not started", "not ready"},
                                       {"error", "error"}}) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(state);
        const auto device = open_dhd("");
        EXPECT_EQ(device->read().answer, Answer::fresh) << state;
        EXPECT_FALSE(device->write({0, 0, 1})) << state;
        EXPECT_TRUE(device->write({0, 0, 0})) << state;
        ASSERT_NE(device->withheld(), nullptr) << state;
        expect_words(device->withheld(), {words});
        EXPECT_EQ(stub_.calls("dhdEnableForce"), 0) << state;
        EXPECT_EQ(stub_.force(), dvec3(0)) << state;
        stub_.fail(state, 1, 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(25));
        device->read();
        EXPECT_EQ(device->withheld(), nullptr) << state;
        EXPECT_TRUE(device->write({0, 0, 1})) << state;
    }
}

TEST_F(Dhd, DisplaysNoForceWhileItsStatusIsNotTold) {
    const auto device = open_dhd("");
    EXPECT_TRUE(device->write({0, 0, 1}));
    stub_.fail("dhdGetStatus", 1, 3);
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
    EXPECT_EQ(device->read().answer, Answer::failed);
    EXPECT_FALSE(device->write({0, 0, 1}));
    EXPECT_EQ(stub_.force(), dvec3(0));
    EXPECT_FALSE(device->write({0, 0, 0}));
    EXPECT_STREQ(device->error_text(), "communication error");
    EXPECT_EQ(device->read().answer, Answer::fresh);
    EXPECT_TRUE(device->write({0, 0, 1}));
}

TEST_F(Dhd, SaysThatItHasNoWatchdog) {
    EXPECT_TRUE(open_dhd("")->facts().has_watchdog);
    EXPECT_EQ(open_dhd("")->facts().remark, "");
    for (const char* call : {"dhdEnableExpertMode", "dhdSetWatchdog"}) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(call);
        const auto device = open_dhd("");
        EXPECT_FALSE(device->facts().has_watchdog) << call;
        expect_words(device->facts().remark, {"omega.3", "refuses its watchdog"});
    }
    const StubLibrary old("FORCESHADE_DHD_LIBRARY", kDhdStubOld);
    EXPECT_FALSE(open_dhd("")->facts().has_watchdog);
}

TEST_F(Dhd, HasTheWorkspaceOfItsType) {
    EXPECT_EQ(open_dhd("")->facts().low, dvec3(-0.12));
    EXPECT_EQ(open_dhd("")->facts().high, dvec3(0.12));
    const StubLibrary old("FORCESHADE_DHD_LIBRARY", kDhdStubOld);
    EXPECT_EQ(open_dhd("")->facts().high, dvec3(0.5)) << "of a type that is not told";
}

TEST_F(Dhd, LeavesNoForce) {
    {
        const auto device = open_dhd("");
        EXPECT_TRUE(device->write({0, 0, 1}));
        EXPECT_EQ(stub_.force(), dvec3(0, 0, 1));
    }
    EXPECT_EQ(stub_.force(), dvec3(0));
    EXPECT_GE(stub_.calls("dhdStop"), 1);
    EXPECT_EQ(stub_.calls("dhdClose"), 1);
}

TEST_F(Dhd, RestsUntilTheNextForce) {
    const auto device = open_dhd("");
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_EQ(stub_.force(), dvec3(0, 0, 1));
    device->rest();
    EXPECT_EQ(stub_.force(), dvec3(0));
    EXPECT_TRUE(device->write({0, 0, 1}));
    EXPECT_EQ(stub_.force(), dvec3(0, 0, 1));
}

TEST_F(Dhd, IsHaltedWhileAnotherThreadWrites) {
    for (int round = 0; round < 20; ++round) {
        const auto device = open_dhd("");
        std::atomic<int> written = 0;
        std::atomic<bool> enough = false;
        std::thread loop([&] {
            while (!enough) {
                device->read();
                device->write({0, 0, 1});
                ++written;
            }
        });
        while (written < 20)
            std::this_thread::yield();
        device->halt();
        EXPECT_FALSE(device->write({0, 0, 1})) << "what is not displayed is not taken";
        const int then = written;
        while (written < then + 20)
            std::this_thread::yield();
        enough = true;
        loop.join();
        EXPECT_EQ(stub_.force(), dvec3(0));
    }
}

TEST_F(Dhd, TakesBackAForceThatWasOnItsWayWhenItWasHalted) {
    const auto device = open_dhd("");
    stub_.fail("speed", 1, 1);
    std::thread loop([&] { device->write({0, 0, 1}); });
    while (stub_.calls("speed") == 0)
        std::this_thread::yield();
    device->halt();
    loop.join();
    EXPECT_GE(stub_.forces(), 1);
    EXPECT_EQ(stub_.force(), dvec3(0));
}

TEST_F(Dhd, LeavesNoForceWhenTheProgramAborts) {
    expect_no_force_after_abort(
        stub_, [] { return open_dhd(""); },
        [&](BackEnd& device) {
            device.write({0, 0, 1});
        });
}

} // namespace
} // namespace forceshade::device::testing
