#include "host/plot/colour_scale.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/picture/colour_map.h"
#include "host/plot/axes.h"
#include "host/plot/text_size.h"

namespace forceshade::plot {
namespace {

constexpr std::size_t kBands = 128;

std::string hex(const picture::Rgb8& colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", colour.r, colour.g, colour.b);
}

// t in [-1, 1]. Lightness falls linearly with |t|, hue says the sign.
picture::Rgb8 diverging_colour(double t) {
    const double size = std::fabs(t), hue = (t < 0 ? 255 : 32) * std::numbers::pi / 180;
    const double chroma = 0.15 * std::sin(size * std::numbers::pi / 2 * 0.95);
    return picture::to_rgb8(
        picture::to_linear_rgb({0.965 - 0.525 * size, chroma * std::cos(hue), chroma * std::sin(hue)}));
}

Range exact_range(const std::vector<double>& values, bool logarithmic) {
    std::vector<double> kept = values;
    std::erase_if(kept, [&](double value) { return logarithmic && !(value > 0); });
    if (kept.empty())
        return range_of(kept, logarithmic);
    const auto [low, high] = std::ranges::minmax(kept);
    const bool distinct = logarithmic ? high > low * (1 + 1e-9) : high - low > 1e-9 * std::max(high, -low);
    return distinct ? Range{low, high} : range_of(kept, logarithmic);
}

} // namespace

std::string sequential_colours() {
    std::string text;
    for (const picture::Rgb8& colour : picture::force_colours())
        text += hex(colour).substr(1);
    return text;
}

std::string diverging_colours() {
    std::string text;
    for (int i = 0; i < 256; ++i)
        text += hex(diverging_colour(i / 127.5 - 1)).substr(1);
    return text;
}

ColourScale::ColourScale(const std::vector<double>& values, bool logarithmic, double limit) {
    Range range = exact_range(values, logarithmic);
    if (limit > 0 && logarithmic && range.low < limit)
        range.high = limit;
    else if (limit > 0 && !logarithmic)
        range = {std::ranges::any_of(values, [](double value) { return value < 0; }) ? -limit : 0, limit};
    diverging_ = !logarithmic && range.low < 0 && range.high > 0;
    const double size = std::max(-range.low, range.high);
    scale_ = Scale(diverging_ ? Range{-size, size} : range, logarithmic);
}

std::string ColourScale::colour_at(double fraction) const {
    const double inside = std::clamp(fraction, 0.0, 1.0);
    if (diverging_)
        return hex(diverging_colour(2 * inside - 1));
    const auto& map = picture::force_colours();
    return hex(map[static_cast<std::size_t>(std::lround(inside * static_cast<double>(map.size() - 1)))]);
}

std::string ColourScale::colour(double value) const {
    return colour_at(scale_.fraction(value));
}

double ColourScale::draw(Svg& svg, const Box& bar, const std::string& label) const {
    const double step = bar.height / kBands;
    for (std::size_t i = 0; i < kBands; ++i) {
        const double low = bar.bottom() - static_cast<double>(i + 1) * step;
        const double height = i == 0 ? step : step + 0.5; // no seams
        svg.rect({bar.x, low, bar.width, height}, "v", {},
                 fmt::format(" fill=\"{}\"", colour_at((static_cast<double>(i) + 0.5) / kBands)));
    }
    svg.rect(bar, "edge");
    Scale scale = scale_;
    scale.place(bar.bottom(), bar.y);
    double right = bar.right();
    for (const Tick& tick : scale.ticks(7)) {
        const double y = scale.at(tick.value);
        svg.line(bar.right(), y, bar.right() + (tick.label.empty() ? 3 : 5), y, "axis");
        svg.text(bar.right() + 8, y + 4, tick.label, {.size = kTickSize});
        right = std::max(right, bar.right() + 8 + text_width(tick.label, kTickSize));
    }
    svg.text(right + 18, bar.y + bar.height / 2, shortened(label, kAxisTitleSize, bar.height + 40),
             {.anchor = Anchor::middle, .size = kAxisTitleSize, .rotate = -90});
    return right + 24;
}

} // namespace forceshade::plot
