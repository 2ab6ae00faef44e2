// The legend below a picture: what each sign means.
#pragma once

#include "host/picture/canvas.h"

#include <string>
#include <vector>

namespace forceshade::picture {

enum class Sign { no_force, non_finite, nominal_surface, smooth_shape, arrow };

struct LegendItem {
    Sign sign;
    std::string text;
    double arrow_length = 0; // pixels
};

/// Height of the items, flowed into rows of `width` pixels; 0 if there are none.
double legend_height(const std::vector<LegendItem>& items, double width);
void draw_legend(Canvas& canvas, const std::vector<LegendItem>& items, Point upper_left, double width);

inline constexpr double kLeastArrowLength = 4; // pixels

/// An arrow that stays readable on any colour: white, outlined in dark. One shorter than kLeastArrowLength is a dot.
void draw_arrow(Canvas& canvas, Point tail, Point tip);
/// The lines of the nominal surface (solid) and the smooth shape (dashed), each with a halo.
void draw_surface_line(Canvas& canvas, const std::vector<Point>& points, Sign sign);

} // namespace forceshade::picture
