// The end report's page: the times of its samples, and what the log holds.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "device/report/report.h"
#include "device/report/text.h"
#include "tests/device/report_cases.h"

namespace forceshade::device::test {
namespace {

// Without the scripts, which know names, too.
std::size_t times_said(std::string page, std::string_view part) {
    page.resize(page.find("<script>const"));
    std::size_t count = 0;
    for (std::size_t at = page.find(part); at != std::string::npos; at = page.find(part, at + 1))
        ++count;
    return count;
}

TEST(LivePage, is_there_of_every_run) {
    for (const Case& one : cases())
        EXPECT_TRUE(live_page(one.outcome).ends_with("</html>\n")) << one.file;
}

TEST(LivePage, marks_quantiles_and_the_period) {
    const std::string page = live_page(usual(1000));
    for (const char* label : {"\"p50 ", "\"p99 ", "\"p99.9 ", "\"largest "})
        EXPECT_EQ(times_said(page, label), 3u) << label;
    for (const char* label : {"p50 424 ns", "period 1 ms", "bump.toml (f64), live at 1 kHz", "60000 samples in 60 s"})
        EXPECT_GE(times_said(page, label), 1u) << label;
}

TEST(LivePage, shows_no_lateness_as_fast_as_possible_and_says_so) {
    const std::string page = live_page(as_fast_as_possible());
    for (const char* label : {"jitter: the time", "late: woken"})
        EXPECT_EQ(times_said(page, label), 0u) << label;
    EXPECT_EQ(times_said(page, "\"p50 "), 1u);
    EXPECT_EQ(times_said(page, "no sample is due at any time"), 1u);
}

// By the names of its columns, whatever their order, and thinned.
TEST(LivePage, has_the_samples_of_the_log) {
    const std::filesystem::path log = std::filesystem::temp_directory_path() / "live_page_test.csv";
    std::ofstream stream(log);
    stream << "t,path,x,y,z,depth,fx,fy,fz\n";
    for (int i = 0; i < 9000; ++i)
        stream << i * 1e-3 << ",7,0.012," << i * 1e-6 << ",-0.001,0.001,3,0,4\n";
    stream.close();
    const std::string page = live_page(usual(1000), log);
    std::filesystem::remove(log);
    EXPECT_NE(page.find("One of 4 samples is shown"), std::string::npos);
    EXPECT_NE(page.find("\"of\":[\"path 7\"]"), std::string::npos);
    EXPECT_NE(page.find("\"of\":[12.0]"), std::string::npos) << "mm";
    EXPECT_NE(page.find("\"of\":[5.0]"), std::string::npos) << "N";
    EXPECT_NE(page.find("\"of\":[36.86989764584402]"), std::string::npos) << "deg";
    EXPECT_EQ(live_page(usual(1000)).find("samples is shown"), std::string::npos);
}

TEST(TimeBars, hold_every_time_once_side_by_side) {
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

} // namespace
} // namespace forceshade::device::test
