#include "host/picture/path_plot.h"

#include "host/picture/chart_style.h"
#include "host/picture/frame.h"
#include "host/picture/legend.h"
#include "host/picture/polyline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <utility>

namespace forceshade::picture {
namespace {

constexpr double kMostSectionHeight = 560; // pixels
constexpr double kAngleHeight = 360;
constexpr double kBetween = 20;        // between the upper panel's labels and the lower panel
constexpr double kHardlyWide = 0.1;    // of the height
constexpr double kLeastBreadth = 2e-3; // m: of what has neither width nor height

struct Bounds {
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

struct Section {
    Box box;
    Range x, y;
    std::vector<std::vector<Point>> pieces(const std::vector<LinePoint>& line) const {
        std::vector<Point> points;
        for (const LinePoint& point : line)
            points.push_back({box.x + x.fraction(point.x) * box.width, box.y + (1 - y.fraction(point.z)) * box.height});
        return visible_pieces(points, box);
    }
};

class PathSheet {
public:
    explicit PathSheet(const PathDrawing& drawing) : drawing_(drawing) {
        find_ranges();
        axes_ = plan_axes({{x_.low, x_.high}, {z_.low, z_.high}, 0, 0, 0, 0});
        std::vector<std::string> notes = drawing.notes;
        if (!axes_.stretch_note.empty())
            notes.push_back(axes_.stretch_note);
        heading_ = plan_heading(drawing.look, notes);
        plan_legend();
        plan(kMostSectionHeight, kAngleHeight);
        if (const int excess = height() - drawing.look.most_height; drawing.look.most_height > 0 && excess > 0) {
            const double both = section_.box.height + below_.box.height;
            const double share = std::max(both - excess, 80.0) / both;
            plan(section_.box.height * share, kAngleHeight * share);
        }
    }

    int height() const {
        return static_cast<int>(std::ceil(legend_top_ + legend_height(legend_, legend_width()) + kMargin / 2));
    }

    void draw(Canvas& canvas) const {
        draw_heading(canvas, heading_);
        draw_section(canvas);
        draw_angles(canvas);
        Axis untitled = horizontal_;
        untitled.title.clear();
        for (const auto& [panel, x, y] : {std::tuple(&section_, &std::as_const(untitled), &vertical_),
                                          std::tuple(&below_, &horizontal_, &angles_)}) {
            draw_axes(canvas, panel->box, *x, *y);
            draw_axis_titles(canvas, panel->box, *x, *y);
        }
        draw_legend(canvas, legend_, {kMargin, legend_top_}, legend_width());
    }

private:
    double legend_width() const { return drawing_.look.width - 2 * kMargin; }

    // The section keeps its shape, at most so high.
    void plan(double most_height, double angle_height) {
        angles_ = fit_axis(angle_height, true, [&](std::size_t most) {
            return quantity_axis("force direction", "°", angle_.low, angle_.high, most);
        });
        double left = left_room(angles_);
        for (const double pixels : {60.0, most_height})
            left = std::max(left, left_room(fit_vertical(axes_, pixels)));
        const double room = std::floor(legend_width() - left);
        const double width = std::floor(std::min(room, most_height / axes_.aspect));
        const double x = std::floor(kMargin + left + (room - width) / 2),
                     top = std::floor(kMargin + heading_.height + 14);
        section_ = {{x, top, width, std::round(width * axes_.aspect)}, x_, z_};
        below_ = {{x, top + section_.box.height + bottom_room(false) + kBetween, width, angle_height}, x_, angle_};
        horizontal_ = fit_horizontal(axes_, width);
        vertical_ = fit_vertical(axes_, section_.box.height);
        legend_top_ = below_.box.y + below_.box.height + bottom_room() + 14;
    }

    void find_ranges() {
        Bounds x, z, angle;
        const Breadth breadth = drawn_breadth(drawing_.paths);
        x.add(breadth.low);
        x.add(breadth.high);
        x_ = x.widened(0);
        if (!(x_.high > x_.low))
            x_ = x.widened(kLeastBreadth / 2);
        for (const DrawnPath& path : drawing_.paths) {
            for (const LinePoint& point : path.way)
                z.add(point.z);
            for (const double direction : path.direction) {
                angle.add(direction);
                any_force_ = any_force_ || std::isfinite(direction);
            }
        }
        const auto add_shown = [&](const std::vector<LinePoint>& line, Bounds& bounds) {
            for (const LinePoint& point : line)
                if (point.x >= x_.low && point.x <= x_.high)
                    bounds.add(point.z);
        };
        for (const auto* line : {&drawing_.surface.nominal, &drawing_.surface.smooth}) {
            add_shown(*line, z);
            if (drawing_.draws_normals)
                add_shown(normals_of(*line), angle);
        }
        z_ = z.widened(0);
        if (!(z_.high > z_.low))
            z_ = z.widened(0.1 * (x_.high - x_.low));
        angle_ = angle.widened(1);
    }

    Stroke stroke_of(std::size_t path, double width) const { return {series_colour(path), width, {}, true}; }

    void plan_legend() {
        const char* normals = drawing_.draws_normals ? "; below, its normal" : "";
        if (!drawing_.surface.nominal.empty())
            legend_.push_back(surface_item(fmt::format("surface{}", normals), false));
        if (!drawing_.surface.smooth.empty())
            legend_.push_back(surface_item(fmt::format("shape that the shading imitates{}", normals), true));
        for (std::size_t i = 0; i < drawing_.paths.size(); ++i)
            legend_.push_back(line_item(drawing_.paths[i].label, stroke_of(i, 2.4)));
    }

    void draw_section(Canvas& canvas) const {
        canvas.begin_clip(section_.box);
        for (const bool smooth : {true, false})
            for (const auto& piece : section_.pieces(smooth ? drawing_.surface.smooth : drawing_.surface.nominal))
                draw_surface_line(canvas, piece, smooth);
        for (std::size_t i = 0; i < drawing_.paths.size(); ++i)
            for (const auto& piece : section_.pieces(drawing_.paths[i].way))
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
            for (const auto& piece : below_.pieces(line))
                canvas.polyline(seen_as_line(piece), {lighter(series_colour(i)), 5, {}, true});
        }
        for (const bool smooth : {false, true}) // without a halo, which would hide the forces that follow them
            if (drawing_.draws_normals)
                for (const auto& piece :
                     below_.pieces(normals_of(smooth ? drawing_.surface.smooth : drawing_.surface.nominal)))
                    canvas.polyline(piece, surface_stroke(smooth, 1.4));
        canvas.end_clip();
        if (!any_force_)
            canvas.text("no force on these paths",
                        {below_.box.x + below_.box.width / 2, below_.box.y + below_.box.height / 4}, kNoteStyle,
                        kQuietInk);
    }

    const PathDrawing& drawing_;
    std::vector<LegendItem> legend_;
    Range x_, z_, angle_;
    bool any_force_ = false;
    PlaneAxes axes_;
    Axis horizontal_, vertical_, angles_;
    double legend_top_ = 0;
    Heading heading_;
    Section section_{}, below_{};
};

} // namespace

Breadth drawn_breadth(const std::vector<DrawnPath>& paths) {
    Bounds x, z;
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
    Canvas canvas(drawing.look.width, sheet.height());
    sheet.draw(canvas);
    return canvas.finish();
}

} // namespace forceshade::picture
