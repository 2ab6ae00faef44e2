// 3D Systems' devices, by a stub of their library: axes, units, every call failing in turn, the scheduler's thread, no
// force at the end.
#include <cmath>

#include <glm/geometric.hpp>

#include "device/backends/devices.h"
#include "tests/device/stub_library.h"

namespace forceshade::device::testing {
namespace {

using glm::dvec3;

class Hd : public ::testing::Test {
protected:
    static std::string refusal(const std::string& name = "") {
        return message_of<DeviceAbsent>([&] { open_hd(name); });
    }

    StubLibrary stub_{"FORCESHADE_HD_LIBRARY", kHdStub};
};

// The scheduler's frames come when they come. A force is displayed for 50 ms only, so it is written again and again.
bool displays(BackEnd& device, const StubLibrary& stub, const dvec3& force, const dvec3& axes) {
    return wait_until([&] {
        device.write(force);
        return stub.force() == axes;
    });
}

TEST_F(Hd, TellsWhatItIs) {
    const auto device = open_hd("");
    const DeviceFacts& facts = device->facts();
    EXPECT_EQ(facts.name, "Touch (serial number 8042)");
    EXPECT_EQ(facts.software, "OpenHaptics HDAPI 3.40.0, driver 2022.4");
    EXPECT_EQ(facts.max_force, 3.3);
    EXPECT_EQ(facts.continuous_force, 0.88);
    EXPECT_LT(glm::length(facts.low - dvec3(-0.21, -0.13, -0.11)), 1e-12);
    EXPECT_LT(glm::length(facts.high - dvec3(0.21, 0.085, 0.205)), 1e-12);
    EXPECT_EQ(device->error_text(), nullptr);
}

TEST_F(Hd, TellsItsButtons) {
    const auto device = open_hd("");
    EXPECT_EQ(device->facts().buttons, 4u);
    stub_.press(2);
    EXPECT_TRUE(wait_until([&] { return device->read().buttons == 2; }));
    stub_.fail("buttons"); // from now on
    EXPECT_TRUE(wait_until([&] { return device->read().buttons == 0; })) << "none that it does not tell";
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0})) << "which is no failure of the rest";
    EXPECT_NE(device->read().answer, Answer::failed);
    EXPECT_EQ(device->error_text(), nullptr);
}

TEST_F(Hd, WithoutButtonsItIsADeviceAllTheSame) {
    stub_.fail("buttons");
    EXPECT_EQ(open_hd("")->facts().buttons, 0u);
}

// The vendor's x points to the right, y up, z to the user; ours x to the right, y away from the user, z up. mm and m.
TEST_F(Hd, TurnsItsAxesIntoTheWorlds) {
    const auto device = open_hd("");
    const auto reads = [&](const dvec3& place) {
        return wait_until([&] { return glm::length(device->read().position - place) < 1e-12; });
    };
    stub_.place(0, 0, 10);
    EXPECT_TRUE(reads({0, -0.01, 0})) << "nearer to the user";
    stub_.place(0, 10, 0);
    EXPECT_TRUE(reads({0, 0, 0.01})) << "up";
    stub_.place(10, 20, 30);
    EXPECT_TRUE(reads({0.01, -0.03, 0.02}));
    EXPECT_TRUE(displays(*device, stub_, {0, 1, 0}, {0, 0, -1})) << "away from the user";
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0})) << "up";
    EXPECT_TRUE(displays(*device, stub_, {1, 2, 3}, {1, 3, -2}));
}

TEST_F(Hd, TellsANewPositionFromAnOldOne) {
    const auto device = open_hd("");
    EXPECT_TRUE(wait_until([&] { return device->read().answer == Answer::fresh; }));
    stub_.call<void(int)>("stub_freeze")(1);
    EXPECT_TRUE(wait_until([&] { return device->read().answer == Answer::repeated; }));
    EXPECT_LT(glm::length(device->read().position - dvec3(0.01, -0.03, 0.02)), 1e-12);
    stub_.call<void(int)>("stub_freeze")(0);
    EXPECT_TRUE(wait_until([&] { return device->read().answer == Answer::fresh; }));
    stub_.place(std::nan(""), 0, 0);
    EXPECT_TRUE(wait_until([&] { return std::isnan(device->read().position.x); }));
}

