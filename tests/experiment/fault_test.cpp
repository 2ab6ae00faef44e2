// A session at a device while something goes wrong: the device or the page is gone, the force is clamped, the clock
// leaps, the disk is full. No trial is lost or counted twice.
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/experiment/record.h"
#include "tests/device/simulated_service.h"
#include "tests/e2e/process.h"
#include "tests/e2e/small_disk.h"
#include "tests/io/folder.h"
#include "tests/places.h"

namespace forceshade::experiment {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using device::test::Received;
using device::test::ServiceScript;
using device::test::SimulatedService;
using forceshade::testing::Folder;
using forceshade::testing::Launch;
using forceshade::testing::Outcome;
using forceshade::testing::Process;
using forceshade::testing::says;
using forceshade::testing::SmallDisk;
using forceshade::testing::with;
using Clock = std::chrono::steady_clock;

// Whether it comes about within 20 s.
bool await(const std::function<bool()>& condition) {
    for (const auto begin = Clock::now(); Clock::now() - begin < std::chrono::seconds(20);) {
        if (condition())
            return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

/// The participant's page without a browser: tells that it lives, remembers what it was told last.
class Page {
public:
    explicit Page(const std::string& address) : socket_(io_) {
        const std::size_t port = address.find(':', 7) + 1, path = address.find('/', port);
        socket_.next_layer().connect(
            {asio::ip::make_address("127.0.0.1"), static_cast<unsigned short>(std::stoi(address.substr(port)))});
        socket_.handshake(address.substr(7, path - 7), address.substr(path));
        reader_ = std::thread([this] {
            boost::beast::flat_buffer buffer;
            for (boost::beast::error_code error; socket_.read(buffer, error), !error; buffer.clear()) {
                const std::lock_guard lock(mutex_);
                state_ = nlohmann::json::parse(boost::beast::buffers_to_string(buffer.data()));
            }
        });
        heart_ = std::jthread([this](const std::stop_token& stop) {
            for (; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(200)))
                say({{"type", "alive"}});
        });
    }
    ~Page() {
        vanish();
        heart_ = {};
        reader_.join();
    }
    void vanish() { ::shutdown(socket_.next_layer().native_handle(), SHUT_RDWR); }
    void say(const nlohmann::json& json) {
        const std::lock_guard lock(writing_);
        boost::beast::error_code gone;
        socket_.write(asio::buffer(json.dump()), gone);
    }
    /// Once the stimulus was touched.
    void answer(unsigned key) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        answer_now(key);
    }
    void answer_now(unsigned key) { say({{"type", "answer"}, {"sequence", told("sequence")}, {"answer", key - 1}}); }
    nlohmann::json told(const char* what) const {
        const std::lock_guard lock(mutex_);
        return state_.value(what, nlohmann::json());
    }
    bool reaches(const char* phase) const {
        return await([&] { return told("phase") == phase; });
    }
    /// Answers every trial until the end.
    void finish() {
        EXPECT_TRUE(await([&] {
            if (told("phase") == "feel")
                answer(1);
            else if (told("phase") == "rest" || told("phase") == "pause" || told("phase") == "welcome")
                say({{"type", "go"}});
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            return told("phase") == "done";
        }));
    }

private:
    asio::io_context io_;
    websocket::stream<asio::ip::tcp::socket> socket_;
    mutable std::mutex mutex_; // of the state
    std::mutex writing_;
    nlohmann::json state_ = nlohmann::json::object();
    std::thread reader_;
    std::jthread heart_;
};

// A probe that swings down onto the bump's crest, twice a second.
ServiceScript swinging() {
    ServiceScript script;
    script.center = {0, 0, 0.009};
    script.amplitude = {0.002, 0.001, 0.004};
    script.frequency = 2;
    return script;
}

// How often each trial counts.
std::map<std::uint64_t, int> answers_in(const std::vector<TrialRow>& rows) {
    std::map<std::uint64_t, int> answers;
    for (const TrialRow& row : rows)
        answers[row.number] += row.counts();
    return answers;
}

class FaultySession : public ::testing::Test {
protected:
    FaultySession() {
        folder.write("e.toml", "[experiment]\ntrials = 1\n[surface]\nradius = \"600 mil\"\nfacets = 2\n"
                               "[force]\nstiffness = \"0.5 N/mm\"\nshading = [\"none\", \"reference\"]\n");
    }

