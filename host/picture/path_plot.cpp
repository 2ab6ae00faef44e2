// Over x: explored paths with the section of the surface and where the force pointed, and the force along a stroke.
#include <algorithm>
#include <cmath>
#include <numbers>

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
    // With a border, and never empty; `least` of border at no width, and that share of the size always.
    Range widened(double least, double share = 1e-9) const {
        if (!(low <= high))
            return {-least, least};
        const double border = std::max(0.05 * (high - low), share * std::max(std::fabs(low), std::fabs(high)));
        return border > 0 ? Range{low - border, high + border} : Range{low - least, high + least};
    }
};

Range in_unit(const Range& range, const Unit& unit) {
    return {divide_by_power_of_ten(range.low, unit.exponent), divide_by_power_of_ten(range.high, unit.exponent)};
}

ChartSeries line_of(std::string name, const std::vector<LinePoint>& line, std::vector<Stroke> strokes) {
    ChartSeries series{std::move(name), {}, false, true, false, std::move(strokes)};
    for (const LinePoint& point : line)
        series.points.push_back({point.x, point.z});
    return series;
}

// A band about its median.
ChartSeries band_of(const PathDrawing& drawing, std::string name, std::array<double, 3> PathBand::*values) {
    ChartSeries series{std::move(name), {}, false, true, false, {{kQuietInk, 2.4, {1, 5}, true}}, false, true};
    for (const PathBand& band : drawing.bands) {
        const auto& [low, median, high] = band.*values;
        series.points.push_back({band.x, median, {}, {}, low, high});
    }
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
    for (const PathBand& band : drawing.bands)
        for (const std::size_t i : {0, 2}) {
            z_bounds.add(band.z[i]);
            angles.add(band.direction[i]);
        }
    Chart section, below;
    if (!drawing.bands.empty()) {
        section.series.push_back(band_of(drawing, "of the paths: median, 5th to 95th percentile", &PathBand::z));
        below.series.push_back(band_of(drawing, "", &PathBand::direction));
    }
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

Picture draw_stroke(const Look& look, const std::vector<std::string>& notes, std::span<const StrokedForce> forces,
                    bool differs) {
    struct Panel {
        std::string name;
        bool in_newtons;
        double least; // of border
        double (*value)(const std::array<double, 3>& force);
    };
    static constexpr double kPanelHeight = 260;
    static const std::array<Panel, 3> kPanels{
        {{"force direction", false, 1,
          [](const std::array<double, 3>& force) {
              return force[0] == 0 && force[2] == 0 ? NAN : std::atan2(force[0], force[2]) * 180 / std::numbers::pi;
          }},
         {"force along x", true, 1e-6, [](const std::array<double, 3>& force) { return force[0]; }},
         {"force along z", true, 1e-6, [](const std::array<double, 3>& force) { return force[2]; }}}};
    Bounds x;
    double largest = 0;
    for (const StrokedForce& one : forces) {
        x.add(one.x);
        for (const double part : {one.force[0], one.force[2], one.unshaded[0], one.unshaded[2]})
            largest = std::fmax(largest, std::fabs(part));
    }
    const Unit unit = choose_unit(std::isfinite(largest) && largest > 0 ? largest : 1, "N");
    const Range across = x.widened(kLeastBreadth / 2);
    std::vector<Chart> charts;
    for (const Panel& panel : kPanels) {
        Chart& chart = charts.emplace_back();
        Bounds bounds;
        for (const bool shaded : {false, true}) {
            if (!shaded && !differs)
                continue;
            std::vector<LinePoint> line;
            for (const StrokedForce& one : forces) {
                const double value = panel.value(shaded ? one.force : one.unshaded);
                if (!panel.in_newtons && !line.empty() && std::fabs(value - line.back().z) > 180)
                    line.push_back({one.x, NAN}); // the direction goes on from the other end of the axis
                line.push_back({one.x, value});
                bounds.add(value);
            }
            const bool named = charts.size() == 1 && differs;
            chart.series.push_back(line_of(!named   ? ""
                                           : shaded ? "shaded"
                                                    : "unshaded",
                                           line, {{series_colour(shaded ? 0 : 1), shaded ? 2.4 : 1.8, {}, true}}));
        }
        const Range y = bounds.widened(panel.least, 1e-3); // so that ticks have few digits
        chart.x.range = across;
        chart.x.make = [across](std::size_t most) { return quantity_axis("x", "m", across.low, across.high, most); };
        chart.y.range = y;
        chart.y.make = [y, panel, unit](std::size_t most) {
            return panel.in_newtons ? number_axis(panel.name + per_unit(unit), in_unit(y, unit), most, decimal)
                                    : quantity_axis(panel.name, "°", y.low, y.high, most);
        };
        chart.height = kPanelHeight;
    }
    return draw_charts(look, notes, charts);
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
