#include "host/picture/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

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
    const Unit unit = choose_unit(longer, "m");
    PlaneAxes axes{kAxisNames[samples.axis[0]], kAxisNames[samples.axis[1]], samples, unit, unit, unit, v / u, ""};
    if (longer > kSharedUnitRatio * shorter) {
        axes.u_unit = choose_unit(u, "m");
        axes.v_unit = choose_unit(v, "m");
    }
    if (longer > kMaxAspect * shorter) {
        axes.aspect = u > v ? 1 / kMaxAspect : kMaxAspect;
        axes.stretch_note = fmt::format("not to scale: {} is stretched {} times", u > v ? axes.v_name : axes.u_name,
                                        three_digits(longer / shorter / kMaxAspect));
    }
    return axes;
}

std::string sampling_note(const PlaneAxes& axes) {
    std::string note;
    const auto describe = [&](const std::string& name, const std::vector<double>& samples, double spacing) {
        const double count = std::round((samples.back() - samples.front()) / spacing) + 1;
        if (count >= static_cast<double>(samples.size()) + 0.5)
            note += fmt::format("{}{} of {:.0f} samples along {}", note.empty() ? "shown: " : ", ", samples.size(),
                                count, name);
    };
    describe(axes.u_name, axes.samples.u, axes.samples.u_spacing);
    describe(axes.v_name, axes.samples.v, axes.samples.v_spacing);
    return note;
}

// The most ticks that look neither crowded nor bare; more rather than fewer than two; else the outer ones, or one.
Axis fit_axis(double pixels, bool vertical, const std::function<Axis(std::size_t)>& make) {
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

Axis fit_horizontal(const PlaneAxes& axes, double pixels) {
    return fit_axis(pixels, false, [&](std::size_t most) {
        return make_axis(axes.u_name, axes.samples.u, axes.samples.u_spacing, axes.u_unit, most);
    });
}

Axis fit_vertical(const PlaneAxes& axes, double pixels) {
    return fit_axis(pixels, true, [&](std::size_t most) {
        return make_axis(axes.v_name, axes.samples.v, axes.samples.v_spacing, axes.v_unit, most);
    });
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

} // namespace forceshade::picture
