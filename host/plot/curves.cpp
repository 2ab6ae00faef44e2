#include "host/plot/curves.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/plot/figure_data.h"
#include "host/plot/palette.h"

namespace forceshade::plot {
namespace {

constexpr double kFarAway = 1e5; /* px, beyond any plot */
constexpr std::array<const char*, 4> kDashes{"7 4", "2 3", "10 3 2 3", "14 5"};

std::string points_text(const Axes& axes, const std::vector<std::pair<double, double>>& piece) {
    std::string d;
    for (const auto& [x, y] : piece)
        d += fmt::format("{}{} {}", d.empty() ? "M" : "L", px(std::clamp(axes.x.at(x), -kFarAway, kFarAway)),
                         px(std::clamp(axes.y.at(y), -kFarAway, kFarAway)));
    return d;
}

std::string dash_attribute(const CurveLine& line) {
    return line.dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", line.dashes);
}

CurveLine line_of(const study::Curve& curve, const study::Figure& figure, const study::StudyData& data) {
    const study::Table& table = data.table(curve.table);
    const std::vector<std::size_t> rows = chosen_rows(table, curve.where);
    const auto xs = optional_numbers(table, rows, curve.x), ys = optional_numbers(table, rows, curve.y);
    const auto has_place = [](const std::optional<double>& value, bool logarithmic) {
        return value && (!logarithmic || *value > 0);
    };
    CurveLine line{curve.label, "", "", {{}}};
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (has_place(xs[i], figure.x.logarithmic) && has_place(ys[i], figure.y.logarithmic))
            line.pieces.back().emplace_back(*xs[i], *ys[i]);
        else if (!line.pieces.back().empty())
            line.pieces.emplace_back();
    std::erase_if(line.pieces, [](const auto& piece) { return piece.size() < 2; });
    return line;
}

} // namespace

std::vector<CurveLine> curve_lines(const study::Figure& figure, const study::StudyData& data,
                                   const std::vector<std::string>& series) {
    std::vector<CurveLine> lines;
    std::size_t dashed = 0, solid = 0;
    for (const study::Curve& curve : figure.curves) {
        CurveLine line = line_of(curve, figure, data);
        const auto same = std::ranges::find(series, curve.label);
        // Plain ink first; later solid lines differ by colour, dashed ones by their dashes.
        if (same != series.end() && !curve.label.empty())
            line.classes = series_class(static_cast<std::size_t>(same - series.begin()));
        else if (curve.dashed || solid == 0)
            line.classes = "ink";
        else
            line.classes = series_class(series.size() + solid);
        if (curve.dashed)
            line.dashes = kDashes[dashed++ % kDashes.size()];
        else
            ++solid;
        lines.push_back(std::move(line));
    }
    return lines;
}

void draw_curves(Sheet& sheet, const Axes& axes, const std::vector<CurveLine>& lines, bool halo) {
    if (lines.empty())
        return;
    sheet.svg.raw(fmt::format("<g clip-path=\"url(#{}-plot)\">\n", sheet.id));
    for (const CurveLine& line : lines) // all of them first, so that no curve hides another
        for (const auto& piece : line.pieces)
            if (halo)
                sheet.svg.path(points_text(axes, piece), "halo");
    for (const CurveLine& line : lines)
        for (const auto& piece : line.pieces)
            sheet.svg.path(points_text(axes, piece), "l " + line.classes, line.label, dash_attribute(line));
    sheet.svg.raw("</g>\n");
}

void add_curves(std::vector<LegendEntry>& entries, const std::vector<CurveLine>& lines, bool halo) {
    for (const CurveLine& line : lines) {
        if (line.label.empty())
            continue;
        const auto known = std::ranges::find(entries, line.label, &LegendEntry::text);
        const auto draw = [line, halo](Svg& svg, double x, double y) {
            const std::string d = fmt::format("M{} {}h{}", px(x), px(y), px(kSwatch));
            if (halo)
                svg.path(d, "halo");
            svg.path(d, "l " + line.classes, {}, dash_attribute(line));
        };
        if (known == entries.end()) {
            entries.push_back({line.label, draw});
        } else {
            known->draw = [before = known->draw, draw](Svg& svg, double x, double y) {
                draw(svg, x, y);
                before(svg, x, y);
            };
        }
    }
}

} // namespace forceshade::plot
