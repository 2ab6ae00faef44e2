// Slices side by side on one sheet, and what the pictures of a field show by them: a mosaic, arrows, what shading
// changes.
#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "host/picture/frame.h"

namespace forceshade::picture {
namespace {

struct Panel {
    std::string label; // above it
    ValueSlice values; // its axes are those of all panels, but for `at`
    std::size_t scale = 0;
    FieldSlice force{}; // drawn as arrows unless it has no samples
};

struct PanelSheet {
    Look look;
    std::vector<std::string> notes; // below the title
    std::vector<Panel> panels;      // at least one
    std::vector<ColourScale> scales;
    SurfaceLines lines; // over every panel
    Touch touch{};      // where arrows stand along
    std::vector<std::vector<ContourPoint>> touched{};
};

constexpr double kRoomForOne = 860, kRoomForMany = 1100; // pixels: the height of all panels together
constexpr double kLeastPanelSide = 8;
constexpr std::size_t kShownTiles = 12;
constexpr double kLeastArrowPitch = 44; // pixels between arrows
constexpr double kLongestArrow = 36, kShortestArrow = 20;
constexpr double kLeastInPlane = 0.5; // of the force: it points out of the plane by 60 degrees
constexpr double kLeastBarHeight = 180;
constexpr double kBarHeight = 500; // pixels: for which the width of bars is known well enough
constexpr TextStyle kPanelStyle{kSmallTextSize, false, Horizontal::left, Vertical::bottom, false};

// The samples along one side of a panel that carry an arrow: every n-th, so that arrows stand kLeastArrowPitch apart
// and half of that from both ends; and how long arrows may be to neither touch each other nor leave the panel.
struct ArrowRow {
    std::vector<std::size_t> samples;
    double longest = 0; // pixels

    ArrowRow(std::size_t count, double pixels) {
        const double apart = pixels / static_cast<double>(count);
        const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(kLeastArrowPitch / apart)));
        const std::size_t arrows = std::max<std::size_t>(1, count / stride);
        const std::size_t first = (count - 1 - (arrows - 1) * stride) / 2;
        for (std::size_t i = 0; i < arrows; ++i)
            samples.push_back(first + i * stride);
        longest = std::min({0.95 * static_cast<double>(arrows > 1 ? stride : count),
                            2 * (static_cast<double>(samples.front()) + 0.5),
                            2 * (static_cast<double>(count - samples.back()) - 0.5)}) *
                  apart;
    }
};

// Empty without a force.
std::optional<std::array<double, 3>> direction_of(std::array<double, 3> force) {
    const double largest = std::max({std::fabs(force[0]), std::fabs(force[1]), std::fabs(force[2])});
    if (largest == 0)
        return std::nullopt;
    for (double& part : force)
        part /= largest; // no square overflows or vanishes
    const double length = std::hypot(force[0], force[1], force[2]);
    return std::array{force[0] / length, force[1] / length, force[2] / length};
}

bool is_free(const ValueSlice& slice) {
    return std::ranges::all_of(slice.value, [](double value) { return value == kNoForce; });
}

class Layout {
public:
    explicit Layout(const PanelSheet& sheet)
        : sheet_(sheet), axes_(plan_axes(sheet.panels[0].values.axes)), heading_(plan_heading(sheet.look, sheet.notes)),
          width_(sheet.look.width - 2 * kMargin) {
        plan(sheet.panels.size() == 1 ? kRoomForOne : kRoomForMany);
        if (const int excess = height() - sheet.look.most_height; sheet.look.most_height > 0 && excess > 0)
            plan(std::max(grid_height() - excess, kLeastPanelSide));
    }

    int height() const { return static_cast<int>(std::ceil(below_ + legend_height(legend_, width_) + kMargin / 2)); }

