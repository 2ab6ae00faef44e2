// The report of a live run: as text, JSON and page, and as files.
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "device/run_report/report.h"
#include "device/run_report/text.h"
#include "host/error.h"
#include "host/output/json.h"
#include "host/program.h"
#include "tests/device/report_cases.h"
#include "tests/io/folder.h"

namespace forceshade::device::test {
namespace {

using forceshade::testing::Folder;
using forceshade::testing::lines_of;
using forceshade::testing::message_of;
using forceshade::testing::says;

TEST(ReportJson, CanBeReadAgainWhateverItIsTold) {
    for (const auto& [file, outcome] : cases()) {
        const Json json = report_json(outcome);
        Json again;
        ASSERT_NO_THROW(again = Json::parse(json.dump(2))) << file;
        EXPECT_EQ(again, json) << file;
        EXPECT_EQ(json["version"], version());
        for (const char* times : {"compute", "read", "write", "late", "jitter"}) {
            std::uint64_t counted = 0, end = 0;
            for (const Json& bin : json[times]["histogram"]) {
                EXPECT_GE(bin["from_ns"].get<std::uint64_t>(), end);
                end = bin["to_ns"].get<std::uint64_t>();
                EXPECT_GT(bin["count"].get<std::uint64_t>(), 0u);
                counted += bin["count"].get<std::uint64_t>();
            }
            EXPECT_EQ(json[times]["count"], counted) << file << " " << times;
        }
    }
}

TEST(ReportJson, HoldsWhatTheRunCameTo) {
    const LiveOutcome outcome = usual(1000);
    const Json json = report_json(outcome);
    const Json expected{{"/scene", "bump.toml"},
                        {"/precision", "f64"},
                        {"/device/asked_for", "sim"},
                        {"/device/max_force_N", 3.3},
                        {"/device/simulated", true},
                        {"/rate_Hz", 1000},
                        {"/real_time", true},
                        {"/ended", "after 60 s"},
                        {"/elapsed_s", 60},
                        {"/samples", 60000},
                        {"/waiting", 12},
                        {"/in_contact", 41230},
                        {"/paths", 1},
                        {"/largest_force_N", 3.214},
                        {"/largest_commanded_N", 3},
                        {"/largest_depth_m", 2.14e-3},
                        {"/largest_speed_m_per_s", 0.251},
                        {"/energy_J", -1.25e-3},
                        {"/largest_energy_J", 3.4e-4},
                        {"/damped_J", 0},
                        {"/log/file", "live.csv"},
                        {"/log/samples", 60000},
                        {"/log/lost", 0},
                        {"/sent/to", nullptr},
                        {"/limits/max_slew", "1 N/ms"},
                        {"/permissions/0/what", "SCHED_FIFO"},
                        {"/permissions/0/granted", false},
                        {"/permissions/1/detail", "all pages"},
                        {"/happened/clamped", 12},
                        {"/happened/overrun", 3},
                        {"/happened/own_overrun", 0},
                        {"/compute/p50_ns", outcome.counts.computing.quantile(0.5)},
                        {"/compute/p99_ns", outcome.counts.computing.quantile(0.99)},
                        {"/compute/p99_9_ns", outcome.counts.computing.quantile(0.999)},
                        {"/late/largest_ns", outcome.counts.late.largest()},
                        {"/jitter/mean_ns", outcome.counts.jitter.mean()},
                        {"/read/p50_ns", outcome.counts.reading.quantile(0.5)},
                        {"/write/p50_ns", outcome.counts.writing.quantile(0.5)}};
    for (const auto& [place, value] : expected.items())
        EXPECT_EQ(json.at(Json::json_pointer(place)), value) << place;
    EXPECT_EQ(json["happened"].size(), kSampleFlagNames.size());
    EXPECT_EQ(report_json(talkative())["sent"],
              (Json{{"to", "udp:127.0.0.1:5005"}, {"samples", 59900}, {"dropped", 100}}));
}

TEST(ReportJson, WhatIsNoNumberIsNull) {
    const Json json = report_json(beyond());
    EXPECT_TRUE(json["largest_force_N"].is_null());
    EXPECT_TRUE(json["energy_J"].is_null());
    EXPECT_TRUE(json["device"]["max_force_N"].is_null());
    EXPECT_TRUE(json["device"]["workspace_low_m"][2].is_null());
    const Json none = report_json(no_sample());
    EXPECT_TRUE(none["compute"]["p50_ns"].is_null());
    EXPECT_TRUE(none["compute"]["largest_ns"].is_null());
    EXPECT_TRUE(none["log"]["file"].is_null());
    EXPECT_EQ(none["compute"]["histogram"], Json::array());
}

TEST(Units, ThreeDigitsAndAPrefix) {
    EXPECT_EQ(quantity(0, "N"), "0 N");
    EXPECT_EQ(quantity(3.2144, "N"), "3.21 N");
    EXPECT_EQ(quantity(-1.25e-3, "J"), "-1.25 mJ");
    EXPECT_EQ(quantity(1000, "Hz"), "1 kHz");
    EXPECT_EQ(quantity(999.6, "Hz"), "1 kHz") << "rounded up into the next prefix";
    EXPECT_EQ(quantity(99.96, "Hz"), "100 Hz");
    EXPECT_EQ(quantity(2e-6, "m"), "2 um");
    EXPECT_EQ(quantity(2e-6, "m", {false, "µ"}), "2 µm");
    EXPECT_EQ(quantity(1234.4, "m"), "1234 m");
    EXPECT_EQ(quantity(3600, "s"), "3600 s");
    EXPECT_EQ(quantity(1e300, "J"), "1.00e+300 J");
    EXPECT_EQ(quantity(5e-324, "J"), "4.94e-324 J");
    EXPECT_EQ(quantity(INFINITY, "N"), "unknown");
    EXPECT_EQ(quantity(NAN, "N"), "unknown");
}

TEST(Units, SharesAreNeitherNoneOfSomeNorAllOfFewer) {
    EXPECT_EQ(share_text(0, 10), " (0 %)");
    EXPECT_EQ(share_text(10, 10), " (100 %)");
    EXPECT_EQ(share_text(3, 60000), " (0.005 %)");
    EXPECT_EQ(share_text(999'999, 1'000'000), " (> 99.9 %)");
    EXPECT_EQ(share_text(1, 100'000'000), " (10 in 10^9)");
    EXPECT_EQ(share_text(0, 0), "");
}

TEST(ReportText, FitsATerminalWhateverItIsTold) {
    for (const auto& [file, outcome] : cases()) {
        const std::string text = report_text(outcome);
        EXPECT_TRUE(text.ends_with('\n')) << file;
        for (const std::string& line : lines_of(text)) {
            EXPECT_EQ(cut_to_columns(line, kColumns), line) << file << ": " << line;
            EXPECT_FALSE(line.ends_with(' ')) << file << ": " << line;
        }
        EXPECT_FALSE(says(text, "\x1b")) << file << ": no device's name speaks to the terminal";
        EXPECT_FALSE(says(text, "nan")) << file;
        EXPECT_FALSE(says(text, "inf ")) << file;
    }
}

TEST(ReportText, SaysWhatWasLostAndRemarked) {
    const std::string text = report_text(talkative());
    EXPECT_TRUE(says(text, "17 samples LOST",
                     "sent          udp:127.0.0.1:5005: 59900 samples, 100 samples DROPPED: Connection refused",
                     "note          the scene bump2.toml was refused", "2 mJ taken out by the passivity"));
    for (const std::string_view name : kSampleFlagNames)
        EXPECT_NE(bool(says(text, name)), name.ends_with("overrun")) << name;
}

TEST(LivePage, IsThereOfEveryRun) {
    for (const Case& one : cases())
        EXPECT_TRUE(live_page(one.outcome).ends_with("</html>\n")) << one.file;
}

// By the names of its columns, whatever their order, and thinned.
TEST(LivePage, HasTheSamplesOfTheLog) {
    const Folder folder;
    std::string log = "t,path,x,y,z,depth,fx,fy,fz\n";
    for (int i = 0; i < 9000; ++i)
        log += fmt::format("{},7,0.012,{},-0.001,0.001,3,0,4\n", i * 1e-3, i * 1e-6);
    const std::string page = live_page(usual(1000), folder.write("log.csv", log));
    EXPECT_TRUE(says(page, "One of 4 samples is shown", "\"of\":[\"path 7\"]"));
    EXPECT_TRUE(says(page, "\"of\":[12.0]")) << "mm";
    EXPECT_TRUE(says(page, "\"of\":[5.0]")) << "N";
    EXPECT_TRUE(says(page, "\"of\":[36.86989764584402]")) << "deg";
    EXPECT_FALSE(says(live_page(usual(1000)), "samples is shown"));
}

TEST(TimeBars, HoldEveryTimeOnceSideBySide) {
    Histogram times;
    std::uint64_t count = 0;
    for (std::int64_t time = 0; time < 100'000'000; time = time + 1 + time / 100, ++count)
        times.add(time);
    std::uint64_t counted = 0, end = 0;
    for (const TimeBar& bar : time_bars(times, 20)) {
        EXPECT_EQ(bar.from, end) << "nothing between";
        EXPECT_LT(bar.from, bar.to);
        const double decades = std::log10(double(bar.to) / std::max(1.0, double(bar.from)));
        EXPECT_NEAR(decades, 0.05, bar.from > 100 ? 0.016 : 0.3);
        end = bar.to;
        counted += bar.count;
    }
    EXPECT_EQ(counted, count);
}

TEST(ReportFiles, AreTheTextTheJsonAndThePage) {
    const Folder folder;
    const LiveOutcome outcome = usual(1000);
    write_live_report(outcome, folder / "run.1");
    EXPECT_EQ(folder.read("run.1.txt"), report_text(outcome));
    EXPECT_EQ(folder.read("run.1.json"), report_json(outcome).dump(2) + "\n");
    EXPECT_EQ(folder.read("run.1.html"), live_page(outcome));
    EXPECT_EQ(folder.names().size(), 3u) << "and nothing else";
}

TEST(ReportFiles, AnErrorNamesWhatCouldNotBeWritten) {
    const Folder folder;
    EXPECT_TRUE(
        says(message_of<IoError>([&] { write_live_report(usual(1000), folder / "missing/run"); }), "missing/run.txt"));
    std::filesystem::create_directories(folder / "run.html/in_the_way");
    EXPECT_THROW(write_live_report(usual(1000), folder / "run"), IoError);
    EXPECT_EQ(folder.read("run.txt"), report_text(usual(1000))) << "the others are there";
}

} // namespace
} // namespace forceshade::device::test
