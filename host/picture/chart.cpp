#include "host/picture/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "host/picture/frame.h"

namespace forceshade::picture {
namespace {

constexpr double kWidth = 1000, kPlotHeight = 480; // pixels
constexpr double kLeft = 92, kRight = 24, kTick = 5, kMarkSize = 5;
constexpr TextStyle kChartLabelStyle{kSmallTextSize, false, Horizontal::left, Vertical::middle, false};
constexpr std::array<Rgb8, 8> kColours{{{0, 98, 173},
                                        {194, 65, 12},
                                        {0, 121, 92},
                                        {138, 58, 149},
                                        {125, 96, 0},
                                        {11, 118, 145},
                                        {179, 23, 79},
                                        {77, 77, 77}}};
constexpr Rgb8 kGrid{226, 229, 233};
constexpr std::size_t kMostLabels = 8;

bool can_show(const ChartAxis& axis, double value) {
    return std::isfinite(value) && (!axis.logarithmic || value > 0);
}

// Where numbers of an axis lie, and which of them are written.
class AxisScale {
public:
    AxisScale(const ChartAxis& axis, const std::vector<double>& values, double from, double to)
        : logarithmic_(axis.logarithmic), from_(from), to_(to) {
        double low = INFINITY, high = -INFINITY;
        for (const double value : values)
            if (can_show(axis, value)) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
        if (low > high)
            low = high = 1;
        if (logarithmic_) {
            low_ = std::log10(low) - 0.04 * std::max(1.0, std::log10(high / low));
            high_ = std::log10(high) + 0.04 * std::max(1.0, std::log10(high / low));
        } else {
            const double pad = high > low ? 0.05 * (high - low) : std::max(std::fabs(high), 1.0) * 0.1;
            low_ = low >= 0 && low < 0.4 * high ? 0 : low - pad;
            high_ = high <= 0 && high > 0.4 * low ? 0 : high + pad;
        }
    }
    double at(double value) const {
        return from_ + (to_ - from_) * ((logarithmic_ ? std::log10(value) : value) - low_) / (high_ - low_);
    }
    std::vector<std::pair<double, std::string>> ticks(std::size_t most) const {
        std::vector<std::pair<double, std::string>> all;
        if (!logarithmic_) {
            const RoundTicks round = round_ticks(low_, high_, most);
            for (const double value : round.values)
                all.emplace_back(value, number(value, round.decimals));
            return all;
        }
        const double decades = high_ - low_;
        const int every = std::max(1, static_cast<int>(std::ceil(decades / static_cast<double>(most))));
        const auto times = decades < 1.5 ? std::vector<double>{1, 2, 5}
                           : decades < 3 ? std::vector<double>{1, 3}
                                         : std::vector<double>{1};
        for (int power = static_cast<int>(std::floor(low_)); power <= high_; ++power)
            for (const double digit : times)
                if (const double place = power + std::log10(digit);
                    power % every == 0 && place >= low_ && place <= high_)
                    all.emplace_back(digit * std::pow(10, power),
                                     number(digit * std::pow(10, power), std::max(0, -power)));
        if (all.size() < 2) { // less than a decade between them
            all.clear();
            const RoundTicks round = round_ticks(std::pow(10, low_), std::pow(10, high_), most);
            for (const double value : round.values)
                all.emplace_back(value, number(value, round.decimals));
        }
        return all;
    }

private:
    static std::string number(double value, int decimals) {
        const double size = std::fabs(value);
        if (value == 0 || (size >= 1e-3 && size < 1e5))
            return (value < 0 ? "−" : "") + fmt::format("{:.{}f}", size, decimals);
        static constexpr std::array<const char*, 10> kRaised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
        std::string text = fmt::format("{:.5e}", size);
        const std::size_t e = text.find('e');
        const int power = std::stoi(text.substr(e + 1));
        std::string raised = power < 0 ? "⁻" : "";
        for (const char digit : fmt::format("{}", std::abs(power)))
            raised += kRaised[static_cast<std::size_t>(digit - '0')];
        text.erase(e);
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.')
            text.pop_back();
        text = (text == "1" ? "10" : text + "×10") + raised;
        return value < 0 ? "−" + text : text;
    }