    void draw(Canvas& canvas) const {
        draw_heading(canvas, heading_);
        for (std::size_t i = 0; i < sheet_.panels.size(); ++i)
            draw_panel(canvas, i);
        draw_axis_titles(canvas, {first_.x, first_.y, grid_width(), grid_height()}, horizontal_, vertical_);
        double x = first_.x + grid_width();
        for (std::size_t i = 0; i < sheet_.scales.size(); ++i)
            if (const ColourScale& scale = sheet_.scales[i]; scale.shows()) {
                const auto [top, height] = bar_of(i);
                draw_colour_bar(canvas, {std::round(x + kBarGap), top}, height, scale);
                x += beside_their_panels() ? 0 : kBarGap + colour_bar_width(scale, height);
            }
        draw_legend(canvas, legend_, {kMargin, below_}, width_);
    }

private:
    double grid_width() const { return static_cast<double>(columns_ - 1) * column_pitch_ + panel_width_; }
    double grid_height() const { return static_cast<double>(rows_ - 1) * row_pitch_ + panel_height_; }
    Box box(std::size_t i) const {
        return {first_.x + static_cast<double>(i % columns_) * column_pitch_,
                first_.y + static_cast<double>(i / columns_) * row_pitch_, panel_width_, panel_height_};
    }
    Point place(const Box& plot, double u, double v) const { // from the first sample, m
        const SliceAxes& s = axes_.samples;
        return {plot.x + (u + s.u_spacing / 2) / axis_extent(s.u, s.u_spacing) * plot.width,
                plot.y + plot.height - (v + s.v_spacing / 2) / axis_extent(s.v, s.v_spacing) * plot.height};
    }
    std::vector<std::vector<Point>> pieces(const Box& plot, const std::vector<LinePoint>& line) const {
        std::vector<Point> points;
        for (const LinePoint& point : line)
            points.push_back(place(plot, point.x - axes_.samples.u[0], point.z - axes_.samples.v[0]));
        return visible_pieces(points, plot);
    }

    // Panels in one column have the bars of their scales on their right; else bars stand in a row.
    bool beside_their_panels() const {
        return columns_ == 1 && sheet_.scales.size() > 1 && panel_height_ >= kLeastBarHeight;
    }
    std::pair<double, double> bar_of(std::size_t scale) const { // top and height
        if (!beside_their_panels())
            return {top_, body_};
        double top = INFINITY, bottom = 0;
        for (std::size_t i = 0; i < sheet_.panels.size(); ++i)
            if (sheet_.panels[i].scale == scale) {
                top = std::min(top, box(i).y);
                bottom = std::max(bottom, box(i).y + panel_height_);
            }
        return {top, bottom - top};
    }
    double bars_width() const {
        double all = 0, widest = 0;
        for (const ColourScale& scale : sheet_.scales)
            if (scale.shows()) {
                const double width = kBarGap + colour_bar_width(scale, kBarHeight);
                all += width;
                widest = std::max(widest, width);
            }
        return beside_their_panels() ? widest : all;
    }

    // Everything for panels that are together at most `room` high.
    void plan(double room) {
        double left = 0;
        for (const double pixels : {60.0, 250.0, kRoomForMany}) // the panels' height is not known yet
            left = std::max(left, left_room(fit_axis(pixels, true, axes_.up)));
        arrange(width_ - left - bars_width(), room);
        horizontal_ = fit_axis(panel_width_, false, axes_.across);
        vertical_ = fit_axis(panel_height_, true, axes_.up);
        plan_arrows();
        plan_legend();
        body_ = std::max(grid_height(), measure(vertical_.title, {kTextSize}).width);
        for (const ColourScale& scale : sheet_.scales)
            body_ = std::max(body_, colour_bar_least_height(scale));
        body_ = std::ceil(body_);
        const double labels = left_room(vertical_);
        top_ = std::ceil(kMargin + heading_.height + 12 + label_height_);
        first_ = {kMargin + std::round((width_ - labels - grid_width() - bars_width()) / 2 + labels),
                  top_ + std::round((body_ - grid_height()) / 2)};
        below_ = top_ + body_ + bottom_room() + 14;
    }