TEST_F(Hd, IsRefusedWhereUnitsCannotBeMillimetresAndNewtons) {
    stub_.call<void(double)>("stub_scale")(1e-3);
    expect_words(refusal(), {"Touch", "workspace", "-0.21", "millimetres"});
    stub_.call<void(double)>("stub_scale")(1e3);
    expect_words(refusal(), {"workspace", "-210000"});
    stub_.call<void(double)>("stub_scale")(1);
    stub_.most_force(0.1);
    expect_words(refusal(), {"0.1 N", "0.5 N"});
    stub_.most_force(1000);
    expect_words(refusal(), {"1000 N"});
    stub_.most_force(3.3);
    const auto continuous_force = stub_.call<void(double)>("stub_continuous_force");
    continuous_force(4);
    expect_words(refusal(), {"continuous force of 4 N", "3.3 N"});
    continuous_force(std::nan(""));
    expect_words(refusal(), {"nan"});
    continuous_force(0.88);
    stub_.place(10, 5000, 10);
    expect_words(refusal(), {"(10, 5000, 10) mm", "3 m"});
    stub_.place(5000, 10, 10);
    expect_words(refusal(), {"(5000, 10, 10) mm"});
    stub_.place(10, 10, -5000);
    expect_words(refusal(), {"(10, 10, -5000) mm"});
    stub_.place(10, 20, std::nan(""));
    expect_words(refusal(), {"nan"});
    EXPECT_EQ(stub_.calls("hdDisableDevice"), 10);
    EXPECT_EQ(stub_.calls("hdStopScheduler"), 4);
}

TEST_F(Hd, IsChosenByItsName) {
    EXPECT_NO_THROW(open_hd("Touch"));
    expect_words(refusal("Right Device"), {"\"Right Device\"", "Communication configuration error", kHdStub});
    stub_.devices(0);
    expect_words(refusal(), {"configured as default", "Communication configuration error", "Touch_Setup"});
}

TEST_F(Hd, IsRefusedUncalibrated) {
    const auto calibration = stub_.call<void(long)>("stub_calibration");
    calibration(0x5002);
    expect_words(refusal(), {"not calibrated", "inkwell"});
    calibration(0x5001);
    EXPECT_NO_THROW(open_hd("")) << "the library can bring it up to date";
    EXPECT_EQ(stub_.calls("hdUpdateCalibration"), 1);
}

TEST_F(Hd, IsCalibratedByOneStyleBeforeItDisplaysAForce) {
    const std::vector<std::pair<long, std::string>> chosen{{1, "1"}, {2, "2"}, {3, "2"}, {4, "4"},
                                                           {5, "4"}, {6, "2"}, {7, "2"}, {0x16, "2"}};
    for (const auto& [styles, style] : chosen) {
        stub_.call<void()>("stub_reset")();
        stub_.call<void(long)>("stub_calibration")(0x5001);
        stub_.call<void(long)>("stub_styles")(styles);
        const auto device = open_hd("");
        EXPECT_EQ(stub_.order(), "check;calibrate " + style + ";check;enable;") << styles;
        EXPECT_EQ(device->facts().remark.find("reset position") != std::string::npos, style == "1") << styles;
    }
}

