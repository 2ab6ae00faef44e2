#include "host/sweep/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <utility>

#include <sys/ioctl.h>

#include "host/remark.h"

namespace forceshade {
namespace {

constexpr double kLineEvery = 5;   // s between lines where there is no terminal
constexpr double kDrawEvery = 0.1; // s between drawings of the bar

std::size_t terminal_width() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

} // namespace

std::string clock_text(double seconds) {
    const auto whole = static_cast<long>(std::lround(std::max(0.0, seconds)));
    if (whole < 3600)
        return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

Progress::Progress(std::string what, std::size_t total, bool quiet)
    : what_(std::move(what)), total_(total), quiet_(quiet), terminal_(isatty(STDERR_FILENO)) {}

Progress::~Progress() {
    clear();
}

void Progress::clear() {
    if (std::exchange(drawn_, false))
        remark("\r\033[K");
}

void Progress::say(const std::string& line) {
    if (quiet_)
        return;
    clear();
    remark("{}\n", line);
}

void Progress::update(std::size_t done, const std::string& now) {
    if (quiet_ || total_ == 0)
        return;
    const Clock::time_point time = Clock::now();
    const double since_last = std::chrono::duration<double>(time - last_).count();
    const bool last = done == total_;
    if (!last && since_last < (terminal_ ? kDrawEvery : kLineEvery))
        return;
    last_ = time;
    const double elapsed = std::chrono::duration<double>(time - start_).count();
    const double left = done ? elapsed * static_cast<double>(total_ - done) / static_cast<double>(done) : 0;
    const std::string tail = last ? fmt::format("{}/{} {} in {}", done, total_, what_, clock_text(elapsed))
                                  : fmt::format("{}/{} {}, {} left  {}", done, total_, what_, clock_text(left), now);
    if (!terminal_) {
        remark("{}\n", tail);
        return;
    }
    constexpr std::size_t kBar = 24;
    const std::size_t filled = done * kBar / total_;
    std::string line = fmt::format("[{:=<{}}{:<{}}] {}", "", filled, "", kBar - filled, tail);
    line.resize(std::min(line.size(), terminal_width() - 1));
    remark("\r\033[K{}", line);
    drawn_ = true;
    if (last) {
        remark("\n");
        drawn_ = false;
    }
}

} // namespace forceshade