    // Tries every number of columns and keeps the one with the largest panels.
    void arrange(double available, double room) {
        double label_width = 0, best = 0;
        for (const Panel& panel : sheet_.panels)
            label_width = std::max(label_width, measure(panel.label, kPanelStyle).width);
        double tick_width = 0;
        for (const AxisTick& tick : fit_axis(available, false, axes_.across).ticks)
            tick_width = std::max(tick_width, measure(tick.label, kPanelStyle).width);
        const double gap = std::ceil(tick_width + 12);
        label_height_ = label_width > 0 ? std::ceil(measure("z", kPanelStyle).height + 4) : 0;
        const std::size_t count = sheet_.panels.size();
        for (std::size_t columns = 1; columns <= count; ++columns) {
            const std::size_t rows = (count + columns - 1) / columns;
            const double across = static_cast<double>(columns), down = static_cast<double>(rows);
            const double most_u = most_pixels(axes_.samples.u.size(), (available - (across - 1) * gap) / across);
            const double most_v = most_pixels(axes_.samples.v.size(), room / down - label_height_ - 10);
            const double width = std::max(std::floor(std::min(most_u, most_v / axes_.aspect)), kLeastPanelSide);
            const double pitch = std::ceil(std::max(width, label_width) + gap);
            if (width <= best || (columns > 1 && pitch * (across - 1) + width > available))
                continue;
            best = width;
            columns_ = columns;
            rows_ = rows;
            panel_width_ = width;
            column_pitch_ = pitch;
        }
        panel_height_ = std::max(std::round(panel_width_ * axes_.aspect), kLeastPanelSide);
        row_pitch_ = panel_height_ + label_height_ + 10;
    }

    // Where arrows stand in a panel, and how long all of them are: they touch neither each other nor leave the panel.
    void plan_arrows() {
        arrows_.clear();
        const Box panel{0, 0, panel_width_, panel_height_};
        for (const auto& line : sheet_.touched)
            add_arrows_along(line, panel);
        along_surface_ = !arrows_.empty();
        longest_arrow_ = kLongestArrow;
        if (!along_surface_) {
            const SliceAxes& s = axes_.samples;
            const ArrowRow across(s.u.size(), panel_width_), up(s.v.size(), panel_height_);
            longest_arrow_ = std::min({across.longest, up.longest, kLongestArrow});
            for (const std::size_t row : up.samples)
                for (const std::size_t column : across.samples)
                    arrows_.push_back(
                        {place(panel, s.u[column] - s.u[0], s.v[row] - s.v[0]), row * s.u.size() + column});
        }
        any_arrow_ = any_dot_ = false;
        for (const Panel& one : sheet_.panels)
            for (const ArrowPlace& arrow : arrows_)
                if (const auto along = arrow_of(one, arrow)) {
                    (along->x == 0 && along->y == 0 ? any_dot_ : any_arrow_) = true;
                    if (along_surface_)
                        for (const auto& [at, step, end] :
                             {std::tuple(arrow.at.x, along->x, panel.width), {arrow.at.y, along->y, panel.height}})
                            if (step != 0)
                                longest_arrow_ = std::min(longest_arrow_, (step > 0 ? end - at : -at) / step);
                }
        if (along_surface_)
            longest_arrow_ = std::max(longest_arrow_, kShortestArrow);
    }

    // At equal steps, half a step from both ends.
    void add_arrows_along(const std::vector<ContourPoint>& line, const Box& panel) {
        std::vector<Point> points;
        std::vector<double> lengths; // up to each point, pixels
        for (const ContourPoint& point : line) {
            points.push_back(place(panel, point.u, point.v));
            const Point &from = points[points.size() - std::min<std::size_t>(points.size(), 2)], &to = points.back();
            lengths.push_back((lengths.empty() ? 0 : lengths.back()) + std::hypot(to.x - from.x, to.y - from.y));
        }
        const double count = std::round(lengths.back() / kLeastArrowPitch);
        std::size_t next = 1;
        for (double i = 0; i < count; ++i) {
            const double along = (i + 0.5) * lengths.back() / count;
            while (lengths[next] < along)
                ++next;
            const double share = (along - lengths[next - 1]) / (lengths[next] - lengths[next - 1]);
            const Point &from = points[next - 1], &to = points[next];
            arrows_.push_back({{std::lerp(from.x, to.x, share), std::lerp(from.y, to.y, share)},
                               line[share < 0.5 ? next - 1 : next].sample});
        }
    }

