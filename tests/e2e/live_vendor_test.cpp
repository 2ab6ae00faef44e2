// live with a vendor's device, by stubs of the vendors' libraries: whatever ends the program, no force is left.
#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

struct Vendor {
    const char* device;
    const char* variable;
    const char* library;
    const char* inside; // the vendor's position of a probe in the surface, 1 mm above its lowest
    const char* position_call;
};
constexpr Vendor kDhd{"dhd", "FORCESHADE_DHD_LIBRARY", DHD_STUB, "0,0,0.001", "dhdGetPosition"};
constexpr Vendor kHd{"hd", "FORCESHADE_HD_LIBRARY", HD_STUB, "0,1,0", "position"};
constexpr double kMostForce = 1; /* N */

class LiveVendor : public Workplace, public ::testing::WithParamInterface<Vendor> {
protected:
    LiveVendor() { write("scene.toml", kOneCase); }

    Launch live(const std::vector<std::string>& further) const {
        std::vector<std::string> arguments{"live",        "scene.toml", "--device", GetParam().device,
                                           "--max-force", "1 N",        "--ramp",   "5 ms"};
        arguments.insert(arguments.end(), further.begin(), further.end());
        Launch launch = this->launch(arguments);
        launch.environment = {{GetParam().variable, GetParam().library},
                              {"STUB_POSITION", GetParam().inside},
                              {"STUB_RECORD", path("forces")}};
        return launch;
    }

    /// N: every force that the device displayed, in order.
    std::vector<double> forces() const {
        std::vector<double> sizes;
        std::ifstream in(path("forces"));
        for (std::array<double, 4> line; in >> line[0] >> line[1] >> line[2] >> line[3];)
            sizes.push_back(std::hypot(line[1], line[2], line[3]));
        return sizes;
    }

    bool pressed() const {
        const std::vector<double> sizes = forces();
        return std::ranges::any_of(sizes, [](double size) { return size > 0.5 * kMostForce; });
    }

    /// A process that pushes the probe out of the surface.
    void await_force(Process& process) const {
        while (!pressed() && process.running())
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        ASSERT_TRUE(process.running());
    }

    void expect_no_force_left() const {
        const std::vector<double> sizes = forces();
        ASSERT_FALSE(sizes.empty());
        EXPECT_EQ(sizes.back(), 0);
        EXPECT_TRUE(pressed());
        EXPECT_LE(*std::ranges::max_element(sizes), kMostForce * (1 + 1e-9));
    }
};

TEST_P(LiveVendor, leaves_no_force_when_its_time_is_over) {
    const Outcome outcome = run(live({"--duration", "0.3 s"}));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    expect_no_force_left();
}

TEST_P(LiveVendor, leaves_no_force_whatever_signal_ends_it) {
    for (const int signal : {SIGINT, SIGTERM, SIGABRT, SIGSEGV, SIGQUIT}) {
        std::filesystem::remove(path("forces"));
        Process process(live({}));
        await_force(process);
        process.send(signal);
        process.wait();
        SCOPED_TRACE(signal);
        expect_no_force_left();
    }
}

TEST_P(LiveVendor, has_no_force_while_positions_fail_and_ends_when_they_do_not_come_back) {
    Launch launch = live({"--patience", "0.5 s", "--duration", "60 s"});
    launch.environment["STUB_FAIL"] = std::string(GetParam().position_call) + "@300";
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, 3) << outcome.error;
    EXPECT_NE((outcome.out + outcome.error).find("ommunication error"), std::string::npos) << outcome.out;
    expect_no_force_left();
}

TEST_P(LiveVendor, is_not_begun_without_device_or_library) {
    Launch launch = live({});
    launch.environment["STUB_DEVICES"] = "0";
    expect_failure(3, launch, {GetParam().library});
    launch.environment[GetParam().variable] = path("none.so");
    expect_failure(3, launch, {"none.so", GetParam().variable});
}

TEST_P(LiveVendor, feels_a_stiffness_that_the_hand_cannot_hold_only_if_it_is_told_to) {
    write("scene.toml", "surface.facets = 2\nforce.stiffness = \"20 N/mm\"\n");
    expect_failure(2, live({"--duration", "0.2 s"}), {"20000 N/m", "comes to rest below", "--unstable"});
    EXPECT_EQ(run(live({"--duration", "0.2 s", "--unstable"})).code, 0);
}

INSTANTIATE_TEST_SUITE_P(Vendors, LiveVendor, ::testing::Values(kDhd, kHd),
                         [](const auto& instance) { return std::string(instance.param.device); });

// The check before a session: its outcome, and an exit code that a script can go by.
TEST_F(LiveDevice, is_checked_before_it_is_felt) {
    const auto checked = [&](std::vector<std::string> further, const char* hand) {
        std::vector<std::string> all{"device", "check", "plane.toml", "--quiet",    "--watchdog",
                                     "100",    "--out", "check.json", "--overwrite"};
        all.insert(all.end(), further.begin(), further.end());
        Launch launch = this->launch(std::move(all));
        launch.environment["FORCESHADE_DHD_LIBRARY"] = DHD_STUB_OLD; // without buttons
        launch.environment["STUB_HAND"] = hand;
        return run(launch);
    };
    const Outcome sound = checked({"--device", "dhd", "--yes"}, "1");
    EXPECT_EQ(sound.code, 1) << "the old library refuses its watchdog";
    EXPECT_NE(sound.out.find("passed   axes"), std::string::npos) << sound.out;
    EXPECT_NE(sound.out.find("failed   watchdog"), std::string::npos) << sound.out;
    EXPECT_EQ(checked({"--device", "dhd", "--yes"}, "3").out.find("passed   axes"), std::string::npos);
    const Outcome alone = checked({"--device", "dhd"}, "1");
    EXPECT_EQ(alone.code, 1);
    EXPECT_NE(alone.out.find("skipped  axes"), std::string::npos) << "nobody is at a terminal";
    EXPECT_EQ(read_json("check.json")["passed"], false);
    const Outcome simulated = checked({"--device", "sim", "--json"}, "0");
    EXPECT_EQ(simulated.code, 0) << simulated.out;
    EXPECT_EQ(simulated.error, "");
    EXPECT_EQ(nlohmann::json::parse(simulated.out), read_json("check.json"));
    EXPECT_EQ(read_json("check.json")["passed"], true);
    expect_failure(2, {"device", "check", "--device", "replay:x.csv"}, {"cannot be pushed"});
    expect_failure(2, {"device", "chek"}, {"did you mean forceshade device check?"});
}

} // namespace
} // namespace forceshade::testing