    void start(const std::vector<std::string>& further = {},
               const std::map<std::string, std::string>& environment = {}) {
        page.reset();
        Launch launch;
        launch.arguments = with({"experiment", "run", folder / "e.toml", "--subject", "03", "--out", data, "--device",
                                 "haply:" + service.url(), "--patience", "0.3 s"},
                                further);
        launch.environment.insert(environment.begin(), environment.end());
        launch.error = folder / "stderr.txt";
        std::filesystem::remove(launch.error);
        process = std::make_unique<Process>(launch);
        ASSERT_TRUE(await([&] { return bool(says(said(), "/operator\n")); })) << said();
        open_page();
        ASSERT_TRUE(await([&] { return page->told("phase") == "welcome" || page->told("phase") == "pause"; }));
        page->say({{"type", "go"}});
    }
    void open_page() {
        const std::string text = said();
        const std::size_t end = text.find("/participant\n") + 12;
        page = std::make_unique<Page>(text.substr(text.rfind("http://", end), end - text.rfind("http://", end)));
    }
    std::string said() const { return folder.read("stderr.txt"); }
    // More than one of a trial, where a busy machine's loop was late.
    std::vector<TrialRow> rows() const { return read_rows(data_files(data)[0]); }
    std::vector<Received> forces(Clock::time_point after) const {
        std::vector<Received> some;
        for (const Received& one : service.received())
            if (one.time > after && one.force != glm::dvec3(0))
                some.push_back(one);
        return some;
    }
    bool is_pushing() const { return !forces(Clock::now() - std::chrono::milliseconds(3)).empty(); }
    // Both trials are answered, each once.
    void expect_whole() { EXPECT_EQ(answers_in(last_rows(rows())), (std::map<std::uint64_t, int>{{1, 1}, {2, 1}})); }

