// The arrow plot: |F| as colour, the in-plane force as arrows, the surfaces as lines.
#include "host/picture/frame.h"
#include "host/picture/legend.h"
#include "host/picture/picture.h"
#include "host/picture/polyline.h"
#include "host/picture/raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>

namespace forceshade::picture {
namespace {

constexpr double kMostPlotHeight = 860; // pixels
constexpr double kLeastPlotSide = 40;
constexpr double kLeastArrowPitch = 44; // pixels between arrows
constexpr double kLongestArrow = 90;
constexpr std::string_view kNoForce = "no force in this slice";

struct ArrowPlot {
    const FieldSlice& slice;
    MagnitudeSlice magnitude;
    Census census;
    PlaneAxes axes;
    Box plot{}; // pixels, whole
    Axis horizontal{}, vertical{};
    std::vector<std::size_t> columns{}, rows{}; // samples that carry an arrow
    double longest_arrow = 0;                   // pixels, for largest_in_plane
    double largest_in_plane = 0;                /* N */

    Point place(std::size_t column, std::size_t row) const {
        const SliceAxes& s = slice.axes;
        return place_at(s.u[column] - s.u[0], s.v[row] - s.v[0]);
    }
    // Coordinates from the first sample, m.
    Point place_at(double u, double v) const {
        const SliceAxes& s = slice.axes;
        return {plot.x + (u + s.u_spacing / 2) / axis_extent(s.u, s.u_spacing) * plot.width,
                plot.y + plot.height - (v + s.v_spacing / 2) / axis_extent(s.v, s.v_spacing) * plot.height};
    }
};

// Every n-th sample, so that arrows stand at least kLeastArrowPitch apart and half of that from both ends.
std::vector<std::size_t> arrow_samples(std::size_t samples, double pixels) {
    const double apart = pixels / static_cast<double>(samples);
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(kLeastArrowPitch / apart)));
    const std::size_t count = std::max<std::size_t>(1, samples / stride);
    std::vector<std::size_t> chosen(count);
    for (std::size_t i = 0; i < count; ++i)
        chosen[i] = (samples - 1 - (count - 1) * stride) / 2 + i * stride;
    return chosen;
}

// So that arrows, centred on their samples, neither touch each other nor reach out of the plot.
double longest_along(const std::vector<std::size_t>& chosen, std::size_t samples, double pixels) {
    const double apart = pixels / static_cast<double>(samples);
    const double stride = static_cast<double>(chosen.size() > 1 ? chosen[1] - chosen[0] : samples);
    const double below = static_cast<double>(chosen.front()) + 0.5;
    const double above = static_cast<double>(samples - chosen.back()) - 0.5;
    return std::min({0.95 * stride, 2 * below, 2 * above}) * apart;
}

void plan_arrows(ArrowPlot& p) {
    const SliceAxes& s = p.slice.axes;
    p.columns = arrow_samples(s.u.size(), p.plot.width);
    p.rows = arrow_samples(s.v.size(), p.plot.height);
    const double longest_u = longest_along(p.columns, s.u.size(), p.plot.width);
    const double longest_v = longest_along(p.rows, s.v.size(), p.plot.height);
    p.longest_arrow = std::min({longest_u, longest_v, kLongestArrow});
}

void draw_force_arrows(Canvas& canvas, const ArrowPlot& p) {
    for (const std::size_t row : p.rows)
        for (const std::size_t column : p.columns) {
            const std::size_t sample = row * p.slice.axes.u.size() + column;
            const auto& force = p.slice.force[sample];
            const double magnitude = p.magnitude.magnitude[sample];
            if (!std::isfinite(magnitude) || magnitude == 0 || p.largest_in_plane == 0)
                continue;
            const double x = force[0] / p.largest_in_plane * p.longest_arrow;
            const double z = force[2] / p.largest_in_plane * p.longest_arrow;
            const Point middle = p.place(column, row);
            draw_arrow(canvas, {middle.x - x / 2, middle.y + z / 2}, {middle.x + x / 2, middle.y - z / 2});
        }
}

void draw_line(Canvas& canvas, const ArrowPlot& p, const std::vector<LinePoint>& line, Sign sign) {
    std::vector<Point> points;
    for (const LinePoint& point : line)
        points.push_back(p.place_at(point.x - p.slice.axes.u[0], point.z - p.slice.axes.v[0]));
    for (const std::vector<Point>& piece : visible_pieces(points, p.plot))
        draw_surface_line(canvas, piece, sign);
}

