#include "device/run_report/status_line.h"

#include <utility>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "device/run_report/text.h"
#include "host/picture/canvas.h"

namespace forceshade::device {
namespace {

constexpr double kDrawEvery = 0.1; // s
constexpr double kLineEvery = 10;  // s, without a terminal

std::size_t width_of(std::FILE* terminal) {
    winsize size{};
    return ioctl(fileno(terminal), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kColumns;
}

} // namespace

std::string status_text(const LiveStatus& status) {
    const NumberStyle column{true, "u"};
    std::string text =
        fmt::format("{:>8.1f} s {:>9} {:>8} {:>8} deep  {} late  {} clamped", status.seconds,
                    status.rate > 0 ? quantity(status.rate, "Hz", column) : "", quantity(status.force, "N", column),
                    quantity(status.depth, "m", column), status.late, status.clamped);
    if (status.lost > 0)
        text += fmt::format("  {} LOST", status.lost);
    if (!status.state.empty())
        text += "  " + picture::printable(status.state);
    return text;
}

StatusLine::StatusLine(bool quiet, std::FILE* stream)
    : stream_(stream), quiet_(quiet), terminal_(isatty(fileno(stream)) == 1), next_(terminal_ ? 0 : kLineEvery) {}

StatusLine::~StatusLine() {
    clear();
}

void StatusLine::put(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stream_);
    std::fflush(stream_);
}

void StatusLine::clear() {
    if (std::exchange(drawn_, false))
        put("\r\033[K");
}

void StatusLine::say(const std::string& line) {
    if (quiet_)
        return;
    clear();
    put(line + "\n");
    next_ = terminal_ ? 0 : next_;
}

void StatusLine::update(const LiveStatus& status) {
    if (quiet_ || status.seconds < next_)
        return;
    next_ = status.seconds + (terminal_ ? kDrawEvery : kLineEvery);
    const std::string text = status_text(status);
    if (!terminal_)
        return put(std::string(cut_to_columns(text, kColumns)) + "\n");
    put(fmt::format("\r\033[K{}", cut_to_columns(text, width_of(stream_) - 1)));
    drawn_ = true;
}

} // namespace forceshade::device