    bool logarithmic_;
    double from_, to_, low_ = 0, high_ = 1;
};

// The mark of a series: disc, square, triangle, diamond, cross, and so on again.
void draw_mark(Canvas& canvas, std::size_t kind, Point at, Rgb8 colour) {
    static constexpr std::array<std::pair<int, double>, 4> kPolygons{
        {{4, 0.25}, {3, 0.5}, {4, 0}, {5, 0.5}}}; // turns / corners
    if (kind % 5 == 0) {
        canvas.disc(at, kMarkSize + 0.8, kPaper);
        canvas.disc(at, kMarkSize, colour);
        return;
    }
    const auto [corners, turn] = kPolygons[kind % 5 - 1];
    std::vector<Point> outline;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * ((i + 2 * turn) / corners) - std::numbers::pi / 2 +
                             (corners == 3 || corners == 5 ? -2 * std::numbers::pi / corners : 0);
        outline.push_back({at.x + 1.35 * kMarkSize * std::cos(angle), at.y + 1.35 * kMarkSize * std::sin(angle)});
    }
    canvas.polygon(outline, colour, {kPaper, 1.6, {}, false});
}

// Curves differ by their dashes: the first of those that are not dashed is solid.
std::vector<double> dashes_of(const Chart& chart, std::size_t number) {
    static const std::vector<std::vector<double>> kDashes{{8, 5}, {2, 4}, {10, 4, 2, 4}, {4, 4}, {12, 3}};
    std::size_t solid = 0;
    for (std::size_t i = 0; i < number; ++i)
        solid += !chart.series[i].marks && !chart.series[i].dashed;
    const ChartSeries& series = chart.series[number];
    return series.dashed || (!series.marks && solid > 0) ? kDashes[number % kDashes.size()] : std::vector<double>{};
}

Rgb8 colour_of(const Chart& chart, std::size_t series) {
    return chart.series[series].marks ? kColours[series % kColours.size()] : kInk;
}

struct Sheet {
    const Chart& chart;
    Canvas& canvas;
    Box plot;

