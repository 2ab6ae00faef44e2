#include "host/picture/legend.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace forceshade::picture {
namespace {

constexpr double kItemGap = 34; // pixels between items
constexpr double kSignGap = 8;  // between a sign and its text
constexpr double kLegendRow = 26;
constexpr double kSwatch = 18;
constexpr TextStyle kLegendStyle{kTextSize, false, Horizontal::left, Vertical::middle, false};

double item_width(const LegendItem& item) {
    return item.width + kSignGap + measure(item.text, kLegendStyle).width;
}

std::vector<Point> place_items(const std::vector<LegendItem>& items, double width) {
    std::vector<Point> places;
    Point next;
    for (const LegendItem& item : items) {
        if (next.x > 0 && next.x + item_width(item) > width)
            next = {0, next.y + kLegendRow};
        places.push_back(next);
        next.x += item_width(item) + kItemGap;
    }
    return places;
}

} // namespace

double legend_height(const std::vector<LegendItem>& items, double width) {
    return items.empty() ? 0 : place_items(items, width).back().y + kLegendRow;
}

void draw_legend(Canvas& canvas, const std::vector<LegendItem>& items, Point upper_left, double width) {
    const std::vector<Point> places = place_items(items, width);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Point left{upper_left.x + places[i].x, upper_left.y + places[i].y + kLegendRow / 2};
        items[i].draw(canvas, left, {left.x + items[i].width, left.y});
        canvas.text(items[i].text, {left.x + items[i].width + kSignGap, left.y}, kLegendStyle);
    }
}

LegendItem line_item(std::string text, const Stroke& stroke) {
    return {std::move(text), kKeyLength, [stroke](Canvas& canvas, Point left, Point right) {
                canvas.polyline(std::array{left, right}, stroke);
            }};
}

LegendItem swatch_item(std::string text, Rgb8 colour) {
    return {std::move(text), kSwatch, [colour](Canvas& canvas, Point left, Point) {
                const Box box{left.x, left.y - kSwatch / 2, kSwatch, kSwatch};
                canvas.fill(box, colour);
                canvas.outline(box, {});
            }};
}

LegendItem checker_item(std::string text) {
    return {std::move(text), kSwatch, [](Canvas& canvas, Point left, Point) {
                constexpr double kSquare = kSwatch / 4;
                for (int y = 0; y < 4; ++y)
                    for (int x = 0; x < 4; ++x)
                        canvas.fill({left.x + x * kSquare, left.y - kSwatch / 2 + y * kSquare, kSquare, kSquare},
                                    kNonFiniteColours[static_cast<std::size_t>((x + y) % 2)]);
            }};
}

void draw_arrow(Canvas& canvas, Point tail, Point tip) {
    const double length = std::hypot(tip.x - tail.x, tip.y - tail.y);
    if (length < kLeastArrowLength) {
        const Point middle{(tail.x + tip.x) / 2, (tail.y + tip.y) / 2};
        canvas.disc(middle, 2.2, kInk);
        canvas.disc(middle, 1.2, kPaper);
        return;
    }
    const double along_x = (tip.x - tail.x) / length, along_y = (tip.y - tail.y) / length;
    const double head = std::min(0.45 * length, 12.0), half_head = std::max(0.45 * head, 2.0),
                 half_shaft = std::min(1.3, 0.18 * head);
    const std::array<Point, 7> local{{{0, half_shaft},
                                      {length - head, half_shaft},
                                      {length - head, half_head},
                                      {length, 0},
                                      {length - head, -half_head},
                                      {length - head, -half_shaft},
                                      {0, -half_shaft}}};
    std::array<Point, 7> points;
    std::transform(local.begin(), local.end(), points.begin(), [&](Point p) {
        return Point{tail.x + along_x * p.x - along_y * p.y, tail.y + along_y * p.x + along_x * p.y};
    });
    canvas.polygon(points, kPaper, {kInk, 1.8, {}, true});
}

Stroke surface_stroke(bool smooth, double width) {
    return smooth ? Stroke{{200, 20, 60}, width, {9, 5}, true} : Stroke{kInk, width, {}, true};
}

void draw_surface_line(Canvas& canvas, const std::vector<Point>& points, bool smooth) {
    canvas.polyline(points, {kPaper, 5, {}, true});
    canvas.polyline(points, surface_stroke(smooth));
}

LegendItem surface_item(std::string text, bool smooth) {
    return line_item(std::move(text), surface_stroke(smooth));
}

} // namespace forceshade::picture
