#include "device/run_report/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "host/spelling.h"

namespace forceshade::device {

namespace {

constexpr std::size_t kIndent = 14; // columns

bool begins_character(char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

// The part that fits on a line, at most `columns` > 0 wide; removed from `rest` with the space behind.
std::string_view take_line(std::string_view& rest, std::size_t columns) {
    std::string_view line = cut_to_columns(rest, columns);
    if (line.size() < rest.size() && rest[line.size()] != ' ')
        if (const std::size_t space = line.rfind(' '); space != std::string_view::npos && space > 0)
            line = line.substr(0, space);
    rest.remove_prefix(line.size());
    while (rest.starts_with(' '))
        rest.remove_prefix(1);
    return line;
}

constexpr double kDrawEvery = 0.1; // s
constexpr double kLineEvery = 10;  // s, without a terminal

std::size_t width_of(std::FILE* terminal) {
    winsize size{};
    return ioctl(fileno(terminal), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kColumns;
}

} // namespace

std::string quantity(double value, std::string_view base, const NumberStyle& style) {
    if (!std::isfinite(value))
        return "unknown";
    if (value == 0)
        return fmt::format("0 {}", base);
    const char* sign = value >= 0 ? "" : style.micro == "µ" ? "−" : "-";
    const double size = std::fabs(value);
    const std::string digits = fmt::format("{:.2e}", size);
    double rounded = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
    rounded *= 1 + 1e-12; // 1e-6 is a little less than that
    const int exponent = numbers::decade(rounded);
    const bool metric = base != "s" && !base.starts_with("m");
    if (!metric && exponent >= 3 && exponent < 15)
        return fmt::format("{}{:.0f} {}", sign, size, base);
    const numbers::Unit unit = numbers::choose_unit(rounded, base);
    if (unit.name.find(' ') != std::string::npos || (!metric && exponent >= 3)) // there is no prefix
        return fmt::format("{}{:.2e} {}", sign, size, base);
    const int decimals = 2 - exponent + unit.exponent;
    const double number = numbers::divide_by_power_of_ten(rounded, unit.exponent);
    std::string name = unit.name;
    if (name.starts_with("µ"))
        name.replace(0, std::string_view("µ").size(), style.micro);
    return fmt::format("{}{} {}", sign,
                       style.zeros ? numbers::decimal(number, decimals) : numbers::trimmed(number, decimals), name);
}

std::string time_text(double nanoseconds, const NumberStyle& style) {
    NumberStyle used = style;
    used.zeros = style.zeros && nanoseconds >= 999.5; // they are whole
    return quantity(nanoseconds * 1e-9, "s", used);
}

std::string share_text(std::uint64_t part, std::uint64_t whole) {
    if (whole == 0)
        return "";
    if (part == 0 || part >= whole)
        return part == 0 ? " (0 %)" : " (100 %)";
    const double percent = 100 * static_cast<double>(part) / static_cast<double>(whole);
    if (percent >= 99.95)
        return " (> 99.9 %)";
    if (percent < 0.001)
        return fmt::format(" ({:.0f} in 10^9)", std::max(1.0, percent * 1e7));
    const int decimals = percent >= 10 ? 1 : percent >= 1 ? 2 : percent >= 0.1 ? 3 : percent >= 0.01 ? 4 : 5;
    return fmt::format(" ({} %)", numbers::trimmed(percent, decimals));
}

std::string_view cut_to_columns(std::string_view text, std::size_t columns) {
    std::size_t end = 0, seen = 0;
    while (end < text.size() && (seen += begins_character(text[end])) <= columns)
        ++end;
    return text.substr(0, end);
}

void WrappedLines::add(std::string_view label, std::string_view text) {
    const std::string clean = printable(text);
    std::string_view rest = clean;
    do {
        const std::string_view line = take_line(rest, kColumns - kIndent);
        text_ += fmt::format("{:<{}}{}\n", label, kIndent, line);
        label = "";
    } while (!rest.empty());
}

void WrappedLines::add_line(std::string_view line) {
    text_ += line.substr(0, line.find_last_not_of(' ') + 1);
    text_ += '\n';
}

std::vector<std::string> count_rows(std::span<const NamedTimes> columns) {
    constexpr std::size_t kLabel = 22, kCount = 11;                       // columns
    std::map<std::pair<double, double>, std::vector<std::uint64_t>> rows; // by their times
    std::vector<std::uint64_t> most(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i)
        for (const TimeBar& bar : time_bars(columns[i].times, 3)) {
            auto& counts = rows[{double(bar.from), double(bar.to)}];
            counts.resize(columns.size());
            counts[i] = bar.count;
            most[i] = std::max(most[i], bar.count);
        }
    if (rows.empty())
        return {};
    const std::size_t width = (kColumns - kLabel) / columns.size() - kCount - 1;
    std::vector<std::string> lines{fmt::format("{:<{}}", "how often", kLabel)};
    for (const NamedTimes& column : columns)
        lines[0] += fmt::format("{:<{}} ", column.name, width + kCount);
    for (const auto& [times, counts] : rows) {
        std::string line = fmt::format("{:>8} to {:>8}  ", time_text(times.first), time_text(times.second));
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const double length = double(counts[i]) / double(std::max<std::uint64_t>(most[i], 1)) * double(width);
            const std::size_t marks = counts[i] == 0 ? 0 : std::max<std::size_t>(1, std::size_t(std::lround(length)));
            const std::string text = counts[i] == 0 ? "" : fmt::format("{} {}", std::string(marks, '#'), counts[i]);
            line += fmt::format("{:<{}} ", text, width + kCount);
        }
        lines.push_back(line);
    }
    return lines;
}

std::vector<TimeBar> time_bars(const Histogram& times, unsigned per_decade) {
    std::vector<TimeBar> bars;
    double slot = -INFINITY; // of the last bar
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
        const std::uint64_t from = Histogram::begin_of(bin);
        const double next = from > 0 ? std::floor(std::log10(static_cast<double>(from)) * per_decade + 1e-9) : -1;
        if (next > slot)
            bars.push_back({from, from, 0});
        slot = next;
        bars.back().to = Histogram::begin_of(bin + 1);
        bars.back().count += times.bin(bin);
    }
    std::erase_if(bars, [](const TimeBar& bar) { return bar.count == 0; });
    return bars;
}

std::string status_text(const LiveStatus& status) {
    const NumberStyle column{true, "u"};
    std::string text =
        fmt::format("{:>8.1f} s {:>9} {:>8} {:>8} deep  {} late  {} clamped", status.seconds,
                    status.rate > 0 ? quantity(status.rate, "Hz", column) : "", quantity(status.force, "N", column),
                    quantity(status.depth, "m", column), status.late, status.clamped);
    if (status.lost > 0)
        text += fmt::format("  {} LOST", status.lost);
    if (!status.state.empty())
        text += "  " + printable(status.state);
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
