// Text for a person: numbers with units, lines that fit a terminal, histograms of times, and the status of the live
// loop while it runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device/loop/sample.h"
#include "host/numbers.h"

namespace forceshade::device {

struct NumberStyle {
    bool zeros = false;           // behind the point: "1.20 us" and not "1.2 us", to stand in a column
    std::string_view micro = "u"; // "µ" in a picture, with a true minus sign
};

/// `value` in the unit `base` to three significant digits: "412 ns", "-1.2 mJ", "3.4 kHz". Seconds and lengths have no
/// prefix for thousands. Infinity and NaN are "unknown".
std::string quantity(double value, std::string_view base, const NumberStyle& style = {});

/// A time in ns.
std::string time_text(double nanoseconds, const NumberStyle& style = {});

/// " (0.5 %)", empty for 0 of 0. "0 %" only of none, "100 %" only of all.
std::string share_text(std::uint64_t part, std::uint64_t whole);

using numbers::counted;

inline constexpr std::size_t kColumns = 100;

/// At most `columns` columns of UTF-8 text, a character each.
std::string_view cut_to_columns(std::string_view text, std::size_t columns);

class WrappedLines {
public:
    /// `label` in the first columns of the first line, the text to its right, broken at spaces, or anywhere if
    /// necessary. Unprintable characters are replaced.
    void add(std::string_view label, std::string_view text);
    /// A line as it is.
    void add_line(std::string_view line);

    const std::string& text() const noexcept { return text_; }

private:
    std::string text_;
};

struct NamedTimes {
    std::string_view name;
    const Histogram& times;
};

/// Times of [from, to) ns and their count.
struct TimeBar {
    std::uint64_t from = 0, to = 0, count = 0;
};

/// Neighbouring bins of a histogram put together, about `per_decade` of them to a power of ten; those with a count.
std::vector<TimeBar> time_bars(const Histogram& times, unsigned per_decade);

/// Lines of bars of '#' side by side, three rows to a power of ten, with counts; at least one '#' for a count above 0.
/// Rows of zeros are left out. Within 100 columns for up to two; empty without counts.
std::vector<std::string> count_rows(std::span<const NamedTimes> columns);

struct LiveStatus {
    double seconds = 0;        /* s since the start, by the clock */
    double rate = 0;           /* Hz: samples in the last while, by the clock */
    double force = 0;          /* N: commanded, its magnitude */
    double depth = 0;          /* m */
    std::uint64_t late = 0;    // samples: overruns
    std::uint64_t clamped = 0; // samples
    std::uint64_t lost = 0;    // samples that the log had no room for
    std::string state;         // in a word or two: "waiting for the device"; empty: no fault
};

/// "    12.3 s  1.00 kHz   1.23 N   520 um deep  3 late  12 clamped  ramping", with fixed columns.
std::string status_text(const LiveStatus& status);

/// Not for two threads at once. A stream that fails does not stop the work.
class StatusLine {
public:
    /// Silent if `quiet`.
    explicit StatusLine(bool quiet, std::FILE* stream = stderr);
    /// Erases the line.
    ~StatusLine();
    StatusLine(const StatusLine&) = delete;
    StatusLine& operator=(const StatusLine&) = delete;

    /// May be called at any rate: drawn at most 10 times a second of `seconds`, without a terminal once in 10 s.
    void update(const LiveStatus& status);

    /// Prints a line above that of the status, which comes again with the next update.
    void say(const std::string& line);

private:
    void put(const std::string& text);
    void clear();

    std::FILE* stream_;
    bool quiet_, terminal_, drawn_ = false;
    double next_; /* s: when to draw again */
};

} // namespace forceshade::device
