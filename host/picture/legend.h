// The legend of a picture: what each sign means; and the signs that several pictures have.
#pragma once

#include "host/picture/canvas.h"

#include <functional>
#include <string>
#include <vector>

namespace forceshade::picture {

inline constexpr double kKeyLength = 44; // pixels: of a line's sign

struct LegendItem {
    std::string text;
    double width = kKeyLength;                                         // pixels: of its sign
    std::function<void(Canvas& canvas, Point left, Point right)> draw; // at half the height of the text
};

/// Height of the items, flowed into rows of `width` pixels; 0 if there are none.
double legend_height(const std::vector<LegendItem>& items, double width);
void draw_legend(Canvas& canvas, const std::vector<LegendItem>& items, Point upper_left, double width);

LegendItem line_item(std::string text, const Stroke& stroke);
LegendItem swatch_item(std::string text, Rgb8 colour);
/// Of values that are no finite number.
LegendItem checker_item(std::string text);

inline constexpr double kLeastArrowLength = 4; // pixels

/// An arrow that stays readable on any colour: white, outlined in dark. One shorter than kLeastArrowLength is a dot.
void draw_arrow(Canvas& canvas, Point tail, Point tip);

/// The nominal surface is a solid line, the smooth shape a dashed one; over colours they have a halo.
Stroke surface_stroke(bool smooth, double width = 2.6);
void draw_surface_line(Canvas& canvas, const std::vector<Point>& points, bool smooth);
LegendItem surface_item(std::string text, bool smooth);

} // namespace forceshade::picture
