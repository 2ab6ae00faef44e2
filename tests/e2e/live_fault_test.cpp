// However a live loop ends, or is made to pause, the device is left without force: witnessed by the device.
#include "tests/e2e/live_workplace.h"
#include "tests/places.h"

namespace forceshade::testing {
namespace {

char state_of(const Process& process) {
    const std::string stat = read_text(fmt::format("/proc/{}/stat", process.id()));
    const std::size_t end = stat.rfind(')');
    return end == std::string::npos || end + 2 >= stat.size() ? '?' : stat[end + 2];
}

class LiveFault : public LiveDevice {
protected:
    // Starts it, waits for the force, does something; what the device was told in all.
    template <typename Deed> std::vector<Told> pushed(const Launch& launch, Outcome& outcome, Deed&& deed) const {
        Process process(launch);
        if (await(process, [&] { return is_pushing(); }))
            deed(process);
        outcome = process.wait();
        outcome.error = text("stderr");
        const std::vector<Told> told = record();
        EXPECT_FALSE(told.empty());
        const bool deaf = launch.environment.at("STUB_FAIL") == "dhdSetForce@300"; // can be told nothing
        EXPECT_TRUE(deaf || (!told.empty() && told.back().size() == 0)) << "it is left without force";
        return told;
    }
    void expect_whole_log(const std::string& name, const nlohmann::json& said) const {
        const std::string all = text(name);
        EXPECT_TRUE(all.ends_with('\n'));
        const Rows log = rows(name);
        EXPECT_EQ(said["samples"], log.size());
        EXPECT_EQ(said["log"]["lost"], 0);
        for (std::size_t i = 0; i < log.size(); ++i)
            ASSERT_EQ(log[i].at("tick"), std::to_string(i));
    }
};

TEST_F(LiveFault, ItsNormalEndLeavesNoForce) {
    Outcome outcome;
    const std::vector<Told> told = pushed(felt({"--duration", "0.8 s", "--log", "log.csv"}), outcome, [](Process&) {});
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_GE(told.size(), 800u);
    expect_whole_log("log.csv", read_json("log.live.json"));
    double before = 0;
    for (std::size_t i = 0; i < 800; ++i) {
        ASSERT_LE(told[i].size(), before + 0.021) << "it comes up over 50 ms, forces " << i;
        ASSERT_LE(told[i].size(), 1.0 + 1e-9);
        ASSERT_GE(told[i].z, 0) << "upwards in the vendor's axes, too";
        before = told[i].size();
    }
}

TEST_F(LiveFault, AFirstSignalEndsItWithinTwoSamplesAndNothingIsLost) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        std::size_t fewest = 1000;
        for (int attempt = 0; attempt < 4 && fewest > 2; ++attempt) { // a busy machine may not wake us in time
            Outcome outcome;
            double sent = 0;
            const std::vector<Told> told =
                pushed(felt({"--log", "log.csv", "--overwrite"}), outcome, [&](Process& process) {
                    process.send(signal);
                    sent = now();
                });
            EXPECT_EQ(outcome.code, 130) << outcome.error;
            const nlohmann::json said = read_json("log.live.json");
            EXPECT_EQ(said["ended"], "interrupted");
            expect_whole_log("log.csv", said);
            EXPECT_LT(pushes_after(told, sent), 1000u);
            fewest = std::min(fewest, pushes_after(told, sent));
        }
        EXPECT_LE(fewest, 2u) << "signal " << signal;
    }
}

TEST_F(LiveFault, UnderNohupItDoesNotEndWithTheTerminal) {
    ::signal(SIGHUP, SIG_IGN); // inherited
    Outcome outcome;
    pushed(felt({"--duration", "0.5 s"}), outcome, [](Process& process) { process.send(SIGHUP); });
    ::signal(SIGHUP, SIG_DFL);
    EXPECT_EQ(outcome.code, 0) << outcome.error;
}

