#include "device/report/time_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "device/report/text.h"
#include "host/picture/canvas.h"
#include "host/picture/frame.h"

namespace forceshade::device {

namespace {

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

constexpr double kBorder = 0.12;      // decades behind the largest
constexpr double kLeastDecades = 1.1; // so that two ticks are seen
constexpr double kLabelGap = 10;      // pixels
constexpr double kRoomy = 300;        // pixels a decade, from where 2 and 5 are labelled
constexpr int kLastBetween = 14;      // power of ten of ns that is written with all its digits

std::string power_of_ten(int power) {
    constexpr std::array<std::string_view, 10> kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    if (power < 5)
        return fmt::format("{:.0f}", std::pow(10.0, power));
    std::string text = "10";
    for (const char digit : fmt::format("{}", power))
        text += kDigits[static_cast<std::size_t>(digit - '0')];
    return text;
}

std::string time_label(int digit, int power) {
    constexpr std::array<std::string_view, 4> kUnits{"ns", "µs", "ms", "s"};
    const int unit = std::clamp(power / 3, 0, 3), rest = power - 3 * unit;
    const std::string number = rest < 5 ? fmt::format("{:.0f}", digit * std::pow(10.0, rest)) : power_of_ten(rest);
    return fmt::format("{} {}", number, kUnits[static_cast<std::size_t>(unit)]);
}

// The least time above 0.
double least_of(const Histogram& times) {
    for (std::size_t bin = 1; bin < Histogram::kBins; ++bin)
        if (times.bin(bin) > 0)
            return static_cast<double>(Histogram::begin_of(bin));
    return INFINITY;
}

template <typename Label> picture::Axis ticks_of(const LogAxis& axis, Label label) {
    picture::Axis ticks;
    for (int power = static_cast<int>(std::ceil(axis.low - 1e-9)); power <= axis.high; ++power)
        ticks.ticks.push_back({axis.fraction(std::pow(10.0, power)), label(power)});
    return ticks;
}

// Every nth label only, so that they stand this far apart.
void thin_out(picture::Axis& axis, double apart, double pixels) {
    if (axis.ticks.size() < 2)
        return;
    const double step = (axis.ticks[1].fraction - axis.ticks[0].fraction) * pixels;
    const auto every = static_cast<std::size_t>(std::max(1.0, std::ceil(apart / step)));
    for (std::size_t i = 0; i < axis.ticks.size(); ++i)
        if (i % every != 0)
            axis.ticks[i].label.clear();
}

// Those of 2 and 5 times a power of ten too.
void add_between(picture::Axis& ticks, const LogAxis& axis) {
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power)
        for (const int digit : {2, 5}) {
            const double place = std::log10(digit) + power;
            if (place > axis.low && place < axis.high && power < kLastBetween)
                ticks.ticks.push_back({(place - axis.low) / (axis.high - axis.low), time_label(digit, power)});
        }
}

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

double LogAxis::fraction(double value) const {
    return value > 0 ? std::clamp((std::log10(value) - low) / (high - low), 0.0, 1.0) : 0;
}

LogAxis time_axis(std::span<const Histogram* const> shown, double period) {
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
        return {0, kLeastDecades};
    if (least == period) // nothing is shorter: not at the axis's very begin
        least /= 100;
    const double low = std::floor(std::log10(least) + 1e-9);
    return {low, std::max(std::log10(most) + kBorder, low + kLeastDecades)};
}

LogAxis count_axis(std::uint64_t most) {
    return {-0.25, std::log10(static_cast<double>(std::max<std::uint64_t>(most, 8))) + 0.15};
}

picture::Axis time_ticks(const LogAxis& axis, double pixels) {
    picture::Axis ticks = ticks_of(axis, [](int power) { return time_label(1, power); });
    if (pixels / (axis.high - axis.low) > kRoomy) {
        add_between(ticks, axis);
        return ticks;
    }
    double widest = 0;
    for (const picture::AxisTick& tick : ticks.ticks)
        widest = std::max(widest, picture::measure(tick.label, {picture::kSmallTextSize}).width);
    thin_out(ticks, widest + kLabelGap, pixels);
    return ticks;
}

picture::Axis count_ticks(const LogAxis& axis, double pixels) {
    picture::Axis ticks = ticks_of(axis, power_of_ten);
    thin_out(ticks, picture::measure("1", {picture::kSmallTextSize}).height + 4, pixels);
    return ticks;
}

std::vector<double> minor_fractions(const LogAxis& axis) {
    std::vector<double> fractions;
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power)
        for (int times = 2; times <= 9; ++times) {
            const double place = std::log10(times) + power;
            if (place > axis.low && place < axis.high)
                fractions.push_back((place - axis.low) / (axis.high - axis.low));
        }
    return fractions;
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
