#include "host/plot/plot.h"

#include <fmt/format.h>

#include "host/plot/axes.h"
#include "host/plot/kinds.h"
#include "host/plot/palette.h"
#include "host/plot/text_size.h"
#include "host/plot/xml_text.h"

namespace forceshade::plot {
namespace {

constexpr double kTitleSize = 15, kNoteSize = 11; /* px */

// What may stand in an id and in url(#...).
std::string plain(const std::string& name) {
    std::string id;
    for (const char c : name)
        id += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '-';
    return id;
}

double draw_lines(Svg& svg, const std::string& text, double size, std::string_view classes, double y) {
    for (const std::string& line : wrapped(text, size, kWidth - 2 * kMargin)) {
        y += size * 1.35;
        svg.text(kMargin, y, shortened(line, size, kWidth - 2 * kMargin), {.classes = classes, .size = size});
    }
    return y;
}

double draw_kind(Sheet& sheet, const study::Figure& figure, const study::StudyData& data, double top) {
    switch (figure.kind) {
    case study::FigureKind::map:
        return draw_map(sheet, figure, data, top);
    case study::FigureKind::bars:
        return draw_bars(sheet, figure, data, top);
    default:
        return draw_scatter(sheet, figure, data, top);
    }
}

} // namespace

std::string figure_styles() {
    return style_sheet();
}

std::string svg_of(const study::Figure& figure, const study::StudyData& data, bool styles) {
    Sheet sheet{plain(data.study + "-" + figure.name), {}, {}};
    double y = 6;
    if (!figure.title.empty())
        y = draw_lines(sheet.svg, figure.title, kTitleSize, "t b", y);
    y = draw_kind(sheet, figure, data, y + 16);
    for (const std::string& note : sheet.notes)
        y = draw_lines(sheet.svg, note, kNoteSize, "q", y + 2);
    const std::string height = px(y + kMargin), width = px(kWidth);
    return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"fsp\" width=\"{0}\" height=\"{1}\" "
                       "viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\">\n<title>{2}</title>\n<desc>{3}"
                       "</desc>\n{4}<rect class=\"paper\" width=\"{0}\" height=\"{1}\"/>\n{5}</svg>\n",
                       width, height, escaped(figure.title.empty() ? figure.name : figure.title),
                       escaped(figure.caption), styles ? "<style>\n" + style_sheet() + "</style>\n" : "",
                       sheet.svg.body());
}

std::vector<study::TextFile> pictures(const study::StudyData& data) {
    std::vector<study::TextFile> files;
    for (const study::Figure& figure : data.figures)
        files.push_back({figure.name + ".svg", svg_of(figure, data)});
    return files;
}

} // namespace forceshade::plot