    void axes(const std::vector<std::pair<double, std::string>>& x,
              const std::vector<std::pair<double, std::string>>& y, bool grid) const {
        const double bottom = plot.y + plot.height, right = plot.x + plot.width;
        for (const auto& [at, label] : x) {
            if (grid)
                canvas.polyline(std::array{Point{at, plot.y}, Point{at, bottom}}, {kGrid, 1, {}, false});
            canvas.polyline(std::array{Point{at, bottom}, Point{at, bottom + kTick}}, {});
            canvas.text(label, {at, bottom + kTick + 2},
                        {kSmallTextSize, false, Horizontal::centre, Vertical::top, false});
        }
        for (const auto& [at, label] : y) {
            if (grid)
                canvas.polyline(std::array{Point{plot.x, at}, Point{right, at}}, {kGrid, 1, {}, false});
            canvas.polyline(std::array{Point{plot.x - kTick, at}, Point{plot.x, at}}, {});
            canvas.text(label, {plot.x - kTick - 3, at},
                        {kSmallTextSize, false, Horizontal::right, Vertical::middle, false});
        }
        canvas.outline(plot, {});
        canvas.text(chart.x.label, {plot.x + plot.width / 2, bottom + 27},
                    {kTextSize, false, Horizontal::centre, Vertical::top, false});
        canvas.text(chart.y.label, {14, plot.y + plot.height / 2},
                    {kTextSize, false, Horizontal::centre, Vertical::middle, true});
    }
};

// The legend's entries, as many on a line as have room, and the height that they take.
double draw_legend(Canvas* canvas, double top,
                   const std::vector<std::pair<std::string, std::function<void(Canvas&, Point)>>>& entries) {
    double x = kLeft, y = top;
    for (const auto& [name, draw_key] : entries) {
        const double width = 44 + measure(name, kChartLabelStyle).width;
        if (x + width > kWidth - kRight && x > kLeft) {
            x = kLeft;
            y += 22;
        }
        if (canvas) {
            draw_key(*canvas, {x + 14, y + 9});
            canvas->text(name, {x + 34, y + 9}, kChartLabelStyle);
        }
        x += width + 14;
    }
    return entries.empty() ? 0 : y - top + 26;
}

void draw_labels(Canvas& canvas, const Box& plot, const std::vector<std::pair<std::string, Point>>& labels,
                 const std::vector<Point>& marks) {
    std::vector<Box> taken;
    for (const auto& [text, at] : labels) {
        const Extent size = measure(text, kChartLabelStyle);
        for (const auto& [dx, dy] : {std::pair{10.0, -9.0},
                                     {-10 - size.width, -9.0},
                                     {10.0, -26.0},
                                     {10.0, 8.0},
                                     {-10 - size.width, -26.0},
                                     {-10 - size.width, 8.0}}) {
            const Box box{at.x + dx, at.y + dy, size.width, size.height};
            const auto meets = [&](const Box& other) {
                return box.x < other.x + other.width && other.x < box.x + box.width && box.y < other.y + other.height &&
                       other.y < box.y + box.height;
            };
            const bool inside = box.x > plot.x + 2 && box.x + box.width < plot.x + plot.width - 2 &&
                                box.y > plot.y + 2 && box.y + box.height < plot.y + plot.height - 2;
            const bool covers = std::ranges::any_of(taken, meets) || std::ranges::any_of(marks, [&](Point mark) {
                                    return meets({mark.x - 5, mark.y - 5, 10, 10});
                                });
            if (inside && !covers && taken.size() < kMostLabels) {
                canvas.text(text, {box.x, box.y + box.height / 2}, kChartLabelStyle);
                taken.push_back(box);
                break;
            }
        }
    }
}

std::vector<double> all_of(const Chart& chart, bool x) {
    std::vector<double> values;
    for (const ChartSeries& series : chart.series)
        for (const ChartPoint& point : series.points) {
            if (chart.groups.empty() && (!can_show(chart.x, point.x) || !can_show(chart.y, point.y)))
                continue; // not drawn
            values.push_back(x ? point.x : point.y);
            for (const auto& end : {x ? point.x_low : point.y_low, x ? point.x_high : point.y_high})
                if (end)
                    values.push_back(*end);
        }
    return values;
}

using Entries = std::vector<std::pair<std::string, std::function<void(Canvas&, Point)>>>;

Entries series_entries(const Chart& chart) {
    Entries entries;
    for (std::size_t i = 0; i < chart.series.size(); ++i)
        if (const ChartSeries& series = chart.series[i]; !series.name.empty())
            entries.emplace_back(series.name, [&chart, &series, i](Canvas& canvas, Point at) {
                if (!chart.groups.empty()) {
                    canvas.fill({at.x - 12, at.y - 6, 24, 12}, colour_of(chart, i));
                    return;
                }
                if (series.joined || !series.marks)
                    canvas.polyline(std::array{Point{at.x - 14, at.y}, Point{at.x + 14, at.y}},
                                    {colour_of(chart, i), 1.8, dashes_of(chart, i), false});
                if (series.marks)
                    draw_mark(canvas, i, at, colour_of(chart, i));
            });
    return entries;
}

// Lines, marks and whiskers; how many points were left out.
std::size_t draw_points(const Sheet& sheet, const AxisScale& x, const AxisScale& y) {
    const Chart& chart = sheet.chart;
    std::size_t left_out = 0;
    std::vector<std::pair<std::string, Point>> labels;
    std::vector<Point> marks;
    sheet.canvas.begin_clip(sheet.plot);
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        const ChartSeries& series = chart.series[i];
        std::vector<Point> places;
        for (const ChartPoint& point : series.points) {
            if (!can_show(chart.x, point.x) || !can_show(chart.y, point.y)) {
                ++left_out;
                continue;
            }
            const Point at{x.at(point.x), y.at(point.y)};
            places.push_back(at);
            const auto whisker = [&](const ChartAxis& axis, const auto& low, const auto& high, bool along_x) {
                if (!low || !high || !can_show(axis, *low) || !can_show(axis, *high))
                    return;
                const Stroke stroke{colour_of(chart, i), 1.3, {}, false};
                const double from = along_x ? x.at(*low) : y.at(*low), to = along_x ? x.at(*high) : y.at(*high);
                const auto place = [&](double along, double aside) {
                    return along_x ? Point{along, at.y + aside} : Point{at.x + aside, along};
                };
                sheet.canvas.polyline(std::array{place(from, 0), place(to, 0)}, stroke);
                for (const double end : {from, to})
                    sheet.canvas.polyline(std::array{place(end, -3), place(end, 3)}, stroke);
            };
            whisker(chart.x, point.x_low, point.x_high, true);
            whisker(chart.y, point.y_low, point.y_high, false);
            if (!point.label.empty())
                labels.emplace_back(point.label, at);
        }
        if (series.joined || !series.marks)
            sheet.canvas.polyline(places, {colour_of(chart, i), series.marks ? 1.8 : 1.4, dashes_of(chart, i), true});
        if (series.marks)
            for (const Point& at : places) {
                draw_mark(sheet.canvas, i, at, colour_of(chart, i));
                marks.push_back(at);
            }
    }
    sheet.canvas.end_clip();
    draw_labels(sheet.canvas, sheet.plot, labels, marks);
    return left_out;
}

