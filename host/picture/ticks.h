// The one maker of ticks: round ones at steps of 1, 2 or 5, powers of ten on logarithmic axes, units, and an offset
// where a grid is far from the origin.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host/numbers.h"

namespace forceshade::picture {

using namespace numbers;

/// The largest 1, 2 or 5 times a power of ten that does not exceed `value` > 0.
double round_below(double value);

/// Multiples of `step` = {1, 2, 5} * 10^k within [low, high], and how many decimals they need.
struct RoundTicks {
    std::vector<double> values;
    double step = 1;
    int decimals = 0;
};

/// At most `most` >= 1 ticks in [low, high], high > low, with the smallest step that allows it; at least one if most
/// >= 2.
RoundTicks round_ticks(double low, double high, std::size_t most);

/// The numbers along an axis.
struct Range {
    double low = 0, high = 1;
    bool logarithmic = false; // both are positive then
    /// Where a value lies: 0 at `low`, 1 at `high`. What a logarithmic axis cannot hold lies at its begin.
    double fraction(double value) const;
};

/// Makes an axis with at most `most` ticks.
using AxisMaker = std::function<struct Axis(std::size_t most)>;

struct AxisTick {
    double fraction; // of the axis length, in [0, 1]
    std::string label;
};

struct Axis {
    std::string title; // "x / mm", or "(x − 1000 m) / mm": each label is the offset coordinate in that unit
    std::vector<AxisTick> ticks;
    double offset = 0; /* m */
    Unit unit{};
    std::vector<double> minor{}; // fractions: of short ticks without a label
};

/// How a tick is written; `decimals` are those that its step needs.
using TickLabel = std::function<std::string(double value, int decimals)>;

/// At most `most` >= 2 ticks, on a logarithmic axis 1, 2, 5 or 1, 3 or 1 times powers of ten.
Axis number_axis(std::string title, const Range& range, std::size_t most, const TickLabel& label = number_label);

/// "force magnitude / mN": from `low` to `high` > low of a quantity in the unit `base`, degrees among them.
Axis quantity_axis(std::string_view name, std::string_view base, double low, double high, std::size_t most);

/// The length from the outer edge of the first sample's cell to that of the last one's. /* m */
double axis_extent(const std::vector<double>& samples, double spacing);

/// The axis of increasing `samples` (m); a lone sample gets a tick that names it. `unit` is usually that of
/// axis_extent.
Axis make_axis(std::string_view name, const std::vector<double>& samples, double spacing, const Unit& unit,
               std::size_t most_ticks);

/// "z = −4.2 mm" for each increasing coordinate (m), in one unit, with the decimals that distinguish them.
/// `spacing` of the grid (m) sets the resolution for a single coordinate. `preferred`: the unit to use where
/// its numbers are handy, between 0.001 and 10000.
std::vector<std::string> position_labels(std::string_view name, const std::vector<double>& at, double spacing,
                                         const Unit& preferred);

} // namespace forceshade::picture
