// The end report in words: numbers and their units, what it says of each run, and that it fits a terminal.
#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "device/report/report.h"
#include "device/report/text.h"
#include "tests/device/report_cases.h"

namespace forceshade::device::test {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Units, three_digits_and_a_prefix) {
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

TEST(Units, times) {
    EXPECT_EQ(time_text(0), "0 s");
    EXPECT_EQ(time_text(5, {true, "u"}), "5 ns");
    EXPECT_EQ(time_text(1200, {true, "u"}), "1.20 us");
    EXPECT_EQ(time_text(999999), "1 ms");
    EXPECT_EQ(time_text(1e9), "1 s");
    EXPECT_EQ(time_text(static_cast<double>(std::numeric_limits<std::uint64_t>::max())), "18446744074 s");
}

TEST(Units, shares_are_neither_none_of_some_nor_all_of_fewer) {
    EXPECT_EQ(share_text(0, 10), " (0 %)");
    EXPECT_EQ(share_text(10, 10), " (100 %)");
    EXPECT_EQ(share_text(3, 60000), " (0.005 %)");
    EXPECT_EQ(share_text(999'999, 1'000'000), " (> 99.9 %)");
    EXPECT_EQ(share_text(1, 100'000'000), " (10 in 10^9)");
    EXPECT_EQ(share_text(0, 0), "");
}

TEST(CountRows, count_every_time_and_two_columns_share_their_rows) {
    Histogram many, few;
    for (int i = 0; i < 100000; ++i)
        many.add(15);
    many.add(30);
    few.add(30);
    few.add(1'000'000'000);
    const std::vector<NamedTimes> columns{{"compute", many}, {"jitter", few}};
    const std::vector<std::string> rows = count_rows(columns);
    ASSERT_EQ(rows.size(), 4u) << "no row without a time";
    EXPECT_TRUE(says(rows[1], "10 ns to    22 ns  " + std::string(27, '#') + " 100000 ")) << rows[1];
    EXPECT_TRUE(says(rows[2], "  # 1 ")) << rows[2];
    EXPECT_EQ(rows[2].find(std::string(27, '#')), rows[0].find("jitter"));
    EXPECT_TRUE(count_rows({}).empty());
}

TEST(ReportText, fits_a_terminal_whatever_it_is_told) {
    for (const auto& [file, outcome] : cases()) {
        const std::string text = report_text(outcome);
        EXPECT_TRUE(text.ends_with('\n')) << file;
        for (const std::string& line : lines_of(text)) {
            EXPECT_EQ(cut_to_columns(line, kColumns), line) << file << ": " << line;
            EXPECT_FALSE(line.ends_with(' ')) << file << ": " << line;
        }
        EXPECT_EQ(text.find('\x1b'), std::string::npos) << file << ": no device's name speaks to the terminal";
        EXPECT_EQ(text.find("nan"), std::string::npos) << file;
        EXPECT_EQ(text.find("inf "), std::string::npos) << file;
    }
}

TEST(ReportText, says_how_a_run_went) {
    const std::string text = report_text(usual(1000));
    for (const char* part :
         {"bump.toml (f64)", "sim, simulated hand, at most 3.3 N", "60000 samples in 60 s at 1 kHz",
          "SCHED_FIFO: NOT granted: Operation not permitted; run as root", "memory lock: granted, all pages",
          "3 samples late (0.005 %), 0 of them by our own computing", "41230 in contact (68.7 %)", "12 ticks without",
          "safety        clamped 12, ramping 200\n", "max_force 3 N, max_slew 1 N/ms",
          "force 3.21 N by the law, 3 N commanded; depth 2.14 mm; speed 251 mm/s",
          "-1.25 mJ given to the hand at the end, 340 uJ at most", "live.csv: 60000 samples, none lost", "p99.9"})
        EXPECT_TRUE(says(text, part)) << part << "\n" << text;
    EXPECT_LE(lines_of(text).size(), 40u);
}

TEST(ReportText, its_table_holds_the_quantiles) {
    LiveOutcome outcome = usual(1000);
    outcome.counts.computing = {};
    for (int i = 0; i < 998; ++i)
        outcome.counts.computing.add(20);
    outcome.counts.computing.add(30);
    outcome.counts.computing.add(4'000'000);
    const std::string text = report_text(outcome);
    EXPECT_TRUE(says(text, "  compute            21 ns       21 ns       31 ns     4.00 ms\n")) << text;
}

TEST(ReportText, says_what_was_lost_and_remarked) {
    const std::string text = report_text(talkative());
    EXPECT_TRUE(says(text, "17 samples LOST"));
    EXPECT_TRUE(says(text, "sent          udp:127.0.0.1:5005: 59900 samples, 100 samples DROPPED: Connection refused"));
    EXPECT_TRUE(says(text, "note          the scene bump2.toml was refused"));
    EXPECT_TRUE(says(text, "2 mJ taken out by the passivity controller") || says(text, "passivity"));
    for (const std::string_view name : kSampleFlagNames)
        EXPECT_NE(says(text, std::string(name)), name.ends_with("overrun")) << name;
}

TEST(ReportText, speaks_of_no_lateness_as_fast_as_possible) {
    const std::string text = report_text(as_fast_as_possible());
    EXPECT_TRUE(says(text, "1935 times"));
    EXPECT_TRUE(says(text, "no sample is due at any time"));
    EXPECT_FALSE(says(text, "jitter "));
}

} // namespace
} // namespace forceshade::device::test
