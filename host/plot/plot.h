// A figure of a study as SVG: whole, with its title, axes, legend and tooltips, on white paper unless a page that holds
// it sets other colours (--plot-paper and so on, see palette.cpp).
#pragma once

#include <string>
#include <vector>

#include "host/study/data/data_files.h"
#include "host/study/data/study_data.h"

namespace forceshade::plot {

/// One <svg> element, the same bytes for the same data. Rows without a number, or without a place on a logarithmic
/// axis, are counted below the figure. \throws study::DataError if a table or column that the figure names is missing.
/// Without `styles` it stands in a page that holds figure_styles().
std::string svg_of(const study::Figure& figure, const study::StudyData& data, bool styles = true);

/// Style rules of all figures.
std::string figure_styles();

/// FIGURE.svg for each figure. \throws study::DataError.
std::vector<study::TextFile> pictures(const study::StudyData& data);

} // namespace forceshade::plot