    void plan_legend() {
        legend_.clear();
        const std::string where = along_surface_ ? fmt::format(" {} below the surface, at equal steps along it",
                                                               quantity_text(sheet_.touch.depth, "m"))
                                                 : "";
        if (any_arrow_)
            legend_.push_back({"direction of the force" + where, longest_arrow_, draw_arrow});
        if (any_dot_)
            legend_.push_back({"force that points out of the plane by more than 60°", kLeastArrowLength,
                               [](Canvas& canvas, Point left, Point) { draw_arrow(canvas, left, left); }});
        const Box sample{0, 0, panel_width_, panel_height_};
        if (!pieces(sample, sheet_.lines.nominal).empty())
            legend_.push_back(line_item("surface", surface_stroke(false)));
        if (!pieces(sample, sheet_.lines.smooth).empty())
            legend_.push_back(line_item("shape that the shading imitates", surface_stroke(true)));
        if (std::ranges::any_of(
                sheet_.panels, [](const Panel& panel) { return std::ranges::count(panel.values.value, kNoForce) > 0; }))
            legend_.push_back(swatch_item("no force", kNoForceColour));
    }

    void draw_panel(Canvas& canvas, std::size_t i) const {
        const Panel& panel = sheet_.panels[i];
        const Box plot = box(i);
        const auto width = static_cast<int>(plot.width), height = static_cast<int>(plot.height);
        canvas.image(static_cast<int>(plot.x), static_cast<int>(plot.y), width, height,
                     rasterise(panel.values, width, height, sheet_.scales[panel.scale]));
        canvas.begin_clip(plot);
        for (const bool smooth : {false, true})
            for (const auto& piece : pieces(plot, smooth ? sheet_.lines.smooth : sheet_.lines.nominal))
                draw_surface_line(canvas, piece, smooth);
        draw_arrows_of(canvas, panel, plot);
        canvas.end_clip();
        const bool lowest = i + columns_ >= sheet_.panels.size();
        draw_axes(canvas, plot, horizontal_, vertical_, {lowest, i % columns_ == 0});
        if (!panel.label.empty())
            canvas.text(panel.label, {plot.x, plot.y - 4}, kPanelStyle);
        if (is_free(panel.values))
            for (const char* text : {"no force in this slice", "no force", "0 N"})
                if (const Extent size = measure(text, kNoteStyle);
                    size.width + 8 <= plot.width && size.height <= plot.height) {
                    const Point middle{plot.x + plot.width / 2, plot.y + plot.height / 2};
                    canvas.fill(
                        {middle.x - size.width / 2 - 4, middle.y - size.height / 2, size.width + 8, size.height},
                        kPaper);
                    canvas.text(text, middle, kNoteStyle, kQuietInk);
                    break;
                }
    }

    struct ArrowPlace {
        Point at; // in a panel at (0, 0)
        std::size_t sample;
    };

    // Of length 1; 0 where the force hardly lies in the plane. Empty without a force.
    std::optional<Point> arrow_of(const Panel& panel, const ArrowPlace& arrow) const {
        if (panel.force.force.empty())
            return std::nullopt;
        const auto direction = direction_of(panel.force.force[arrow.sample]);
        if (!direction)
            return std::nullopt;
        const double x = (*direction)[axes_.samples.axis[0]], y = -(*direction)[axes_.samples.axis[1]];
        const double in_plane = std::hypot(x, y);
        return in_plane < kLeastInPlane ? Point{} : Point{x / in_plane, y / in_plane};
    }

