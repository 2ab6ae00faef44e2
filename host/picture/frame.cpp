#include "host/picture/frame.h"

#include <algorithm>
#include <array>
#include <boost/geometry/algorithms/intersection.hpp>
#include <boost/geometry/algorithms/intersects.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/linestring.hpp>
#include <boost/geometry/geometries/register/point.hpp>
#include <boost/geometry/geometries/segment.hpp>
#include <cmath>
#include <fmt/format.h>

BOOST_GEOMETRY_REGISTER_POINT_2D(forceshade::picture::Point, double, boost::geometry::cs::cartesian, x, y)

namespace forceshade::picture {
namespace {

constexpr double kMaxAspect = 8;         // longer plots are drawn out of scale, and say so
constexpr double kSharedUnitRatio = 1e3; // extents further apart than this get units of their own
constexpr double kLabelGap = 10;
constexpr double kBarWidth = 22;
constexpr TextStyle kTickStyle{kSmallTextSize, false, Horizontal::centre, Vertical::top, false};
constexpr TextStyle kLeftStyle{kSmallTextSize, false, Horizontal::right, Vertical::middle, false};
constexpr TextStyle kBarTickStyle{kSmallTextSize, false, Horizontal::left, Vertical::middle, false};
constexpr TextStyle kBelowStyle{kTextSize, false, Horizontal::centre, Vertical::top, false};
constexpr TextStyle kUpStyle{kTextSize, false, Horizontal::right, Vertical::middle, true};
constexpr TextStyle kBarTitleStyle{kTextSize, false, Horizontal::left, Vertical::middle, true};

// Labels are centred on their ticks, which stand in order.
bool labels_clear(const Axis& axis, double pixels, bool vertical) {
    double previous_end = -1e9;
    for (const AxisTick& tick : axis.ticks) {
        const Extent size = measure(tick.label, kTickStyle);
        const double half = (vertical ? size.height : size.width + kLabelGap) / 2;
        if (tick.fraction * pixels - half < previous_end)
            return false;
        previous_end = tick.fraction * pixels + half;
    }
    return true;
}

double widest_label(const Axis& axis) {
    double widest = 0;
    for (const AxisTick& tick : axis.ticks)
        widest = std::max(widest, measure(tick.label, kTickStyle).width);
    return widest;
}

Axis bar_axis(const ColourScale& scale, double height) {
    return quantity_axis(scale.title, scale.unit, scale.low, scale.high,
                         static_cast<std::size_t>(std::clamp(height / 38, 3.0, 9.0)));
}

double line_height(const TextStyle& style) {
    return measure("0", style).height;
}

} // namespace

double most_pixels(std::size_t samples, double room) {
    return std::min(room, std::max(360.0, 160.0 * static_cast<double>(samples)));
}

PlaneAxes plan_axes(const SliceAxes& samples) {
    const double u = axis_extent(samples.u, samples.u_spacing), v = axis_extent(samples.v, samples.v_spacing);
    const double longer = std::max(u, v), shorter = std::min(u, v);
    PlaneAxes axes{samples, {}, {}, choose_unit(longer, "m"), v / u, "", ""};
    const std::string u_name = kAxisNames[samples.axis[0]], v_name = kAxisNames[samples.axis[1]];
    const auto add = [&](AxisMaker& make, const std::string& name, const std::vector<double>& along, double spacing,
                         double extent) {
        const Unit unit = longer > kSharedUnitRatio * shorter ? choose_unit(extent, "m") : axes.longer_unit;
        make = [=](std::size_t most) { return make_axis(name, along, spacing, unit, most); };
        const double count = std::round((along.back() - along.front()) / spacing) + 1;
        if (spacing > 0 && count >= static_cast<double>(along.size()) + 0.5)
            axes.sampling_note += fmt::format("{}{} of {:.0f} samples along {}",
                                              axes.sampling_note.empty() ? "shown: " : ", ", along.size(), count, name);
    };
    add(axes.across, u_name, samples.u, samples.u_spacing, u);
    add(axes.up, v_name, samples.v, samples.v_spacing, v);
    if (longer > kMaxAspect * shorter) {
        axes.aspect = u > v ? 1 / kMaxAspect : kMaxAspect;
        axes.stretch_note = fmt::format("not to scale: {} is stretched {} times", u > v ? v_name : u_name,
                                        three_digits(longer / shorter / kMaxAspect));
    }
    return axes;
}

// The most ticks that look neither crowded nor bare; more rather than fewer than two; else the outer ones, or one.
Axis fit_axis(double pixels, bool vertical, const AxisMaker& make) {
    const auto roomy = static_cast<std::size_t>(std::clamp(pixels / (vertical ? 45 : 80), 2.0, 12.0));
    for (const bool upwards : {false, true})
        for (std::size_t most = roomy; most >= 2 && most <= roomy + 4; upwards ? ++most : --most) {
            Axis axis = make(most);
            if (labels_clear(axis, pixels, vertical) && axis.ticks.size() >= 2)
                return axis;
        }
    Axis axis = make(3);
    axis.ticks.erase(axis.ticks.begin() + 1, std::max(axis.ticks.begin() + 1, axis.ticks.end() - 1));
    if (!labels_clear(axis, pixels, vertical))
        axis.ticks.resize(1);
    return axis;
}

double left_room(const Axis& axis, bool title) {
    return kTickLength + 4 + widest_label(axis) + (title && !axis.title.empty() ? 8 + line_height(kUpStyle) : 0);
}

double bottom_room(bool title) {
    return kTickLength + 3 + line_height(kTickStyle) + (title ? 4 + line_height(kBelowStyle) : 0);
}

void draw_axes(Canvas& canvas, const Box& plot, const Axis& x, const Axis& y, const AxesStyle& style) {
    const double bottom = plot.y + plot.height, right = plot.x + plot.width;
    const auto across = [&](double fraction, bool along_x, double from, double to, Rgb8 colour) {
        const double at = along_x ? plot.x + fraction * plot.width : bottom - fraction * plot.height;
        canvas.polyline(along_x ? std::array{Point{at, from}, Point{at, to}}
                                : std::array{Point{from, at}, Point{to, at}},
                        {colour, 1, {}, false});
        return at;
    };
    if (style.grid)
        for (const auto& [axis, along_x] : {std::pair(&x, true), std::pair(&y, false)})
            for (const AxisTick& tick : axis->ticks)
                across(tick.fraction, along_x, along_x ? plot.y : plot.x, along_x ? bottom : right, kGridInk);
    canvas.outline({plot.x - 0.5, plot.y - 0.5, plot.width + 1, plot.height + 1}, {});
    for (const double fraction : x.minor)
        across(fraction, true, bottom, bottom + kTickLength / 2, kInk);
    for (const double fraction : y.minor)
        across(fraction, false, plot.x - kTickLength / 2, plot.x, kInk);
    for (const AxisTick& tick : x.ticks) {
        const double at = across(tick.fraction, true, bottom, bottom + kTickLength, kInk);
        if (style.bottom_labels)
            canvas.text(tick.label, {at, bottom + kTickLength + 3}, kTickStyle);
    }
    for (const AxisTick& tick : y.ticks) {
        const double at = across(tick.fraction, false, plot.x - kTickLength, plot.x, kInk);
        if (style.left_labels)
            canvas.text(tick.label, {plot.x - kTickLength - 4, at}, kLeftStyle);
    }
}

void draw_axis_titles(Canvas& canvas, const Box& plot, const Axis& x, const Axis& y) {
    if (!x.title.empty())
        canvas.text(x.title, {plot.x + plot.width / 2, plot.y + plot.height + bottom_room(false) + 4}, kBelowStyle);
    if (!y.title.empty())
        canvas.text(y.title, {plot.x - left_room(y, false) - 8, plot.y + plot.height / 2}, kUpStyle);
}

double colour_bar_width(const ColourScale& scale, double height) {
    if (!scale.shows())
        return 0;
    return kBarWidth + kTickLength + 4 + widest_label(bar_axis(scale, height)) + 10 + line_height(kBarTitleStyle);
}

double colour_bar_least_height(const ColourScale& scale) {
    return scale.shows() ? measure(bar_axis(scale, 300).title, kBarTitleStyle).height + 8 : 0;
}

void draw_colour_bar(Canvas& canvas, Point upper_left, double height, const ColourScale& scale) {
    if (!scale.shows())
        return;
    const Axis axis = bar_axis(scale, height);
    const double right = upper_left.x + kBarWidth;
    const auto rows = static_cast<int>(height);
    std::vector<std::uint32_t> pixels;
    for (int y = 0; y < rows; ++y)
        pixels.insert(pixels.end(), static_cast<std::size_t>(kBarWidth),
                      packed(colour_at(scale.map, (rows - y - 0.5) / rows)));
    canvas.image(static_cast<int>(upper_left.x), static_cast<int>(upper_left.y), static_cast<int>(kBarWidth), rows,
                 pixels);
    canvas.outline({upper_left.x - 0.5, upper_left.y - 0.5, kBarWidth + 1, height + 1}, {});
    for (const AxisTick& tick : axis.ticks) {
        const double y = upper_left.y + (1 - tick.fraction) * height;
        canvas.polyline(std::array{Point{right, y}, Point{right + kTickLength, y}}, {});
        canvas.text(tick.label, {right + kTickLength + 4, y}, kBarTickStyle);
    }
    canvas.text(axis.title, {right + kTickLength + 4 + widest_label(axis) + 10, upper_left.y + height / 2},
                kBarTitleStyle);
}

Heading plan_heading(const Look& look, const std::vector<std::string>& notes) {
    constexpr std::size_t kMostBytes = 600, kMostLines = 5;
    const double width = look.width - 2 * kMargin;
    const std::string name = look.title.substr(0, kMostBytes);
    Heading heading;
    heading.name_style = {kTitleSize, true, Horizontal::left, Vertical::top, false};
    heading.note_style = {kTextSize, false, Horizontal::left, Vertical::top, false};
    heading.name = wrap(name, heading.name_style, width);
    if (heading.name.size() > 2) {
        heading.name_style.size = kTextSize;
        heading.name = wrap(name, heading.name_style, width);
    }
    if (heading.name.size() > kMostLines || look.title.size() > kMostBytes) {
        heading.name.resize(std::min(heading.name.size(), kMostLines));
        heading.name.back() = wrap(heading.name.back(), heading.name_style, width - 40).front() + "…";
    }
    for (const std::string& note : notes)
        for (const std::string& line : wrap(note, heading.note_style, width))
            heading.notes.push_back(line);
    heading.height = static_cast<double>(heading.name.size()) * line_height(heading.name_style) + 4 +
                     static_cast<double>(heading.notes.size()) * line_height(heading.note_style);
    return heading;
}

void draw_heading(Canvas& canvas, const Heading& heading) {
    double y = kMargin;
    for (const auto& [lines, style, gap] :
         {std::tuple(&heading.name, &heading.name_style, 4.0), std::tuple(&heading.notes, &heading.note_style, 0.0)}) {
        for (const std::string& line : *lines) {
            canvas.text(line, {kMargin, y}, *style);
            y += line_height(*style);
        }
        y += gap;
    }
}

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

LegendItem line_item(std::string text, Stroke stroke, double width) {
    return {std::move(text), width, [stroke = std::move(stroke)](Canvas& canvas, Point left, Point right) {
                canvas.polyline(std::array{left, right}, stroke);
            }};
}

LegendItem swatch_item(std::string text, Rgb8 colour, std::function<void(Canvas&, const Box&)> more) {
    return {std::move(text), kSwatch, [colour, more = std::move(more)](Canvas& canvas, Point left, Point) {
                const Box box{left.x, left.y - kSwatch / 2, kSwatch, kSwatch};
                canvas.fill(box, colour);
                if (more)
                    more(canvas, box);
                canvas.outline(box, {});
            }};
}

void draw_arrow(Canvas& canvas, Point tail, Point tip) {
    const double length = std::hypot(tip.x - tail.x, tip.y - tail.y);
    if (length < kLeastArrowLength) {
        const Point middle{(tail.x + tip.x) / 2, (tail.y + tip.y) / 2};
        canvas.disc(middle, 3, kInk);
        canvas.disc(middle, 1.8, kPaper);
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

namespace {

namespace geometry = boost::geometry;
using Shape = geometry::model::box<Point>;

bool finite(Point p) {
    return std::isfinite(p.x) && std::isfinite(p.y);
}

Shape shape_of(const Box& box, double border) {
    return {{box.x - border, box.y - border}, {box.x + box.width + border, box.y + box.height + border}};
}

} // namespace

std::vector<std::vector<Point>> visible_pieces(std::span<const Point> line, const Box& box) {
    constexpr double kBorder = 8; // pixels: the width of a line with its halo, so that its cut ends stay outside
    constexpr double kNear = 1.0 / 3;
    std::vector<std::vector<Point>> pieces;
    geometry::model::linestring<Point> run;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i < line.size() && finite(line[i])) {
            const bool last = i + 1 == line.size() || !finite(line[i + 1]);
            if (run.empty() || last || std::hypot(line[i].x - run.back().x, line[i].y - run.back().y) >= kNear)
                run.push_back(line[i]);
            continue;
        }
        std::vector<geometry::model::linestring<Point>> seen;
        if (run.size() > 1)
            geometry::intersection(run, shape_of(box, kBorder), seen);
        for (const auto& piece : seen)
            pieces.emplace_back(piece.begin(), piece.end());
        run.clear();
    }
    return pieces;
}

bool crosses(Point from, Point to, const Box& box) {
    return finite(from) && finite(to) &&
           geometry::intersects(geometry::model::segment<Point>(from, to), shape_of(box, 0));
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
