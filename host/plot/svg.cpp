#include "host/plot/svg.h"

#include <cmath>

#include <fmt/format.h>

#include "host/plot/xml_text.h"

namespace forceshade::plot {

std::string px(double value) {
    std::string text = fmt::format("{:.2f}", value);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
        text.pop_back();
    return text == "-0" ? "0" : text;
}

bool overlap(const Box& a, const Box& b) {
    return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

void Svg::line(double x1, double y1, double x2, double y2, std::string_view classes) {
    body_ += fmt::format("<path class=\"{}\" d=\"M{} {}L{} {}\"/>\n", classes, px(x1), px(y1), px(x2), px(y2));
}

void Svg::close(std::string_view element, std::string_view tooltip) {
    if (tooltip.empty())
        body_ += "/>\n";
    else
        body_ += fmt::format("><title>{}</title></{}>\n", escaped(tooltip), element);
}

void Svg::rect(const Box& box, std::string_view classes, std::string_view tooltip, std::string_view extra) {
    body_ += fmt::format("<rect class=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}", classes, px(box.x),
                         px(box.y), px(box.width), px(box.height), extra);
    close("rect", tooltip);
}

void Svg::path(std::string_view d, std::string_view classes, std::string_view tooltip, std::string_view extra) {
    body_ += fmt::format("<path class=\"{}\" d=\"{}\"{}", classes, d, extra);
    close("path", tooltip);
}

void Svg::text(double x, double y, std::string_view text, const TextStyle& style) {
    static constexpr const char* kAnchors[] = {"", " text-anchor=\"middle\"", " text-anchor=\"end\""};
    body_ += fmt::format("<text class=\"{}\" x=\"{}\" y=\"{}\" font-size=\"{}\"{}", style.classes, px(x), px(y),
                         px(style.size), kAnchors[static_cast<int>(style.anchor)]);
    if (style.rotate != 0)
        body_ += fmt::format(" transform=\"rotate({} {} {})\"", px(style.rotate), px(x), px(y));
    body_ += fmt::format(">{}</text>\n", escaped(text));
}

} // namespace forceshade::plot