    // From the probe along a surface, centred on the sample in a grid.
    void draw_arrows_of(Canvas& canvas, const Panel& panel, const Box& plot) const {
        const double before = along_surface_ ? 0 : longest_arrow_ / 2, after = longest_arrow_ - before;
        for (const ArrowPlace& arrow : arrows_)
            if (const auto along = arrow_of(panel, arrow)) {
                const Point at{plot.x + arrow.at.x, plot.y + arrow.at.y};
                draw_arrow(canvas, {at.x - before * along->x, at.y - before * along->y},
                           {at.x + after * along->x, at.y + after * along->y});
            }
    }

    const PanelSheet& sheet_;
    PlaneAxes axes_;
    Heading heading_;
    double width_; // between the margins
    bool along_surface_ = false, any_arrow_ = false, any_dot_ = false;
    double longest_arrow_ = 0; /* pixels */
    std::size_t columns_ = 1, rows_ = 1;
    double panel_width_ = 0, panel_height_ = 0, column_pitch_ = 0, row_pitch_ = 0, label_height_ = 0; // whole pixels
    double top_ = 0, body_ = 0, below_ = 0;
    Point first_{}; // upper left corner of the first panel
    Axis horizontal_{}, vertical_{};
    std::vector<ArrowPlace> arrows_;
    std::vector<LegendItem> legend_;
};

// As many columns as make the panels largest.
Picture draw_panels(const PanelSheet& sheet) {
    const Layout layout(sheet);
    Canvas canvas(sheet.look.width, layout.height());
    layout.draw(canvas);
    return canvas.finish();
}

void add_axes_notes(const PlaneAxes& axes, bool arrows, std::vector<std::string>& notes) {
    if (!axes.stretch_note.empty())
        notes.push_back(axes.stretch_note + (arrows ? "; arrows keep their true direction" : ""));
    if (!axes.sampling_note.empty())
        notes.push_back(axes.sampling_note);
}

// From the lowest to the highest place of the lines over the slice.
std::optional<std::array<double, 2>> reach_of(const SurfaceLines& lines, const SliceAxes& axes) {
    std::array<double, 2> reach{INFINITY, -INFINITY};
    for (const auto* line : {&lines.nominal, &lines.smooth})
        for (const LinePoint& point : *line)
            if (point.x >= axes.u.front() && point.x <= axes.u.back())
                reach = {std::min(reach[0], point.z), std::max(reach[1], point.z)};
    return reach[0] <= reach[1] ? std::optional(reach) : std::nullopt;
}

// Slices of one plane with arrows where `touched` has the touching force; panels have their scales in order.
Picture draw_slices(const Look& look, std::vector<Panel> panels, const std::vector<Quantity>& quantities,
                    const FieldSlice& touched, const Touch& touch, const SurfaceLines& lines,
                    const std::vector<std::string>& more_notes) {
    std::vector<ValueSlice> values;
    std::vector<double> largest(quantities.size());
    PanelSheet sheet{look, {}, {}, {}, lines, touch};
    for (const Panel& panel : panels) {
        assert(panel.values.value.size() == panel.values.axes.u.size() * panel.values.axes.v.size());
        values.push_back(panel.values);
        largest[panel.scale] = std::max(largest[panel.scale], largest_of(panel.values));
    }
    const SliceAxes& whole = values[0].axes;
    for (std::size_t i = 0; i < quantities.size(); ++i)
        sheet.scales.push_back(scale_for(quantities[i], largest[i], whole.axis, look.full_scale));
    const Window window = contact_window(values, reach_of(lines, whole));
    for (Panel& panel : panels)
        sheet.panels.push_back({panel.label, cropped(panel.values, window), panel.scale, cropped(panel.force, window)});
    if (touch.force > 0)
        sheet.touched = contours(cropped(touched, window), touch.force);
    const PlaneAxes axes = plan_axes(sheet.panels[0].values.axes);
    const auto [u, v, normal] = whole.axis;
    sheet.notes.push_back(fmt::format(
        "{}–{} slice at {}: {} as colour{}, its direction as arrows of equal length", kAxisNames[u], kAxisNames[v],
        position_labels(kAxisNames[normal], {whole.at}, whole.at_spacing, axes.longer_unit).front(),
        sheet.scales[0].words, largest_note(sheet.scales[0], largest[0])));
    sheet.notes.insert(sheet.notes.end(), more_notes.begin(), more_notes.end());
    add_axes_notes(axes, true, sheet.notes);
    return draw_panels(sheet);
}

