// Disks and pipes that do not take a live loop's log: the loop goes on, and what is lost is counted and told.
#include <array>
#include <csignal>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host/output/files.h"
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

class LiveLog : public Live {
protected:
    static constexpr std::size_t kRows = 4000;

    LiveLog() { write_still("still.csv", kRows); }

    static std::vector<std::string> by_the_clock(const std::string& log, const std::vector<std::string>& further = {}) {
        return with(live("plane.toml", {"--device", "replay:still.csv", "--log", log, "--report", "said", "--json",
                                        "--rate", "4 kHz"}),
                    further);
    }
    // What is in the log is there without a gap.
    void expect_every_tick(const Rows& log) const {
        for (std::size_t i = 0; i < log.size(); ++i)
            ASSERT_EQ(log[i].at("tick"), std::to_string(i));
    }
    // Every sample was felt; what is not in the log is counted, in JSON, text and message.
    void expect_losses_told(const Outcome& outcome, std::size_t logged, const std::string& why) const {
        EXPECT_EQ(outcome.code, 4) << outcome.error;
        const nlohmann::json said = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(said["samples"], kRows) << "the loop ran to its end";
        EXPECT_EQ(said["log"]["samples"], logged);
        EXPECT_EQ(said["log"]["lost"], kRows - logged);
        EXPECT_EQ(said, read_json("said.json"));
        EXPECT_TRUE(says(outcome.error, "error: cannot write ", why,
                         fmt::format("{} samples are in the log, {} are lost", logged, kRows - logged)));
        EXPECT_TRUE(says(text("said.txt"), std::to_string(kRows - logged)));
    }
};

TEST_F(LiveLog, ADiskThatIsFullEndsTheLogWithAWholeLineAndNotTheLoop) {
    for (const std::uint64_t most : {120'000, 140'001}) {
        Launch launch = this->launch(by_the_clock("log.csv", {"--overwrite"}));
        launch.most_file_bytes = most;
        const Outcome outcome = run(launch);
        EXPECT_TRUE(text("log.csv").ends_with('\n'));
        EXPECT_LE(text("log.csv").size(), most);
        const Rows log = rows("log.csv");
        EXPECT_GT(log.size(), 50u);
        EXPECT_LT(log.size(), kRows);
        expect_every_tick(log);
        expect_losses_told(outcome, log.size(), "File too large");
    }
}

TEST_F(LiveLog, NorIsAReportThatCannotBeWrittenTheOnlyThingThatIsTold) {
    Launch launch = this->launch(by_the_clock("log.csv"));
    launch.most_file_bytes = 1000;
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, 4);
    launch = this->launch(live("bump.toml", {"--fast", "--duration", "1 s", "--report", "said", "--quiet"}));
    launch.most_file_bytes = 2500;
    expect_failure(4, launch, {"error: cannot write", "said", "File too large"});
}

TEST_F(LiveLog, ADiskThatTakesNothingIsRefusedAtOnce) {
    expect_refused(by_the_clock("/dev/full"), {"/dev/full", "No space left on device"}, 4);
    Launch launch = this->launch(by_the_clock("log.csv"));
    launch.most_file_bytes = 50;
    expect_refused(launch, {}, 4); // no half a header stays
}