TEST_F(Hd, DisplaysNoForceBeforeItsCalibrationIsConfirmed) {
    const auto expect_refused = [&](long state, long styles, const char* call, const std::string& words) {
        stub_.call<void()>("stub_reset")();
        stub_.call<void(long)>("stub_calibration")(state);
        stub_.call<void(long)>("stub_styles")(styles);
        if (call)
            stub_.fail(call);
        expect_words(refusal(), {"Touch", "not calibrated", words});
        EXPECT_EQ(stub_.calls("hdEnable"), 0) << words;
        EXPECT_EQ(stub_.calls("hdDisableDevice"), 1) << words;
    };
    expect_refused(0x5002, 2, nullptr, "placed");
    expect_refused(0x5001, 0, nullptr, "does not state how");
    expect_refused(0x5001, 2, "hdGetIntegerv", "Communication error");
    expect_refused(0x5001, 2, "hdUpdateCalibration", "Communication error");
    expect_refused(0x5000, 2, "hdCheckCalibration", "Communication error");
    expect_refused(0, 2, nullptr, "after an update");
}

TEST_F(Hd, IsAbsentWhenWhatItNeedsFailsAtOpening) {
    const std::map<std::string, std::string> calls{{"hdInitDevice", "Device fault"},
                                                   {"hdEnable", "Force error"},
                                                   {"hdScheduleAsynchronous", "Scheduler full"},
                                                   {"hdStartScheduler", "Timer error"},
                                                   {"hdBeginFrame", "Communication error"},
                                                   {"position", "Communication error"},
                                                   {"hdGetError", "Device fault"}};
    for (const auto& [call, words] : calls) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(call.c_str());
        expect_words(refusal(), {words});
        EXPECT_EQ(stub_.force(), dvec3(0)) << call;
    }
}

TEST_F(Hd, DoesWithoutWhatItCanDoWithout) {
    for (const char* call : {"hdMakeCurrentDevice", "hdGetString", "largest force", "continuous force", "workspace",
                             "hdGetIntegerv", "hdUnschedule", "hdStopScheduler", "hdDisableDevice", "hdDisable"}) {
        stub_.call<void()>("stub_reset")();
        stub_.fail(call);
        const auto device = open_hd("");
        EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0})) << call;
        if (std::string(call) == "largest force") {
            EXPECT_EQ(device->facts().max_force, kUnknown);
        }
        if (std::string(call) == "workspace") {
            EXPECT_EQ(device->facts().high, dvec3(0.5));
        }
    }
    EXPECT_EQ(stub_.force(), dvec3(0));
}

TEST_F(Hd, TellsOfCallsThatFailInMidLoopAndGoesOnWhenTheyDo) {
    const auto device = open_hd("");
    const auto read = [&](Answer answer) { return wait_until([&] { return device->read().answer == answer; }); };
    const auto written = [&](bool taken) { return wait_until([&] { return device->write({0, 0, 1}) == taken; }); };
    for (const char* call : {"hdBeginFrame", "position", "hdGetError"}) {
        EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0})) << call;
        stub_.fail(call);
        EXPECT_TRUE(read(Answer::failed)) << call;
        for (int i = 0; i < 20; ++i) // between frames too
            EXPECT_EQ(device->read().answer, Answer::failed) << call;
        EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 0, 0})) << call << ": no position, no force";
        EXPECT_NE(device->error_text(), nullptr);
        stub_.fail(call, 1, 0);
        EXPECT_TRUE(read(Answer::fresh)) << call;
    }
    for (const char* call : {"hdSetDoublev", "hdEndFrame"}) {
        EXPECT_TRUE(written(true)) << call;
        stub_.fail(call);
        EXPECT_TRUE(written(false)) << call;
        stub_.fail(call, 1, 0);
        EXPECT_TRUE(written(true)) << call;
    }
    EXPECT_STREQ(device->error_text(), "Maximum force exceeded") << "the cause, not what came of it";
}

TEST_F(Hd, WithholdsForcesWhileItsMotorsAreTooWarm) {
    const auto device = open_hd("");
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
    stub_.fail("warm motors", 1, 2);
    EXPECT_TRUE(wait_until([&] { return !device->write({0, 0, 1}); }));
    expect_words(device->withheld(), {"too warm"});
    EXPECT_TRUE(wait_until([&] { return stub_.force() == dvec3(0); }));
    EXPECT_TRUE(device->write({0, 0, 0})) << "it waits";
    EXPECT_EQ(device->read().answer == Answer::failed, false);
    EXPECT_TRUE(wait_until([&] { return device->withheld() == nullptr; })) << "after five seconds";
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
}

