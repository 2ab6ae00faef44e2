// Colours, markers and patterns: what differs by colour differs by shape, pattern or place too.
#pragma once

#include <cstddef>
#include <string>

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

/// The fill patterns of word cells as <defs>, their ids beginning with `id`.
std::string word_patterns(const std::string& id, std::size_t count);
/// Attribute text: the fill of the i-th word.
std::string word_fill(const std::string& id, std::size_t word);

} // namespace forceshade::plot
