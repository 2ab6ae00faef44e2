// Points by series, joined or not, with spreads, labels and curves.
#include <algorithm>

#include <fmt/format.h>

#include "host/plot/curves.h"
#include "host/plot/figure_data.h"
#include "host/plot/kinds.h"
#include "host/plot/label_places.h"
#include "host/plot/legend.h"
#include "host/plot/palette.h"

namespace forceshade::plot {
namespace {

constexpr double kScatterHeight = 380, kLabelSize = 11; /* px */

struct Scatter {
    const study::Figure& figure;
    const study::Table& table;
    std::vector<std::size_t> rows;
    AxisData x, y;
    std::vector<std::optional<double>> low, high;
    SeriesData series;
    std::vector<CurveLine> curves;
    Axes axes;

    bool shown(std::size_t i) const {
        return x.values[i] && y.values[i] && axes.x.has(*x.values[i]) && axes.y.has(*y.values[i]);
    }
    double at_x(std::size_t i) const { return axes.x.at(*x.values[i]); }
    double at_y(std::size_t i) const { return axes.y.at(*y.values[i]); }
    std::string label(std::size_t i) const {
        return figure.label.empty() ? std::string() : table.word(rows[i], figure.label);
    }
};

Scale scale_of(const AxisData& data, std::vector<double> more, bool logarithmic) {
    if (!data.words.empty())
        return Scale(data.words);
    const std::vector<double> values = present(data.values);
    more.insert(more.end(), values.begin(), values.end());
    return Scale(range_of(more, logarithmic), logarithmic);
}

void set_scales(Scatter& s) {
    std::vector<double> xs, ys;
    for (const CurveLine& curve : s.curves)
        for (const auto& piece : curve.pieces)
            for (const auto& [x, y] : piece) {
                xs.push_back(x);
                ys.push_back(y);
            }
    for (const auto& ends : {s.low, s.high}) {
        const std::vector<double> values = present(ends);
        ys.insert(ys.end(), values.begin(), values.end());
    }
    s.axes.x = scale_of(s.x, xs, s.figure.x.logarithmic);
    s.axes.y = scale_of(s.y, ys, s.figure.y.logarithmic);
    s.axes.x_label = s.figure.x.label;
    s.axes.y_label = s.figure.y.label;
}

std::string tooltip(const Scatter& s, std::size_t i) {
    std::string text;
    for (const std::string& word : {s.label(i), s.series.words[s.series.of_row[i]]})
        text += word.empty() ? "" : word + "\n";
    text += spoken(s.figure.x.label, s.x, i) + "\n" + spoken(s.figure.y.label, s.y, i);
    if (s.low[i] && s.high[i])
        text += fmt::format(" ({} to {})", number_label(*s.low[i]), number_label(*s.high[i]));
    return text;
}

void draw_spread(Svg& svg, const Scatter& s, std::size_t i) {
    const auto end_of = [&](const std::optional<double>& end) {
        const bool placed = end && s.axes.y.has(*end);
        return placed ? s.axes.y.at(*end) : end ? s.axes.plot.bottom() : s.at_y(i);
    };
    if (!s.low[i] && !s.high[i])
        return;
    const std::string x = px(s.at_x(i) - 3), low = px(end_of(s.low[i])), high = px(end_of(s.high[i]));
    svg.path(fmt::format("M{0} {1}h6m-3 0L{2} {3}m-3 0h6", x, low, px(s.at_x(i)), high),
             "l thin " + series_class(s.series.of_row[i]));
}

void draw_joined(Svg& svg, const Scatter& s, std::size_t series) {
    std::string d;
    bool broken = true;
    for (std::size_t i = 0; i < s.rows.size(); ++i) {
        if (s.series.of_row[i] != series)
            continue;
        if (s.shown(i))
            d += fmt::format("{}{} {}", broken ? "M" : "L", px(s.at_x(i)), px(s.at_y(i)));
        broken = !s.shown(i);
    }
    if (!d.empty())
        svg.path(d, "l thin " + series_class(series));
}

void draw_point(Svg& svg, std::size_t series, double x, double y, std::string_view text) {
    svg.path(marker(series, x, y), (is_open_marker(series) ? "l " : "f m ") + series_class(series), text);
}

// The curves as they are drawn.
std::vector<Piece> pieces_of(const Scatter& s) {
    std::vector<Piece> pieces;
    for (const CurveLine& curve : s.curves)
        for (const auto& line : curve.pieces)
            for (std::size_t i = 1; i < line.size(); ++i)
                pieces.push_back({s.axes.x.at(line[i - 1].first), s.axes.y.at(line[i - 1].second),
                                  s.axes.x.at(line[i].first), s.axes.y.at(line[i].second)});
    return pieces;
}

void draw_labels(Sheet& sheet, const Scatter& s) {
    std::vector<LabelledPoint> points;
    for (std::size_t i = 0; i < s.rows.size(); ++i)
        if (s.shown(i))
            points.push_back({s.at_x(i), s.at_y(i), s.label(i)});
    const std::vector<std::optional<Box>> places = place_labels(points, s.axes.plot, kLabelSize, pieces_of(s));
    std::size_t dropped = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!places[i]) {
            dropped += !points[i].text.empty();
            continue;
        }
        const Box& box = *places[i];
        const double x = std::clamp(points[i].x, box.x, box.right()), y = std::clamp(points[i].y, box.y, box.bottom());
        if (std::max(std::abs(x - points[i].x), std::abs(y - points[i].y)) > 12)
            sheet.svg.line(points[i].x, points[i].y, x, y, "edge");
        sheet.svg.text(box.x, box.y + kLabelSize, points[i].text, {.classes = "t lab", .size = kLabelSize});
    }
    if (dropped > 0)
        sheet.notes.push_back(fmt::format("{} label{} found no room; the points tell when pointed at, and the table.",
                                          dropped, dropped == 1 ? "" : "s"));
}