TEST_F(LiveLog, NowhereTakesEverything) {
    const nlohmann::json said =
        json_of(live("bump.toml", {"--fast", "--duration", "1 s", "--log", "/dev/null", "--json", "--quiet"}));
    EXPECT_EQ(said["log"]["samples"], 1000);
    EXPECT_FALSE(std::filesystem::exists("/dev/null.live.txt"));
    EXPECT_FALSE(std::filesystem::exists("/dev/null.scene-0.toml"));
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(LiveLog, ThatAnotherRunWritesIsRefusedAndStaysWhole) {
    write_still("still.csv", 60 * kRows); // a minute: the others may come late
    Process first(launch(by_the_clock("log.csv", {"--overwrite"})));
    await(first, [&] { return text("log.csv").size() > 10'000; });
    for (const char* const name : {"log.csv", "also.csv"}) {
        std::error_code ignored;
        std::filesystem::create_hard_link(path("log.csv"), path("also.csv"), ignored);
        expect_failure(2, live("bump.toml", {"--fast", "--duration", "1 s", "--log", name, "--overwrite"}),
                       {std::string("--log "), name, "another run writes it now"});
    }
    first.send(SIGINT);
    const Outcome outcome = first.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.error;
    const Rows log = rows("log.csv");
    EXPECT_GT(log.size(), 100u);
    expect_every_tick(log);
    expect_success(live("bump.toml", {"--fast", "--duration", "1 s", "--log", "log.csv", "--overwrite"}));
    EXPECT_EQ(rows("log.csv").size(), 1000u) << "once it is written it may be replaced";
}

TEST_F(LiveLog, InThePlaceOfALinkLeavesAloneWhatTheLinkLeadsTo) {
    write("letter.txt", "dear");
    std::filesystem::create_symlink("letter.txt", path("log.csv"));
    expect_failure(2, live("bump.toml", {"--fast", "--duration", "1 s", "--log", "log.csv"}), {"is there already"});
    expect_success(live("bump.toml", {"--fast", "--duration", "1 s", "--log", "log.csv", "--overwrite"}));
    EXPECT_EQ(rows("log.csv").size(), 1000u);
    EXPECT_EQ(text("letter.txt"), "dear");
}

TEST_F(LiveLog, ThatAnotherRunWritesToAPipeIsRefused) {
    ASSERT_EQ(::mkfifo(path("log.fifo").c_str(), 0600), 0);
    const int reader = ::open(path("log.fifo").c_str(), O_RDWR | O_NONBLOCK); // also holds the pipe open
    ASSERT_GE(reader, 0);
    Process first(launch(by_the_clock("log.fifo", {})));
    std::array<char, 64> bytes;
    await(first, [&] { return ::read(reader, bytes.data(), bytes.size()) > 0; });
    expect_failure(2, live("bump.toml", {"--fast", "--duration", "1 s", "--log", "log.fifo"}),
                   {"--log ", "log.fifo", "another run writes it now"});
    first.send(SIGINT);
    first.wait();
    ::close(reader);
}

TEST_F(LiveLog, HoldsItsSceneAndTheScenesHash) {
    expect_success(live("bump.toml", {"--fast", "--duration", "1 s", "--log", "log.csv"}));
    const nlohmann::json said = read_json("log.live.json");
    ASSERT_EQ(said["scenes"].size(), 1u);
    EXPECT_EQ(said["scenes"][0]["path"], 0);
    const std::string scene = text("log.scene-0.toml"), hash = said["scenes"][0]["sha256"];
    EXPECT_EQ(said["scenes"][0]["toml"], scene);
    EXPECT_TRUE(says(scene, "facets = 3"));
    EXPECT_EQ(hash, sha256_of(scene));
    for (const auto& row : rows("log.csv"))
        ASSERT_EQ(row.at("scene"), hash.substr(0, 16));
    EXPECT_TRUE(says(text("log.live.txt"), hash));
    expect_success(replayed("log.scene-0.toml", "log.csv", "out.csv", "cpu", "f64"));
    EXPECT_TRUE(felt_in(text("log.csv")) == text("out.csv"));
    expect_success(live("bump.toml", {"--fast", "--duration", "1 s", "--report", "said"}));
    EXPECT_EQ(read_json("said.json")["scenes"], said["scenes"]) << "without a log, too";
}

TEST_F(LiveLog, MarksAChangeOfPathOfARecording) {
    std::string table = "path,t,x,y,z\n";
    for (int i = 0; i < 1000; ++i)
        table += fmt::format("{},{},0,0,-0.001\n", i / 500, 1e-3 * (i % 500));
    write("two.csv", table);
    expect_success(live("plane.toml", {"--device", "replay:two.csv", "--fast", "--log", "log.csv"}));
    const Rows log = rows("log.csv");
    ASSERT_EQ(log.size(), 1000u);
    EXPECT_EQ(size_in(log[499], "cx", "cy", "cz"), 1);
    EXPECT_LT(size_in(log[500], "cx", "cy", "cz"), 0.01);
    for (std::size_t i = 0; i < log.size(); ++i)
        ASSERT_EQ(happened_in(log[i], "new_path"), i == 500) << i;
}

class LivePipe : public LiveLog {
protected:
    LivePipe() { ::mkfifo(path("pipe").c_str(), 0600); }
    int open_to_read() const { return ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC); }
};

TEST_F(LivePipe, ThatIsReadGetsEverything) {
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

TEST_F(LivePipe, ThatNobodyReadsIsRefused) {
    expect_failure(4, by_the_clock("pipe"), {"pipe", "this pipe has no reader", "start its reader first"});
}

TEST_F(LivePipe, WhoseReaderStallsDoesNotHoldUpTheLoopNorItsEnd) {
    const int reader = open_to_read();
    const Outcome outcome = forceshade(by_the_clock("pipe"));
    ::close(reader);
    const nlohmann::json said = nlohmann::json::parse(outcome.out);
    EXPECT_LT(said["log"]["samples"], kRows);
    expect_losses_told(outcome, said["log"]["samples"], "timed out");
    EXPECT_LT(said["elapsed_s"], 10);
}

TEST_F(LivePipe, WhoseReaderGoesAwayDoesNotEndTheLoop) {
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
