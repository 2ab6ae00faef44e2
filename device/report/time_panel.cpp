#include "device/report/time_panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "device/report/marks.h"
#include "device/report/units.h"
#include "host/picture/frame.h"

namespace forceshade::device {
namespace {

using picture::Box;
using picture::Canvas;
using picture::Point;
using picture::Rgb8;

constexpr double kPlotHeight = 190; // pixels
constexpr double kLeaders = 16;     // between the labels of marks and the plot
constexpr double kLeft = 86;        // for the counts and their title
constexpr double kRight = 40;       // for half a label of the axis
constexpr unsigned kBarsPerDecade = 20;
constexpr Rgb8 kPeriodColour{200, 20, 60};
constexpr Rgb8 kFaint{110, 110, 110};
constexpr picture::TextStyle kTitleStyle{picture::kTextSize, true, picture::Horizontal::left, picture::Vertical::top};
constexpr picture::TextStyle kMarkStyle{picture::kSmallTextSize, false, picture::Horizontal::centre,
                                        picture::Vertical::top};
constexpr picture::TextStyle kUpStyle{picture::kTextSize, false, picture::Horizontal::centre, picture::Vertical::middle,
                                      true};
constexpr picture::TextStyle kNoteStyle{picture::kTextSize, false, picture::Horizontal::centre,
                                        picture::Vertical::middle};

double title_height() {
    return picture::measure("0", kTitleStyle).height + 2;
}

double marks_height() {
    return picture::measure("0", kMarkStyle).height + 2;
}

std::vector<Mark> marks_of(const TimePanel& panel, const Box& plot) {
    const Histogram& times = *panel.times;
    std::vector<std::pair<std::string, double>> named;
    if (times.count() > 0)
        named = {{"p50", times.quantile(0.5)},
                 {"p99", times.quantile(0.99)},
                 {"p99.9", times.quantile(0.999)},
                 {"largest", static_cast<double>(times.largest())}};
    std::vector<Mark> marks;
    const auto add = [&](const std::string& label, double time, bool is_period) {
        Mark mark{label, plot.x + panel.axis.fraction(time) * plot.width};
        mark.width = picture::measure(label, kMarkStyle).width;
        mark.is_period = is_period;
        marks.push_back(mark);
    };
    for (std::size_t i = 0; i < named.size();) { // those of the same time share a label
        std::string names = named[i].first;
        const double time = named[i].second;
        while (++i < named.size() && named[i].second == time)
            names += ", " + named[i].first;
        add(names + " " + time_text(time, {false, "µ"}), time, false);
    }
    if (panel.period > 0)
        add("period " + time_text(panel.period, {false, "µ"}), panel.period, true);
    return marks;
}

void draw_bars(Canvas& canvas, const TimePanel& panel, const Box& plot, const LogAxis& counts) {
    const double floor = plot.y + plot.height;
    for (const TimeBar& bar : time_bars(*panel.times, kBarsPerDecade)) {
        const double from = panel.axis.fraction(static_cast<double>(bar.from)) * plot.width;
        const double to = panel.axis.fraction(static_cast<double>(bar.to)) * plot.width;
        const double height = counts.fraction(static_cast<double>(bar.count)) * plot.height;
        const double wide = std::max(to - from - 1, bar.from == 0 ? 5.0 : 2.0); // 0 has no room of its own
        canvas.fill({plot.x + std::min(from, plot.width - wide), floor - height, wide, height}, panel.colour);
    }
}

void draw_marks(Canvas& canvas, const std::vector<Mark>& marks, const Box& plot) {
    for (const Mark& mark : marks) {
        const Rgb8 colour = mark.is_period ? kPeriodColour : picture::kInk;
        const double top = plot.y - kLeaders;
        canvas.polyline(std::vector<Point>{{mark.at, plot.y + plot.height}, {mark.at, plot.y}},
                        {colour, mark.is_period ? 2.0 : 1.2,
                         mark.is_period ? std::vector<double>{} : std::vector<double>{5, 3}, false});
        canvas.polyline(
            std::vector<Point>{{mark.at, plot.y}, {mark.at, plot.y - 3}, {mark.centre, top + 3}, {mark.centre, top}},
            {colour, 1, {}, true});
        canvas.text(mark.label, {mark.centre, top - marks_height()}, kMarkStyle, colour);
    }
}

void draw_scales(Canvas& canvas, const TimePanel& panel, const Box& plot, const LogAxis& counts) {
    canvas.outline({plot.x - 0.5, plot.y - 0.5, plot.width + 1, plot.height + 1}, {});
    const double floor = plot.y + plot.height;
    for (const double fraction : minor_fractions(panel.axis)) {
        const double x = plot.x + fraction * plot.width;
        canvas.polyline(std::vector<Point>{{x, floor}, {x, floor + picture::kTickLength / 2}}, {});
    }
    picture::draw_bottom_ticks(canvas, plot, time_ticks(panel.axis, plot.width), true);
    picture::draw_left_ticks(canvas, plot, count_ticks(counts, plot.height), true);
    canvas.text("samples", {plot.x - kLeft + picture::measure("0", kUpStyle).width / 2, plot.y + plot.height / 2},
                kUpStyle);
}

} // namespace

double time_panel_height() {
    return title_height() + marks_height() + kLeaders + kPlotHeight + picture::bottom_labels_height();
}

void draw_time_panel(Canvas& canvas, const TimePanel& panel, Point corner, double width) {
    const Box plot{std::floor(corner.x + kLeft), std::floor(corner.y + title_height() + marks_height() + kLeaders),
                   std::floor(width - kLeft - kRight), kPlotHeight};
    canvas.text(panel.title, corner, kTitleStyle);
    std::uint64_t most = 0;
    for (const TimeBar& bar : time_bars(*panel.times, kBarsPerDecade))
        most = std::max(most, bar.count);
    const LogAxis counts = count_axis(most);
    draw_bars(canvas, panel, plot, counts);
    std::vector<Mark> marks = marks_of(panel, plot);
    place_labels(marks, corner.x, corner.x + width, 14);
    draw_marks(canvas, marks, plot);
    draw_scales(canvas, panel, plot, counts);
    if (most == 0)
        canvas.text("no samples", {plot.x + plot.width / 3, plot.y + plot.height / 2}, kNoteStyle, kFaint);
}

} // namespace forceshade::device
