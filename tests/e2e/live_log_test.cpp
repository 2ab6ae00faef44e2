// Disks and pipes that do not take a live loop's log: the loop goes on, and what is lost is counted and told.
#include <fcntl.h>
#include <sys/stat.h>

#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

class LiveLog : public Live {
protected:
    static constexpr std::size_t kRows = 4000;

    LiveLog() { write_still("still.csv", kRows); }

    std::vector<std::string> by_the_clock(const std::string& log, std::vector<std::string> further = {}) const {
        std::vector<std::string> all = live("plane.toml", {"--device", "replay:still.csv", "--log", log, "--report",
                                                           "said", "--json", "--rate", "4 kHz"});
        all.insert(all.end(), further.begin(), further.end());
        return all;
    }
    // Every sample was felt; what is not in the log is counted, in JSON, text and message.
    void expect_losses_told(const Outcome& outcome, std::size_t logged, const std::string& why) const {
        EXPECT_EQ(outcome.code, 4) << outcome.error;
        const nlohmann::json said = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(said["samples"], kRows) << "the loop ran to its end";
        EXPECT_EQ(said["log"]["samples"], logged);
        EXPECT_EQ(said["log"]["lost"], kRows - logged);
        EXPECT_EQ(said, read_json("said.json"));
        const std::string counts = fmt::format("{} samples are in the log, {} are lost", logged, kRows - logged);
        for (const std::string& word : {std::string("error: cannot write "), why, counts})
            EXPECT_NE(outcome.error.find(word), std::string::npos) << "no " << word << " in " << outcome.error;
        EXPECT_NE(text("said.txt").find(std::to_string(kRows - logged)), std::string::npos);
    }
};

TEST_F(LiveLog, a_disk_that_is_full_ends_the_log_with_a_whole_line_and_not_the_loop) {
    for (const std::uint64_t most : {120'000, 140'001}) {
        Launch launch = this->launch(by_the_clock("log.csv", {"--overwrite"}));
        launch.most_file_bytes = most;
        const Outcome outcome = run(launch);
        EXPECT_TRUE(text("log.csv").ends_with('\n'));
        EXPECT_LE(text("log.csv").size(), most);
        const Rows log = rows("log.csv");
        EXPECT_GT(log.size(), 50u);
        EXPECT_LT(log.size(), kRows);
        for (std::size_t i = 0; i < log.size(); ++i)
            ASSERT_EQ(log[i].at("tick"), std::to_string(i));
        expect_losses_told(outcome, log.size(), "File too large");
    }
}

TEST_F(LiveLog, nor_is_a_report_that_cannot_be_written_the_only_thing_that_is_told) {
    Launch launch = this->launch(by_the_clock("log.csv"));
    launch.most_file_bytes = 1000;
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, 4);
    launch = this->launch(live("bump.toml", {"--fast", "--duration", "1 s", "--report", "said", "--quiet"}));
    launch.most_file_bytes = 2500;
    expect_failure(4, launch, {"error: cannot write", "said", "File too large"});
}

TEST_F(LiveLog, a_disk_that_takes_nothing_is_refused_at_once) {
    const Tree before = tree_of(folder_.path());
    expect_failure(4, by_the_clock("/dev/full"), {"/dev/full", "No space left on device"});
    Launch launch = this->launch(by_the_clock("log.csv"));
    launch.most_file_bytes = 50;
    EXPECT_EQ(run(launch).code, 4);
    EXPECT_EQ(differences(before, tree_of(folder_.path())), std::set<std::string>{}) << "no half a header stays";
}

TEST_F(LiveLog, nowhere_takes_everything) {
    const Outcome outcome =
        expect_success(live("bump.toml", {"--fast", "--duration", "1 s", "--log", "/dev/null", "--json", "--quiet"}));
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["log"]["samples"], 1000);
    EXPECT_FALSE(std::filesystem::exists("/dev/null.live.txt"));
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

class LivePipe : public LiveLog {
protected:
    LivePipe() { ::mkfifo(path("pipe").c_str(), 0600); }
    int open_to_read() const { return ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC); }
};

TEST_F(LivePipe, that_is_read_gets_everything) {
    const int reader = open_to_read();
    Process process(launch(by_the_clock("pipe")));
    std::string all;
    char some[4096];
    while (process.running()) {
        for (ssize_t count = 0; (count = ::read(reader, some, sizeof some)) > 0;)
            all.append(some, std::size_t(count));
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    for (ssize_t count = 0; (count = ::read(reader, some, sizeof some)) > 0;)
        all.append(some, std::size_t(count));
    ::close(reader);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    EXPECT_EQ(table_in(all).size(), kRows);
}

TEST_F(LivePipe, that_nobody_reads_is_refused) {
    expect_failure(4, by_the_clock("pipe"), {"pipe", "nobody reads this pipe", "start its reader first"});
}

TEST_F(LivePipe, whose_reader_stalls_does_not_hold_up_the_loop_nor_its_end) {
    const int reader = open_to_read();
    const Outcome outcome = forceshade(by_the_clock("pipe"));
    ::close(reader);
    const nlohmann::json said = nlohmann::json::parse(outcome.out);
    EXPECT_LT(said["log"]["samples"], kRows);
    expect_losses_told(outcome, said["log"]["samples"], "timed out");
    EXPECT_LT(said["elapsed_s"], 10);
}

TEST_F(LivePipe, whose_reader_goes_away_does_not_end_the_loop) {
    const int reader = open_to_read();
    Process process(launch(by_the_clock("pipe")));
    std::string all;
    await(process, [&] {
        char some[4096];
        const ssize_t count = ::read(reader, some, sizeof some);
        all.append(some, std::size_t(std::max<ssize_t>(0, count)));
        return all.size() > 20'000;
    });
    ::close(reader);
    const Outcome outcome = process.wait();
    const nlohmann::json said = nlohmann::json::parse(outcome.out);
    EXPECT_GT(said["log"]["samples"], 10);
    expect_losses_told(outcome, said["log"]["samples"], "Broken pipe");
}

} // namespace
} // namespace forceshade::testing
