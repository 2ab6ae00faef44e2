// The frame of a plot: axes, ticks, grid, titles, with room for all of it.
#pragma once

#include <string>
#include <vector>

#include "host/plot/scale.h"
#include "host/plot/svg.h"

namespace forceshade::plot {

inline constexpr double kWidth = 760; /* px, of every figure */
inline constexpr double kMargin = 14;
inline constexpr double kTickSize = 11, kAxisTitleSize = 12; /* px, of text */

/// A figure while it is drawn.
struct Sheet {
    std::string id; /* begins the ids of everything in it */
    Svg svg;
    std::vector<std::string> notes; /* what is not shown, and why */
};

struct Axes {
    Scale x, y;
    std::string x_label, y_label;
    Box plot; /* within the ticks */
};

/// Places the plot below `top`, `height` px high, leaving `right` px at its right side.
void lay_out(Axes& axes, double top, double height, double right);

/// Paper, grid and ticks. Returns where the axis title below ends.
double draw_axes(Sheet& sheet, const Axes& axes, bool grid);

/// The clip path "ID-plot", for curves that leave the plot.
void add_clip(Sheet& sheet, const Box& plot);

/// Says that rows are not shown: "3 of 40 rows have no number here and are not shown".
void note_missing(Sheet& sheet, std::size_t missing, std::size_t rows, bool logarithmic);

} // namespace forceshade::plot