TEST_F(Hd, FollowsItsCalibration) {
    const auto device = open_hd("");
    const auto calibration = stub_.call<void(long)>("stub_calibration");
    calibration(0x5002);
    EXPECT_TRUE(wait_until([&] { return device->withheld() != nullptr; }));
    expect_words(device->withheld(), {"calibration", "inkwell"});
    EXPECT_FALSE(device->write({0, 0, 1}));
    calibration(0x5001); // the stylus is in the inkwell
    EXPECT_TRUE(wait_until([&] { return device->withheld() == nullptr; }));
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
}

TEST_F(Hd, DisplaysNoForceWhenNoneWasWrittenForAWhile) {
    const auto device = open_hd("");
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
    EXPECT_TRUE(wait_until([&] { return stub_.force() == dvec3(0); }));
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
}

TEST_F(Hd, TellsOfASchedulerThatStandsStill) {
    const auto device = open_hd("");
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
    stub_.call<void(int)>("stub_freeze")(1);
    EXPECT_TRUE(wait_until([&] { return !device->write({0, 0, 1}); }));
    EXPECT_TRUE(wait_until([&] { return device->read().answer == Answer::failed; }));
    expect_words(device->error_text(), {"scheduler"});
    stub_.call<void(int)>("stub_freeze")(0);
    EXPECT_TRUE(wait_until([&] { return device->write({0, 0, 1}); }));
}

TEST_F(Hd, LeavesNoForce) {
    {
        const auto device = open_hd("");
        EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
    }
    EXPECT_EQ(stub_.force(), dvec3(0));
    EXPECT_EQ(stub_.calls("hdStopScheduler"), 1);
    EXPECT_EQ(stub_.calls("hdUnschedule"), 0) << "the callback had ended by itself";
    EXPECT_EQ(stub_.calls("hdDisableDevice"), 1);
}

TEST_F(Hd, RestsUntilTheNextForce) {
    const auto device = open_hd("");
    long fewest = 1000; // frames until no force is displayed; without a rest it is 50
    for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
        const long then = stub_.forces();
        device->rest();
        EXPECT_TRUE(wait_until([&] { return stub_.force() == dvec3(0); }));
        fewest = std::min(fewest, stub_.forces() - then);
    }
    EXPECT_LT(fewest, 30);
}

TEST_F(Hd, DisplaysNothingOnceHalted) {
    const auto device = open_hd("");
    EXPECT_TRUE(displays(*device, stub_, {0, 0, 1}, {0, 1, 0}));
    device->halt();
    EXPECT_TRUE(wait_until([&] { return stub_.force() == dvec3(0); }));
    device->halt();
    const long then = stub_.forces();
    EXPECT_TRUE(wait_until([&] {
        device->write({0, 0, 1});
        return stub_.forces() > then + 20;
    }));
    EXPECT_EQ(stub_.force(), dvec3(0));
}

TEST_F(Hd, IsClosedThoughItsSchedulerStandsStill) {
    {
        const auto device = open_hd("");
        stub_.call<void(int)>("stub_freeze")(1);
    }
    EXPECT_EQ(stub_.calls("hdUnschedule"), 1);
    EXPECT_EQ(stub_.calls("hdDisableDevice"), 1);
}

TEST_F(Hd, LeavesNoForceWhenTheProgramAborts) {
    expect_no_force_after_abort(
        stub_, [] { return open_hd(""); },
        [&](BackEnd& device) {
            EXPECT_TRUE(displays(device, stub_, {0, 0, 1}, {0, 1, 0}));
        });
}

} // namespace
} // namespace forceshade::device::testing