// Bars lie, a group of them at each word.
void draw_bars(const Sheet& sheet, const AxisScale& x) {
    const Chart& chart = sheet.chart;
    const double row = sheet.plot.height / static_cast<double>(chart.groups.size());
    const double height = 0.75 * row / static_cast<double>(chart.series.size());
    for (std::size_t i = 0; i < chart.series.size(); ++i)
        for (const ChartPoint& point : chart.series[i].points) {
            if (!can_show(chart.x, point.y))
                continue;
            const double top = sheet.plot.y + (point.x + 0.125) * row + static_cast<double>(i) * height;
            const double base = chart.x.logarithmic ? sheet.plot.x : x.at(0), end = x.at(point.y);
            sheet.canvas.fill({std::min(base, end), top, std::max(1.0, std::fabs(end - base)), height - 1},
                              colour_of(chart, i));
            if (point.y_low && point.y_high && can_show(chart.x, *point.y_low))
                sheet.canvas.polyline(std::array{Point{x.at(*point.y_low), top + height / 2},
                                                 Point{x.at(*point.y_high), top + height / 2}},
                                      {});
        }
}

// The cells of a map: between the middles of neighbouring numbers.
struct CellColours {
    bool words = false, both_signs = false;
    double low = 0, high = 1;
    bool logarithmic = false;
    std::vector<std::string> names;

    Rgb8 of(const ChartCell& cell) const {
        if (words) {
            const auto found = std::ranges::find(names, cell.word);
            const Rgb8 dark = kColours[static_cast<std::size_t>(found - names.begin()) % kColours.size()];
            const auto lighter = [](std::uint8_t c) { return static_cast<std::uint8_t>(255 - (255 - c) / 2); };
            return {lighter(dark.r), lighter(dark.g), lighter(dark.b)};
        }
        return of(cell.value);
    }
    Rgb8 of(double value) const {
        const double share =
            logarithmic ? std::log(std::max(value, low) / low) / std::log(high / low) : (value - low) / (high - low);
        const double t = std::clamp(share, 0.0, 1.0);
        const auto mix = [&](double a, double b, double part) {
            return static_cast<std::uint8_t>(std::lround(a + (b - a) * part));
        };
        if (both_signs) // blue, white, red
            return t < 0.5 ? Rgb8{mix(33, 247, 2 * t), mix(102, 247, 2 * t), mix(172, 247, 2 * t)}
                           : Rgb8{mix(247, 178, 2 * t - 1), mix(247, 24, 2 * t - 1), mix(247, 43, 2 * t - 1)};
        return force_colours()[static_cast<std::size_t>(std::lround(t * (kColourCount - 1)))];
    }
};

