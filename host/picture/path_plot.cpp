#include "host/picture/path_plot.h"

#include "host/picture/frame.h"
#include "host/picture/legend.h"
#include "host/picture/polyline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace forceshade::picture {
namespace {

constexpr double kSectionHeight = 400; // pixels
constexpr double kAngleHeight = 360;
constexpr double kBetween = 46; // room for the upper panel's ticks
constexpr double kRowHeight = 26;
constexpr double kSignLength = 44;
constexpr double kItemGap = 30;
constexpr double kHardlyWide = 0.1;    // of the height
constexpr double kLeastBreadth = 2e-3; // m: of what has neither width nor height
constexpr TextStyle kUpTitleStyle{kTextSize, false, Horizontal::centre, Vertical::middle, true};
constexpr TextStyle kItemStyle{kTextSize, false, Horizontal::left, Vertical::middle, false};
// Told apart without red-green vision (Okabe and Ito 2008).
constexpr std::array<Rgb8, 6> kPathColours{Rgb8{0, 114, 178},   Rgb8{230, 159, 0},  Rgb8{0, 158, 115},
                                           Rgb8{204, 121, 167}, Rgb8{86, 180, 233}, Rgb8{120, 80, 40}};

struct Range {
    double low = INFINITY, high = -INFINITY;
    void add(double value) {
        if (!std::isfinite(value))
            return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    // With a border, and never empty.
    Range widened(double least) const {
        if (!(low <= high))
            return {-least, least};
        const double border = std::max({0.05 * (high - low), least, 1e-9 * std::max(std::fabs(low), std::fabs(high))});
        return {low - border, high + border};
    }
};

struct Panel {
    Box box;
    Range x, y;
    Point at(double u, double v) const {
        return {box.x + (u - x.low) / (x.high - x.low) * box.width,
                box.y + box.height - (v - y.low) / (y.high - y.low) * box.height};
    }
    std::vector<std::vector<Point>> pieces(const std::vector<LinePoint>& line) const {
        std::vector<Point> points;
        for (const LinePoint& point : line)
            points.push_back(at(point.x, point.z));
        return visible_pieces(points, box);
    }
};

Axis angle_axis(const Range& range) {
    const RoundTicks ticks = round_ticks(range.low, range.high, 9);
    Axis axis{"force direction / °", {}, 0, {}};
    for (const double value : ticks.values)
        axis.ticks.push_back({(value - range.low) / (range.high - range.low), decimal(value, ticks.decimals)});
    return axis;
}

struct Item {
    std::string text;
    Stroke stroke;
    Sign sign = Sign::arrow; // a surface's, or of no meaning
};

std::vector<Item> items_of(const PathDrawing& drawing) {
    std::vector<Item> items;
    if (!drawing.surface.nominal.empty())
        items.push_back({drawing.draws_normals ? "surface; below, its normal" : "surface", {}, Sign::nominal_surface});
    if (!drawing.surface.smooth.empty())
        items.push_back({drawing.draws_normals ? "shape that the shading imitates; below, its normal"
                                               : "shape that the shading imitates",
                         {},
                         Sign::smooth_shape});
    for (std::size_t i = 0; i < drawing.paths.size(); ++i)
        items.push_back({drawing.paths[i].label, {kPathColours[i % kPathColours.size()], 2.4, {}, true}});
    return items;
}

std::vector<Point> places_of(const std::vector<Item>& items, double width) {
    std::vector<Point> places;
    Point next;
    for (const Item& item : items) {
        const double size = kSignLength + 8 + measure(item.text, kItemStyle).width;
        if (next.x > 0 && next.x + size > width)
            next = {0, next.y + kRowHeight};
        places.push_back(next);
        next.x += size + kItemGap;
    }
    return places;
}

class PathSheet {
public:
    explicit PathSheet(const PathDrawing& drawing) : drawing_(drawing), items_(items_of(drawing)) {
        find_ranges();
        const SliceAxes samples{{x_.low, x_.high}, {z_.low, z_.high}, 0, 0, 0, 0};
        axes_ = plan_axes("x", "z", samples);
        std::vector<std::string> notes = drawing.notes;
        horizontal_ = fit_horizontal(axes_, kSheetWidth - 200);
        vertical_ = fit_vertical(axes_, kSectionHeight);
        angles_ = angle_axis(angle_);
        left_ = kMargin + measure("0", kUpTitleStyle).width + 10 +
                std::max(left_labels_width(vertical_), left_labels_width(angles_));
        const double width = std::floor(kSheetWidth - kMargin - left_);
        const double stretch = (x_.high - x_.low) / width / ((z_.high - z_.low) / kSectionHeight);
        if (stretch > 1.05 || stretch < 0.95)
            notes.push_back(fmt::format("not to scale: {} is stretched {} times", stretch > 1 ? "z" : "x",
                                        three_digits(std::max(stretch, 1 / stretch))));
        heading_ = plan_heading(drawing.name, notes);
        const double top = std::floor(kMargin + heading_.height + 14);
        section_ = {{std::floor(left_), top, width, kSectionHeight}, x_, z_};
        below_ = {{std::floor(left_), top + kSectionHeight + kBetween, width, kAngleHeight}, x_, angle_};
        legend_top_ = below_.box.y + below_.box.height + bottom_labels_height() + measure("0", kAxisStyle).height + 18;
        places_ = places_of(items_, kSheetWidth - 2 * kMargin);
    }

