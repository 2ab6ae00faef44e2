// Charts: points and lines over two axes, cells of a map, bars.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/picture/frame.h"

namespace forceshade::picture {

struct ChartAxis {
    std::string label; /* with its unit: "time / ns" */
    bool logarithmic = false;
    std::optional<Range> range{};     /* empty: that of the points, with a border */
    AxisMaker make{};                 /* of the axis in place of the label */
    std::vector<std::string> words{}; /* of a map: what stands at 0, 1, 2, ...; of y at 0, -1, -2, ... */
};

struct ChartPoint {
    double x = 0, y = 0;
    std::optional<double> x_low{}, x_high{}, y_low{}, y_high{}; /* ends of whiskers */
    std::string label{};                                        /* stands next to the mark, where there is room */
    bool marked = true;                                         /* if the series has marks */
};

struct ChartSeries {
    std::string name;
    std::vector<ChartPoint> points;
    bool marks = true, joined = false, dashed = false; /* without marks a point that is not finite breaks the line */
    std::vector<Stroke> strokes{};                     /* of the line, one over the other; empty: by the name */
    bool bar_if_still = false;                         /* a line that stays in one place is a short bar there */
};

struct ChartCell {
    double x = 0, y = 0;
    double value = 0;
    std::string word;      /* instead of a number */
    std::size_t panel = 0; /* of Chart::panels */
};

/// Bars are those of series, a point each; their x are words.
struct Chart {
    std::string title;
    ChartAxis x, y;
    std::vector<ChartSeries> series;
    std::vector<ChartCell> cells;    /* of a map, beneath the series; empty: no map */
    std::vector<std::string> panels; /* of a map: several side by side on the same axes; empty: one */
    std::string value_label;         /* of the cells' numbers */
    bool value_logarithmic = false;
    double value_limit = 0;          /* the colours end at this size; 0: at the largest */
    std::vector<std::string> words;  /* of the cells, in the legend's order */
    std::vector<std::string> groups; /* of bars: what stands at x = 0, 1, 2, ...; empty: no bars */
    double height = 480;             /* pixels, of the plot; of bars as many as they need */
    double aspect = 0;               /* height over width, with `height` as the most; 0: any */
    std::string remark;              /* in the plot */
};

/// Points and cells that an axis cannot show (no number, not positive on a logarithmic one) are left out, and the
/// picture says how many.
Picture draw_chart(const Chart& chart);

/// Charts below each other on one sheet, with one axis of x and one legend, in place of their titles and notes.
Picture draw_charts(const Look& look, const std::vector<std::string>& notes, const std::vector<Chart>& charts);

} // namespace forceshade::picture
