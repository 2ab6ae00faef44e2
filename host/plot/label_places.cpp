#include "host/plot/label_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/plot/text_size.h"

namespace forceshade::plot {
namespace {

constexpr double kMarkerSize = 12; // px
constexpr double kGap = 8;         // px: the least between a point and its label
constexpr double kFurthest = 140;  // px: the most
constexpr double kLeader = 12;     // px: from here on a line leads to the label
constexpr double kAcross = 8;      // px: between places to try
constexpr double kDown = 4;        // px

bool inside(const Box& box, const Box& plot) {
    return box.x >= plot.x + 2 && box.right() <= plot.right() - 2 && box.y >= plot.y + 2 &&
           box.bottom() <= plot.bottom() - 2;
}

// From a point to the nearest of a box.
Piece way_to(const LabelledPoint& point, const Box& box) {
    return {point.x, point.y, std::clamp(point.x, box.x, box.right()), std::clamp(point.y, box.y, box.bottom())};
}

double length(const Piece& piece) {
    return std::hypot(piece.x2 - piece.x1, piece.y2 - piece.y1);
}

// Within the plot, the nearest first; of those as near, the most level.
std::vector<Box> candidates(const LabelledPoint& point, const Box& plot, double width, double height) {
    std::vector<double> xs;
    for (double gap = kGap; gap <= kFurthest; gap += kAcross) {
        xs.push_back(point.x + gap);
        xs.push_back(point.x - gap - width);
    }
    for (double left = 0; left <= width; left += kAcross)
        xs.push_back(point.x - left);
    std::vector<std::pair<double, Box>> boxes;
    for (double down = 0; down <= kFurthest + height; down += kDown)
        for (const double way : {-down, down})
            for (const double x : xs) {
                const Box box{x, point.y - height / 2 + way, width, height};
                const double distance = length(way_to(point, box));
                if (distance >= kGap - 2 && distance <= kFurthest && inside(box, plot))
                    boxes.emplace_back(distance + 0.02 * down, box);
            }
    std::ranges::stable_sort(boxes, {}, [](const auto& one) { return one.first; });
    std::vector<Box> sorted;
    for (const auto& [cost, box] : boxes)
        sorted.push_back(box);
    return sorted;
}

// The share of a piece, [from, to], that is left of it between two bounds on an axis.
void clip(double start, double end, double low, double high, double& from, double& to) {
    const double along = end - start;
    if (along == 0) {
        if (start < low || start > high)
            to = -1;
        return;
    }
    const double one = (low - start) / along, other = (high - start) / along;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
}

bool crosses_any(const Piece& piece, const std::vector<Box>& boxes) {
    return std::ranges::any_of(boxes, [&](const Box& box) { return box.width > 0 && crosses(piece, box); });
}

// What labels keep off.
struct Taken {
    std::vector<Box> markers; /* of the points, in their order */
    std::vector<Box> labels;
    std::vector<Piece> lines;

    bool has_room(const Box& box, const LabelledPoint& point) const {
        const auto overlaps = [&](const Box& other) { return overlap(box, other); };
        const auto runs_through = [&](const Piece& line) { return crosses(line, box); };
        return std::ranges::none_of(markers, overlaps) && std::ranges::none_of(labels, overlaps) &&
               std::ranges::none_of(lines, runs_through) && !crosses_any(way_to(point, box), labels);
    }
    // Room, and led to past other points.
    bool is_clear(const Box& box, const LabelledPoint& point, std::size_t number) const {
        if (!has_room(box, point))
            return false;
        std::vector<Box> others = markers;
        others[number] = {};
        const Piece way = way_to(point, box);
        return length(way) <= kLeader || !crosses_any(way, others);
    }
};

} // namespace

bool crosses(const Piece& piece, const Box& box) {
    double from = 0, to = 1;
    clip(piece.x1, piece.x2, box.x, box.right(), from, to);
    clip(piece.y1, piece.y2, box.y, box.bottom(), from, to);
    return from <= to;
}

std::vector<std::optional<Box>> place_labels(const std::vector<LabelledPoint>& points, const Box& plot,
                                             double font_size, const std::vector<Piece>& lines) {
    Taken taken{{}, {}, lines};
    for (const LabelledPoint& point : points)
        taken.markers.push_back({point.x - kMarkerSize / 2, point.y - kMarkerSize / 2, kMarkerSize, kMarkerSize});
    std::vector<std::vector<Box>> choices(points.size());
    std::vector<std::size_t> room(points.size()), order;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].text.empty())
            continue;
        order.push_back(i);
        choices[i] = candidates(points[i], plot, text_width(points[i].text, font_size), font_size + 3);
        room[i] = static_cast<std::size_t>(
            std::ranges::count_if(choices[i], [&](const Box& box) { return taken.is_clear(box, points[i], i); }));
    }
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return room[i]; }); // those with little room choose first
    std::vector<std::optional<Box>> places(points.size());
    for (const std::size_t i : order) {
        auto found =
            std::ranges::find_if(choices[i], [&](const Box& box) { return taken.is_clear(box, points[i], i); });
        if (found == choices[i].end())
            found = std::ranges::find_if(choices[i], [&](const Box& box) { return taken.has_room(box, points[i]); });
        if (found == choices[i].end())
            continue;
        places[i] = *found;
        taken.labels.push_back(*found);
        if (const Piece way = way_to(points[i], *found); length(way) > kLeader)
            taken.lines.push_back(way);
    }
    return places;
}

} // namespace forceshade::plot
