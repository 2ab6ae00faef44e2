// The list of haptic devices as a user sees it, with vendors' libraries that are stubs or are not there.
#include "tests/e2e/live_workplace.h"
#include "tests/places.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class Devices : public Workplace {
protected:
    json kind(const std::map<std::string, std::string>& environment, const std::string& option) const {
        Launch launch = this->launch({"devices", "--json"});
        launch.environment.insert(environment.begin(), environment.end());
        launch.environment.insert({{"FORCESHADE_DHD_LIBRARY", ""}, {"FORCESHADE_HD_LIBRARY", ""}}); // if not named
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
    const json dhd = kind({{"FORCESHADE_DHD_LIBRARY", module_of("device", "dhd_stub")}}, "dhd[:INDEX]");
    EXPECT_EQ(dhd["devices"], json::array({"dhd:0"}));
    EXPECT_EQ(dhd["software"], "DHD SDK 3.17.6.1");
    std::filesystem::create_directory(path("lib"));
    std::filesystem::create_symlink(module_of("device", "dhd_stub"), path("lib/libdhd.so.3"));
    std::filesystem::create_symlink(module_of("device", "HD_stub"), path("lib/libHD.so"));
    const std::map<std::string, std::string> environment{{"LD_LIBRARY_PATH", path("lib")}};
    EXPECT_EQ(kind(environment, "dhd[:INDEX]")["place"], path("lib/libdhd.so.3").string());
    EXPECT_EQ(kind(environment, "hd[:NAME]")["place"], path("lib/libHD.so").string());
}

TEST_F(Devices, ThatFailOrAreNotThereAreToldInTheLibrarysWords) {
    EXPECT_EQ(kind({}, "sim")["devices"], json::array({"sim"}));
    EXPECT_EQ(kind({}, "dhd[:INDEX]")["devices"], json::array());
    const json failed =
        kind({{"FORCESHADE_DHD_LIBRARY", module_of("device", "dhd_stub")}, {"STUB_FAIL", "dhdGetDeviceCount"}},
             "dhd[:INDEX]");
    EXPECT_TRUE(says(failed["problem"].dump(), "no driver found"));
}

// The other vendor's device, a millimetre above the lowest place of a bump that pushes with 5 N.
class LiveVendor : public LiveDevice {
protected:
    Launch on_hd(const std::vector<std::string>& further = {}) const {
        Launch launch =
            this->launch(with(live("bump.toml", {"--device", "hd", "--max-force", "1 N", "--ramp", "5 ms"}), further));
        launch.environment["FORCESHADE_HD_LIBRARY"] = module_of("device", "HD_stub");
        launch.environment["STUB_POSITION"] = "0,1,0";
        launch.environment["STUB_RECORD"] = path("record").string();
        std::filesystem::remove(path("record"));
        return launch;
    }

    void expect_no_force_left() const {
        const std::vector<Told> told = record();
        ASSERT_FALSE(told.empty());
        EXPECT_EQ(told.back().size(), 0);
        const double largest = std::ranges::max(told, {}, &Told::size).size();
        EXPECT_GT(largest, 0.95);
        EXPECT_LE(largest, 1 + 1e-9);
    }
};

TEST_F(LiveVendor, LeavesNoForceWhenItsTimeIsOver) {
    const Outcome outcome = run(on_hd({"--duration", "0.3 s"}));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    expect_no_force_left();
}

TEST_F(LiveVendor, LeavesNoForceWhateverSignalEndsIt) {
    for (const int signal : {SIGINT, SIGTERM, SIGABRT, SIGSEGV, SIGQUIT}) {
        SCOPED_TRACE(signal);
        Process process(on_hd());
        await(process, [&] { return is_pushing(); });
        process.send(signal);
        process.wait();
        expect_no_force_left();
    }
}

TEST_F(LiveVendor, HasNoForceWhilePositionsFailAndEndsWhenTheyDoNotComeBack) {
    Launch launch = on_hd({"--patience", "0.5 s", "--duration", "60 s"});
    launch.environment["STUB_FAIL"] = "position@300";
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, 3) << outcome.error;
    EXPECT_TRUE(says(outcome.out + outcome.error, "ommunication error"));
    expect_no_force_left();
}

TEST_F(LiveVendor, IsNotBegunWithoutDeviceOrLibrary) {
    Launch launch = on_hd();
    launch.environment["STUB_DEVICES"] = "0";
    expect_failure(3, launch, {module_of("device", "HD_stub")});
    launch.environment["FORCESHADE_HD_LIBRARY"] = path("none.so").string();
    expect_failure(3, launch, {"none.so", "FORCESHADE_HD_LIBRARY"});
}

TEST_F(LiveVendor, FeelsAStiffnessThatTheHandCannotHoldOnlyIfItIsToldTo) {
    write("bump.toml", "surface.facets = 2\nforce.stiffness = \"20 N/mm\"\n");
    expect_failure(2, on_hd({"--duration", "0.2 s"}), {"20000 N/m", "comes to rest below", "--unstable"});
    EXPECT_EQ(run(on_hd({"--duration", "0.2 s", "--unstable"})).code, 0);
}

// The check before a session: its outcome, and an exit code that a script can go by.
TEST_F(LiveDevice, IsCheckedBeforeItIsFelt) {
    const auto checked = [&](const std::vector<std::string>& further, const char* hand) {
        Launch launch = this->launch(with(
            {"device", "check", "plane.toml", "--quiet", "--watchdog", "100 ms", "--out", "check.json", "--overwrite"},
            further));
        launch.environment["FORCESHADE_DHD_LIBRARY"] = module_of("device", "dhd_stub_old"); // without buttons
        launch.environment["STUB_HAND"] = hand;
        return run(launch);
    };
    const Outcome sound = checked({"--device", "dhd", "--yes"}, "1");
    EXPECT_EQ(sound.code, 1) << "the old library refuses its watchdog";
    EXPECT_TRUE(says(sound.out, "passed   axes", "failed   watchdog"));
    EXPECT_FALSE(says(checked({"--device", "dhd", "--yes"}, "3").out, "passed   axes"));
    const Outcome alone = checked({"--device", "dhd"}, "1");
    EXPECT_EQ(alone.code, 1);
    EXPECT_TRUE(says(alone.out, "skipped  axes")) << "nobody is at a terminal";
    EXPECT_EQ(read_json("check.json")["passed"], false);
    const Outcome simulated = checked({"--device", "sim", "--json"}, "0");
    EXPECT_EQ(simulated.code, 0) << simulated.out;
    EXPECT_EQ(simulated.error, "");
    EXPECT_EQ(json::parse(simulated.out), read_json("check.json"));
    EXPECT_EQ(read_json("check.json")["passed"], true);
    expect_failure(2, {"device", "check", "--device", "replay:x.csv"}, {"cannot be pushed"});
    expect_failure(2, {"device", "chek"}, {"did you mean forceshade device check?"});
}

} // namespace
} // namespace forceshade::testing
