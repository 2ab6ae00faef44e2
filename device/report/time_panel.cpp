#include "device/report/time_panel.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "device/report/text.h"
#include "host/picture/frame.h"

namespace forceshade::device {

namespace {

using picture::Axis;
using picture::Box;
using picture::Canvas;
using picture::Point;
using picture::Range;

constexpr double kBorder = 0.12;      // decades behind the largest
constexpr double kLeastDecades = 1.1; // so that two ticks are seen
constexpr double kPlotHeight = 190;   // pixels
constexpr double kLeaders = 16;       // between the labels of marks and the plot
constexpr double kLeft = 86;          // for the counts and their title
constexpr double kRight = 40;         // for half a label of the axis
constexpr unsigned kBarsPerDecade = 20;
constexpr picture::Rgb8 kPeriodColour{200, 20, 60};
constexpr picture::TextStyle kTitleStyle{picture::kTextSize, true, picture::Horizontal::left, picture::Vertical::top};
constexpr picture::TextStyle kMarkStyle{picture::kSmallTextSize, false, picture::Horizontal::centre,
                                        picture::Vertical::top};

// Labels that touch and are moved as one.
struct Cluster {
    std::size_t first = 0, count = 0;
    double wanted = 0; // sum of the begins that its labels would like for it
    double width = 0;  // with a gap behind each label
    double begin(double low, double high, double gap) const {
        const double mean = wanted / static_cast<double>(count);
        return std::max(low, std::min(mean, high - (width - gap)));
    }
};

// The least time above 0.
double least_of(const Histogram& times) {
    for (std::size_t bin = 1; bin < Histogram::kBins; ++bin)
        if (times.bin(bin) > 0)
            return static_cast<double>(Histogram::begin_of(bin));
    return INFINITY;
}

// What is below the axis, 0 among it, lies at its begin.
double clamped(const Range& range, double value) {
    return std::clamp(range.fraction(value), 0.0, 1.0);
}

double line_height(const picture::TextStyle& style) {
    return picture::measure("0", style).height + 2;
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
    const auto add = [&](const std::string& names, double time, bool is_period) {
        const std::string label = names + " " + time_text(time, {false, "µ"});
        marks.push_back({label, plot.x + clamped(panel.range, time) * plot.width,
                         picture::measure(label, kMarkStyle).width, 0, is_period});
    };
    for (std::size_t i = 0; i < named.size();) { // those of the same time share a label
        std::string names = named[i].first;
        const double time = named[i].second;
        while (++i < named.size() && named[i].second == time)
            names += ", " + named[i].first;
        add(names, time, false);
    }
    if (panel.period > 0)
        add("period", panel.period, true);
    return marks;
}

void draw_bars(Canvas& canvas, const TimePanel& panel, const Box& plot, const Range& counts) {
    const double floor = plot.y + plot.height;
    for (const TimeBar& bar : time_bars(*panel.times, kBarsPerDecade)) {
        const double from = clamped(panel.range, static_cast<double>(bar.from)) * plot.width;
        const double to = clamped(panel.range, static_cast<double>(bar.to)) * plot.width;
        const double height = clamped(counts, static_cast<double>(bar.count)) * plot.height;
        const double wide = std::max(to - from - 1, bar.from == 0 ? 5.0 : 2.0); // 0 has no room of its own
        canvas.fill({plot.x + std::min(from, plot.width - wide), floor - height, wide, height}, panel.colour);
    }
}

void draw_marks(Canvas& canvas, const std::vector<Mark>& marks, const Box& plot) {
    const double top = plot.y - kLeaders;
    for (const Mark& mark : marks) {
        const picture::Rgb8 colour = mark.is_period ? kPeriodColour : picture::kInk;
        const std::vector<double> dashes = mark.is_period ? std::vector<double>{} : std::vector<double>{5, 3};
        canvas.polyline(std::array{Point{mark.at, plot.y + plot.height}, Point{mark.at, plot.y}},
                        {colour, mark.is_period ? 2.0 : 1.2, dashes, false});
        canvas.polyline(std::array{Point{mark.at, plot.y}, Point{mark.at, plot.y - 3}, Point{mark.centre, top + 3},
                                   Point{mark.centre, top}},
                        {colour, 1, {}, true});
        canvas.text(mark.label, {mark.centre, top - line_height(kMarkStyle)}, kMarkStyle, colour);
    }
}

} // namespace

void place_labels(std::vector<Mark>& marks, double low, double high, double gap) {
    std::stable_sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) { return a.at < b.at; });
    std::vector<Cluster> clusters;
    for (std::size_t i = 0; i < marks.size(); ++i) {
        clusters.push_back({i, 1, marks[i].at - marks[i].width / 2, marks[i].width + gap});
        while (clusters.size() > 1) {
            Cluster& before = clusters[clusters.size() - 2];
            const Cluster& last = clusters.back();
            if (before.begin(low, high, gap) + before.width <= last.begin(low, high, gap))
                break;
            before.wanted += last.wanted - static_cast<double>(last.count) * before.width;
            before.count += last.count;
            before.width += last.width;
            clusters.pop_back();
        }
    }
    for (const Cluster& cluster : clusters) {
        double begin = cluster.begin(low, high, gap);
        for (std::size_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
            marks[i].centre = begin + marks[i].width / 2;
            begin += marks[i].width + gap;
        }
    }
}

