// Cells coloured by a number or a word.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "host/plot/colour_scale.h"
#include "host/plot/curves.h"
#include "host/plot/figure_data.h"
#include "host/plot/kinds.h"
#include "host/plot/legend.h"
#include "host/plot/palette.h"

namespace forceshade::plot {
namespace {

constexpr double kMapHeight = 380, kRow = 26, kLeast = 90; /* px */
constexpr double kScaleBar = 124;                          /* px at the right */
constexpr std::size_t kMostTooltips = 5000;                // cells; more would make the file large

// Sample places in order and the edges of the cells about them: midway between neighbours on the axis.
struct Cells {
    std::vector<double> centres, edges; /* edges: one more */
};

Cells cells_of(const AxisData& data, bool logarithmic) {
    const std::vector<double> values = present(data.values);
    std::set<double> distinct(values.begin(), values.end());
    if (logarithmic)
        distinct.erase(distinct.begin(), distinct.upper_bound(0.0));
    Cells cells{{distinct.begin(), distinct.end()}, {}};
    const std::vector<double>& c = cells.centres;
    if (c.empty())
        return cells;
    const auto forth = [&](double v) { return logarithmic ? std::log10(v) : v; };
    const auto back = [&](double v) { return logarithmic ? std::pow(10.0, v) : v; };
    const double alone = logarithmic ? 0.3 : data.words.empty() && c[0] != 0 ? std::fabs(c[0]) : 1.0;
    const std::size_t n = c.size();
    const double first_gap = n > 1 ? forth(c[1]) - forth(c[0]) : alone;
    const double last_gap = n > 1 ? forth(c[n - 1]) - forth(c[n - 2]) : alone;
    cells.edges.push_back(back(forth(c[0]) - first_gap / 2));
    for (std::size_t i = 0; i + 1 < n; ++i)
        cells.edges.push_back(back(std::midpoint(forth(c[i]), forth(c[i + 1]))));
    cells.edges.push_back(back(forth(c[n - 1]) + last_gap / 2));
    return cells;
}

Scale scale_of(const AxisData& data, const Cells& cells, bool logarithmic) {
    if (!data.words.empty())
        return Scale(data.words);
    if (cells.centres.empty())
        return Scale(range_of({}, logarithmic), logarithmic);
    return Scale({cells.edges.front(), cells.edges.back()}, logarithmic);
}

struct Map {
    const study::Figure& figure;
    const study::Table& table;
    std::vector<std::size_t> rows;
    AxisData x, y, value;
    Cells columns, lines;
    Axes axes;
    std::vector<std::string> words; /* empty: the values are numbers */

