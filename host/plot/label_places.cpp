#include "host/plot/label_places.h"

#include <algorithm>
#include <array>

#include "host/plot/text_size.h"

namespace forceshade::plot {
namespace {

constexpr double kMarkerSize = 12; /* px */

bool inside(const Box& box, const Box& plot) {
    return box.x >= plot.x + 2 && box.right() <= plot.right() - 2 && box.y >= plot.y + 2 &&
           box.bottom() <= plot.bottom() - 2;
}

// Right, left, above, below, then the corners, nearest first.
std::vector<Box> candidates(const LabelledPoint& point, double width, double height) {
    std::vector<Box> boxes;
    for (const double gap : {8.0, 16.0, 26.0, 40.0, 56.0}) {
        const double left = point.x - gap - width, right = point.x + gap, middle = point.x - width / 2;
        const double above = point.y - gap - height, below = point.y + gap, level = point.y - height / 2;
        for (const Box& box : {Box{right, level, width, height}, Box{left, level, width, height},
                               Box{middle, above, width, height}, Box{middle, below, width, height},
                               Box{right, above + 4, width, height}, Box{left, above + 4, width, height},
                               Box{right, below - 4, width, height}, Box{left, below - 4, width, height}})
            boxes.push_back(box);
    }
    return boxes;
}

} // namespace

std::vector<std::optional<Box>> place_labels(const std::vector<LabelledPoint>& points, const Box& plot,
                                             double font_size) {
    std::vector<Box> taken;
    for (const LabelledPoint& point : points)
        taken.push_back({point.x - kMarkerSize / 2, point.y - kMarkerSize / 2, kMarkerSize, kMarkerSize});
    std::vector<std::optional<Box>> places(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].text.empty())
            continue;
        for (const Box& box : candidates(points[i], text_width(points[i].text, font_size), font_size + 3))
            if (inside(box, plot) &&
                std::ranges::none_of(taken, [&](const Box& other) { return overlap(box, other); })) {
                places[i] = box;
                taken.push_back(box);
                break;
            }
    }
    return places;
}

} // namespace forceshade::plot