TEST_F(LiveFault, ASecondSignalThatCannotWaitLeavesNoForceEither) {
    for (int i = 0; i < 5; ++i) {
        Outcome outcome;
        pushed(felt({}), outcome, [](Process& process) {
            process.send(SIGINT);
            process.send(SIGTERM);
            process.send(SIGINT);
        });
        EXPECT_GE(outcome.code, 128) << outcome.error;
    }
}

TEST_F(LiveFault, SignalsThatKillLeaveNoForce) {
    for (const int signal : {SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGUSR1, SIGUSR2,
                             SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGIO, SIGPWR}) {
        SCOPED_TRACE(signal);
        Outcome outcome;
        pushed(felt({"--log", "log.csv", "--overwrite"}), outcome, [&](Process& process) { process.send(signal); });
        EXPECT_EQ(outcome.code, 128 + signal);
        EXPECT_TRUE(text("log.csv").ends_with('\n'));
    }
}

TEST_F(LiveFault, SignalsThatMeanNothingDoNothing) {
    Outcome outcome;
    const std::vector<Told> told = pushed(felt({"--duration", "0.6 s"}), outcome, [](Process& process) {
        for (const int signal : {SIGPIPE, SIGXFSZ, SIGCHLD, SIGWINCH, SIGURG, SIGCONT})
            process.send(signal);
    });
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_GE(told.size(), 600u);
}

TEST_F(LiveFault, StoppedByTheTerminalItHasNoForceAndRampsWhenItGoesOn) {
    for (const int signal : {SIGTSTP, SIGTTOU, SIGTTIN})
        for (const int times : {1, 3}) {
            SCOPED_TRACE(fmt::format("{} x {}", signal, times));
            Outcome outcome;
            double on = 0;
            const std::vector<Told> told =
                pushed(felt({"--log", "log.csv", "--overwrite"}), outcome, [&](Process& process) {
                    for (int i = 0; i < times; ++i)
                        process.send(signal);
                    ASSERT_TRUE(await(process, [&] { return state_of(process) == 'T'; }));
                    const std::vector<Told> before = record();
                    EXPECT_EQ(before.back().size(), 0);
                    std::this_thread::sleep_for(std::chrono::milliseconds(150));
                    EXPECT_EQ(record().size(), before.size());
                    on = now();
                    // Signals that were sent again stop it again.
                    ASSERT_TRUE(await(process, [&] {
                        process.send(SIGCONT);
                        return is_pushing();
                    }));
                    process.send(SIGINT);
                });
            EXPECT_EQ(outcome.code, 130) << outcome.error;
            double before = 0;
            for (const Told& one : told) {
                if (one.time > on) {
                    ASSERT_LE(one.size(), before + 0.021);
                    before = one.size();
                }
            }
            EXPECT_GT(before, -1);
            expect_whole_log("log.csv", read_json("log.live.json"));
        }
}