std::vector<std::string> notes_of(const ArrowPlot& p) {
    const SliceAxes& s = p.slice.axes;
    const std::string where = position_labels("y", {s.at}, s.at_spacing, p.axes.longer_unit).front();
    std::vector<std::string> notes{fmt::format("x–z slice at {}: force magnitude |F| as colour{}, in-plane force (Fx, "
                                               "Fz) as arrows centred on their samples",
                                               where, largest_note(p.census.largest))};
    if (!p.axes.stretch_note.empty())
        notes.push_back(p.axes.stretch_note + "; arrows keep their true direction");
    if (const std::string sampling = sampling_note(p.axes); !sampling.empty())
        notes.push_back(sampling);
    return notes;
}

std::vector<LegendItem> legend_of(const ArrowPlot& p, const SurfaceLines& lines) {
    std::vector<LegendItem> items;
    if (p.largest_in_plane > 0) {
        const Unit unit = choose_unit(p.largest_in_plane, "N");
        const double largest = divide_by_power_of_ten(p.largest_in_plane, unit.exponent); // in that unit
        const double key = round_below(largest), least = kLeastArrowLength / p.longest_arrow * largest;
        items.push_back({Sign::arrow,
                         fmt::format("in-plane force of {} (dot: under {})", with_unit(decimal(key, 0), unit),
                                     with_unit(three_digits(least), unit)),
                         key / largest * p.longest_arrow});
    }
    if (!lines.nominal.empty())
        items.push_back({Sign::nominal_surface, "nominal surface"});
    if (!lines.smooth.empty())
        items.push_back({Sign::smooth_shape, "smooth shape"});
    if (p.census.zero > 0)
        items.push_back({Sign::no_force, "no force (|F| = 0)"});
    if (p.census.non_finite > 0)
        items.push_back({Sign::non_finite,
                         fmt::format("not a finite number ({} of {} samples)", p.census.non_finite, p.census.samples)});
    return items;
}

// What the scales of a slice are made for, N.
struct Scale {
    double largest = 0, largest_in_plane = 0;
};

Scale scale_of(const FieldSlice& slice) {
    Scale scale{take_census(magnitude_of(slice).magnitude).largest, 0};
    for (const auto& force : slice.force) {
        const double in_plane = std::hypot(force[0], force[2]);
        if (std::isfinite(in_plane) && std::isfinite(force[1]))
            scale.largest_in_plane = std::max(scale.largest_in_plane, in_plane);
    }
    return scale;
}

ArrowPlot plan_plot(const FieldSlice& slice, const Scale& scale) {
    ArrowPlot p{
        .slice = slice, .magnitude = magnitude_of(slice), .census = {}, .axes = plan_axes("x", "z", slice.axes)};
    p.census = take_census(p.magnitude.magnitude);
    p.census.largest = scale.largest;
    p.largest_in_plane = scale.largest_in_plane;
    const double left = left_labels_width(fit_vertical(p.axes, kMostPlotHeight)) + 40;
    const double right = kBarGap + colour_bar_width(p.census.largest, kMostPlotHeight) + 10;
    const double room = kSheetWidth - 2 * kMargin - left - right;
    const double aspect = p.axes.v_length / p.axes.u_length;
    const double width = most_pixels(slice.axes.u.size(), room);
    const double height = most_pixels(slice.axes.v.size(), kMostPlotHeight);
    p.plot.width = std::max(std::floor(std::min(width, height / aspect)), kLeastPlotSide);
    p.plot.height = std::max(std::round(p.plot.width * aspect), kLeastPlotSide);
    p.horizontal = fit_horizontal(p.axes, p.plot.width);
    p.vertical = fit_vertical(p.axes, p.plot.height);
    plan_arrows(p);
    return p;
}

