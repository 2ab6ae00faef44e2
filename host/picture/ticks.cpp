#include "host/picture/ticks.h"

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

// Where an axis lies without its offset, so that nothing cancels.
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

double axis_extent(const std::vector<double>& samples, double spacing) {
    return samples.back() - samples.front() + spacing;
}

Axis make_axis(std::string_view name, const std::vector<double>& samples, double spacing, const Unit& unit,
               std::size_t most_ticks) {
    const double extent = axis_extent(samples, spacing);
    const Placed placed = place(samples.front(), samples.back(), extent);
    Axis axis{placed.offset_text.empty() ? fmt::format("{}{}", name, per_unit(unit))
                                         : fmt::format("({}{}){}", name, placed.offset_text, per_unit(unit)),
              {},
              placed.offset,
              unit};
    if (samples.size() == 1) {
        const double value = divide_by_power_of_ten(placed.low, unit.exponent);
        axis.ticks.push_back({0.5, trimmed(value, decimals_for(spacing, unit) + 3)});
        return axis;
    }
    const double low = divide_by_power_of_ten(placed.low - spacing / 2, unit.exponent);
    const double length = divide_by_power_of_ten(extent, unit.exponent);
    const RoundTicks ticks = round_ticks(low, low + length, most_ticks);
    for (const double value : ticks.values)
        axis.ticks.push_back({std::clamp((value - low) / length, 0.0, 1.0), decimal(value, ticks.decimals)});
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

Axis magnitude_axis(double largest, std::size_t most_ticks) {
    const Unit unit = choose_unit(largest, "N");
    Axis axis{"force magnitude" + per_unit(unit), {}, 0, unit};
    const double top = divide_by_power_of_ten(largest, unit.exponent);
    const RoundTicks ticks = round_ticks(0, top, most_ticks);
    for (const double value : ticks.values)
        axis.ticks.push_back({std::clamp(value / top, 0.0, 1.0), decimal(value, ticks.decimals)});
    return axis;
}

} // namespace forceshade::picture