Range time_range(std::span<const Histogram* const> shown, double period) {
    double least = INFINITY, most = 0;
    for (const Histogram* times : shown) {
        least = std::min(least, least_of(*times));
        most = std::max(most, static_cast<double>(times->largest()));
    }
    if (period > 0) {
        least = std::min(least, period);
        most = std::max(most, period);
    }
    if (!(least <= most))
        return {1, std::pow(10, kLeastDecades), true};
    if (least == period) // nothing is shorter: not at the axis's very begin
        least /= 100;
    const double low = std::floor(std::log10(least) + 1e-9);
    return {std::pow(10, low), std::pow(10, std::max(std::log10(most) + kBorder, low + kLeastDecades)), true};
}

std::vector<TimeBar> time_bars(const Histogram& times, unsigned per_decade) {
    std::vector<TimeBar> bars;
    double slot = -INFINITY; // of the last bar
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
        const std::uint64_t from = Histogram::begin_of(bin);
        const double next = from > 0 ? std::floor(std::log10(static_cast<double>(from)) * per_decade + 1e-9) : -1;
        if (next > slot)
            bars.push_back({from, from, 0});
        slot = next;
        bars.back().to = Histogram::begin_of(bin + 1);
        bars.back().count += times.bin(bin);
    }
    std::erase_if(bars, [](const TimeBar& bar) { return bar.count == 0; });
    return bars;
}

double time_panel_height() {
    return line_height(kTitleStyle) + line_height(kMarkStyle) + kLeaders + kPlotHeight + picture::bottom_room(false);
}

void draw_time_panel(Canvas& canvas, const TimePanel& panel, Point corner, double width) {
    const double above = line_height(kTitleStyle) + line_height(kMarkStyle) + kLeaders;
    const Box plot{std::floor(corner.x + kLeft), std::floor(corner.y + above), std::floor(width - kLeft - kRight),
                   kPlotHeight};
    canvas.text(panel.title, corner, kTitleStyle);
    double most = 8;
    for (const TimeBar& bar : time_bars(*panel.times, kBarsPerDecade))
        most = std::max(most, static_cast<double>(bar.count));
    const Range counts{0.56, 1.4 * most, true}; // on which a count of one has a height
    draw_bars(canvas, panel, plot, counts);
    std::vector<Mark> marks = marks_of(panel, plot);
    place_labels(marks, corner.x, corner.x + width, 14);
    draw_marks(canvas, marks, plot);
    const Axis x = picture::fit_axis(plot.width, false, [&](std::size_t most_ticks) {
        return picture::number_axis("", panel.range, most_ticks, [](double time, int) {
            return time_text(time, {false, "µ"});
        });
    });
    const Axis y = picture::fit_axis(
        plot.height, true, [&](std::size_t most_ticks) { return picture::number_axis("samples", counts, most_ticks); });
    picture::draw_axes(canvas, plot, x, y);
    picture::draw_axis_titles(canvas, plot, x, y);
    if (panel.times->count() == 0)
        canvas.text("no samples", {plot.x + plot.width / 3, plot.y + plot.height / 2}, picture::kNoteStyle,
                    picture::kQuietInk);
}

} // namespace forceshade::device
