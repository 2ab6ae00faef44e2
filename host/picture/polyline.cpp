#include "host/picture/polyline.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace forceshade::picture {
namespace {

constexpr double kBorder = 8; // pixels: the width of a line with its halo, so that its cut ends stay outside
constexpr double kNear = 1.0 / 3;

struct Segment {
    Point from, to;
};

bool finite(Point p) {
    return std::isfinite(p.x) && std::isfinite(p.y);
}

// Liang and Barsky 1984, "A new concept and method for line clipping".
std::optional<Segment> clip(Point from, Point to, const Box& box) {
    const double dx = to.x - from.x, dy = to.y - from.y;
    double enter = 0, leave = 1;
    const auto within = [&](double delta, double distance) { // delta * t <= distance
        if (delta == 0)
            return distance >= 0;
        const double t = distance / delta;
        (delta < 0 ? enter : leave) = delta < 0 ? std::max(enter, t) : std::min(leave, t);
        return enter <= leave;
    };
    if (!within(-dx, from.x - box.x) || !within(dx, box.x + box.width - from.x) || !within(-dy, from.y - box.y) ||
        !within(dy, box.y + box.height - from.y))
        return std::nullopt;
    const auto at = [&](double t) { // far-away ends leave few digits: keep the cut on the box
        return Point{std::clamp(from.x + t * dx, box.x, box.x + box.width),
                     std::clamp(from.y + t * dy, box.y, box.y + box.height)};
    };
    return Segment{enter == 0 ? from : at(enter), leave == 1 ? to : at(leave)};
}

} // namespace

std::vector<std::vector<Point>> visible_pieces(std::span<const Point> line, const Box& box) {
    const Box wide{box.x - kBorder, box.y - kBorder, box.width + 2 * kBorder, box.height + 2 * kBorder};
    std::vector<std::vector<Point>> pieces;
    std::optional<Point> previous;
    bool connected = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Point next = line[i];
        if (!finite(next)) {
            previous.reset();
            connected = false;
            continue;
        }
        const bool last = i + 1 == line.size() || !finite(line[i + 1]);
        if (previous && !last && std::hypot(next.x - previous->x, next.y - previous->y) < kNear)
            continue;
        if (previous) {
            const std::optional<Segment> seen = clip(*previous, next, wide);
            if (seen && !connected)
                pieces.push_back({seen->from});
            if (seen)
                pieces.back().push_back(seen->to);
            connected = seen && seen->to.x == next.x && seen->to.y == next.y;
        }
        previous = next;
    }
    return pieces;
}

bool crosses(Point from, Point to, const Box& box) {
    return finite(from) && finite(to) && clip(from, to, box);
}

std::vector<Point> seen_as_line(std::vector<Point> piece) {
    constexpr double kBar = 14; // pixels
    if (piece.empty())
        return piece;
    const auto [left, right] = std::ranges::minmax(piece, {}, &Point::x);
    const auto [high, low] = std::ranges::minmax(piece, {}, &Point::y);
    if (std::max(right.x - left.x, low.y - high.y) > kBar / 4)
        return piece;
    const double middle = (left.x + right.x) / 2;
    return {{middle - kBar / 2, high.y}, {middle + kBar / 2, high.y}};
}

} // namespace forceshade::picture
