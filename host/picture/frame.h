// What stands round and in a plot: axes with labels that keep clear of each other, colour bar, title, legend, and lines
// cut to what is shown, so that far-away or non-finite points and a million vertices do no harm.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/numbers.h"
#include "host/picture/canvas.h"

namespace forceshade::picture {

// The one maker of ticks: round ones at steps of 1, 2 or 5, powers of ten on logarithmic axes, units, and an offset
// where a grid is far from the origin.

using namespace numbers;

/// The largest 1, 2 or 5 times a power of ten that does not exceed `value` > 0.
double round_below(double value);

/// Multiples of `step` = {1, 2, 5} * 10^k within [low, high], and how many decimals they need.
struct RoundTicks {
    std::vector<double> values;
    double step = 1;
    int decimals = 0;
};

/// At most `most` >= 1 ticks in [low, high], high > low, with the smallest step that allows it; at least one if most
/// >= 2.
RoundTicks round_ticks(double low, double high, std::size_t most);

/// The numbers along an axis.
struct Range {
    double low = 0, high = 1;
    bool logarithmic = false; // both are positive then
    /// Where a value lies: 0 at `low`, 1 at `high`. What a logarithmic axis cannot hold lies at its begin.
    double fraction(double value) const;
};

/// Makes an axis with at most `most` ticks.
using AxisMaker = std::function<struct Axis(std::size_t most)>;

struct AxisTick {
    double fraction; // of the axis length, in [0, 1]
    std::string label;
};

struct Axis {
    std::string title; // "x / mm", or "(x − 1000 m) / mm": each label is the offset coordinate in that unit
    std::vector<AxisTick> ticks;
    std::vector<double> minor{}; // fractions: of short ticks without a label
};

/// How a tick is written; `decimals` are those that its step needs.
using TickLabel = std::function<std::string(double value, int decimals)>;

/// At most `most` >= 2 ticks, on a logarithmic axis 1, 2, 5 or 1, 3 or 1 times powers of ten.
Axis number_axis(std::string title, const Range& range, std::size_t most, const TickLabel& label = number_label);

/// "force magnitude / mN": from `low` to `high` > low of a quantity in the unit `base`, degrees among them.
Axis quantity_axis(std::string_view name, std::string_view base, double low, double high, std::size_t most);

/// The length from the outer edge of the first sample's cell to that of the last one's. /* m */
double axis_extent(const std::vector<double>& samples, double spacing);

/// The axis of increasing `samples` (m); a lone sample gets a tick that names it. `unit` is usually that of
/// axis_extent.
Axis make_axis(std::string_view name, const std::vector<double>& samples, double spacing, const Unit& unit,
               std::size_t most_ticks);

/// "z = −4.2 mm" for each increasing coordinate (m), in one unit, with the decimals that distinguish them.
/// `spacing` of the grid (m) sets the resolution for a single coordinate. `preferred`: the unit to use where
/// its numbers are handy, between 0.001 and 10000.
std::vector<std::string> position_labels(std::string_view name, const std::vector<double>& at, double spacing,
                                         const Unit& preferred);

// What stands round a plot and in it.

inline constexpr double kMargin = 24; // pixels
inline constexpr double kBarGap = 34; // between a plot and its colour bar
inline constexpr double kTickLength = 6;
inline constexpr Rgb8 kQuietInk{110, 110, 110};
inline constexpr Rgb8 kGridInk{226, 229, 233};
inline constexpr TextStyle kNoteStyle{kTextSize, false, Horizontal::centre, Vertical::middle, false};

/// The axes of a slice in the plane of the picture, at most kMaxAspect apart in length.
struct PlaneAxes {
    SliceAxes samples;
    AxisMaker across, up;      // in one unit unless the extents are far apart
    Unit longer_unit;          // that of the longer axis
    double aspect = 1;         // height over width to draw: the true one, unless one axis is stretched
    std::string stretch_note;  // says so if one is, else empty
    std::string sampling_note; // "shown: 256 of 1024 samples along x", of axes shown sub-sampled; else empty
};

PlaneAxes plan_axes(const SliceAxes& samples);

/// How long a plot side of `samples` samples may be, at most `room` pixels: a handful of samples needs no whole sheet.
double most_pixels(std::size_t samples, double room);

/// Of the axes that make(most ticks) returns the one with as many ticks as fit into `pixels`.
Axis fit_axis(double pixels, bool vertical, const AxisMaker& make);

struct AxesStyle {
    bool bottom_labels = true, left_labels = true, grid = false;
};

/// Pixels that labels and title take left of a plot, or below it.
double left_room(const Axis& axis, bool title = true);
double bottom_room(bool title = true);
/// The frame of a plot, ticks and labels.
void draw_axes(Canvas& canvas, const Box& plot, const Axis& x, const Axis& y, const AxesStyle& style = {});
/// The titles outside of that, unless they are empty.
void draw_axis_titles(Canvas& canvas, const Box& plot, const Axis& x, const Axis& y);

/// A vertical bar of the scale's colours with ticks and title on its right; without values it is not drawn and has no
/// width.
double colour_bar_width(const ColourScale& scale, double height);
double colour_bar_least_height(const ColourScale& scale);
void draw_colour_bar(Canvas& canvas, Point upper_left, double height, const ColourScale& scale);

/// The title in bold over as many lines as it needs, then what the picture shows.
struct Heading {
    std::vector<std::string> name, notes;
    TextStyle name_style, note_style;
    double height = 0; // pixels, from the upper margin
};
Heading plan_heading(const Look& look, const std::vector<std::string>& notes);
void draw_heading(Canvas& canvas, const Heading& heading);

inline constexpr double kKeyLength = 44; // pixels: of a line's sign

struct LegendItem {
    std::string text;
    double width = kKeyLength;                                         // pixels: of its sign
    std::function<void(Canvas& canvas, Point left, Point right)> draw; // at half the height of the text
};

/// Height of the items, flowed into rows of `width` pixels; 0 without items.
double legend_height(const std::vector<LegendItem>& items, double width);
void draw_legend(Canvas& canvas, const std::vector<LegendItem>& items, Point upper_left, double width);

LegendItem line_item(std::string text, Stroke stroke, double width = kKeyLength);
/// `more` is drawn upon it.
LegendItem swatch_item(std::string text, Rgb8 colour, std::function<void(Canvas&, const Box&)> more = {});

inline constexpr double kLeastArrowLength = 4; // pixels

/// An arrow that stays readable on any colour: white, outlined in dark. One shorter than kLeastArrowLength is a dot.
void draw_arrow(Canvas& canvas, Point tail, Point tip);

/// The nominal surface is a solid line, the smooth shape a dashed one; over colours they have a halo.
Stroke surface_stroke(bool smooth, double width = 2.6);
void draw_surface_line(Canvas& canvas, const std::vector<Point>& points, bool smooth);

/// The connected pieces of the line that pass within a few pixels of `box`; points closer than a third of a pixel to
/// the one before are dropped. A point that is not finite breaks the line.
std::vector<std::vector<Point>> visible_pieces(std::span<const Point> line, const Box& box);

/// Whether the segment passes through `box`.
bool crosses(Point from, Point to, const Box& box);

/// The piece; one that stays in one place, as the force's direction in taps does, as a short bar there.
std::vector<Point> seen_as_line(std::vector<Point> piece);

// Charts: points and lines over two axes, cells of a map, bars.

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
    std::string shape{};                                        /* whose mark it has; empty: the series' */
};

struct ChartSeries {
    std::string name;
    std::vector<ChartPoint> points;
    bool marks = true, joined = false, dashed = false; /* without marks a point that is not finite breaks the line */
    std::vector<Stroke> strokes{};                     /* of the line, one over the other; empty: by the name */
    bool bar_if_still = false;                         /* a line that stays in one place is a short bar there */
    bool band = false;                                 /* filled between the points' whiskers, which are not drawn */
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
