// Bars of words, side by side by series.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "host/plot/curves.h"
#include "host/plot/figure_data.h"
#include "host/plot/kinds.h"
#include "host/plot/legend.h"
#include "host/plot/palette.h"
#include "host/plot/text_size.h"

namespace forceshade::plot {
namespace {

constexpr double kBarsHeight = 340, kWidest = 54, kValueSize = 10; /* px */

struct Bars {
    const study::Figure& figure;
    std::vector<std::size_t> rows;
    AxisData x, y;
    std::vector<std::optional<double>> low, high;
    SeriesData series;
    bool ratios;   /* of a logarithmic axis, about 1: bars stand on 1 */
    bool labelled; /* with their numbers */
    Axes axes;

    bool shown(std::size_t i) const { return y.values[i] && axes.y.has(*y.values[i]); }
    double slot() const { return axes.plot.width / static_cast<double>(x.words.size()); }
    double width() const {
        return std::min(kWidest, 0.84 * slot() / static_cast<double>(std::max<std::size_t>(series.words.size(), 1)));
    }
    double centre(std::size_t i) const {
        const double place = static_cast<double>(series.of_row[i]) - 0.5 * static_cast<double>(series.words.size() - 1);
        return axes.x.at(*x.values[i]) + place * width();
    }
    double foot() const {
        if (axes.y.logarithmic())
            return ratios ? axes.y.at(1) : axes.plot.bottom();
        return std::clamp(axes.y.at(0), axes.plot.y, axes.plot.bottom());
    }
};

// From zero on, or from the power of ten below; with room for numbers above the bars.
Range bar_range(const Bars& bars, bool logarithmic) {
    std::vector<double> values = present(bars.y.values);
    for (const auto& ends : {bars.low, bars.high})
        for (const double value : present(ends))
            values.push_back(value);
    if (!logarithmic)
        values.push_back(0);
    Range range = range_of(values, logarithmic);
    if (logarithmic) {
        if (!bars.ratios)
            range.low = std::pow(10.0, std::floor(std::log10(range.low)));
        range.high =
            std::pow(10.0, std::min(std::log10(range.high) + 0.05 * std::log10(range.high / range.low), 307.0));
    } else if (range.high > 0) {
        range.high += 0.03 * (range.high - range.low);
    }
    return range;
}

std::string tooltip(const Bars& bars, std::size_t i) {
    const std::string& series = bars.series.words[bars.series.of_row[i]];
    std::string text = bars.x.words[static_cast<std::size_t>(*bars.x.values[i])] + "\n";
    text += (series.empty() ? "" : series + "\n") + spoken(bars.figure.y.label, bars.y, i);
    if (bars.low[i] && bars.high[i])
        text += fmt::format(" ({} to {})", number_label(*bars.low[i]), number_label(*bars.high[i]));
    return text;
}

void draw_bar(Svg& svg, const Bars& bars, std::size_t i) {
    const double at = bars.axes.y.at(*bars.y.values[i]), foot = bars.foot(), width = bars.width() * 0.92;
    const double x = bars.centre(i) - width / 2;
    const std::string classes = series_class(bars.series.of_row[i]);
    svg.rect({x, std::min(at, foot), width, std::max(std::fabs(at - foot), 1.0)}, "f " + classes, tooltip(bars, i));
    double end = at;
    if (bars.low[i] && bars.high[i] && bars.axes.y.has(*bars.low[i]) && bars.axes.y.has(*bars.high[i])) {
        const double low = bars.axes.y.at(*bars.low[i]), high = bars.axes.y.at(*bars.high[i]);
        svg.path(fmt::format("M{0} {1}h6m-3 0V{2}m-3 0h6", px(bars.centre(i) - 3), px(low), px(high)), "l thin ink");
        end = at <= foot ? std::min(at, high) : std::max(at, low);
    }
    if (bars.labelled)
        svg.text(bars.centre(i), at <= foot ? end - 4 : end + 12, number_label(*bars.y.values[i], 3),
                 {.anchor = Anchor::middle, .size = kValueSize});
}

// Numbers stand at all bars or at none.
bool have_room(const Bars& bars) {
    const double room = bars.series.words.size() == 1 ? bars.slot() : bars.width();
    for (std::size_t i = 0; i < bars.rows.size(); ++i)
        if (bars.shown(i) && text_width(number_label(*bars.y.values[i], 3), kValueSize) > room)
            return false;
    return true;
}

// Numbers without a unit on either side of 1.
bool are_ratios(const Bars& bars, const study::Table& table) {
    const std::vector<double> values = present(bars.y.values);
    return table.columns[table.index(bars.figure.y.column)].unit == "1" &&
           std::ranges::any_of(values, [](double value) { return value > 0 && value <= 1; }) &&
           std::ranges::any_of(values, [](double value) { return value >= 1; });
}

void note_rows(Sheet& sheet, const Bars& bars) {
    std::size_t missing = 0, twice = 0;
    std::set<std::pair<double, std::size_t>> seen;
    for (std::size_t i = 0; i < bars.rows.size(); ++i)
        if (!bars.shown(i))
            ++missing;
        else
            twice += !seen.emplace(*bars.x.values[i], bars.series.of_row[i]).second;
    note_missing(sheet, missing, bars.rows.size(), bars.figure.y.logarithmic);
    if (twice > 0)
        sheet.notes.push_back(fmt::format("{} row{} stand{} where there is a bar already.", twice,
                                          twice == 1 ? "" : "s", twice == 1 ? "s" : ""));
}

} // namespace

double draw_bars(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top) {
    const study::Table& table = data.table(figure.table);
    const std::vector<std::size_t> rows = chosen_rows(table, figure.where);
    Bars bars{figure,
              rows,
              word_data(table, rows, figure.x.column),
              axis_data(table, rows, figure.y.column),
              optional_numbers(table, rows, figure.low),
              optional_numbers(table, rows, figure.high),
              series_data(table, rows, figure.series),
              false,
              false,
              {}};
    if (!bars.y.words.empty()) // words have no height
        std::ranges::fill(bars.y.values, std::nullopt);
    bars.ratios = figure.y.logarithmic && are_ratios(bars, table);
    bars.axes = {bars.x.words.empty() ? Scale({0, 1}, false) : Scale(bars.x.words),
                 Scale(bar_range(bars, figure.y.logarithmic), figure.y.logarithmic),
                 figure.x.label,
                 figure.y.label,
                 {}};
    const std::vector<CurveLine> curves = curve_lines(figure, data, bars.series.words);
    lay_out(bars.axes, top, kBarsHeight, 0);
    bars.labelled = have_room(bars);
    const double axes_end = draw_axes(sheet, bars.axes, true);
    add_clip(sheet, bars.axes.plot);
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (bars.shown(i))
            draw_bar(sheet.svg, bars, i);
    draw_curves(sheet, bars.axes, curves, true);
    if (!figure.y.logarithmic || bars.ratios)
        sheet.svg.line(bars.axes.plot.x, bars.foot(), bars.axes.plot.right(), bars.foot(), "axis");
    note_rows(sheet, bars);
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < bars.series.words.size(); ++k)
        if (!bars.series.words[k].empty())
            entries.push_back({bars.series.words[k], [k](Svg& svg, double x, double y) {
                                   svg.rect({x, y - 7, kSwatch, 14}, "f " + series_class(k));
                               }});
    add_curves(entries, curves, true);
    return draw_legend(sheet, entries, bars.axes.plot.x, axes_end);
}

} // namespace forceshade::plot
