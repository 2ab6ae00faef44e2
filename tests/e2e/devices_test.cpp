// The list of haptic devices as a user sees it, with vendors' libraries that are stubs or are not there.
#include <array>
#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/e2e/live_workplace.h"
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class Devices : public Workplace {
protected:
    json kind(const std::map<std::string, std::string>& environment, const std::string& option) const {
        Launch launch = this->launch({"devices", "--json"});
        launch.environment.insert({{"FORCESHADE_DHD_LIBRARY", ""}, {"FORCESHADE_HD_LIBRARY", ""}});
        for (const auto& [name, value] : environment)
            launch.environment[name] = value;
        const Outcome outcome = run(launch);
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        for (const json& one : json::parse(outcome.out))
            if (one["option"] == option)
                return one;
        ADD_FAILURE() << option << " is not among " << outcome.out;
        return {};
    }
};

TEST_F(Devices, AreFoundByTheLibraryThatTheEnvironmentNamesOrWhereTheLinkerLooks) {
    const json dhd = kind({{"FORCESHADE_DHD_LIBRARY", DHD_STUB}}, "dhd[:INDEX]");
    EXPECT_EQ(dhd["devices"], json::array({"dhd:0"}));
    EXPECT_EQ(dhd["software"], "DHD SDK 3.17.6.1");
    std::filesystem::create_directory(path("lib"));
    std::filesystem::create_symlink(DHD_STUB, path("lib/libdhd.so.3"));
    std::filesystem::create_symlink(HD_STUB, path("lib/libHD.so"));
    const std::map<std::string, std::string> environment{{"LD_LIBRARY_PATH", path("lib")}};
    EXPECT_EQ(kind(environment, "dhd[:INDEX]")["place"], path("lib/libdhd.so.3").string());
    EXPECT_EQ(kind(environment, "hd[:NAME]")["place"], path("lib/libHD.so").string());
}

TEST_F(Devices, ThatFailOrAreNotThereAreToldInTheLibrarysWords) {
    EXPECT_EQ(kind({}, "sim")["devices"], json::array({"sim"}));
    EXPECT_EQ(kind({}, "dhd[:INDEX]")["devices"], json::array());
    EXPECT_NE(kind({{"FORCESHADE_DHD_LIBRARY", DHD_STUB}, {"STUB_FAIL", "dhdGetDeviceCount"}}, "dhd[:INDEX]")["problem"]
                  .dump()
                  .find("no driver found"),
              std::string::npos);
}

constexpr double kMostForce = 1; /* N */

// Of the other vendor: live_fault_test.
class LiveVendor : public Workplace {
protected:
    LiveVendor() { write("scene.toml", kOneCase); }

    Launch live(const std::vector<std::string>& further) const {
        std::vector<std::string> arguments{"live",        "scene.toml", "--device", "hd",
                                           "--max-force", "1 N",        "--ramp",   "5 ms"};
        arguments.insert(arguments.end(), further.begin(), further.end());
        Launch launch = this->launch(arguments);
        launch.environment = {{"FORCESHADE_HD_LIBRARY", HD_STUB},
                              {"STUB_POSITION", "0,1,0"}, // 1 mm above its lowest
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

TEST_F(LiveVendor, LeavesNoForceWhenItsTimeIsOver) {
    const Outcome outcome = run(live({"--duration", "0.3 s"}));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    expect_no_force_left();
}

TEST_F(LiveVendor, LeavesNoForceWhateverSignalEndsIt) {
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

TEST_F(LiveVendor, HasNoForceWhilePositionsFailAndEndsWhenTheyDoNotComeBack) {
    Launch launch = live({"--patience", "0.5 s", "--duration", "60 s"});
    launch.environment["STUB_FAIL"] = "position@300";
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, 3) << outcome.error;
    EXPECT_NE((outcome.out + outcome.error).find("ommunication error"), std::string::npos) << outcome.out;
    expect_no_force_left();
}

TEST_F(LiveVendor, IsNotBegunWithoutDeviceOrLibrary) {
    Launch launch = live({});
    launch.environment["STUB_DEVICES"] = "0";
    expect_failure(3, launch, {HD_STUB});
    launch.environment["FORCESHADE_HD_LIBRARY"] = path("none.so");
    expect_failure(3, launch, {"none.so", "FORCESHADE_HD_LIBRARY"});
}

TEST_F(LiveVendor, FeelsAStiffnessThatTheHandCannotHoldOnlyIfItIsToldTo) {
    write("scene.toml", "surface.facets = 2\nforce.stiffness = \"20 N/mm\"\n");
    expect_failure(2, live({"--duration", "0.2 s"}), {"20000 N/m", "comes to rest below", "--unstable"});
    EXPECT_EQ(run(live({"--duration", "0.2 s", "--unstable"})).code, 0);
}

// The check before a session: its outcome, and an exit code that a script can go by.
TEST_F(LiveDevice, IsCheckedBeforeItIsFelt) {
    const auto checked = [&](std::vector<std::string> further, const char* hand) {
        std::vector<std::string> all{"device", "check", "plane.toml", "--quiet",    "--watchdog",
                                     "100 ms", "--out", "check.json", "--overwrite"};
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