TEST_F(LiveFault, StoppedForASecondItMakesUpForEveryTickWithoutForce) {
    write_still("still.csv", 3000);
    Process process(launch(live("plane.toml", {"--device", "replay:still.csv", "--ramp", "200 ms", "--log", "log.csv",
                                               "--watchdog", "100 ms"})));
    ASSERT_TRUE(await(process, [&] { return std::filesystem::exists(path("log.csv")); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    process.send(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    process.send(SIGCONT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    const Rows log = rows("log.csv");
    ASSERT_EQ(log.size(), 3000u);
    std::size_t too_late = 0, since = 1000;
    for (std::size_t i = 0; i < log.size(); ++i, ++since) {
        ASSERT_EQ(log[i].at("tick"), std::to_string(i));
        ASSERT_EQ(number_in(log[i], "fz"), 1);
        const double shown = size_in(log[i], "cx", "cy", "cz");
        if (number_in(log[i], "late_ns") > 100e6 || happened_in(log[i], "too_late")) {
            ++too_late;
            since = 0;
            ASSERT_TRUE(happened_in(log[i], "too_late")) << i;
            ASSERT_EQ(shown, 0) << i;
        } else if (since < 100 && i > 0) {
            ASSERT_LE(shown, 0.005 * double(since) + 1e-9) << "it ramps, row " << i;
        }
    }
    EXPECT_GE(too_late, 800u);
    EXPECT_GT(size_in(log.back(), "cx", "cy", "cz"), 0.99);
    EXPECT_EQ(read_json("log.live.json")["happened"]["too_late"], too_late);
}

TEST_F(LiveFault, ALeapOfTheWallClockIsNothingToIt) {
    write_still("still.csv", 1200);
    Launch launch = this->launch(live("plane.toml", {"--device", "replay:still.csv", "--log", "log.csv"}));
    launch.environment["LD_PRELOAD"] = module_of("e2e", "leaping_clock");
    launch.environment["LEAP_AFTER"] = "0.6";
    launch.environment["LEAP_WITNESS"] = path("witness").string();
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    ASSERT_TRUE(std::filesystem::exists(path("witness"))) << "the clock was in place";
    const Rows log = rows("log.csv");
    ASSERT_EQ(log.size(), 1200u);
    for (std::size_t i = 0; i < log.size(); ++i) {
        ASSERT_GE(number_in(log[i], "t"), 0.001 * double(i) - 1e-9);
        ASSERT_LT(number_in(log[i], "t"), 0.001 * double(i) + 60) << "an hour would be more";
        ASSERT_TRUE(i == 0 || number_in(log[i], "t") > number_in(log[i - 1], "t"));
    }
    const double elapsed = read_json("log.live.json")["elapsed_s"];
    EXPECT_GT(elapsed, 1.19);
    EXPECT_LT(elapsed, 60);
}

// What fails, from which call on.
TEST_F(LiveFault, ADeviceThatGoesAwayHasNoForceAndIsGivenUp) {
    for (const char* const fail : {"dhdGetPosition@300", "dhdSetForce@300"}) {
        SCOPED_TRACE(fail);
        Outcome outcome;
        const std::vector<Told> told =
            pushed(felt({"--patience", "0.3 s", "--log", "log.csv", "--overwrite"}, fail), outcome, [](Process&) {});
        EXPECT_EQ(outcome.code, 3) << outcome.error;
        EXPECT_TRUE(says(outcome.error, "error: dhd is gone: communication error"));
        expect_whole_log("log.csv", read_json("log.live.json"));
        for (const auto& row : rows("log.csv"))
            if (happened_in(row, "failed") && std::string(fail).starts_with("dhdGet")) {
                ASSERT_EQ(size_in(row, "cx", "cy", "cz"), 0);
            }
        EXPECT_GT(read_json("log.live.json")["happened"]["failed"], 100);
    }
}

TEST_F(LiveFault, ADeviceThatFailsForAWhileComesBackSlowly) {
    for (const auto& [fail, name] : {std::pair{"dhdGetPosition@300+100", "failed"},
                                     {"dhdSetForce@300+100", "failed"},
                                     {"nan@300+100", "bad_position"},
                                     {"millimetres@300+100", "bad_position"}}) {
        SCOPED_TRACE(fail);
        Outcome outcome;
        Launch launch = felt(
            {"--rate", "2 kHz", "--duration", "0.5 s", "--log", "log.csv", "--overwrite", "--max-speed", "none"}, fail);
        launch.environment["STUB_POSITION"] = "0.004,0,-0.001"; // times 1000 no device reaches
        pushed(launch, outcome, [](Process&) {});
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        const Rows log = rows("log.csv");
        ASSERT_EQ(log.size(), 1000u);
        std::size_t found = 0;
        double before = 0;
        for (const auto& row : log) {
            const double shown = size_in(row, "cx", "cy", "cz");
            if (happened_in(row, name)) {
                ++found;
                ASSERT_TRUE(shown == 0 || std::string(fail).starts_with("dhdSetForce"));
            }
            ASSERT_LE(shown, before + 0.021);
            before = shown;
        }
        EXPECT_EQ(found, 100u);
        EXPECT_GT(before, 0.9);
    }
}

// After the device's own watchdog forces come up again, from zero; after the user's button they stay off.
TEST_F(LiveFault, ForcesThatTheButtonSwitchedOffStayOff) {
    Outcome outcome;
    pushed(felt({"--duration", "1 s", "--patience", "0.2 s", "--log", "log.csv"}, "button@300+1"), outcome,
           [](Process&) {});
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_TRUE(says(outcome.error, "no force: forces were switched off by the device's button"));
    const Rows log = rows("log.csv");
    ASSERT_EQ(log.size(), 1000u);
    std::size_t withheld = 0;
    for (std::size_t i = 310; i < log.size(); ++i) {
        withheld += happened_in(log[i], "withheld");
        ASSERT_EQ(size_in(log[i], "cx", "cy", "cz"), 0) << i;
    }
    EXPECT_GT(withheld, 680u);
    EXPECT_TRUE(says(read_json("log.live.json")["remarks"].dump(), "button"));
}

TEST_F(LiveFault, ADeviceThatIsNotCalibratedHasNoForceUntilItIs) {
    Outcome outcome;
    pushed(felt({"--duration", "2 s", "--log", "log.csv"}, "uncalibrated@1+30"), outcome, [](Process&) {});
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_TRUE(says(outcome.error, "no force: the device is not calibrated", "displays forces again"));
    const Rows log = rows("log.csv");
    EXPECT_TRUE(happened_in(log.front(), "withheld"));
    EXPECT_FALSE(happened_in(log.back(), "withheld"));
    EXPECT_EQ(run(felt({"--origin", "here", "--patience", "0.3 s"}, "uncalibrated")).code, 3);
    EXPECT_TRUE(says(text("stderr"), "not calibrated")) << "its position says nothing";
}

TEST_F(LiveFault, ADeviceWithoutAWatchdogDisplaysLittleUnlessTheUserInsists) {
    for (const auto& [flag, most] : {std::pair{"--quiet", 0.5}, {"--without-device-watchdog", 1.0}}) {
        SCOPED_TRACE(flag);
        const Outcome outcome =
            run(felt({"--duration", "0.3 s", "--max-force", "3 N", "--json", flag}, "dhdSetWatchdog"));
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        double largest = 0;
        for (const Told& told : record())
            largest = std::max(largest, told.size());
        EXPECT_NEAR(largest, most, 1e-9);
        const nlohmann::json said = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(said["device"]["has_watchdog"], false);
        EXPECT_EQ(said["limits"]["largest force"], most < 1 ? "0.5 N" : "3 N");
        const std::string remarks = said["remarks"].dump();
        EXPECT_TRUE(says(remarks, "omega.3 (serial number 417) refuses its watchdog"));
        EXPECT_EQ(remarks.find("--without-device-watchdog") != std::string::npos, most < 1) << remarks;
    }
}

TEST_F(LiveFault, OutsideOfTheDevicesWorkspaceThereIsNoForce) {
    Launch launch = felt({"--duration", "0.3 s", "--json"});
    launch.environment["STUB_POSITION"] = "0,0,-0.2"; // an omega is 160 mm wide
    Outcome outcome = run(launch);
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(report["happened"]["outside"], 300);
    EXPECT_TRUE(says(report["remarks"].dump(), "every position lay outside of the workspace"));
    EXPECT_EQ(pushes_after(record(), 0), 0u);
    launch.arguments.insert(launch.arguments.end(), {"--workspace", "none"});
    EXPECT_EQ(nlohmann::json::parse(run(launch).out)["happened"]["outside"], 0);
    EXPECT_GT(pushes_after(record(), 0), 0u);
}

TEST_F(LiveFault, WaitingForADeviceCanBeInterrupted) {
    Launch launch = felt({"--origin", "here", "--patience", "none"}, "time guard"); // never a new position
    Process process(launch);
    ASSERT_TRUE(await(process, [&] { return record().size() > 10; }));
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 130);
    EXPECT_EQ(pushes_after(record(), 0), 0u);
}

} // namespace
} // namespace forceshade::testing