// Of forces before and after shading.
std::string magnitude_note(const ValueSlice& before, const ValueSlice& after) {
    double largest = 0, change = 0;
    for (std::size_t i = 0; i < before.value.size(); ++i)
        if (std::isfinite(before.value[i]) && std::isfinite(after.value[i])) {
            largest = std::max(largest, before.value[i]);
            change = std::max(change, std::fabs(after.value[i] - before.value[i]));
        }
    if (change <= 1e-5 * largest)
        return "stays";
    return "changes by up to " + quantity_text(change, "N");
}

} // namespace

Picture draw_mosaic(const Look& look, std::span<const ValueSlice> tiles, Quantity quantity) {
    assert(!tiles.empty());
    double largest = 0;
    std::vector<ValueSlice> filled;
    for (const ValueSlice& tile : tiles)
        if (!is_free(tile)) {
            largest = std::max(largest, largest_of(tile));
            filled.push_back(tile);
        }
    const bool empty = filled.empty();
    if (empty)
        filled.push_back(tiles[0]);
    const Window window = contact_window(filled);
    PanelSheet sheet{look, {}, {}, {scale_for(quantity, largest, tiles[0].axes.axis, look.full_scale)}, {}};
    std::vector<double> heights;
    for (std::size_t i = 0; i < filled.size(); i += (filled.size() + kShownTiles - 1) / kShownTiles) {
        heights.push_back(filled[i].axes.at);
        sheet.panels.push_back({"", cropped(filled[i], window), 0});
    }
    const PlaneAxes axes = plan_axes(sheet.panels[0].values.axes);
    const std::vector<std::string> labels = position_labels("z", heights, tiles[0].axes.at_spacing, axes.longer_unit);
    for (std::size_t i = 0; i < labels.size(); ++i)
        sheet.panels[i].label = labels[i];
    sheet.notes.push_back((labels.size() == 1
                               ? sheet.scales[0].words + " in one slice of constant z"
                               : fmt::format("{} in {} slices of constant z through the contact, one colour scale",
                                             sheet.scales[0].words, labels.size())) +
                          largest_note(sheet.scales[0], largest));
    add_axes_notes(axes, false, sheet.notes);
    if (empty)
        sheet.notes.push_back("no force in this field");
    return draw_panels(sheet);
}

Picture draw_arrows(const Look& look, const FieldSlice& slice, const Touch& touch, const SurfaceLines& lines,
                    Quantity quantity, const FieldSlice& unshaded) {
    return draw_slices(look, {{"", values_of(slice, quantity, unshaded), 0, slice}}, {quantity},
                       unshaded.force.empty() ? slice : unshaded, touch, lines, {});
}

Picture draw_shading(const Look& look, const FieldSlice& unshaded, const FieldSlice& shaded, const Touch& touch,
                     const SurfaceLines& lines) {
    assert(unshaded.force.size() == shaded.force.size());
    const ValueSlice before = values_of(unshaded, Quantity::magnitude), after = values_of(shaded, Quantity::magnitude),
                     angle = values_of(shaded, Quantity::angle, unshaded);
    const double turn = largest_of(angle);
    return draw_slices(look,
                       {{"unshaded", before, 0, unshaded},
                        {"shaded", after, 0, shaded},
                        {"angle between unshaded and shaded force", angle, 1}},
                       {Quantity::magnitude, Quantity::angle}, unshaded, touch, lines,
                       {turn > 0 ? fmt::format("shading turns the force by up to {}°; the magnitude {}",
                                               three_digits(turn), magnitude_note(before, after))
                                 : "shading turns the force nowhere in this slice"});
}

} // namespace forceshade::picture
