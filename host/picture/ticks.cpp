// Ticks.
#include "host/picture/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace forceshade::picture {
namespace {

constexpr double kSlack = 1e-9;  // steps: a tick on the very end of an axis counts in spite of rounding
constexpr double kHandy = 20;    // extents from the offset that labels may reach
constexpr double kFarAway = 100; // extents from the origin, from where labels without an offset would be unreadable

// Where an axis lies without its offset, so that no digits cancel.
struct Placed {
    double offset;           /* m */
    std::string offset_text; // " − 1000 m" or empty
    double low;              /* m, relative to offset */
};

Placed place(double first, double last, double extent) {
    if (std::max(std::fabs(first), std::fabs(last)) <= kFarAway * extent)
        return {0, "", first};
    const double centre = std::midpoint(first, last);
    int power = decade(std::fabs(centre)) + 1;
    double offset = 0;
    do { // the roundest offset that leaves handy numbers
        offset = divide_by_power_of_ten(std::round(divide_by_power_of_ten(centre, power)), -power);
    } while (std::fabs(centre - offset) > kHandy * extent && --power > decade(extent));
    const std::string size = std::fabs(offset) < 1e15 ? trimmed(std::fabs(offset), std::max(0, -power))
                                                      : fmt::format("{:g}", std::fabs(offset));
    return {offset, fmt::format(" {} {} m", offset < 0 ? "+" : "−", size), first - offset};
}

int decimals_for(double resolution, const Unit& unit) {
    return std::max(0, unit.exponent - decade(resolution));
}

} // namespace

double round_below(double value) {
    const int exponent = decade(value);
    const double leading = divide_by_power_of_ten(value, exponent);
    const double mantissa = leading >= 5 ? 5 : leading >= 2 ? 2 : 1;
    return divide_by_power_of_ten(mantissa, -exponent);
}

RoundTicks round_ticks(double low, double high, std::size_t most) {
    int exponent = decade((high - low) / static_cast<double>(most)) - 1;
    for (std::size_t candidate = 0;; ++candidate) {
        constexpr std::array<double, 3> kMantissas{1, 2, 5};
        const double mantissa = kMantissas[candidate % 3];
        const int power = exponent + static_cast<int>(candidate / 3);
        const double step = divide_by_power_of_ten(mantissa, -power);
        const double first = std::ceil(low / step - kSlack), last = std::floor(high / step + kSlack);
        if (last - first + 1 > static_cast<double>(most))
            continue;
        RoundTicks ticks{{}, step, std::max(0, -power)};
        for (double index = first; index <= last; ++index) // index * mantissa is whole, so each tick is rounded once
            ticks.values.push_back(divide_by_power_of_ten(index * mantissa, -power) + 0.0);
        return ticks;
    }
}

double Range::fraction(double value) const {
    if (!logarithmic)
        return (value - low) / (high - low);
    return value > 0 ? std::log(value / low) / std::log(high / low) : 0;
}

Axis number_axis(std::string title, const Range& range, std::size_t most, const TickLabel& label) {
    Axis axis{std::move(title), {}};
    const auto add = [&](double value, int decimals) {
        axis.ticks.push_back({std::clamp(range.fraction(value), 0.0, 1.0), label(value, decimals)});
    };
    const int first = decade(range.logarithmic ? range.low : 1), last = decade(range.logarithmic ? range.high : 1);
    for (std::size_t coarse = 0; range.logarithmic; ++coarse) {
        axis.ticks.clear();
        for (int power = first; power <= last; ++power)
            for (const int digit : coarse == 0   ? std::vector{1, 2, 5}
                                   : coarse == 1 ? std::vector{1, 3}
                                                 : std::vector{1})
                if (const double value = divide_by_power_of_ten(digit, -power);
                    value >= range.low * (1 - kSlack) && value <= range.high * (1 + kSlack) &&
                    (coarse < 3 || power % static_cast<int>(coarse - 1) == 0))
                    add(value, std::max(0, -power));
        if (axis.ticks.size() <= most)
            break;
    }
    for (int power = first; range.logarithmic && last - first < 12 && power <= last; ++power)
        for (int digit = 1; digit < 10; ++digit)
            if (const double at = range.fraction(divide_by_power_of_ten(digit, -power)); at >= 0 && at <= 1)
                axis.minor.push_back(at);
    if (axis.ticks.size() < 2) { // linear, or less than a decade
        axis.ticks.clear();
        const RoundTicks ticks = round_ticks(range.low, range.high, most);
        for (const double value : ticks.values)
            add(value, ticks.decimals);
    }
    return axis;
}

double axis_extent(const std::vector<double>& samples, double spacing) {
    return samples.back() - samples.front() + spacing;
}

Axis make_axis(std::string_view name, const std::vector<double>& samples, double spacing, const Unit& unit,
               std::size_t most_ticks) {
    const double extent = axis_extent(samples, spacing);
    const Placed placed = place(samples.front(), samples.back(), extent);
    Axis axis{placed.offset_text.empty() ? fmt::format("{}{}", name, per_unit(unit))
                                         : fmt::format("({}{}){}", name, placed.offset_text, per_unit(unit)),
              {}};
    if (samples.size() == 1) {
        const double value = divide_by_power_of_ten(placed.low, unit.exponent);
        axis.ticks.push_back({0.5, trimmed(value, decimals_for(spacing, unit) + 3)});
        return axis;
    }
    const double low = divide_by_power_of_ten(placed.low - spacing / 2, unit.exponent);
    const double length = divide_by_power_of_ten(extent, unit.exponent);
    axis.ticks = number_axis("", {low, low + length}, most_ticks, decimal).ticks;
    return axis;
}

std::vector<std::string> position_labels(std::string_view name, const std::vector<double>& at, double spacing,
                                         const Unit& preferred) {
    const double alone = at.front() == 0 ? spacing : std::min(spacing, std::fabs(at.front()));
    const double gap = at.size() > 1 ? (at.back() - at.front()) / static_cast<double>(at.size() - 1) : alone;
    const Placed placed = place(at.front(), at.back(), axis_extent(at, gap));
    const double largest = std::max({std::fabs(placed.low), std::fabs(at.back() - placed.offset), gap});
    const int difference = decade(largest) - preferred.exponent;
    const Unit unit = difference >= -3 && difference < 4 ? preferred : choose_unit(largest, "m");
    const int most = decimals_for(gap, unit) + 2;
    std::vector<double> values;
    int decimals = 0;
    for (const double position : at) {
        values.push_back(divide_by_power_of_ten(position - placed.offset, unit.exponent));
        decimals = std::max(decimals, needed_decimals(values.back(), most));
    }
    std::vector<std::string> labels;
    for (const double value : values)
        labels.push_back(fmt::format("{}{} = {}", name, placed.offset_text, with_unit(decimal(value, decimals), unit)));
    return labels;
}

Axis quantity_axis(std::string_view name, std::string_view base, double low, double high, std::size_t most) {
    const Unit unit = base == "°" ? Unit{0, "°"} : choose_unit(std::max(std::fabs(low), std::fabs(high)), base);
    const Range range{divide_by_power_of_ten(low, unit.exponent), divide_by_power_of_ten(high, unit.exponent)};
    return number_axis(std::string(name) + per_unit(unit), range, most, decimal);
}

} // namespace forceshade::picture
