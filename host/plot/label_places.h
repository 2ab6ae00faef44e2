// Labels beside points that overlap neither each other, nor points, nor the plot's edge, nor lines drawn over it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/plot/svg.h"

namespace forceshade::plot {

struct LabelledPoint {
    double x = 0, y = 0; /* px */
    std::string text;
};

/// A straight piece of a line that is drawn, px.
struct Piece {
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
};

/// True if a piece and a box have a point in common.
bool crosses(const Piece& piece, const Box& box);

/// A box for each text, as near its point as there is room, rather where a line that leads to it passes no other point;
/// those with the least room choose first. Nothing where there is none within 140 px.
std::vector<std::optional<Box>> place_labels(const std::vector<LabelledPoint>& points, const Box& plot,
                                             double font_size, const std::vector<Piece>& lines = {});

} // namespace forceshade::plot