bool any_shown(const Scatter& s, std::size_t series) {
    for (std::size_t i = 0; i < s.rows.size(); ++i)
        if (s.series.of_row[i] == series && s.shown(i))
            return true;
    return false;
}

std::vector<LegendEntry> legend_of(const Scatter& s) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < s.series.words.size(); ++k)
        if (!s.series.words[k].empty() && any_shown(s, k))
            entries.push_back({s.series.words[k], [k, joined = s.figure.joined](Svg& svg, double x, double y) {
                                   if (joined)
                                       svg.path(fmt::format("M{} {}h{}", px(x), px(y), px(kSwatch)),
                                                "l thin " + series_class(k));
                                   draw_point(svg, k, x + kSwatch / 2, y, {});
                               }});
    add_curves(entries, s.curves, false);
    return entries;
}

void count_missing(Sheet& sheet, const Scatter& s) {
    std::size_t missing = 0;
    for (std::size_t i = 0; i < s.rows.size(); ++i)
        missing += !s.shown(i);
    note_missing(sheet, missing, s.rows.size(), s.figure.x.logarithmic || s.figure.y.logarithmic);
}

} // namespace

double draw_scatter(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top) {
    const study::Table& table = data.table(figure.table);
    const std::vector<std::size_t> rows = chosen_rows(table, figure.where);
    Scatter s{figure,
              table,
              rows,
              axis_data(table, rows, figure.x.column),
              axis_data(table, rows, figure.y.column),
              optional_numbers(table, rows, figure.low),
              optional_numbers(table, rows, figure.high),
              series_data(table, rows, figure.series),
              {},
              {}};
    s.curves = curve_lines(figure, data, s.series.words);
    set_scales(s);
    lay_out(s.axes, top, kScatterHeight, 0);
    const double axes_end = draw_axes(sheet, s.axes, true);
    add_clip(sheet, s.axes.plot);
    draw_curves(sheet, s.axes, s.curves, false);
    for (std::size_t k = 0; k < s.series.words.size() && figure.joined; ++k)
        draw_joined(sheet.svg, s, k);
    for (std::size_t i = 0; i < s.rows.size(); ++i)
        if (s.shown(i)) {
            draw_spread(sheet.svg, s, i);
            draw_point(sheet.svg, s.series.of_row[i], s.at_x(i), s.at_y(i), tooltip(s, i));
        }
    draw_labels(sheet, s);
    count_missing(sheet, s);
    return draw_legend(sheet, legend_of(s), s.axes.plot.x, axes_end);
}

} // namespace forceshade::plot