    int height() const {
        const double rows = places_.empty() ? 0 : places_.back().y + kRowHeight;
        return static_cast<int>(std::ceil(legend_top_ + rows + kMargin));
    }

    void draw(Canvas& canvas) const {
        draw_heading(canvas, heading_);
        draw_section(canvas);
        draw_angles(canvas);
        draw_frame(canvas, section_, vertical_, vertical_.title, false);
        draw_frame(canvas, below_, angles_, angles_.title, true);
        draw_items(canvas);
    }

private:
    void find_ranges() {
        Range x, z, angle;
        const Breadth breadth = drawn_breadth(drawing_.paths);
        x.add(breadth.low);
        x.add(breadth.high);
        for (const DrawnPath& path : drawing_.paths)
            for (const LinePoint& point : path.way)
                z.add(point.z);
        x_ = x.widened(0);
        if (!(x_.high > x_.low))
            x_ = x.widened(kLeastBreadth / 2);
        for (const auto* line : {&drawing_.surface.nominal, &drawing_.surface.smooth}) {
            for (const LinePoint& point : *line)
                if (point.x >= x_.low && point.x <= x_.high)
                    z.add(point.z);
            if (drawing_.draws_normals)
                for (const LinePoint& point : normals_of(*line))
                    if (point.x >= x_.low && point.x <= x_.high)
                        angle.add(point.z);
        }
        z_ = z.widened(0);
        if (!(z_.high > z_.low))
            z_ = z.widened(0.1 * (x_.high - x_.low));
        for (const DrawnPath& path : drawing_.paths)
            for (const double direction : path.direction) {
                angle.add(direction);
                any_force_ = any_force_ || std::isfinite(direction);
            }
        angle_ = angle.widened(1);
    }

    void draw_lines(Canvas& canvas, const Panel& panel, const std::vector<LinePoint>& line, Sign sign) const {
        for (const std::vector<Point>& piece : panel.pieces(line))
            draw_surface_line(canvas, piece, sign);
    }

    Stroke stroke_of(std::size_t path, double width) const {
        return {kPathColours[path % kPathColours.size()], width, {}, true};
    }

    void draw_section(Canvas& canvas) const {
        canvas.begin_clip(section_.box);
        draw_lines(canvas, section_, drawing_.surface.smooth, Sign::smooth_shape);
        draw_lines(canvas, section_, drawing_.surface.nominal, Sign::nominal_surface);
        for (std::size_t i = 0; i < drawing_.paths.size(); ++i)
            for (const std::vector<Point>& piece : section_.pieces(drawing_.paths[i].way))
                canvas.polyline(piece, stroke_of(i, 1.4));
        canvas.end_clip();
    }

