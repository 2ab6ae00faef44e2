// How the live loop fares while it runs: a line on a terminal, rewritten in place; elsewhere a line now and then.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

#include "device/loop/outcome.h"

namespace forceshade::device {

/// "    12.3 s  1.00 kHz   1.23 N   520 um deep  3 late  12 clamped  ramping", what changes often in its place.
std::string status_text(const LiveStatus& status);

/// Not for two threads at once. A stream that takes nothing stops no work.
class StatusLine {
public:
    /// Silent if `quiet`.
    explicit StatusLine(bool quiet, std::FILE* stream = stderr);
    /// Erases the line.
    ~StatusLine();
    StatusLine(const StatusLine&) = delete;
    StatusLine& operator=(const StatusLine&) = delete;

    /// Called as often as one likes: drawn at most 10 times a second of `seconds`, without a terminal once in 10 s.
    void update(const LiveStatus& status);

    /// A line of its own, above that of the status, which comes again with the next update.
    void say(const std::string& line);

private:
    void put(const std::string& text);
    void clear();

    std::FILE* stream_;
    bool quiet_, terminal_, drawn_ = false;
    double next_; /* s: when to draw again */
};

} // namespace forceshade::device
