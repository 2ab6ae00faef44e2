#include "device/report/time_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/picture/canvas.h"

namespace forceshade::device {
namespace {

constexpr double kBorder = 0.12;      // decades behind the largest
constexpr double kLeastDecades = 1.1; // so that two ticks are seen
constexpr double kLabelGap = 10;      // pixels
constexpr double kRoomy = 300;        // pixels a decade, from where 2 and 5 are labelled
constexpr int kLastBetween = 14;      // power of ten of ns that is written with all its digits

std::string power_of_ten(int power) {
    constexpr std::array<std::string_view, 10> kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    if (power < 5)
        return fmt::format("{:.0f}", std::pow(10.0, power));
    std::string text = "10";
    for (const char digit : fmt::format("{}", power))
        text += kDigits[static_cast<std::size_t>(digit - '0')];
    return text;
}

std::string time_label(int digit, int power) {
    constexpr std::array<std::string_view, 4> kUnits{"ns", "µs", "ms", "s"};
    const int unit = std::clamp(power / 3, 0, 3), rest = power - 3 * unit;
    const std::string number = rest < 5 ? fmt::format("{:.0f}", digit * std::pow(10.0, rest)) : power_of_ten(rest);
    return fmt::format("{} {}", number, kUnits[static_cast<std::size_t>(unit)]);
}

// The least time above 0.
double least_of(const Histogram& times) {
    for (std::size_t bin = 1; bin < Histogram::kBins; ++bin)
        if (times.bin(bin) > 0)
            return static_cast<double>(Histogram::begin_of(bin));
    return INFINITY;
}

template <typename Label> picture::Axis ticks_of(const LogAxis& axis, Label label) {
    picture::Axis ticks;
    for (int power = static_cast<int>(std::ceil(axis.low - 1e-9)); power <= axis.high; ++power)
        ticks.ticks.push_back({axis.fraction(std::pow(10.0, power)), label(power)});
    return ticks;
}

// Every nth label only, so that they stand this far apart.
void thin_out(picture::Axis& axis, double apart, double pixels) {
    if (axis.ticks.size() < 2)
        return;
    const double step = (axis.ticks[1].fraction - axis.ticks[0].fraction) * pixels;
    const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil(apart / step)));
    for (std::size_t i = 0; i < axis.ticks.size(); ++i)
        if (i % every != 0)
            axis.ticks[i].label.clear();
}

// Those of 2 and 5 times a power of ten too.
void add_between(picture::Axis& ticks, const LogAxis& axis) {
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power)
        for (const int digit : {2, 5}) {
            const double place = std::log10(digit) + power;
            if (place > axis.low && place < axis.high && power < kLastBetween)
                ticks.ticks.push_back({(place - axis.low) / (axis.high - axis.low), time_label(digit, power)});
        }
}

} // namespace

double LogAxis::fraction(double value) const {
    return value > 0 ? std::clamp((std::log10(value) - low) / (high - low), 0.0, 1.0) : 0;
}

LogAxis time_axis(std::span<const Histogram* const> shown, double period) {
    double least = INFINITY, most = 0;
    for (const Histogram* times : shown) {
        least = std::min(least, least_of(*times));
        most = std::max(most, static_cast<double>(times->largest()));
    }
    if (period > 0) {
        least = std::min(least, period);
        most = std::max(most, period);
    }
    if (!(least <= most))
        return {0, kLeastDecades};
    if (least == period) // nothing is shorter: not at the axis's very begin
        least /= 100;
    const double low = std::floor(std::log10(least) + 1e-9);
    return {low, std::max(std::log10(most) + kBorder, low + kLeastDecades)};
}

LogAxis count_axis(std::uint64_t most) {
    return {-0.25, std::log10(static_cast<double>(std::max<std::uint64_t>(most, 8))) + 0.15};
}

picture::Axis time_ticks(const LogAxis& axis, double pixels) {
    picture::Axis ticks = ticks_of(axis, [](int power) { return time_label(1, power); });
    if (pixels / (axis.high - axis.low) > kRoomy) {
        add_between(ticks, axis);
        return ticks;
    }
    double widest = 0;
    for (const picture::AxisTick& tick : ticks.ticks)
        widest = std::max(widest, picture::measure(tick.label, {picture::kSmallTextSize}).width);
    thin_out(ticks, widest + kLabelGap, pixels);
    return ticks;
}

picture::Axis count_ticks(const LogAxis& axis, double pixels) {
    picture::Axis ticks = ticks_of(axis, power_of_ten);
    thin_out(ticks, picture::measure("1", {picture::kSmallTextSize}).height + 4, pixels);
    return ticks;
}

std::vector<double> minor_fractions(const LogAxis& axis) {
    std::vector<double> fractions;
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power)
        for (int times = 2; times <= 9; ++times) {
            const double place = std::log10(times) + power;
            if (place > axis.low && place < axis.high)
                fractions.push_back((place - axis.low) / (axis.high - axis.low));
        }
    return fractions;
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

} // namespace forceshade::device
