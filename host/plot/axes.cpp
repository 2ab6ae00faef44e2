#include "host/plot/axes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/plot/text_size.h"

namespace forceshade::plot {
namespace {

constexpr double kLine = 14;     /* px from line to line of a tick's label */
constexpr double kLongest = 170; /* px, of a word along an axis */
constexpr double kSlant = 40;    /* degrees, of words that do not fit side by side */
constexpr double kSlope = kSlant * std::numbers::pi / 180;

std::vector<Tick> x_ticks(const Axes& axes) {
    return axes.x.ticks(8);
}
std::vector<Tick> y_ticks(const Axes& axes) {
    return axes.y.ticks(static_cast<std::size_t>(std::max(3.0, axes.plot.height / 42)));
}

double widest(const std::vector<Tick>& ticks) {
    double width = 0;
    for (const Tick& tick : ticks)
        width = std::max(width, std::min(kLongest, text_width(tick.label, kTickSize)));
    return width;
}

// Words below an axis: in lines within their slots, or slanting where that does not fit.
struct WordLabels {
    bool slanting = false;
    std::size_t lines = 1;
};

WordLabels word_labels(const Axes& axes) {
    WordLabels labels;
    const std::vector<Tick> ticks = x_ticks(axes);
    const double slot = axes.plot.width / static_cast<double>(ticks.size()) - 6;
    for (const Tick& tick : ticks) {
        const std::vector<std::string> lines = wrapped(tick.label, kTickSize, slot);
        labels.lines = std::max(labels.lines, lines.size());
        for (const std::string& line : lines)
            labels.slanting = labels.slanting || text_width(line, kTickSize) > slot;
    }
    labels.slanting = labels.slanting || labels.lines > 3;
    return labels;
}

double draw_words(Svg& svg, const Axes& axes) {
    const WordLabels labels = word_labels(axes);
    const std::vector<Tick> ticks = x_ticks(axes);
    const double slot = axes.plot.width / static_cast<double>(ticks.size()) - 6, top = axes.plot.bottom() + 16;
    for (const Tick& tick : ticks) {
        const double x = axes.x.at(tick.value);
        if (labels.slanting) {
            svg.text(x + 4, top, shortened(tick.label, kTickSize, kLongest),
                     {.anchor = Anchor::end, .size = kTickSize, .rotate = -kSlant});
            continue;
        }
        double y = top;
        for (const std::string& line : wrapped(tick.label, kTickSize, slot)) {
            svg.text(x, y, line, {.anchor = Anchor::middle, .size = kTickSize});
            y += kLine;
        }
    }
    return labels.slanting ? top + widest(ticks) * std::sin(kSlope) : top + kLine * double(labels.lines - 1);
}

double draw_x_ticks(Svg& svg, const Axes& axes) {
    if (axes.x.of_words())
        return draw_words(svg, axes);
    double free_from = -1e9;
    for (const Tick& tick : x_ticks(axes)) {
        const double x = axes.x.at(tick.value), half = text_width(tick.label, kTickSize) / 2;
        svg.line(x, axes.plot.bottom(), x, axes.plot.bottom() + (tick.label.empty() ? 3 : 5), "axis");
        if (tick.label.empty() || x - half < free_from)
            continue;
        svg.text(std::min(x, kWidth - 2 - half), axes.plot.bottom() + 18, tick.label,
                 {.anchor = Anchor::middle, .size = kTickSize});
        free_from = x + half + 4;
    }
    return axes.plot.bottom() + 18;
}

void draw_y_ticks(Svg& svg, const Axes& axes) {
    for (const Tick& tick : y_ticks(axes)) {
        const double y = axes.y.at(tick.value);
        if (!axes.y.of_words())
            svg.line(axes.plot.x - (tick.label.empty() ? 3 : 5), y, axes.plot.x, y, "axis");
        if (!tick.label.empty())
            svg.text(axes.plot.x - 8, y + 4, shortened(tick.label, kTickSize, kLongest),
                     {.anchor = Anchor::end, .size = kTickSize});
    }
}

void draw_grid(Svg& svg, const Axes& axes) {
    for (const Tick& tick : y_ticks(axes))
        if (!tick.label.empty() && !axes.y.of_words())
            svg.line(axes.plot.x, axes.y.at(tick.value), axes.plot.right(), axes.y.at(tick.value), "grid");
    for (const Tick& tick : x_ticks(axes))
        if (!tick.label.empty() && !axes.x.of_words())
            svg.line(axes.x.at(tick.value), axes.plot.y, axes.x.at(tick.value), axes.plot.bottom(), "grid");
}

} // namespace

void lay_out(Axes& axes, double top, double height, double right) {
    axes.plot = {0, top, 0, height};
    double left = kMargin + (axes.y_label.empty() ? 0 : 22) + widest(y_ticks(axes)) + 10;
    const double end = kWidth - kMargin - right;
    axes.plot.x = left;
    axes.plot.width = end - left;
    if (axes.x.of_words() && word_labels(axes).slanting) { // the first words reach to the left
        const std::vector<Tick> ticks = x_ticks(axes);
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            const double reach = std::min(kLongest, text_width(ticks[i].label, kTickSize)) * std::cos(kSlope);
            const double centre = axes.plot.width * (static_cast<double>(i) + 0.5) / static_cast<double>(ticks.size());
            left = std::max(left, std::min(reach - centre + kMargin, left + kLongest));
        }
        axes.plot.x = left;
        axes.plot.width = end - left;
    }
    axes.x.place(axes.plot.x, axes.plot.right());
    axes.y.place(axes.plot.bottom(), axes.plot.y);
}

double draw_axes(Sheet& sheet, const Axes& axes, bool grid) {
    if (grid)
        draw_grid(sheet.svg, axes);
    const double labels_end = draw_x_ticks(sheet.svg, axes);
    draw_y_ticks(sheet.svg, axes);
    sheet.svg.rect(axes.plot, "axis");
    if (!axes.y_label.empty())
        sheet.svg.text(kMargin + 10, axes.plot.y + axes.plot.height / 2,
                       shortened(axes.y_label, kAxisTitleSize, axes.plot.height + 80),
                       {.anchor = Anchor::middle, .size = kAxisTitleSize, .rotate = -90});
    if (axes.x_label.empty())
        return labels_end + 4;
    sheet.svg.text(axes.plot.x + axes.plot.width / 2, labels_end + 20,
                   shortened(axes.x_label, kAxisTitleSize, axes.plot.width + 60),
                   {.anchor = Anchor::middle, .size = kAxisTitleSize});
    return labels_end + 24;
}

void add_clip(Sheet& sheet, const Box& plot) {
    sheet.svg.raw(
        fmt::format("<clipPath id=\"{}-plot\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n",
                    sheet.id, px(plot.x), px(plot.y), px(plot.width), px(plot.height)));
}

void note_missing(Sheet& sheet, std::size_t missing, std::size_t rows, bool logarithmic) {
    if (missing > 0)
        sheet.notes.push_back(fmt::format("{} of {} rows {} no {}number here and {} not shown.", missing, rows,
                                          missing == 1 ? "has" : "have", logarithmic ? "positive " : "",
                                          missing == 1 ? "is" : "are"));
}

} // namespace forceshade::plot
