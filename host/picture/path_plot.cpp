// Explored paths over the section of the surface, and below it where the force pointed.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/picture/chart.h"
#include "host/picture/colours.h"
#include "host/picture/frame.h"

namespace forceshade::picture {
namespace {

constexpr double kMostSectionHeight = 560, kAngleHeight = 360; // pixels
constexpr double kHardlyWide = 0.1;                            // of the height
constexpr double kLeastBreadth = 2e-3;                         // m: of what has neither width nor height

struct Bounds {
    double low = INFINITY, high = -INFINITY;
    void add(double value) {
        if (!std::isfinite(value))
            return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    // With a border, and never empty; `least` of border at no width.
    Range widened(double least) const {
        if (!(low <= high))
            return {-least, least};
        const double border = std::max(0.05 * (high - low), 1e-9 * std::max(std::fabs(low), std::fabs(high)));
        return border > 0 ? Range{low - border, high + border} : Range{low - least, high + least};
    }
};

ChartSeries line_of(std::string name, const std::vector<LinePoint>& line, std::vector<Stroke> strokes) {
    ChartSeries series{std::move(name), {}, false, true, false, std::move(strokes)};
    for (const LinePoint& point : line)
        series.points.push_back({point.x, point.z});
    return series;
}

} // namespace

Picture draw_paths(const PathDrawing& drawing) {
    Bounds z_bounds, angles;
    const Breadth breadth = drawn_breadth(drawing.paths);
    const Range x = Bounds{breadth.low, breadth.high}.widened(kLeastBreadth / 2);
    bool any_force = false;
    for (const DrawnPath& path : drawing.paths) {
        for (const LinePoint& point : path.way)
            z_bounds.add(point.z);
        for (const double direction : path.direction) {
            angles.add(direction);
            any_force = any_force || std::isfinite(direction);
        }
    }
    Chart section, below;
    const char* normals = drawing.draws_normals ? "; below, its normal" : "";
    std::vector<ChartSeries> surfaces;
    for (const bool smooth : {true, false}) {
        const std::vector<LinePoint>& line = smooth ? drawing.surface.smooth : drawing.surface.nominal;
        const std::vector<LinePoint> turned = drawing.draws_normals ? normals_of(line) : std::vector<LinePoint>();
        for (const auto& [points, bounds] : {std::pair(&line, &z_bounds), {&turned, &angles}})
            for (const LinePoint& point : *points)
                if (point.x >= x.low && point.x <= x.high)
                    bounds->add(point.z);
        section.series.push_back(
            line_of((smooth ? "shape that the shading imitates" : "surface") + std::string(normals), line,
                    {{kPaper, 5, {}, true}, surface_stroke(smooth)}));
        surfaces.push_back(line_of("", turned, {surface_stroke(smooth, 1.4)})); // a halo would hide forces that follow
    }
    for (std::size_t i = 0; i < drawing.paths.size(); ++i) {
        const DrawnPath& path = drawing.paths[i];
        section.series.push_back(line_of(path.label, path.way, {{series_colour(i), 1.8, {}, true}}));
        std::vector<LinePoint> directions;
        for (std::size_t s = 0; s < path.way.size(); ++s)
            directions.push_back({path.way[s].x, path.direction[s]});
        below.series.push_back(line_of("", directions, {{lighter(series_colour(i)), 5, {}, true}}));
        below.series.back().bar_if_still = true;
    }
    std::ranges::reverse_copy(surfaces, std::back_inserter(below.series));
    const Range z = z_bounds.widened(0.1 * (x.high - x.low)), angle = angles.widened(1);
    const PlaneAxes axes = plan_axes({{x.low, x.high}, {z.low, z.high}, 0, 0, 0, 0});
    section.x.range = below.x.range = x;
    section.y.range = z;
    below.y.range = angle;
    section.x.make = below.x.make = axes.across;
    section.y.make = axes.up;
    below.y.make = [&](std::size_t most) { return quantity_axis("force direction", "°", angle.low, angle.high, most); };
    section.height = kMostSectionHeight;
    section.aspect = axes.aspect;
    below.height = kAngleHeight;
    below.remark = any_force ? "" : "no force on these paths";
    std::vector<std::string> notes = drawing.notes;
    if (!axes.stretch_note.empty())
        notes.push_back(axes.stretch_note);
    return draw_charts(drawing.look, notes, {section, below});
}

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

} // namespace forceshade::picture
