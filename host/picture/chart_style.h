// The colour and mark of a series: by its name, in files and on the report's page alike.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "host/picture/canvas.h"

namespace forceshade::picture {

/// A number for each name, of which colour and mark follow: known names have theirs everywhere, the others get in
/// their order the first colours that are left.
std::vector<std::size_t> series_numbers(std::span<const std::string> names);
/// {"direct": 0, ...}: the known names, for the page.
std::string known_series_json();

/// Those of the page (--plot-s0 and so on), again from the ninth on.
Rgb8 series_colour(std::size_t number);
/// Half way to white.
Rgb8 lighter(Rgb8 colour);
/// Seven shapes in the order of d3: circle, square, triangle, diamond, cross, star, wye.
void draw_mark(Canvas& canvas, std::size_t number, Point at);

} // namespace forceshade::picture
