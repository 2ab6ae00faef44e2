#include "host/picture/frame.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace forceshade::picture {
namespace {

constexpr double kMaxAspect = 8;         // longer plots are drawn out of scale, and say so
constexpr double kSharedUnitRatio = 1e3; // extents further apart than this get units of their own
constexpr double kLabelGap = 10;
constexpr TextStyle kTickStyle{kSmallTextSize, false, Horizontal::centre, Vertical::top, false};
constexpr TextStyle kLeftStyle{kSmallTextSize, false, Horizontal::right, Vertical::middle, false};

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

// The most ticks that look neither crowded nor bare; more rather than fewer than two; else the outer
// ones, or one.
template <typename MakeAxis> Axis fit(double pixels, bool vertical, MakeAxis make) {
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

} // namespace

double most_pixels(std::size_t samples, double room) {
    return std::min(room, std::max(360.0, 160.0 * static_cast<double>(samples)));
}

PlaneAxes plan_axes(std::string u_name, std::string v_name, const SliceAxes& samples) {
    const double u = axis_extent(samples.u, samples.u_spacing), v = axis_extent(samples.v, samples.v_spacing);
    const double longer = std::max(u, v), shorter = std::min(u, v);
    const Unit unit = choose_unit(longer, "m");
    PlaneAxes axes{std::move(u_name), std::move(v_name), samples, unit, unit, unit, 1, v / u, ""};
    if (longer > kSharedUnitRatio * shorter) {
        axes.u_unit = choose_unit(u, "m");
        axes.v_unit = choose_unit(v, "m");
    }
    if (longer > kMaxAspect * shorter) {
        const double factor = longer / shorter / kMaxAspect;
        axes.v_length = u > v ? 1 / kMaxAspect : kMaxAspect;
        axes.stretch_note = fmt::format("not to scale: {} is stretched {} times", u > v ? axes.v_name : axes.u_name,
                                        three_digits(factor));
    }
    return axes;
}

Axis fit_horizontal(const PlaneAxes& axes, double pixels) {
    return fit(pixels, false, [&](std::size_t most) {
        return make_axis(axes.u_name, axes.samples.u, axes.samples.u_spacing, axes.u_unit, most);
    });
}

Axis fit_vertical(const PlaneAxes& axes, double pixels) {
    return fit(pixels, true, [&](std::size_t most) {
        return make_axis(axes.v_name, axes.samples.v, axes.samples.v_spacing, axes.v_unit, most);
    });
}

double widest_label(const Axis& axis) {
    double widest = 0;
    for (const AxisTick& tick : axis.ticks)
        widest = std::max(widest, measure(tick.label, kTickStyle).width);
    return widest;
}

double bottom_labels_height() {
    return kTickLength + 3 + measure("0", kTickStyle).height;
}
double left_labels_width(const Axis& axis) {
    return kTickLength + 4 + widest_label(axis);
}

void draw_bottom_ticks(Canvas& canvas, const Box& plot, const Axis& axis, bool labels) {
    const double y = plot.y + plot.height;
    for (const AxisTick& tick : axis.ticks) {
        const double x = plot.x + tick.fraction * plot.width;
        canvas.polyline(std::vector<Point>{{x, y}, {x, y + kTickLength}}, {});
        if (labels)
            canvas.text(tick.label, {x, y + kTickLength + 3}, kTickStyle);
    }
}

void draw_left_ticks(Canvas& canvas, const Box& plot, const Axis& axis, bool labels) {
    for (const AxisTick& tick : axis.ticks) {
        const double y = plot.y + (1 - tick.fraction) * plot.height;
        canvas.polyline(std::vector<Point>{{plot.x - kTickLength, y}, {plot.x, y}}, {});
        if (labels)
            canvas.text(tick.label, {plot.x - kTickLength - 4, y}, kLeftStyle);
    }
}

std::string sampling_note(const PlaneAxes& axes) {
    std::string note;
    const auto describe = [&](const std::string& name, const std::vector<double>& samples, double spacing) {
        const double count = std::round((samples.back() - samples.front()) / spacing) + 1;
        if (count < static_cast<double>(samples.size()) + 0.5)
            return;
        note += fmt::format("{}{} of {:.0f} samples along {}", note.empty() ? "shown: " : ", ", samples.size(), count,
                            name);
    };
    describe(axes.u_name, axes.samples.u, axes.samples.u_spacing);
    describe(axes.v_name, axes.samples.v, axes.samples.v_spacing);
    return note;
}

} // namespace forceshade::picture
