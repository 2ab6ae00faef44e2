#include "host/plot/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace forceshade::plot {
namespace {

constexpr std::size_t kSeriesColours = 8, kMarkers = 8, kWords = 8;

// Each reaches a contrast of 4.5 on white paper.
constexpr std::array<const char*, kSeriesColours> kSeries{"#0062ad", "#c2410c", "#00795c", "#8a3a95",
                                                          "#7d6000", "#0b7691", "#b3174f", "#4d4d4d"};

// From light to dark, so that grey tells them apart too.
constexpr std::array<const char*, kWords> kWordColours{"#cfe6f7", "#fbc15e", "#c2512f", "#8fce9c",
                                                       "#b9a2d8", "#e6e6e6", "#5b8bb5", "#f2a8bd"};
constexpr double kHatch = 8; /* px from line to line */

// Lines x + slope y = c through a box, slope +1 or -1.
std::string slanting_lines(const Box& box, int slope) {
    std::string d;
    const double ends[] = {box.x + slope * box.y, box.right() + slope * box.bottom(), box.x + slope * box.bottom(),
                           box.right() + slope * box.y};
    const double last = std::ranges::max(ends);
    for (double c = std::ceil(std::ranges::min(ends) / kHatch) * kHatch; c <= last; c += kHatch) {
        const double at_top = c - slope * box.y, at_bottom = c - slope * box.bottom();
        const double from = std::max(box.x, std::min(at_top, at_bottom));
        const double to = std::min(box.right(), std::max(at_top, at_bottom));
        if (to > from)
            d += fmt::format("M{} {}L{} {}", px(from), px((c - from) / slope), px(to), px((c - to) / slope));
    }
    return d;
}

std::string level_lines(const Box& box) {
    std::string d;
    for (double y = std::ceil(box.y / kHatch) * kHatch; y <= box.bottom(); y += kHatch)
        d += fmt::format("M{} {}H{}", px(box.x), px(y), px(box.right()));
    return d;
}

std::string upright_lines(const Box& box) {
    std::string d;
    for (double x = std::ceil(box.x / kHatch) * kHatch; x <= box.right(); x += kHatch)
        d += fmt::format("M{} {}V{}", px(x), px(box.y), px(box.bottom()));
    return d;
}

std::string property(const std::string& name, const char* what, const std::string& variable, const char* colour) {
    // Twice: readers that know no custom properties take the first.
    return fmt::format(".fsp .{0}{{{1}:{3};{1}:var(--plot-{2},{3})}}\n", name, what, variable, colour);
}

} // namespace

std::string style_sheet() {
    std::string css = ".fsp{font-family:system-ui,\"DejaVu Sans\",Verdana,sans-serif}\n"
                      ".fsp .l{fill:none;stroke:currentColor;stroke-width:1.6}\n"
                      ".fsp .f{fill:currentColor;stroke:none}\n"
                      ".fsp .thin{stroke-width:1}\n.fsp .b{font-weight:600}\n"
                      ".fsp .axis,.fsp .grid,.fsp .edge{fill:none;stroke-width:1}\n"
                      ".fsp .halo{fill:none;stroke-width:5;stroke-opacity:.85}\n"
                      ".fsp .hatch{fill:none;stroke:#1b1f24;stroke-opacity:.65;pointer-events:none}\n"
                      ".fsp .m{stroke-width:1}\n.fsp .v{shape-rendering:crispEdges}\n";
    css += ".fsp .lab{paint-order:stroke;stroke-width:3px;stroke-linejoin:round}\n";
    css += property("lab", "stroke", "paper", "#ffffff");
    css += property("paper", "fill", "paper", "#ffffff");
    css += property("t", "fill", "ink", "#1b1f24");
    css += property("q", "fill", "quiet", "#555c66");
    css += property("axis", "stroke", "ink", "#1b1f24");
    css += property("grid", "stroke", "grid", "#e2e5e9");
    css += property("edge", "stroke", "quiet", "#555c66");
    css += property("halo", "stroke", "paper", "#ffffff");
    css += property("m", "stroke", "paper", "#ffffff");
    css += property("ink", "color", "ink", "#1b1f24");
    for (std::size_t i = 0; i < kSeries.size(); ++i)
        css += property(fmt::format("s{}", i), "color", fmt::format("s{}", i), kSeries[i]);
    return css;
}

std::string series_class(std::size_t series) {
    return fmt::format("s{}", (series + series / kMarkers) % kSeriesColours);
}

bool is_open_marker(std::size_t series) {
    const std::size_t shape = series % kMarkers;
    return shape >= 5;
}

std::string marker(std::size_t series, double x, double y) {
    static constexpr std::array<const char*, kMarkers> kShapes{"m-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z", // disc
                                                               "m-4 -4h8v8h-8z",                      // square
                                                               "m0 -5.2l5 8.6h-10z",                  // triangle
                                                               "m0 -5.6l5.6 5.6l-5.6 5.6l-5.6 -5.6z", // diamond
                                                               "m0 5.2l5 -8.6h-10z",       // triangle on its tip
                                                               "m-4.5 -4.5l9 9m0 -9l-9 9", // cross
                                                               "m-5.5 0h11m-5.5 -5.5v11",  // plus
                                                               "m-5 0h10m-7.5 -4.4l5 8.8m0 -8.8l-5 8.8"}; // asterisk
    return fmt::format("M{} {}{}", px(x), px(y), kShapes[series % kMarkers]);
}

std::string word_fill(std::size_t word) {
    return fmt::format(" fill=\"{}\"", kWordColours[word % kWords]);
}

void draw_hatch(Svg& svg, std::size_t word, const Box& box, std::string_view extra) {
    const std::string dots = fmt::format(" stroke-dasharray=\"2 {}\" stroke-width=\"2\"{}", px(kHatch - 2), extra);
    switch (word % kWords) {
    case 1:
        return svg.path(slanting_lines(box, 1), "hatch", {}, extra);
    case 2:
        return svg.path(slanting_lines(box, 1) + slanting_lines(box, -1), "hatch", {}, extra);
    case 3:
        return svg.path(level_lines(box), "hatch", {}, dots);
    case 4:
        return svg.path(level_lines(box), "hatch", {}, extra);
    case 5:
        return svg.path(upright_lines(box), "hatch", {}, extra);
    case 6:
        return svg.path(slanting_lines(box, -1), "hatch", {}, extra);
    case 7:
        return svg.path(level_lines(box) + upright_lines(box), "hatch", {}, extra);
    default:
        return; // plain
    }
}

} // namespace forceshade::plot
