#include "host/picture/legend.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace forceshade::picture {
namespace {

constexpr double kLegendGap = 34; // pixels between items
constexpr double kSignGap = 8;    // between a sign and its text
constexpr double kLegendRow = 28;
constexpr double kSwatch = 18;
constexpr double kLineLength = 44;
constexpr Rgb8 kSmoothColour{200, 20, 60};
constexpr TextStyle kLegendStyle{kTextSize, false, Horizontal::left, Vertical::middle, false};

double sign_width(const LegendItem& item) {
    switch (item.sign) {
    case Sign::no_force:
    case Sign::non_finite:
        return kSwatch;
    case Sign::nominal_surface:
    case Sign::smooth_shape:
        return kLineLength;
    case Sign::arrow:
        return item.arrow_length;
    }
    assert(false);
    return 0;
}

double item_width(const LegendItem& item) {
    return sign_width(item) + kSignGap + measure(item.text, kLegendStyle).width;
}

std::vector<Point> place_items(const std::vector<LegendItem>& items, double width) {
    std::vector<Point> places;
    Point next;
    for (const LegendItem& item : items) {
        if (next.x > 0 && next.x + item_width(item) > width)
            next = {0, next.y + kLegendRow};
        places.push_back(next);
        next.x += item_width(item) + kLegendGap;
    }
    return places;
}

void draw_checker(Canvas& canvas, const Box& box) {
    constexpr double kSquare = kSwatch / 4;
    canvas.fill(box, kNonFiniteColours[0]);
    for (int y = 0; y < 4; ++y)
        for (int x = y % 2; x < 4; x += 2)
            canvas.fill({box.x + x * kSquare, box.y + y * kSquare, kSquare, kSquare}, kNonFiniteColours[1]);
}

void draw_sign(Canvas& canvas, const LegendItem& item, Point middle_left) {
    const Box swatch{middle_left.x, middle_left.y - kSwatch / 2, kSwatch, kSwatch};
    const Point end{middle_left.x + sign_width(item), middle_left.y};
    switch (item.sign) {
    case Sign::no_force:
        canvas.fill(swatch, kNoForceColour);
        canvas.outline(swatch, {});
        return;
    case Sign::non_finite:
        draw_checker(canvas, swatch);
        return;
    case Sign::nominal_surface:
    case Sign::smooth_shape:
        return draw_surface_line(canvas, {middle_left, end}, item.sign);
    case Sign::arrow:
        return draw_arrow(canvas, middle_left, end);
    }
}

} // namespace

double legend_height(const std::vector<LegendItem>& items, double width) {
    return items.empty() ? 0 : place_items(items, width).back().y + kLegendRow;
}

void draw_legend(Canvas& canvas, const std::vector<LegendItem>& items, Point upper_left, double width) {
    const std::vector<Point> places = place_items(items, width);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Point middle{upper_left.x + places[i].x, upper_left.y + places[i].y + kLegendRow / 2};
        draw_sign(canvas, items[i], middle);
        canvas.text(items[i].text, {middle.x + sign_width(items[i]) + kSignGap, middle.y}, kLegendStyle);
    }
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

void draw_surface_line(Canvas& canvas, const std::vector<Point>& points, Sign sign) {
    const bool dashed = sign == Sign::smooth_shape;
    canvas.polyline(points, {kPaper, 5, {}, true});
    canvas.polyline(
        points, {dashed ? kSmoothColour : kInk, 2.6, dashed ? std::vector<double>{9, 5} : std::vector<double>{}, true});
}

} // namespace forceshade::picture