    void draw_angles(Canvas& canvas) const {
        canvas.begin_clip(below_.box);
        for (std::size_t i = 0; i < drawing_.paths.size(); ++i) {
            const DrawnPath& path = drawing_.paths[i];
            std::vector<LinePoint> line;
            for (std::size_t s = 0; s < path.way.size(); ++s)
                line.push_back({path.way[s].x, path.direction[s]});
            for (const std::vector<Point>& piece : below_.pieces(line))
                canvas.polyline(seen_as_line(piece), stroke_of(i, 3.2));
        }
        if (drawing_.draws_normals)
            for (const auto& [line, sign] : {std::pair(&drawing_.surface.nominal, Sign::nominal_surface),
                                             std::pair(&drawing_.surface.smooth, Sign::smooth_shape)})
                for (const std::vector<Point>& piece : below_.pieces(normals_of(*line)))
                    draw_normals(canvas, piece, sign);
        canvas.end_clip();
        if (!any_force_)
            canvas.text("no force on these paths",
                        {below_.box.x + below_.box.width / 2, below_.box.y + below_.box.height / 4}, kNoteStyle,
                        {110, 110, 110});
    }

    // Without a halo, which would hide the forces that follow them.
    static void draw_normals(Canvas& canvas, const std::vector<Point>& piece, Sign sign) {
        const bool dashed = sign == Sign::smooth_shape;
        canvas.polyline(piece, {dashed ? Rgb8{200, 20, 60} : kInk, 1.4,
                                dashed ? std::vector<double>{9, 5} : std::vector<double>{}, true});
    }

    void draw_frame(Canvas& canvas, const Panel& panel, const Axis& up, const std::string& title, bool names_x) const {
        canvas.outline({panel.box.x - 0.5, panel.box.y - 0.5, panel.box.width + 1, panel.box.height + 1}, {});
        draw_left_ticks(canvas, panel.box, up, true);
        draw_bottom_ticks(canvas, panel.box, horizontal_, true);
        canvas.text(title, {kMargin + measure("0", kUpTitleStyle).width / 2, panel.box.y + panel.box.height / 2},
                    kUpTitleStyle);
        if (names_x)
            canvas.text(
                horizontal_.title,
                {panel.box.x + panel.box.width / 2, panel.box.y + panel.box.height + bottom_labels_height() + 4},
                kAxisStyle);
    }

    void draw_items(Canvas& canvas) const {
        for (std::size_t i = 0; i < items_.size(); ++i) {
            const Point from{kMargin + places_[i].x, legend_top_ + places_[i].y + kRowHeight / 2};
            const Point to{from.x + kSignLength, from.y};
            if (items_[i].sign != Sign::arrow)
                draw_surface_line(canvas, {from, to}, items_[i].sign);
            else
                canvas.polyline(std::vector<Point>{from, to}, items_[i].stroke);
            canvas.text(items_[i].text, {to.x + 8, to.y}, kItemStyle);
        }
    }

    const PathDrawing& drawing_;
    std::vector<Item> items_;
    Range x_, z_, angle_;
    bool any_force_ = false;
    PlaneAxes axes_;
    Axis horizontal_, vertical_, angles_;
    double left_ = 0, legend_top_ = 0;
    Heading heading_;
    Panel section_{}, below_{};
    std::vector<Point> places_;
};

} // namespace

Breadth drawn_breadth(const std::vector<DrawnPath>& paths) {
    Range x, z;
    for (const DrawnPath& path : paths)
        for (const LinePoint& point : path.way) {
            x.add(point.x);
            z.add(point.z);
        }
    const double width = x.high - x.low;
    const double height = z.high > z.low ? z.high - z.low : kLeastBreadth;
    if (width >= 0 && width <= kHardlyWide * height) {
        const double middle = x.low + width / 2;
        return {middle - height / 2, middle + height / 2};
    }
    return {x.low, x.high};
}

std::vector<LinePoint> normals_of(const std::vector<LinePoint>& line) {
    std::vector<LinePoint> normals;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double along = line[i].x - line[i - 1].x, up = line[i].z - line[i - 1].z;
        const double angle = std::atan2(-up, along) * 180 / std::numbers::pi;
        normals.push_back({line[i - 1].x, angle});
        normals.push_back({line[i].x, angle});
    }
    return normals;
}

Picture draw_paths(const PathDrawing& drawing) {
    const PathSheet sheet(drawing);
    Canvas canvas(static_cast<int>(kSheetWidth), sheet.height());
    sheet.draw(canvas);
    return canvas.finish();
}

} // namespace forceshade::picture
