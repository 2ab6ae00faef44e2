#include "host/plot/legend.h"

#include <algorithm>

#include "host/plot/text_size.h"

namespace forceshade::plot {

double draw_legend(Sheet& sheet, const std::vector<LegendEntry>& entries, double left, double top) {
    constexpr double kSize = 12, kRow = 19, kGap = 18;
    const double end = kWidth - kMargin;
    double x = left, y = top + 14;
    for (const LegendEntry& entry : entries) {
        const std::string text = shortened(entry.text, kSize, end - left - kSwatch - 6);
        const double width = kSwatch + 6 + text_width(text, kSize);
        if (x > left && x + width > end) {
            x = left;
            y += kRow;
        }
        entry.draw(sheet.svg, x, y);
        sheet.svg.text(x + kSwatch + 6, y + 4, text, {.size = kSize});
        x += width + kGap;
    }
    return entries.empty() ? top : y + 10;
}

} // namespace forceshade::plot
