// The status of the live loop while it runs: a line on a terminal, rewritten in place; elsewhere a line now and then.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace forceshade::device {

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