CellColours colours_of(const Chart& chart) {
    CellColours colours;
    colours.names = chart.words;
    double least = INFINITY, most = 0;
    for (const ChartCell& cell : chart.cells) {
        colours.words = colours.words || !cell.word.empty();
        colours.both_signs = colours.both_signs || cell.value < 0;
        most = std::max(most, std::fabs(cell.value));
        if (cell.value > 0)
            least = std::min(least, cell.value);
    }
    for (const ChartCell& cell : chart.cells)
        if (!cell.word.empty() && std::ranges::find(colours.names, cell.word) == colours.names.end())
            colours.names.push_back(cell.word);
    colours.logarithmic = chart.value_logarithmic && !colours.both_signs && least < most;
    colours.high = chart.value_limit > 0 ? chart.value_limit : most > 0 ? most : 1;
    colours.low = colours.both_signs ? -colours.high : colours.logarithmic ? least : 0;
    return colours;
}

std::vector<double> sorted_values(const Chart& chart, double ChartCell::*axis) {
    std::vector<double> values;
    for (const ChartCell& cell : chart.cells)
        values.push_back(cell.*axis);
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

// Where a value lies among those of the cells, which are equally wide.
double cell_place(const std::vector<double>& values, double value) {
    const auto above = static_cast<std::size_t>(std::ranges::lower_bound(values, value) - values.begin());
    if (above == 0 || above == values.size() || values[above] == value)
        return static_cast<double>(std::min(above, values.size() - 1)) + 0.5;
    return static_cast<double>(above) - 0.5 + (value - values[above - 1]) / (values[above] - values[above - 1]);
}

void draw_map(const Sheet& sheet, const CellColours& colours) {
    const Chart& chart = sheet.chart;
    const std::vector<double> xs = sorted_values(chart, &ChartCell::x), ys = sorted_values(chart, &ChartCell::y);
    const double width = sheet.plot.width / static_cast<double>(xs.size()),
                 height = sheet.plot.height / static_cast<double>(ys.size());
    const auto place = [&](double x, double y) {
        return Point{sheet.plot.x + width * cell_place(xs, x),
                     sheet.plot.y + sheet.plot.height - height * cell_place(ys, y)};
    };
    for (const ChartCell& cell : chart.cells) {
        const Point middle = place(cell.x, cell.y);
        sheet.canvas.fill({middle.x - width / 2, middle.y - height / 2, width + 0.5, height + 0.5}, colours.of(cell));
    }
    std::vector<std::pair<double, std::string>> x_ticks, y_ticks;
    for (std::size_t i = 0; i < xs.size(); i += xs.size() / 9 + 1)
        x_ticks.emplace_back(place(xs[i], ys[0]).x, fmt::format("{:.3g}", xs[i]));
    for (std::size_t i = 0; i < ys.size(); i += ys.size() / 9 + 1)
        y_ticks.emplace_back(place(xs[0], ys[i]).y, fmt::format("{:.3g}", ys[i]));
    sheet.axes(x_ticks, y_ticks, false);
    sheet.canvas.begin_clip(sheet.plot);
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
        std::vector<Point> line;
        for (const ChartPoint& point : chart.series[i].points)
            if (point.x >= xs.front() && point.x <= xs.back() && point.y >= ys.front() && point.y <= ys.back())
                line.push_back(place(point.x, point.y));
        sheet.canvas.polyline(line, {kInk, 1.8, dashes_of(chart, i), true});
    }
    sheet.canvas.end_clip();
}

} // namespace

