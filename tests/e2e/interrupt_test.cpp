// Sweeps that are interrupted or killed at any moment, and run again.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include <fmt/format.h>

#include "tests/e2e/folder_watch.h"

namespace forceshade::testing {
namespace {

// Cases large enough that some are half-written at any moment.
const char* const kSlowGrid = "size = [64, 16, 32]\norigin = [\"-14 mm\", \"-1 mm\", \"-4 mm\"]\n"
                              "spacing = [\"0.45 mm\", \"0.12 mm\", \"0.15 mm\"]\n";

class Interrupt : public Workplace {
protected:
    Interrupt() {
        write("paper.toml", small_study(kSlowGrid));
        const Outcome outcome = expect_success(arguments("whole"));
        seconds_ = outcome.seconds;
        whole_ = results_in(path("whole"));
    }

    static std::vector<std::string> arguments(const std::string& out) {
        return {"sweep", "paper.toml", "--out", out, "--also", "npy", "--quiet"};
    }

    // Lets a sweep run for a while under watch, or until `results` are there, then sends it a signal.
    Outcome run_until(const std::string& out, double seconds, std::size_t results, int signal) const {
        Process process(launch(arguments(out)));
        FolderWatch watch(path(out), whole_);
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        while (process.running() && std::chrono::steady_clock::now() < end && watch.whole() < results) {
            watch.look();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        process.send(signal);
        const Outcome outcome = process.wait();
        watch.look();
        return outcome;
    }

    void expect_finished_by_another_run(const std::string& out) const {
        const Outcome outcome = expect_success(arguments(out));
        EXPECT_EQ(differences(results_in(path(out)), whole_), std::set<std::string>{});
        EXPECT_EQ(temporaries_in(path(out)), std::vector<std::string>{});
        EXPECT_EQ(read_json(out + "/manifest.json")["complete"], true);
    }

    Tree whole_;
    double seconds_ = 0; // of an undisturbed run
};

constexpr std::size_t kAll = 1000000; // results, more than there are

TEST_F(Interrupt, ByKillAtAnyMomentLeavesOnlyWholeFilesAndASweepThatCanGoOn) {
    std::mt19937 random(7);
    std::size_t killed = 0;
    for (int i = 0; i < 8; ++i) {
        const std::string out = fmt::format("out{}", i);
        // The last one while the report is written, or after.
        const double moment = seconds_ * (i < 7 ? std::uniform_real_distribution(0.05, 0.95)(random) : 0.99);
        killed += run_until(out, moment, kAll, SIGKILL).code == 128 + SIGKILL;
        expect_finished_by_another_run(out);
        std::filesystem::remove_all(path(out));
    }
    EXPECT_GE(killed, 4u) << "most moments must lie within the run, which took " << seconds_ << " s";
}

TEST_F(Interrupt, ByKillAgainAndAgainEndsInTheSameFiles) {
    Outcome outcome;
    for (std::size_t results = 5; results < 103; results += 12) {
        outcome = run_until("out", 60, results, SIGKILL);
        EXPECT_EQ(outcome.code, 128 + SIGKILL);
    }
    const nlohmann::json said = nlohmann::json::parse(
        expect_success({"sweep", "paper.toml", "--out", "out", "--also", "npy", "--quiet", "--json"}).out);
    EXPECT_GT(said["kept"], 30) << "what was done before is not done again";
    EXPECT_EQ(differences(results_in(path("out")), whole_), std::set<std::string>{});
    EXPECT_EQ(temporaries_in(path("out")), std::vector<std::string>{});
}

TEST_F(Interrupt, ByASignalEndsWith130AtOnceAndLeavesNoTemporaries) {
    for (const int signal : {SIGINT, SIGTERM})
        for (const std::size_t results : {std::size_t(3), std::size_t(20), std::size_t(60)}) {
            const std::string out = fmt::format("out{}-{}", signal, results);
            const auto start = std::chrono::steady_clock::now();
            const Outcome outcome = run_until(out, 60, results, signal);
            EXPECT_EQ(outcome.code, 130);
            EXPECT_NE(outcome.error.find("interrupted"), std::string::npos) << outcome.error;
            EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
            EXPECT_EQ(temporaries_in(path(out)), std::vector<std::string>{});
            if (std::filesystem::exists(path(out) / "manifest.json")) { // a busy machine has no time for it
                EXPECT_EQ(read_json(out + "/manifest.json")["complete"], false);
            }
            expect_finished_by_another_run(out);
        }
}

TEST_F(Interrupt, OfOneOfTwoRunsInAFolderDoesNotDisturbTheOther) {
    for (const int signal : {SIGINT, SIGKILL}) {
        const std::string out = fmt::format("both{}", signal);
        Process other(launch(arguments(out)));
        run_until(out, 60, 30, signal);
        EXPECT_EQ(other.wait().code, 0);
        EXPECT_EQ(differences(results_in(path(out)), whole_), std::set<std::string>{});
        expect_finished_by_another_run(out);
    }
}

TEST_F(Interrupt, OfAFieldLeavesNoFile) {
    write("large.toml", "[grid]\nsize = [256, 256, 256]\n[output]\ncompression = \"zip\"\n[texture]\n"
                        "stiffness = \"0.1 N/mm\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n");
    for (const int signal : {SIGINT, SIGTERM}) {
        Process process(launch({"field", "large.toml", "--out", "large.exr", "--also", "npy"}));
        while (process.running() && temporaries_in(folder_.path()).empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        const auto start = std::chrono::steady_clock::now();
        process.send(signal);
        EXPECT_EQ(process.wait().code, 130);
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
        EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
        EXPECT_FALSE(std::filesystem::exists(path("large.exr")));
        EXPECT_FALSE(std::filesystem::exists(path("large.force.npy")));
    }
}

TEST_F(Interrupt, OfAFieldOfWhichOneLayerIsRepeatedForMinutesEndsSoon) {
    write("huge.toml", "[grid]\nsize = [4096, 4096, 4096]\n");
    Process process(launch({"field", "huge.toml", "--out", "huge.exr"}));
    while (process.running() && temporaries_in(folder_.path()).empty())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGINT);
    EXPECT_EQ(process.wait().code, 130);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)); // 0.2 s where the machine is free
    EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
}

TEST_F(Interrupt, OfAValidationEndsWith130) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Process process(launch({"validate"})); // half a minute of work
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        process.send(signal);
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.code, 130) << outcome.error;
        EXPECT_LT(outcome.seconds, 10);
        EXPECT_EQ(outcome.out, "");
    }
}

} // namespace
} // namespace forceshade::testing