    const Folder folder;
    const std::filesystem::path data = folder / "data";
    SimulatedService service{swinging()};
    std::unique_ptr<Process> process;
    std::unique_ptr<Page> page;
};

TEST_F(FaultySession, ADeviceThatIsLostInATrialMarksItAndTheSameCommandRepeatsIt) {
    start();
    ASSERT_TRUE(page->reaches("feel"));
    ASSERT_TRUE(await([&] { return is_pushing(); }));
    service.go_away();
    const Outcome outcome = process->wait();
    EXPECT_EQ(outcome.code, 3);
    EXPECT_TRUE(says(said(), "is gone", "the same command goes on"));
    ASSERT_EQ(rows().size(), 1u);
    EXPECT_EQ(rows()[0].outcome.status, "device lost");
    EXPECT_FALSE(rows()[0].counts());
    service.come_back();
    start();
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_EQ(rows().back().number, 1u) << "it comes at the end";
    expect_whole();
}

TEST_F(FaultySession, AForceThatWasClampedMarksTheTrialAndItIsRepeated) {
    start({"--max-force", "0.05 N"});
    ASSERT_TRUE(page->reaches("feel"));
    ASSERT_TRUE(await([&] { // at the limit
        const auto some = forces({});
        return std::ranges::any_of(some, [](const Received& one) { return glm::length(one.force) > 0.0499; });
    }));
    page->answer(2);
    ASSERT_TRUE(await([&] { return page->told("trial") == 2; }));
    EXPECT_EQ(page->told("done"), 0) << "it does not count";
    ASSERT_TRUE(page->reaches("feel"));
    process->send(SIGINT);
    EXPECT_EQ(process->wait().code, 130);
    EXPECT_EQ(rows()[0].outcome.status, "force clamped");
    start();
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    expect_whole();
}

TEST_F(FaultySession, ATrialThatFailsAgainAndAgainIsLeftOut) {
    std::string text = folder.read("e.toml");
    text.replace(text.find("trials = 1"), 10, "trials = 1\nmax_repeats = 1");
    folder.write("e.toml", text);
    start({"--max-force", "0.05 N"});
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_EQ(rows().size(), 4u) << "two trials, each once more";
    for (const TrialRow& row : rows()) // off: of a loop that is late on a busy machine
        EXPECT_TRUE(row.outcome.status == "force clamped" || row.outcome.status == "force off") << row.outcome.status;
    EXPECT_TRUE(says(said(), "2 trials failed more than max_repeats = 1 times and are left out"));
}

// As a Touch does (0.88 N), a device may lower its force for its motors' sake at any time: that is data.
TEST_F(FaultySession, AForceThatIsLoweredForTheMotorsIsRecordedAndCounts) {
    start({"--lasting-force", "0.02 N"});
    EXPECT_TRUE(says(said(), "displays 0.02 N for long, which 0.5 N/mm has 0.04 mm deep"));
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    expect_whole();
    double largest = 0;
    for (const TrialRow& row : rows())
        largest = std::max(largest, row.outcome.limited);
    EXPECT_GT(largest, 0);
}

TEST_F(FaultySession, ATrialInWhichTheDeviceWithheldItsForceIsRepeated) {
    start();
    ASSERT_TRUE(page->reaches("feel"));
    ASSERT_TRUE(await([&] { return is_pushing(); }));
    service.set(device::test::Fault::not_ready);
    std::this_thread::sleep_for(std::chrono::milliseconds(600)); // a whole swing
    service.set(device::test::Fault::none);
    page->answer(1);
    ASSERT_TRUE(await([&] { return !rows().empty(); }));
    EXPECT_EQ(rows()[0].outcome.status, "force off");
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    expect_whole();
}

TEST_F(FaultySession, AnAnswerWithoutContactOrBeforeItsTimeIsNone) {
    start();
    ASSERT_TRUE(page->reaches("feel"));
    page->answer_now(1);
    EXPECT_TRUE(page->reaches("again"));
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_TRUE(rows()[0].outcome.status == "no contact" || rows()[0].outcome.status == "too early");
    expect_whole();
}

TEST_F(FaultySession, WhatAPageSaysOfAnotherTypeEndsNothing) {
    start();
    for (const nlohmann::json& odd : {nlohmann::json{{"type", 5}},
                                      {{"type", "answer"}, {"sequence", "one"}, {"answer", 0}},
                                      {{"type", "answer"}, {"sequence", nullptr}, {"answer", "x"}},
                                      {{"type", nlohmann::json::array()}},
                                      nlohmann::json::array({1, 2}),
                                      nlohmann::json("text")})
        page->say(odd);
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    expect_whole();
}

// Measured at the device: forces that it was sent after the page's connection broke.
TEST_F(FaultySession, APageThatIsClosedSwitchesTheForceOffWithinTwoSamples) {
    std::size_t fewest = 1000;
    start();
    for (int attempt = 0; attempt < 6 && fewest > 2; ++attempt) { // a busy machine may not wake us in time
        ASSERT_TRUE(page->reaches("feel"));
        ASSERT_TRUE(await([&] { return is_pushing(); }));
        const Clock::time_point closed = Clock::now();
        page->vanish();
        std::this_thread::sleep_for(std::chrono::milliseconds(1200)); // two swings
        fewest = std::min(fewest, forces(closed).size());
        open_page();
        ASSERT_TRUE(page->reaches("pause"));
        page->say({{"type", "go"}});
    }
    EXPECT_LE(fewest, 2u);
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_EQ(rows()[0].outcome.status, "interrupted");
    expect_whole();
}

TEST_F(FaultySession, AClockThatLeapsChangesNoTrial) {
    start({}, {{"LD_PRELOAD", module_of("e2e", "leaping_clock")},
               {"LEAP_AFTER", "1"},
               {"LEAP_WITNESS", (folder / "witness").string()}});
    ASSERT_TRUE(std::filesystem::exists(folder / "witness")) << "the clock was in place";
    ASSERT_TRUE(page->reaches("feel"));
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_GT(rows()[0].outcome.reaction, 1.4);
    for (const TrialRow& row : rows())
        EXPECT_LT(row.outcome.reaction, 30) << "an hour would be more";
    expect_whole();
}

TEST_F(FaultySession, AnswersWhileAStimulusIsLoadedOrTwiceDoNotCount) {
    start();
    for (int i = 0; i < 200 && page->told("phase") != "feel"; ++i) {
        page->answer_now(3); // in welcome and loading
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(page->reaches("feel"));
    page->say({{"type", "answer"}, {"sequence", 7}, {"answer", 1}});   // of no stimulus
    page->say({{"type", "answer"}, {"sequence", 1}, {"answer", 99}});  // no such key
    page->say({{"type", "answer"}, {"sequence", 1}, {"answer", "1"}}); // no number
    page->answer(2);
    page->answer_now(4);
    ASSERT_TRUE(await([&] { return page->told("trial") == 2; }));
    page->finish();
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_EQ(rows()[0].answer, "two_poly");
    EXPECT_EQ(answers_in(rows()), (std::map<std::uint64_t, int>{{1, 1}, {2, 1}})) << "of all rows, not the last alone";
}

TEST(FullDisks, LoseNoTrialAndCountNoneTwice) {
    const Folder folder;
    const SmallDisk disk(folder / "disk", "size=160k");
    if (disk.bad())
        GTEST_SKIP() << "mounting is not permitted";
    const std::filesystem::path data = folder / "disk/data";
    Launch launch;
    launch.arguments = {"experiment", "run", "--participant", "observer", "--subject", "01", "--out", data};
    Outcome outcome = Process(launch).wait();
    EXPECT_EQ(outcome.code, 4);
    EXPECT_TRUE(says(outcome.error, "o space left"));
    EXPECT_EQ(std::filesystem::status(data_files(data)[0]).permissions(), std::filesystem::perms(0600));
    EXPECT_EQ(std::filesystem::status(data).permissions(), std::filesystem::perms(0700));
    const std::size_t kept = read_rows(data_files(data)[0]).size();
    EXPECT_GT(kept, 10u);
    EXPECT_LT(kept, 504u);
    ASSERT_TRUE(disk.change(0, "size=30m"));
    outcome = Process(launch).wait();
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    const auto answered = answers_in(read_rows(data_files(data)[0]));
    EXPECT_EQ(answered.size(), 504u);
    EXPECT_TRUE(std::ranges::all_of(answered, [](const auto& one) { return one.second == 1; }));
}

} // namespace
} // namespace forceshade::experiment