Picture draw_chart(const Chart& chart) {
    const bool bars = !chart.groups.empty(), map = !chart.cells.empty();
    const CellColours colours = map ? colours_of(chart) : CellColours{};
    double left = kLeft;
    for (const std::string& group : chart.groups)
        left = std::max(left, 30 + measure(group, kChartLabelStyle).width);
    const std::vector<std::string> title = wrap(chart.title, {kTitleSize, true}, kWidth - 2 * kMargin);
    const double top = 18 + 27 * static_cast<double>(title.size());
    const double height = bars ? std::max(120.0, 34.0 * static_cast<double>(chart.groups.size())) : kPlotHeight;
    const Box plot{left, top, kWidth - kRight - left, height};
    Entries entries;
    if (map && colours.words) {
        for (std::size_t i = 0; i < colours.names.size(); ++i)
            entries.emplace_back(colours.names[i], [&colours, i](Canvas& canvas, Point at) {
                canvas.fill({at.x - 12, at.y - 6, 24, 12}, colours.of(ChartCell{0, 0, 0, colours.names[i]}));
            });
    } else if (map) {
        entries.emplace_back(fmt::format("{:.3g} to {:.3g}: {}", colours.low, colours.high, chart.value_label),
                             [&](Canvas& canvas, Point at) {
                                 for (int i = 0; i < 28; ++i)
                                     canvas.fill(
                                         {at.x - 14 + i, at.y - 6, 1.5, 12},
                                         colours.of(colours.logarithmic
                                                        ? colours.low * std::pow(colours.high / colours.low, i / 27.0)
                                                        : colours.low + (colours.high - colours.low) * i / 27.0));
                             });
    }
    const double legend_top = plot.y + plot.height + 56;
    for (auto& entry : series_entries(chart))
        entries.push_back(std::move(entry));
    const double whole = legend_top + draw_legend(nullptr, legend_top, entries) + 26;
    Canvas canvas(static_cast<int>(kWidth), static_cast<int>(std::ceil(whole)));
    const Sheet sheet{chart, canvas, plot};
    for (std::size_t i = 0; i < title.size(); ++i)
        canvas.text(title[i], {kMargin, 24 + 27 * static_cast<double>(i)},
                    {kTitleSize, true, Horizontal::left, Vertical::middle, false});
    std::size_t left_out = 0;
    if (map) {
        draw_map(sheet, colours);
    } else {
        std::vector<double> along = all_of(chart, !bars);
        if (bars)
            along.push_back(0); // where they begin
        const AxisScale x(chart.x, along, plot.x, plot.x + plot.width);
        const AxisScale y(chart.y, all_of(chart, false), plot.y + plot.height, plot.y);
        std::vector<std::pair<double, std::string>> x_ticks, y_ticks;
        for (const auto& [value, label] : x.ticks(9))
            x_ticks.emplace_back(x.at(value), label);
        for (const auto& [value, label] : y.ticks(8))
            y_ticks.emplace_back(y.at(value), label);
        if (bars) {
            y_ticks.clear();
            for (std::size_t i = 0; i < chart.groups.size(); ++i)
                y_ticks.emplace_back(plot.y + (static_cast<double>(i) + 0.5) * plot.height /
                                                  static_cast<double>(chart.groups.size()),
                                     chart.groups[i]);
        }
        sheet.axes(x_ticks, y_ticks, true);
        if (bars)
            draw_bars(sheet, x);
        else
            left_out = draw_points(sheet, x, y);
    }
    draw_legend(&canvas, legend_top, entries);
    if (left_out > 0)
        canvas.text(fmt::format("{} points have no number that these axes can show.", left_out), {kLeft, whole - 12},
                    kChartLabelStyle, kQuietInk);
    return canvas.finish();
}

} // namespace forceshade::picture
