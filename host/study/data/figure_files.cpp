// Figures as pictures.
#include <algorithm>
#include <cmath>

#include "host/picture/chart.h"
#include "host/study/data/data_files.h"

namespace forceshade::study {
namespace {

constexpr std::size_t kMostMarks = 100; // of a joined series; of more the line alone

bool shows(const Table& table, std::size_t row, const Where& where) {
    return std::ranges::all_of(
        where, [&](const auto& one) { return table.rows[row][table.index(one.first)].text() == one.second; });
}

std::optional<double> end_of(const Table& table, std::size_t row, const std::string& column) {
    return column.empty() ? std::nullopt : table.number(row, column);
}

std::string text_of(const Table& table, std::size_t row, const std::string& column) {
    return column.empty() ? "" : table.rows[row][table.index(column)].text();
}

picture::ChartSeries& series_named(picture::Chart& chart, const std::string& name, bool joined) {
    const auto found = std::ranges::find(chart.series, name, &picture::ChartSeries::name);
    return found != chart.series.end() ? *found
                                       : chart.series.emplace_back(picture::ChartSeries{name, {}, true, joined, false});
}

// Of a word among others, the last if it is new.
std::size_t place_in(std::vector<std::string>& words, const std::string& word) {
    const auto found = std::ranges::find(words, word);
    const auto place = static_cast<std::size_t>(found - words.begin());
    if (found == words.end())
        words.push_back(word);
    return place;
}

void add_row(picture::Chart& chart, const Figure& figure, const Table& table, std::size_t row) {
    const auto number = [&](const std::string& column) { return table.number(row, column).value_or(NAN); };
    if (figure.kind == FigureKind::map) {
        const std::size_t panel =
            figure.panels.empty() ? 0 : place_in(chart.panels, text_of(table, row, figure.panels));
        const auto place = [&](const FigureAxis& axis, picture::ChartAxis& to) {
            const std::string word = table.word(row, axis.column);
            return word.empty() ? number(axis.column) : static_cast<double>(place_in(to.words, word));
        };
        const double x = place(figure.x, chart.x), y = place(figure.y, chart.y);
        const auto value = table.number(row, figure.value);
        if (const std::string word = table.word(row, figure.value); value || !word.empty())
            chart.cells.push_back({x, chart.y.words.empty() ? y : -y, value.value_or(0), word, panel});
        return;
    }
    picture::ChartPoint point;
    if (figure.kind == FigureKind::bars) {
        point.x = static_cast<double>(place_in(chart.groups, text_of(table, row, figure.x.column)));
    } else {
        point.x = number(figure.x.column);
    }
    point.y = number(figure.y.column);
    point.y_low = end_of(table, row, figure.low);
    point.y_high = end_of(table, row, figure.high);
    point.x_low = end_of(table, row, figure.x_low);
    point.x_high = end_of(table, row, figure.x_high);
    point.label = text_of(table, row, figure.label);
    series_named(chart, text_of(table, row, figure.series), figure.joined).points.push_back(std::move(point));
}

picture::Chart chart_of(const Figure& figure, const StudyData& data) {
    picture::Chart chart;
    chart.title = figure.title;
    chart.x = {figure.x.label, figure.x.logarithmic};
    chart.y = {figure.y.label, figure.y.logarithmic};
    if (figure.kind == FigureKind::bars) { // they lie: what is measured runs to the right
        chart.x = chart.y;
        chart.y = {};
    }
    chart.value_label = figure.value_label;
    chart.value_logarithmic = figure.value_logarithmic;
    chart.value_limit = figure.value_limit;
    chart.words = figure.value_words;
    const Table& table = data.table(figure.table);
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (shows(table, row, figure.where))
            add_row(chart, figure, table, row);
    for (picture::ChartSeries& series : chart.series)
        for (picture::ChartPoint& point : series.points)
            point.marked = !series.joined || series.points.size() <= kMostMarks;
    for (const Curve& curve : figure.curves) {
        const Table& of = data.table(curve.table);
        picture::ChartSeries line{curve.label, {}, false, true, curve.dashed};
        for (std::size_t row = 0; row < of.rows.size(); ++row)
            if (shows(of, row, curve.where))
                if (const auto x = of.number(row, curve.x), y = of.number(row, curve.y); x && y)
                    line.points.push_back({*x, *y, {}, {}, {}, {}, ""});
        chart.series.push_back(std::move(line));
    }
    return chart;
}

} // namespace

std::vector<TextFile> figure_files(const StudyData& data) {
    std::vector<TextFile> files;
    for (const Figure& figure : data.figures)
        files.push_back({figure.name + ".svg", picture::draw_chart(chart_of(figure, data)).svg()});
    return files;
}

} // namespace forceshade::study
