// Lines drawn over a plot: closed forms, bounds, fits.
#pragma once

#include <string>
#include <vector>

#include "host/plot/axes.h"
#include "host/plot/legend.h"
#include "host/study/data/study_data.h"

namespace forceshade::plot {

struct CurveLine {
    std::string label, classes, dashes;
    std::vector<std::vector<std::pair<double, double>>> pieces; /* in the units of the axes */
};

/// A row without numbers, or without a place on a logarithmic axis, cuts a curve in two. A curve whose label is one of
/// the series has its colour. \throws study::DataError.
std::vector<CurveLine> curve_lines(const study::Figure& figure, const study::StudyData& data,
                                   const std::vector<std::string>& series);

/// Clipped to the plot; `halo` sets them off from cells below.
void draw_curves(Sheet& sheet, const Axes& axes, const std::vector<CurveLine>& lines, bool halo);

void add_curves(std::vector<LegendEntry>& entries, const std::vector<CurveLine>& lines, bool halo);

} // namespace forceshade::plot
