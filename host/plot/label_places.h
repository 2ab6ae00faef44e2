// Labels beside points that overlap neither each other, nor points, nor the plot's edge.
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

/// A box for each text, as near its point as there is room; nothing where there is none within 60 px.
std::vector<std::optional<Box>> place_labels(const std::vector<LabelledPoint>& points, const Box& plot,
                                             double font_size);

} // namespace forceshade::plot
