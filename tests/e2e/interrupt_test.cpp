// Sweeps that are interrupted or killed at any moment, and run again; and other commands that are interrupted.
#include <chrono>
#include <csignal>
#include <iterator>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
        static const Outcome outcome = expect_success(arguments("whole"));
        static const Tree whole = results_in(path("whole"));
        seconds_ = outcome.seconds;
        whole_ = &whole;
    }

    static std::vector<std::string> arguments(const std::string& out) {
        return {"sweep", "paper.toml", "--out", out, "--also", "npy", "--quiet"};
    }

    // Lets a sweep run for a while under watch, or until `results` are there, then sends it a signal.
    Outcome run_until(const std::string& out, double seconds, std::size_t results, int signal) const {
        Process process(launch(arguments(out)));
        FolderWatch watch(path(out), *whole_);
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

    // Returns what that run says of itself.
    nlohmann::json expect_finished_by_another_run(const std::string& out) const {
        const nlohmann::json said = json_of(with(arguments(out), {"--json"}));
        EXPECT_EQ(differences(results_in(path(out)), *whole_), std::set<std::string>{});
        EXPECT_EQ(temporaries_in(path(out)), std::vector<std::string>{});
        EXPECT_EQ(read_json(out + "/manifest.json")["complete"], true);
        return said;
    }

    const Tree* whole_ = nullptr; // what an undisturbed run leaves, and its time
    double seconds_ = 0;
};

constexpr std::size_t kAll = 1000000; // results, more than there are

TEST_F(Interrupt, ByKillAtAnyMomentLeavesOnlyWholeFilesAndASweepThatCanGoOn) {
    std::mt19937 random(7);
    std::size_t killed = 0;
    for (int i = 0; i < 5; ++i) {
        const std::string out = fmt::format("out{}", i);
        // The last one while the report is written, or after.
        const double moment = seconds_ * (i < 4 ? std::uniform_real_distribution(0.05, 0.95)(random) : 0.99);
        killed += run_until(out, moment, kAll, SIGKILL).code == 128 + SIGKILL;
        expect_finished_by_another_run(out);
        std::filesystem::remove_all(path(out));
    }
    EXPECT_GE(killed, 3u) << "most moments must lie within the run, which took " << seconds_ << " s";
}

TEST_F(Interrupt, ByKillAgainAndAgainEndsInTheSameFiles) {
    for (std::size_t results = 5; results < 103; results += 12)
        EXPECT_EQ(run_until("out", 60, results, SIGKILL).code, 128 + SIGKILL);
    EXPECT_GT(expect_finished_by_another_run("out")["kept"], 30) << "what was done before is not done again";
}

TEST_F(Interrupt, ByASignalEndsWith130AtOnceAndLeavesNoTemporaries) {
    for (const int signal : {SIGINT, SIGTERM})
        for (const std::size_t results : {std::size_t(3), std::size_t(20), std::size_t(60)}) {
            const std::string out = fmt::format("out{}-{}", signal, results);
            const auto start = std::chrono::steady_clock::now();
            const Outcome outcome = run_until(out, 60, results, signal);
            EXPECT_EQ(outcome.code, 130);
            EXPECT_TRUE(says(outcome.error, "interrupted"));
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
        EXPECT_EQ(differences(results_in(path(out)), *whole_), std::set<std::string>{});
        expect_finished_by_another_run(out);
    }
}

// While a file is read or written, where one layer is repeated for minutes, and where no file is written at all.
using InterruptedCommand = Workplace;

TEST_F(InterruptedCommand, EndsSoonWith130AndLeavesNoFile) {
    const std::string bump = "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n";
    write("large.toml", "[grid]\nsize = [256, 256, 256]\n[output]\ncompression = \"zip\"\n[texture]\n"
                        "stiffness = \"0.1 N/mm\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n");
    write("huge.toml", "[grid]\nsize = [4096, 4096, 4096]\n");
    write("long.toml", bump + "[paths]\ncount = 200000\nsteps = 2000\n");
    write("plain.toml", bump);
    fmt::memory_buffer rows;
    fmt::format_to(std::back_inserter(rows), "path,t,x,y,z\n");
    for (int i = 0; i < 4'000'000; ++i)
        fmt::format_to(std::back_inserter(rows), "{},{},{}e-5,0.001234567,-0.000123456789\n", i / 1'000'000, i,
                       i % 1000 - 500);
    write("in.csv", fmt::to_string(rows));
    const std::vector<std::string> before = folder_.names();
    const auto explore = [](const std::string& scene, const std::string& out, const std::vector<std::string>& more) {
        return with({"explore", scene, "--out", out, "--engine", "cpu"}, more);
    };
    struct Row {
        std::vector<std::string> arguments;
        bool begins_file; // before the time counts
        int wait;         // ms
    };
    for (const auto& [arguments, begins_file, wait] :
         {Row{{"field", "large.toml", "--out", "a.exr", "--also", "npy"}, true, 100},
          {{"field", "huge.toml", "--out", "a.exr"}, true, 300},
          {explore("plain.toml", "a.csv", {"--paths", "in.csv", "--metrics-only"}), false, 250}, // read a first time
          {explore("plain.toml", "a.csv", {"--paths", "in.csv", "--metrics-only"}), false, 900}, // and later
          {explore("plain.toml", "a.csv", {"--paths", "in.csv"}), true, 50},
          {explore("long.toml", "a.exr", {}), true, 300},
          {explore("long.toml", "a.csv", {}), true, 300},
          {explore("long.toml", "a.npy", {}), true, 300},
          {explore("long.toml", "a.csv", {"--metrics-only"}), true, 300},
          {{"validate"}, false, 500}}) // half a minute of work
        for (const int signal : {SIGINT, SIGTERM}) {
            SCOPED_TRACE(fmt::format("{}, {} ms, signal {}", fmt::join(arguments, " "), wait, signal));
            Process process(launch(arguments));
            while (begins_file && process.running() && temporaries_in(folder_.path()).empty())
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            std::this_thread::sleep_for(std::chrono::milliseconds(wait));
            const auto start = std::chrono::steady_clock::now();
            process.send(signal);
            const Outcome outcome = process.wait();
            EXPECT_EQ(outcome.code, 130) << outcome.error;
            EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)); // 0.2 s on a free machine
            EXPECT_EQ(outcome.out, "");
            EXPECT_EQ(folder_.names(), before);
        }
}

} // namespace
} // namespace forceshade::testing