void draw_plot(Canvas& canvas, const ArrowPlot& p, const SurfaceLines& lines) {
    const auto width = static_cast<int>(p.plot.width), height = static_cast<int>(p.plot.height);
    canvas.image(static_cast<int>(p.plot.x), static_cast<int>(p.plot.y), width, height,
                 rasterise(p.magnitude, width, height, p.census.largest));
    canvas.begin_clip(p.plot);
    draw_force_arrows(canvas, p);
    draw_line(canvas, p, lines.nominal, Sign::nominal_surface);
    draw_line(canvas, p, lines.smooth, Sign::smooth_shape);
    canvas.end_clip();
    canvas.outline({p.plot.x - 0.5, p.plot.y - 0.5, p.plot.width + 1, p.plot.height + 1}, {});
    draw_bottom_ticks(canvas, p.plot, p.horizontal, true);
    draw_left_ticks(canvas, p.plot, p.vertical, true);
    const Point middle{p.plot.x + p.plot.width / 2, p.plot.y + p.plot.height / 2};
    if (p.census.zero == p.census.samples) {
        const Extent size = measure(kNoForce, kNoteStyle);
        canvas.fill({middle.x - size.width / 2 - 4, middle.y - size.height / 2, size.width + 8, size.height}, kPaper);
        canvas.text(kNoForce, middle, kNoteStyle, kQuietInk);
    }
    canvas.text(p.horizontal.title, {middle.x, p.plot.y + p.plot.height + bottom_labels_height() + 4}, kAxisStyle);
    canvas.text(p.vertical.title, {p.plot.x - left_labels_width(p.vertical) - 8, middle.y}, kUpAxisStyle);
}

// A plot with all that stands around it.
struct ArrowSheet {
    ArrowSheet(const std::string& name, const FieldSlice& slice, const SurfaceLines& drawn, const Scale& scale)
        : p(plan_plot(slice, scale)), lines(drawn), heading(plan_heading(name, notes_of(p))),
          legend(legend_of(p, lines)) {
        const double largest = p.census.largest;
        const Extent vertical_title = measure(p.vertical.title, kUpAxisStyle);
        body = std::ceil(std::max({p.plot.height, colour_bar_least_height(largest), vertical_title.height}));
        const double left = left_labels_width(p.vertical) + 8 + vertical_title.width;
        const double width = left + p.plot.width + kBarGap + colour_bar_width(largest, body);
        top = std::ceil(kMargin + heading.height + 18);
        p.plot.x = std::round((kSheetWidth - width) / 2 + left);
        p.plot.y = top + std::round((body - p.plot.height) / 2);
        below = top + body + bottom_labels_height() + 4 + measure("x", kAxisStyle).height + 14;
    }

    int height() const {
        return static_cast<int>(std::ceil(below + legend_height(legend, kLegendWidth) + kMargin / 2));
    }

    void draw(Canvas& canvas) const {
        draw_heading(canvas, heading);
        draw_plot(canvas, p, lines);
        draw_colour_bar(canvas, {p.plot.x + p.plot.width + kBarGap, top}, body, p.census.largest);
        draw_legend(canvas, legend, {kMargin, below}, kLegendWidth);
    }

    static constexpr double kLegendWidth = kSheetWidth - 2 * kMargin;
    ArrowPlot p;
    const SurfaceLines& lines;
    Heading heading;
    std::vector<LegendItem> legend;
    double body = 0, top = 0, below = 0; // pixels
};

} // namespace

Picture draw_arrows(const std::string& name, const FieldSlice& slice, const SurfaceLines& lines) {
    assert(slice.force.size() == slice.axes.u.size() * slice.axes.v.size() && !slice.force.empty());
    const ArrowSheet sheet(name, slice, lines, scale_of(slice));
    Canvas canvas(static_cast<int>(kSheetWidth), sheet.height());
    sheet.draw(canvas);
    return canvas.finish();
}

Picture draw_side_by_side(const NamedSlice& left, const NamedSlice& right, const SurfaceLines& lines) {
    const Scale one = scale_of(left.slice), other = scale_of(right.slice);
    const Scale scale{std::max(one.largest, other.largest), std::max(one.largest_in_plane, other.largest_in_plane)};
    const ArrowSheet first(left.name, left.slice, lines, scale), second(right.name, right.slice, lines, scale);
    Canvas canvas(2 * static_cast<int>(kSheetWidth), std::max(first.height(), second.height()));
    first.draw(canvas);
    canvas.shift(static_cast<int>(kSheetWidth));
    second.draw(canvas);
    return canvas.finish();
}

} // namespace forceshade::picture
