// Colours, markers and patterns: what differs by colour differs by shape, pattern or place too.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "host/plot/svg.h"

namespace forceshade::plot {

/// The style rules of a figure. Every colour is a custom property of the page with a value of its own where there is
/// none.
std::string style_sheet();

/// Class of the i-th series' colour: "s0" ...; it repeats, but not together with the marker.
std::string series_class(std::size_t series);

/// Path data of the i-th series' marker about a point.
std::string marker(std::size_t series, double x, double y);
/// Some markers are strokes, not areas.
bool is_open_marker(std::size_t series);

/// Attribute text: the colour of the i-th word's cells.
std::string word_fill(std::size_t word);

/// What tells the i-th word without colour: lines or dots within a box, nothing for the first. Lines, not a pattern:
/// printers take long over patterns.
void draw_hatch(Svg& svg, std::size_t word, const Box& box, std::string_view extra = {});

} // namespace forceshade::plot
