#include "device/report/count_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "device/report/units.h"
#include "device/report/wrapped_lines.h"

namespace forceshade::device {
namespace {

constexpr std::size_t kLabel = 19;               // columns, with the gap behind
constexpr std::size_t kCount = 11;               // with the gap before
constexpr std::size_t kRows = 1 + 3 * 20;        // none, and 1, 2, 5 of each power of ten up to 2^64
constexpr std::array<double, 3> kSteps{1, 2, 5}; // ns

// The least time of a row; of the first 0.
double begin_of(std::size_t row) {
    return row == 0 ? 0 : kSteps[(row - 1) % 3] * std::pow(10.0, static_cast<double>((row - 1) / 3));
}

std::size_t row_of(double time) {
    std::size_t row = 0;
    while (row + 1 < kRows && begin_of(row + 1) <= time)
        ++row;
    return row;
}

using Counts = std::array<std::uint64_t, kRows>;

Counts counts_of(const Histogram& times) {
    Counts counts{};
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
        if (times.bin(bin) == 0)
            continue;
        const std::uint64_t longest = std::min(Histogram::begin_of(bin + 1) - 1, times.largest());
        counts[row_of(static_cast<double>(longest))] += times.bin(bin);
    }
    return counts;
}

std::string label_of(std::size_t row) {
    if (row == 0)
        return "0";
    if (row + 1 == kRows)
        return fmt::format("from {}", time_text(begin_of(row)));
    return fmt::format("{:>6} to {:>6}", time_text(begin_of(row)), time_text(begin_of(row + 1)));
}

std::string bar_of(std::uint64_t count, std::uint64_t most, std::size_t width) {
    if (count == 0)
        return "";
    const double length = static_cast<double>(count) / static_cast<double>(most) * static_cast<double>(width);
    return std::string(std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(length)), 1, width), '#');
}

// Puts the shortest times, at most 1 % of each column, into one row; which one, 0 if there is nothing to gather.
std::size_t gather_shortest(std::vector<Counts>& counts) {
    std::size_t end = 0;
    const auto few = [&](std::size_t row) {
        return std::all_of(counts.begin(), counts.end(), [&](const Counts& one) {
            const auto all = std::accumulate(one.begin(), one.end(), std::uint64_t(0));
            return std::accumulate(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(row) + 1, std::uint64_t(0)) <=
                   all / 100;
        });
    };
    while (end + 1 < kRows && few(end))
        ++end;
    if (end < 2)
        return 0;
    for (Counts& one : counts)
        for (std::size_t row = 0; row + 1 < end; ++row)
            one[end - 1] += std::exchange(one[row], 0);
    return end - 1;
}

} // namespace

std::vector<std::string> count_rows(std::span<const NamedTimes> columns) {
    std::vector<Counts> counts;
    std::size_t first = kRows, last = 0;
    const auto any = [&](std::size_t row) {
        return std::any_of(counts.begin(), counts.end(), [&](const Counts& one) { return one[row] > 0; });
    };
    for (const NamedTimes& column : columns)
        counts.push_back(counts_of(column.times));
    const std::size_t shortest = gather_shortest(counts);
    for (std::size_t row = 0; row < kRows; ++row)
        if (any(row)) {
            first = std::min(first, row);
            last = row;
        }
    if (first == kRows)
        return {};
    const std::size_t width = (kColumns - kLabel) / columns.size() - kCount - 1;
    std::string heading = fmt::format("{:<{}}", "how often", kLabel);
    for (const NamedTimes& column : columns)
        heading += fmt::format("{:<{}} ", column.name, width + kCount);
    std::vector<std::string> lines{heading};
    for (std::size_t row = first; row <= last; ++row) {
        if (!any(row)) {
            if (any(row + 1))
                lines.push_back(fmt::format("{:>{}}", "...", kLabel - 2));
            continue;
        }
        std::string line = fmt::format(
            "{:>{}}  ", shortest > 0 && row == shortest ? "below " + time_text(begin_of(row + 1)) : label_of(row),
            kLabel - 2);
        for (const Counts& one : counts) {
            const std::string count = one[row] > 0 ? fmt::format("{}", one[row]) : "";
            const std::string bar = bar_of(one[row], *std::max_element(one.begin(), one.end()), width);
            line += fmt::format("{:<{}} ", bar + (bar.empty() ? "" : " ") + count, width + kCount);
        }
        lines.push_back(line);
    }
    return lines;
}

} // namespace forceshade::device