    bool placed(std::size_t i) const {
        return x.values[i] && y.values[i] && axes.x.has(*x.values[i]) && axes.y.has(*y.values[i]);
    }
    Box box(std::size_t i) const {
        const auto [left, right] = ends(axes.x, columns, *x.values[i]);
        const auto [bottom, top] = ends(axes.y, lines, *y.values[i]);
        return {left, top, right - left, bottom - top};
    }
    static std::pair<double, double> ends(const Scale& scale, const Cells& cells, double at) {
        const auto found = std::ranges::lower_bound(cells.centres, at);
        const auto i = static_cast<std::size_t>(found - cells.centres.begin());
        return {scale.at(cells.edges[i]), scale.at(cells.edges[i + 1])};
    }
    std::string word(std::size_t i) const { return value.words[static_cast<std::size_t>(*value.values[i])]; }
};

std::string tooltip(const Map& map, std::size_t i) {
    return spoken(map.figure.x.label, map.x, i) + "\n" + spoken(map.figure.y.label, map.y, i) + "\n" +
           spoken(map.figure.value_label, map.value, i);
}

std::vector<std::string> legend_words(const study::Figure& figure, const AxisData& value) {
    if (value.words.empty())
        return {};
    std::vector<std::string> words = figure.value_words;
    for (const std::string& word : value.words)
        if (std::ranges::find(words, word) == words.end())
            words.push_back(word);
    return words;
}

void draw_empty_cell(Svg& svg, const Box& box, std::string_view text) {
    svg.path(fmt::format("M{} {}L{} {}M{} {}L{} {}", px(box.x + 2), px(box.y + 2), px(box.right() - 2),
                         px(box.bottom() - 2), px(box.x + 2), px(box.bottom() - 2), px(box.right() - 2), px(box.y + 2)),
             "edge", text);
}

// Returns how many cells are without a colour.
std::size_t draw_cells(Sheet& sheet, const Map& map, const ColourScale& colours) {
    std::size_t empty = 0;
    for (std::size_t i = 0; i < map.rows.size(); ++i) {
        if (!map.placed(i))
            continue;
        constexpr double kOver = 0.4; // px: a little larger, so that no seams show between cells
        const Box box = map.box(i), filled{box.x, box.y, box.width + kOver, box.height + kOver};
        const std::string text = map.rows.size() <= kMostTooltips ? tooltip(map, i) : std::string();
        if (!map.value.values[i] || (map.words.empty() && !colours.has(*map.value.values[i]))) {
            draw_empty_cell(sheet.svg, box, text);
            ++empty;
        } else if (map.words.empty()) {
            sheet.svg.rect(filled, "v", text, fmt::format(" fill=\"{}\"", colours.colour(*map.value.values[i])));
        } else {
            const auto word = static_cast<std::size_t>(std::ranges::find(map.words, map.word(i)) - map.words.begin());
            sheet.svg.rect(filled, "v", text, word_fill(word));
        }
    }
    return empty;
}

// Each over all cells of its word at once.
void draw_hatches(Sheet& sheet, const Map& map) {
    for (std::size_t word = 1; word < map.words.size(); ++word) {
        std::string cells;
        for (std::size_t i = 0; i < map.rows.size(); ++i)
            if (map.placed(i) && map.value.values[i] && map.word(i) == map.words[word]) {
                const Box box = map.box(i);
                cells += fmt::format("M{} {}h{}v{}h{}z", px(box.x), px(box.y), px(box.width), px(box.height),
                                     px(-box.width));
            }
        if (cells.empty())
            continue;
        const std::string id = fmt::format("{}-word{}", sheet.id, word);
        sheet.svg.raw(fmt::format("<clipPath id=\"{}\"><path d=\"{}\"/></clipPath>\n", id, cells));
        draw_hatch(sheet.svg, word, map.axes.plot, fmt::format(" clip-path=\"url(#{})\"", id));
    }
}

void note_rows(Sheet& sheet, const Map& map) {
    std::size_t missing = 0, twice = 0;
    std::set<std::pair<double, double>> seen;
    for (std::size_t i = 0; i < map.rows.size(); ++i)
        if (!map.placed(i))
            ++missing;
        else
            twice += !seen.emplace(*map.x.values[i], *map.y.values[i]).second;
    note_missing(sheet, missing, map.rows.size(), map.figure.x.logarithmic || map.figure.y.logarithmic);
    if (twice > 0)
        sheet.notes.push_back(
            fmt::format("{} row{} fall{} in a cell that has one already; the last of a cell is shown.", twice,
                        twice == 1 ? "" : "s", twice == 1 ? "s" : ""));
}

std::vector<LegendEntry> legend_of(const Map& map, std::size_t empty, const std::vector<CurveLine>& curves) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < map.words.size(); ++k)
        entries.push_back({map.words[k], [k](Svg& svg, double x, double y) {
                               svg.rect({x, y - 8, kSwatch, 16}, "v", {}, word_fill(k));
                               draw_hatch(svg, k, {x, y - 8, kSwatch, 16});
                               svg.rect({x, y - 8, kSwatch, 16}, "edge");
                           }});
    if (empty > 0)
        entries.push_back({"no value", [](Svg& svg, double x, double y) {
                               draw_empty_cell(svg, {x, y - 8, kSwatch, 16}, {});
                               svg.rect({x, y - 8, kSwatch, 16}, "edge");
                           }});
    add_curves(entries, curves, true);
    return entries;
}

double height_of(const AxisData& y, const Cells& lines) {
    return y.words.empty() ? kMapHeight : std::max(kLeast, kRow * static_cast<double>(lines.centres.size()));
}

} // namespace

double draw_map(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top) {
    const study::Table& table = data.table(figure.table);
    const std::vector<std::size_t> rows = chosen_rows(table, figure.where);
    Map map{figure,
            table,
            rows,
            axis_data(table, rows, figure.x.column),
            axis_data(table, rows, figure.y.column),
            axis_data(table, rows, figure.value),
            {},
            {},
            {},
            {}};
    map.columns = cells_of(map.x, figure.x.logarithmic);
    map.lines = cells_of(map.y, figure.y.logarithmic);
    map.axes = {scale_of(map.x, map.columns, figure.x.logarithmic),
                scale_of(map.y, map.lines, figure.y.logarithmic),
                figure.x.label,
                figure.y.label,
                {}};
    map.words = legend_words(figure, map.value);
    const std::vector<CurveLine> curves = curve_lines(figure, data, {});
    const ColourScale colours(map.words.empty() ? present(map.value.values) : std::vector<double>{},
                              figure.value_logarithmic, figure.value_limit);
    lay_out(map.axes, top, height_of(map.y, map.lines), map.words.empty() ? kScaleBar : 0);
    add_clip(sheet, map.axes.plot);
    const std::size_t empty = draw_cells(sheet, map, colours);
    draw_hatches(sheet, map);
    const double axes_end = draw_axes(sheet, map.axes, false);
    draw_curves(sheet, map.axes, curves, true);
    if (map.words.empty())
        colours.draw(sheet.svg, {map.axes.plot.right() + 16, map.axes.plot.y, 16, map.axes.plot.height},
                     figure.value_label);
    note_rows(sheet, map);
    return draw_legend(sheet, legend_of(map, empty, curves), map.axes.plot.x, axes_end);
}

} // namespace forceshade::plot
