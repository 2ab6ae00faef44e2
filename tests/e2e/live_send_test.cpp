// Samples of a live loop in UDP datagrams: what arrives is what the log says, and nobody who is absent or slow is
// waited for.
#include <array>
#include <charconv>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/device/inbox.h"
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

constexpr std::array<const char*, 16> kSent{"t",  "x",  "y",  "z",  "gx", "gy",    "gz",    "fx",
                                            "fy", "fz", "cx", "cy", "cz", "depth", "facet", "tick"};

Outcome take_until_end_of(Process& process, Inbox& inbox) {
    while (process.running()) {
        inbox.take();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    inbox.take();
    return process.wait();
}

template <typename Number> std::string digits_of(Number value) {
    char digits[40];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

class LiveSend : public Live {
protected:
    // By the clock for a second, with a log.
    Launch sent(const std::string& to, const std::vector<std::string>& further = {},
                const std::string& log = "log.csv") const {
        return launch(with(
            live("hand.toml", {"--duration", "1 s", "--log", log, "--overwrite", "--json", "--send", to}), further));
    }
};

TEST_F(LiveSend, WhatArrivesIsTheLogDigitForDigit) {
    for (const std::string precision : {"f64", "f32"})
        for (const bool is_six : {false, true}) {
            SCOPED_TRACE(precision + (is_six ? " to ::1" : ""));
            Inbox inbox(is_six);
            if (!inbox.is_there)
                continue; // a machine without IPv6
            Process process(
                sent(fmt::format("udp:{}{}", is_six ? "[::1]:" : "", inbox.port), {"--precision", precision}));
            const Outcome outcome = take_until_end_of(process, inbox);
            ASSERT_EQ(outcome.code, 0) << outcome.error;
            const Rows log = rows("log.csv");
            ASSERT_EQ(log.size(), 1000u);
            ASSERT_EQ(inbox.samples.size(), log.size());
            const std::set<std::string> of_the_law{"x", "y", "z", "gx", "gy", "gz", "fx", "fy", "fz", "depth"};
            std::size_t in_contact = 0;
            for (std::size_t i = 0; i < log.size(); ++i)
                for (std::size_t column = 0; column < kSent.size(); ++column) {
                    const std::string name = kSent[column];
                    const double value = inbox.samples[i][column];
                    const bool single = precision == "f32" && of_the_law.contains(name);
                    ASSERT_EQ(single ? digits_of(static_cast<float>(value)) : digits_of(value), log[i].at(name))
                        << name << " of row " << i;
                    in_contact += name == "facet" && value >= 0;
                }
            EXPECT_GT(in_contact, 300u);
            const nlohmann::json said = nlohmann::json::parse(outcome.out)["sent"];
            EXPECT_EQ(said["to"], fmt::format("udp:{}:{}", is_six ? "[::1]" : "127.0.0.1", inbox.port));
            EXPECT_EQ(said["samples"], 1000);
            EXPECT_EQ(said["dropped"], 0);
            EXPECT_TRUE(says(outcome.error, "1000 samples, none dropped"));
        }
}

TEST_F(LiveSend, ToNobodyNeitherStopsNorSlowsTheRun) {
    const unsigned port = Inbox().port; // closed again
    const Outcome outcome = run(sent(fmt::format("udp:{}", port), {"--rate", "4 kHz"}));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    const nlohmann::json said = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(said["samples"], 4000);
    EXPECT_EQ(said["sent"]["dropped"], 4000);
    EXPECT_EQ(said["log"]["lost"], 0);
    EXPECT_LT(said["elapsed_s"], 1.2);
    EXPECT_TRUE(says(outcome.error, "4000 samples DROPPED: Connection refused: no receiver"));
    EXPECT_EQ(rows("log.csv").size(), 4000u);
}

TEST_F(LiveSend, GoesOnWhileNobodyEmptiesTheLogsPipe) {
    ::mkfifo(path("pipe").c_str(), 0600);
    const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    Inbox inbox;
    Process process(sent(fmt::format("udp:{}", inbox.port), {}, "pipe"));
    const Outcome outcome = take_until_end_of(process, inbox);
    ::close(reader);
    EXPECT_EQ(outcome.code, 4) << "the pipe";
    ASSERT_EQ(inbox.samples.size(), 1000u);
    for (std::size_t i = 0; i < inbox.samples.size(); ++i)
        ASSERT_EQ(inbox.samples[i].back(), double(i));
}

// As fast as possible nobody waits for the network: what it did not take is told.
TEST_F(LiveSend, TellsWhatCameTooFast) {
    Inbox inbox;
    const nlohmann::json said = json_of(
        live("bump.toml", {"--fast", "--duration", "100 s", "--json", "--send", fmt::format("udp:{}", inbox.port)}));
    EXPECT_EQ(said["sent"]["samples"].get<int>() + said["sent"]["dropped"].get<int>(), 100'000);
    EXPECT_GT(said["sent"]["samples"], 2000);
}

} // namespace
} // namespace forceshade::testing
