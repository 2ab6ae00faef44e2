// How much room a text takes, without the font: widths of DejaVu Sans, which is wider than the other fonts that a
// reader is likely to have.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace forceshade::plot {

/// px, at least what a sans-serif font of that size needs.
double text_width(std::string_view text, double font_size);

/// Lines cut at spaces, each no wider than `width` px unless it is a single word.
std::vector<std::string> wrapped(std::string_view text, double font_size, double width);

/// The text, or as much of it as fits with "…" at its end.
std::string shortened(std::string_view text, double font_size, double width);

} // namespace forceshade::plot
