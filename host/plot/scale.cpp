#include "host/plot/scale.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "host/picture/quantity.h"
#include "host/picture/ticks.h"

namespace forceshade::plot {
namespace {

constexpr double kLeastExponent = -323, kLargestExponent = 308.2; // of a double
constexpr double kSlack = 1e-9;                                   // of a tick on the very end of an axis

std::string power_of_ten(int exponent) {
    if (exponent == 0)
        return "1";
    return exponent == 1 ? "10" : "10" + picture::superscript(exponent);
}

double ten_to(int exponent) {
    return picture::divide_by_power_of_ten(1, -exponent);
}

// Of the number as it reads in that many digits: 9.99999e-8 is 10^-7 in three.
int rounded_decade(double value, int digits) {
    const std::string text = fmt::format("{:.{}e}", std::fabs(value), digits - 1);
    const std::size_t sign = text.find('e') + 1;
    int exponent = 0;
    std::from_chars(text.data() + sign + (text[sign] == '+'), text.data() + text.size(), exponent);
    return exponent;
}

bool is_plain(double size) {
    return size == 0 || (size >= 1e-3 && size < 1e5);
}

Range padded_log_range(double low, double high) {
    const double from = std::log10(low), to = std::log10(high);
    const double pad = std::max(0.05 * (to - from), 0.12);
    return {std::pow(10.0, std::max(from - pad, kLeastExponent)), std::pow(10.0, std::min(to + pad, kLargestExponent))};
}

} // namespace

std::string number_label(double value, int digits) {
    if (value == 0)
        return "0";
    const int exponent = rounded_decade(value, digits);
    if (is_plain(std::fabs(value)))
        return picture::trimmed(value, std::max(0, digits - 1 - exponent));
    const double mantissa = picture::divide_by_power_of_ten(value, exponent);
    const std::string text = picture::trimmed(mantissa, digits - 1);
    return text == "1" ? power_of_ten(exponent) : text + "×" + power_of_ten(exponent);
}

Range range_of(const std::vector<double>& values, bool logarithmic) {
    double low = INFINITY, high = -INFINITY;
    for (const double value : values)
        if (std::isfinite(value) && (!logarithmic || value > 0)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    if (low > high)
        return logarithmic ? Range{1, 10} : Range{0, 1};
    if (logarithmic)
        return padded_log_range(low, high);
    const double size = std::max(std::fabs(low), std::fabs(high));
    if (high - low <= 1e-9 * size || size == 0) {
        const double half = size == 0 ? 1 : size / 2;
        return {std::midpoint(low, high) - half, std::midpoint(low, high) + half};
    }
    const double pad = 0.05 * (high - low);
    const bool from_zero = low >= 0 && low < 0.4 * high, to_zero = high <= 0 && high > 0.4 * low;
    return {from_zero ? 0 : low - pad, to_zero ? 0 : high + pad};
}

Scale::Scale(std::vector<std::string> words) : words_(std::move(words)) {
    range_ = {-0.5, static_cast<double>(std::max<std::size_t>(words_.size(), 1)) - 0.5};
}

double Scale::fraction(double value) const {
    if (logarithmic_)
        return (std::log10(value) - std::log10(range_.low)) / (std::log10(range_.high) - std::log10(range_.low));
    return (value - range_.low) / (range_.high - range_.low);
}

double Scale::value_at(double fraction) const {
    if (logarithmic_)
        return std::pow(10.0, std::lerp(std::log10(range_.low), std::log10(range_.high), fraction));
    return std::lerp(range_.low, range_.high, fraction);
}

double Scale::at(double value) const {
    return first_ + fraction(value) * (last_ - first_);
}

std::vector<Tick> Scale::decade_ticks(int first, int last, std::size_t most) const {
    const int count = last - first + 1;
    const int step = std::max(1, (count + static_cast<int>(most) - 1) / static_cast<int>(most));
    std::vector<Tick> ticks;
    for (int exponent = first - 1; exponent <= last; ++exponent) {
        if (exponent >= first && (exponent % step == 0 || count < 40))
            ticks.push_back({ten_to(exponent), exponent % step == 0 ? power_of_ten(exponent) : ""});
        for (int digit = 2; digit < 10 && step == 1 && count < 8; ++digit)
            ticks.push_back({digit * ten_to(exponent), ""});
    }
    return ticks;
}

std::vector<Tick> Scale::ticks_within_decades(int first, int last) const {
    std::vector<Tick> ticks;
    for (int exponent = first - 1; exponent <= last; ++exponent)
        for (int digit = 1; digit < 10; ++digit) {
            const double value = digit * ten_to(exponent);
            ticks.push_back({value, digit == 1 || digit == 2 || digit == 5 ? number_label(value) : ""});
        }
    return ticks;
}

std::vector<Tick> Scale::round_ticks(std::size_t most) const {
    const picture::RoundTicks round = picture::round_ticks(range_.low, range_.high, std::max<std::size_t>(most, 2));
    const double largest = std::max(std::fabs(range_.low), std::fabs(range_.high));
    const bool plain = largest < 1e5 && round.step >= 1e-3;
    const int exponent = plain ? 0 : rounded_decade(largest, 4);
    int decimals = plain ? round.decimals : 0;
    for (const double value : round.values)
        if (!plain)
            decimals =
                std::max(decimals, picture::needed_decimals(picture::divide_by_power_of_ten(value, exponent), 9));
    std::vector<Tick> ticks;
    for (const double value : round.values) {
        const std::string mantissa = picture::decimal(picture::divide_by_power_of_ten(value, exponent), decimals);
        ticks.push_back({value, value == 0 ? "0" : exponent == 0 ? mantissa : mantissa + "×" + power_of_ten(exponent)});
    }
    return ticks;
}

std::vector<Tick> Scale::ticks(std::size_t most) const {
    std::vector<Tick> ticks;
    if (of_words()) {
        for (std::size_t i = 0; i < words_.size(); ++i)
            ticks.push_back({static_cast<double>(i), words_[i]});
        return ticks;
    }
    if (!logarithmic_)
        return round_ticks(most);
    const int first = static_cast<int>(std::ceil(std::log10(range_.low) - kSlack));
    const int last = static_cast<int>(std::floor(std::log10(range_.high) + kSlack));
    ticks = last - first >= 1 ? decade_ticks(first, last, most) : ticks_within_decades(first, last);
    std::erase_if(ticks, [&](const Tick& tick) {
        const double place = fraction(tick.value);
        return place < -kSlack || place > 1 + kSlack;
    });
    if (std::ranges::count_if(ticks, [](const Tick& tick) { return !tick.label.empty(); }) >= 2)
        return ticks;
    return round_ticks(most);
}

} // namespace forceshade::plot
