// What markers, lines and fills mean, below a plot.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/plot/axes.h"

namespace forceshade::plot {

inline constexpr double kSwatch = 26; /* px wide */

struct LegendEntry {
    std::string text;
    std::function<void(Svg&, double x, double y)> draw; /* a swatch from x on, its middle at y */
};

/// In rows from `top` on; returns where they end. Nothing for no entries.
double draw_legend(Sheet& sheet, const std::vector<LegendEntry>& entries, double left, double top);

} // namespace forceshade::plot
