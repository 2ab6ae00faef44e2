// How far long work has come: a bar with the time left on a terminal, now and then a line elsewhere, on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace forceshade {

class Progress {
public:
    /// `total` steps of `what` ("cases"). Silent if `quiet`.
    Progress(std::string what, std::size_t total, bool quiet);
    ~Progress();

    /// `done` steps have ended, `now` is the last of them. Not for two threads at once.
    void update(std::size_t done, const std::string& now);

    /// A line of its own, above the bar.
    void say(const std::string& line);

private:
    using Clock = std::chrono::steady_clock;
    void clear();

    std::string what_;
    std::size_t total_;
    bool quiet_, terminal_, drawn_ = false;
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// "0:07", "12:40", "3:05:00".
std::string clock_text(double seconds);

} // namespace forceshade
