#include "host/picture/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace forceshade::picture {
namespace {

constexpr int kChartWidth = 1000; // pixels
constexpr double kRowOfBars = 34, kRowOfWords = 22, kPanelGap = 28, kPanelTitle = 26;
constexpr TextStyle kChartLabelStyle{kSmallTextSize, false, Horizontal::left, Vertical::middle, false};
constexpr std::size_t kMostLabels = 12;
constexpr Rgb8 kBandFilling{222, 222, 222};

bool can_show(const ChartAxis& axis, double value) {
    return std::isfinite(value) && (!axis.logarithmic || value > 0);
}

// With a border; a linear axis begins at 0 if its values come near.
Range range_of(const ChartAxis& axis, const std::vector<double>& values) {
    double low = INFINITY, high = -INFINITY;
    for (const double value : values)
        if (can_show(axis, value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    if (low > high)
        low = high = 1;
    if (axis.logarithmic) {
        const double border = std::pow(std::max(10.0, high / low), 0.04);
        return {low / border, high * border, true};
    }
    const double border = high > low ? 0.05 * (high - low) : std::max(std::fabs(high), 1.0) * 0.1;
    return {low >= 0 && low < 0.4 * high ? 0 : low - border, high <= 0 && high > 0.4 * low ? 0 : high + border};
}

// A number of cells or a limit of their colours.
std::string cell_number(double value) {
    return value == 0 ? "0" : (value < 0 ? "−" : "") + three_digits(std::fabs(value));
}

// The cells of a map: how their numbers or words become colours, and where they lie.
struct Cells {
    const Chart& chart;
    std::vector<std::string> words; // those that some cell has
    bool both_signs = false, logarithmic = false;
    double low = 0, high = 1;
    std::vector<double> xs, ys; // of the columns and rows, which are equally wide

    explicit Cells(const Chart& from) : chart(from) {
        double least = INFINITY, most = 0;
        std::vector<std::string> present;
        for (const ChartCell& cell : chart.cells) {
            both_signs = both_signs || cell.value < 0;
            most = std::max(most, std::fabs(cell.value));
            if (cell.value > 0)
                least = std::min(least, cell.value);
            if (!cell.word.empty() && std::ranges::find(present, cell.word) == present.end())
                present.push_back(cell.word);
            xs.push_back(cell.x);
            ys.push_back(cell.y);
        }
        for (const auto* from_list : {&chart.words, &std::as_const(present)})
            for (const std::string& word : *from_list)
                if (std::ranges::find(present, word) != present.end() && std::ranges::find(words, word) == words.end())
                    words.push_back(word);
        for (auto* values : {&xs, &ys}) {
            std::ranges::sort(*values);
            values->erase(std::unique(values->begin(), values->end()), values->end());
        }
        logarithmic = chart.value_logarithmic && !both_signs && least < most;
        high = chart.value_limit > 0 ? chart.value_limit : most > 0 ? most : 1;
        low = both_signs ? -high : logarithmic ? least : 0;
    }

    Rgb8 of(double value) const {
        return colour_at(both_signs ? ColourMap::diverging : ColourMap::sequential,
                         Range{low, high, logarithmic}.fraction(logarithmic ? std::max(value, low) : value));
    }
    // By its place in the list of all words, so that figures with some of them agree.
    std::size_t number_of(const std::string& word) const {
        const auto& all = chart.words.empty() ? words : chart.words;
        return static_cast<std::size_t>(std::ranges::find(all, word) - all.begin());
    }
    Rgb8 of(const std::string& word) const { return lighter(series_colour(number_of(word))); }

    // What distinguishes words in print without colours: nothing, a dot, a stroke, a cross.
    void mark(Canvas& canvas, const std::string& word, const Box& box) const {
        constexpr double kLeastBox = 5; // pixels
        const double reach = std::min({box.width, box.height, 14.0}) / 4;
        if (4 * reach < kLeastBox)
            return;
        const Point at{box.x + box.width / 2, box.y + box.height / 2};
        const std::size_t number = number_of(word) % 4;
        if (number == 1)
            canvas.disc(at, reach / 2, kInk);
        if (number >= 2)
            canvas.polyline(std::array{Point{at.x - reach, at.y + reach}, Point{at.x + reach, at.y - reach}}, {});
        if (number == 3)
            canvas.polyline(std::array{Point{at.x - reach, at.y - reach}, Point{at.x + reach, at.y + reach}}, {});
    }

    // Where a value lies among those of the cells, 0 to 1.
    static double fraction(const std::vector<double>& values, double value) {
        const auto above = static_cast<std::size_t>(std::ranges::lower_bound(values, value) - values.begin());
        const auto count = static_cast<double>(values.size());
        if (above == 0 || above == values.size() || values[above] == value)
            return (static_cast<double>(std::min(above, values.size() - 1)) + 0.5) / count;
        const double part = (value - values[above - 1]) / (values[above] - values[above - 1]);
        return (static_cast<double>(above) - 0.5 + part) / count;
    }
    // From the first to the last of three values or more; logarithmic where their steps grow.
    static Range range_between(const std::vector<double>& values) {
        constexpr double kGrowth = 1.5;
        const double low = values.front(), high = values.back();
        return {low, high, low > 0 && high - *(values.end() - 2) > kGrowth * (values[1] - low)};
    }
    // Every word has a tick, and so has each of two values and of a few equal steps of counts; else round numbers lie
    // between the values.
    static Axis axis(const ChartAxis& of, const std::vector<double>& values, std::size_t most) {
        const Range range = values.size() > 2 ? range_between(values) : Range{};
        const bool few_counts = values.size() <= most && !range.logarithmic &&
                                std::ranges::all_of(values, [](double value) { return value == std::floor(value); });
        if (of.words.empty() && values.size() > 2 && !few_counts) {
            Axis axis = number_axis(of.label, range, most);
            for (AxisTick& tick : axis.ticks)
                tick.fraction =
                    fraction(values, range.logarithmic ? range.low * std::pow(range.high / range.low, tick.fraction)
                                                       : std::lerp(range.low, range.high, tick.fraction));
            return axis;
        }
        Axis axis{of.label, {}};
        for (const double value : values)
            axis.ticks.push_back({fraction(values, value), of.words.empty()
                                                               ? cell_number(value)
                                                               : of.words[static_cast<std::size_t>(std::fabs(value))]});
        return axis;
    }

    void add_to(std::vector<LegendItem>& legend) const {
        for (const std::string& word : words)
            legend.push_back(
                swatch_item(word, of(word), [this, word](Canvas& canvas, const Box& box) { mark(canvas, word, box); }));
        if (words.empty())
            legend.push_back(
                {fmt::format("{} to {}: {}", cell_number(low), cell_number(high), chart.value_label), 120,
                 [this](Canvas& canvas, Point left, Point right) {
                     const Range along{0, right.x - left.x};
                     for (double x = 0; x < along.high; ++x) {
                         const double share = along.fraction(x);
                         canvas.fill({left.x + x, left.y - 7, 1.5, 14},
                                     of(logarithmic ? low * std::pow(high / low, share) : low + (high - low) * share));
                     }
                 }});
    }
};

// The plot of a chart, on a sheet with others or alone.
class ChartPlot {
public:
    explicit ChartPlot(const Chart& chart) : chart_(chart), cells_(chart) {
        std::vector<std::string> names;
        for (const ChartSeries& series : chart.series)
            names.push_back(series.marks ? series.name : "");
        numbers_ = series_numbers(names);
        std::vector<std::string> shapes;
        for (const ChartSeries& series : chart.series)
            for (const ChartPoint& point : series.points)
                if (!point.shape.empty() && shown(point) && std::ranges::find(shapes, point.shape) == shapes.end())
                    shapes.push_back(point.shape);
        const std::vector<std::size_t> marks = series_numbers(shapes);
        for (std::size_t i = 0; i < shapes.size(); ++i)
            shapes_.emplace_back(shapes[i], marks[i]);
        plan_ranges();
    }

    double height(double share) const {
        if (bars())
            return std::max(120.0, kRowOfBars * static_cast<double>(chart_.groups.size()));
        return std::max(chart_.height * share, kRowOfWords * static_cast<double>(chart_.y.words.size()));
    }
    double room_on_left(double share) const {
        double room = 0;
        for (const double pixels : {chart_.aspect > 0 ? 60 : height(share), height(share)})
            room = std::max(room, left_room(make_y_axis(pixels)));
        return room;
    }
    double most_width(double share) const { return chart_.aspect > 0 ? height(share) / chart_.aspect : INFINITY; }

    /// The plot, but for its width, of which as much is taken as leaves the last label on the sheet.
    void place(const Box& box, double sheet_width) {
        const auto count = static_cast<double>(panels());
        const double title = chart_.panels.empty() ? 0 : kPanelTitle;
        plot_ = {box.x, box.y + title, (box.width - (count - 1) * kPanelGap) / count, box.height};
        for (double beyond = 0; plot_.width > 100; plot_.width -= beyond) {
            x_axis_ = make_axis_of(chart_.x, cells_.xs, x_, counted_[0], plot_.width, false);
            const AxisTick& last = x_axis_.ticks.back();
            beyond = plot_.x + (count - 1) * (plot_.width + kPanelGap) + last.fraction * plot_.width +
                     measure(last.label, kChartLabelStyle).width / 2 - sheet_width + 4;
            if (beyond <= 0)
                break;
        }
        if (chart_.aspect > 0)
            plot_.height = std::round(plot_.width * chart_.aspect);
        y_axis_ = make_y_axis(plot_.height);
    }
    const Box& box() const { return plot_; }
    std::size_t left_out() const { return left_out_; }

    void add_to(std::vector<LegendItem>& legend) const {
        if (map())
            cells_.add_to(legend);
        for (std::size_t i = 0; i < chart_.series.size(); ++i)
            add_item(i, legend);
        for (const auto& [name, shape] : shapes_)
            legend.push_back({name, 14, [shape = shape](Canvas& canvas, Point left, Point right) {
                                  draw_mark(canvas, kQuietInk, shape, {(left.x + right.x) / 2, left.y});
                              }});
    }

    void draw(Canvas& canvas, bool lowest) {
        if (!lowest)
            x_axis_.title.clear();
        const double pitch = plot_.width + kPanelGap;
        draw_axis_titles(canvas, {plot_.x, plot_.y, double(panels()) * pitch - kPanelGap, plot_.height}, x_axis_,
                         y_axis_);
        for (std::size_t panel = 0; panel < panels(); ++panel, plot_.x += pitch)
            draw_panel(canvas, panel);
        plot_.x -= double(panels()) * pitch;
        if (!chart_.remark.empty())
            canvas.text(chart_.remark, {plot_.x + plot_.width / 2, plot_.y + plot_.height / 4}, kNoteStyle, kQuietInk);
    }

private:
    std::size_t panels() const { return std::max<std::size_t>(1, chart_.panels.size()); }

    void draw_panel(Canvas& canvas, std::size_t panel) {
        draw_axes(canvas, plot_, x_axis_, y_axis_, {true, panel == 0, !map()});
        if (!chart_.panels.empty())
            canvas.text(chart_.panels[panel], {plot_.x, plot_.y - kPanelTitle / 2}, kChartLabelStyle);
        canvas.begin_clip(plot_);
        if (map())
            draw_cells(canvas, panel);
        if (bars())
            draw_bars(canvas);
        else
            draw_series(canvas);
        canvas.end_clip();
        canvas.outline({plot_.x - 0.5, plot_.y - 0.5, plot_.width + 1, plot_.height + 1}, {});
        draw_labels(canvas);
    }

    bool map() const { return !chart_.cells.empty(); }
    bool bars() const { return !chart_.groups.empty(); }

    bool shown(const ChartPoint& point) const {
        if (bars())
            return can_show(chart_.x, point.y);
        if (map())
            return point.x >= cells_.xs.front() && point.x <= cells_.xs.back() && point.y >= cells_.ys.front() &&
                   point.y <= cells_.ys.back();
        return can_show(chart_.x, point.x) && can_show(chart_.y, point.y);
    }

    void plan_ranges() {
        std::vector<double> xs, ys;
        for (const ChartSeries& series : chart_.series)
            for (const ChartPoint& point : series.points) {
                if (!shown(point)) {
                    left_out_ += !map() && series.marks;
                    continue;
                }
                for (const auto& [values, at, low, high] :
                     {std::tuple(&xs, point.x, point.x_low, point.x_high), {&ys, point.y, point.y_low, point.y_high}})
                    values->insert(values->end(), {at, low.value_or(at), high.value_or(at)});
            }
        if (bars()) { // they are horizontal, and begin at zero
            ys.push_back(0);
            xs = ys;
        }
        x_ = chart_.x.range ? *chart_.x.range : range_of(chart_.x, xs);
        y_ = chart_.y.range ? *chart_.y.range : range_of(chart_.y, ys);
        const auto counted = [](const ChartAxis& axis, const std::vector<double>& values) {
            return !axis.logarithmic && !values.empty() &&
                   std::ranges::all_of(values, [](double value) { return value == std::floor(value); });
        };
        counted_ = {counted(chart_.x, xs), counted(chart_.y, ys)};
    }

    // `values`: of a map's columns or rows. Nothing lies between what is counted: then no more ticks than whole
    // numbers, if these are several.
    Axis make_axis_of(const ChartAxis& axis, const std::vector<double>& values, const Range& range, bool counted,
                      double pixels, bool vertical) const {
        const double whole = std::floor(range.high) - std::ceil(range.low) + 1;
        return fit_axis(pixels, vertical, [&](std::size_t most) {
            if (map())
                return Cells::axis(axis, values, most);
            if (counted && whole >= 2 && whole < static_cast<double>(most))
                most = static_cast<std::size_t>(whole);
            return axis.make ? axis.make(most) : number_axis(axis.label, range, most);
        });
    }

    Axis make_y_axis(double height) const {
        if (!bars())
            return make_axis_of(chart_.y, cells_.ys, y_, counted_[1], height, true);
        Axis axis{chart_.y.label, {}};
        const auto count = static_cast<double>(chart_.groups.size());
        for (std::size_t i = 0; i < chart_.groups.size(); ++i)
            axis.ticks.push_back({1 - (static_cast<double>(i) + 0.5) / count, chart_.groups[i]});
        return axis;
    }

    Point place(double x, double y) const {
        const double u = map() ? Cells::fraction(cells_.xs, x) : x_.fraction(x);
        const double v = map() ? Cells::fraction(cells_.ys, y) : y_.fraction(y);
        return {plot_.x + u * plot_.width, plot_.y + (1 - v) * plot_.height};
    }

    // The series with marks whose name a curve has, or null.
    const ChartSeries* marked_as(const ChartSeries& curve) const {
        const auto found = std::ranges::find_if(
            chart_.series, [&](const ChartSeries& one) { return !curve.marks && one.marks && one.name == curve.name; });
        return found == chart_.series.end() ? nullptr : &*found;
    }

    // Curves differ by their dashes: the first of those that are not dashed is solid.
    Stroke stroke_of(std::size_t number) const {
        static const std::vector<std::vector<double>> kDashes{{8, 5}, {2, 4}, {10, 4, 2, 4}, {4, 4}, {12, 3}};
        const ChartSeries& series = chart_.series[number];
        if (!series.strokes.empty())
            return series.strokes.back();
        if (series.marks)
            return {series_colour(numbers_[number]), 1.8, series.dashed ? kDashes[0] : std::vector<double>{}, true};
        if (const ChartSeries* own = marked_as(series))
            return {series_colour(numbers_[static_cast<std::size_t>(own - chart_.series.data())]), 1.4, {}, true};
        const auto curves = chart_.series.begin() + static_cast<std::ptrdiff_t>(number);
        const auto before =
            std::count_if(chart_.series.begin(), curves, [](const ChartSeries& one) { return !one.marks; });
        const bool solid = !series.dashed && std::none_of(chart_.series.begin(), curves, [](const ChartSeries& one) {
            return !one.marks && !one.dashed;
        });
        return {kInk, map() ? 1.8 : 1.4,
                solid ? std::vector<double>{} : kDashes[static_cast<std::size_t>(before) % kDashes.size()], true};
    }

    std::size_t shape_of(std::size_t series, const ChartPoint& point) const {
        const auto own = std::ranges::find(shapes_, point.shape, &std::pair<std::string, std::size_t>::first);
        return own == shapes_.end() ? numbers_[series] : own->second;
    }

    // Only of what is drawn.
    void add_item(std::size_t i, std::vector<LegendItem>& legend) const {
        const ChartSeries& series = chart_.series[i];
        const auto points = std::ranges::count_if(series.points, [&](const ChartPoint& one) { return shown(one); });
        if (series.name.empty() || points < (series.marks ? 1 : 2) || marked_as(series))
            return;
        if (bars() || (series.marks && !shapes_.empty()))
            legend.push_back(swatch_item(series.name, series_colour(numbers_[i])));
        else
            legend.push_back(
                {series.name, series.joined || !series.marks ? kKeyLength : 14,
                 [this, i, &series](Canvas& canvas, Point left, Point right) {
                     if (series.joined || !series.marks)
                         canvas.polyline(std::array{left, right}, stroke_of(i));
                     if (series.marks)
                         draw_mark(canvas, series_colour(numbers_[i]), numbers_[i], {(left.x + right.x) / 2, left.y});
                 }});
    }

    void draw_cells(Canvas& canvas, std::size_t panel) const {
        const double width = plot_.width / static_cast<double>(cells_.xs.size()),
                     height = plot_.height / static_cast<double>(cells_.ys.size());
        for (const ChartCell& cell : chart_.cells) {
            if (cell.panel != panel)
                continue;
            const Point middle = place(cell.x, cell.y);
            canvas.fill({middle.x - width / 2, middle.y - height / 2, width + 0.5, height + 0.5},
                        cell.word.empty() ? cells_.of(cell.value) : cells_.of(cell.word));
            if (!cell.word.empty())
                cells_.mark(canvas, cell.word, {middle.x - width / 2, middle.y - height / 2, width, height});
        }
    }

    // Bars lie, a group of them at each word.
    void draw_bars(Canvas& canvas) const {
        const double row = plot_.height / static_cast<double>(chart_.groups.size());
        const double height = 0.75 * row / static_cast<double>(chart_.series.size());
        const double base = chart_.x.logarithmic ? 0 : place(0, 0).x;
        for (std::size_t i = 0; i < chart_.series.size(); ++i)
            for (const ChartPoint& point : chart_.series[i].points) {
                if (!shown(point))
                    continue;
                const double top = plot_.y + (point.x + 0.125) * row + static_cast<double>(i) * height;
                const double end = place(point.y, 0).x;
                if (chart_.x.logarithmic) // it has no zero for a bar to begin at
                    draw_mark(canvas, series_colour(numbers_[i]), numbers_[i], {end, top + height / 2});
                else
                    canvas.fill({std::min(base, end), top, std::max(1.0, std::fabs(end - base)), height - 1},
                                series_colour(numbers_[i]));
                if (point.y_low && point.y_high && can_show(chart_.x, *point.y_low))
                    canvas.polyline(std::array{Point{place(*point.y_low, 0).x, top + height / 2},
                                               Point{place(*point.y_high, 0).x, top + height / 2}},
                                    {});
            }
    }

    void draw_whisker(Canvas& canvas, Point from, Point to, const Stroke& stroke) {
        const double length = std::hypot(to.x - from.x, to.y - from.y);
        if (!(length > 0))
            return;
        const Point aside{3 * (to.y - from.y) / length, 3 * (to.x - from.x) / length};
        canvas.polyline(std::array{from, to}, stroke);
        lines_.emplace_back(from, to);
        for (const Point end : {from, to})
            canvas.polyline(
                std::array{Point{end.x - aside.x, end.y - aside.y}, Point{end.x + aside.x, end.y + aside.y}}, stroke);
    }

    void draw_band(Canvas& canvas, const ChartSeries& series) const {
        std::vector<Point> below, above;
        for (std::size_t k = 0; k <= series.points.size(); ++k) {
            if (k < series.points.size() && shown(series.points[k])) {
                const ChartPoint& point = series.points[k];
                below.push_back(place(point.x, point.y_low.value_or(point.y)));
                above.push_back(place(point.x, point.y_high.value_or(point.y)));
                continue;
            }
            below.insert(below.end(), above.rbegin(), above.rend());
            if (!below.empty())
                canvas.polygon(below, kBandFilling, {kBandFilling, 1, {}, true});
            below.clear();
            above.clear();
        }
    }

    void draw_line(Canvas& canvas, std::size_t number, const std::vector<Point>& places) {
        const ChartSeries& series = chart_.series[number];
        const std::vector<Stroke> strokes = series.strokes.empty() ? std::vector{stroke_of(number)} : series.strokes;
        for (const std::vector<Point>& piece : visible_pieces(places, plot_))
            for (const Stroke& stroke : strokes)
                canvas.polyline(series.bar_if_still ? seen_as_line(piece) : piece, stroke);
        for (std::size_t k = 1; k < places.size(); ++k)
            lines_.emplace_back(places[k - 1], places[k]);
    }

    // Lines, whiskers and marks, and what labels must keep clear of.
    void draw_series(Canvas& canvas) {
        for (std::size_t i = 0; i < chart_.series.size(); ++i) {
            const ChartSeries& series = chart_.series[i];
            std::vector<Point> places;
            if (series.band)
                draw_band(canvas, series);
            for (const ChartPoint& point : series.points) {
                if (shown(point))
                    places.push_back(place(point.x, point.y));
                else if (!series.marks && !map())
                    places.push_back({NAN, NAN});
                if (!shown(point) || series.band)
                    continue;
                const Stroke thin{series_colour(numbers_[i]), 1.3, {}, false};
                if (point.x_low && point.x_high && can_show(chart_.x, *point.x_low))
                    draw_whisker(canvas, place(*point.x_low, point.y), place(*point.x_high, point.y), thin);
                if (point.y_low && point.y_high && can_show(chart_.y, *point.y_low))
                    draw_whisker(canvas, place(point.x, *point.y_low), place(point.x, *point.y_high), thin);
                if (!point.label.empty())
                    labels_.emplace_back(point.label, places.back());
            }
            if (series.joined || !series.marks)
                draw_line(canvas, i, places);
            for (const ChartPoint& point : series.points)
                if (series.marks && point.marked && shown(point)) {
                    marks_.push_back(place(point.x, point.y));
                    draw_mark(canvas, series_colour(numbers_[i]), shape_of(i, point), marks_.back());
                }
        }
    }

    // Next to their marks, where no mark, line or other label is.
    void draw_labels(Canvas& canvas) const {
        std::vector<Box> taken;
        for (const Point& mark : marks_)
            taken.push_back({mark.x - 5, mark.y - 5, 10, 10});
        std::size_t drawn = 0;
        for (const auto& [text, at] : labels_) {
            const Extent size = measure(text, kChartLabelStyle);
            const double left = -10 - size.width;
            for (const auto& [dx, dy] :
                 {std::pair{10.0, -9.0}, {left, -9.0}, {10.0, -26.0}, {10.0, 8.0}, {left, -26.0}, {left, 8.0}}) {
                const Box box{at.x + dx, at.y + dy, size.width, size.height};
                const bool inside = box.x > plot_.x + 2 && box.x + box.width < plot_.x + plot_.width - 2 &&
                                    box.y > plot_.y + 2 && box.y + box.height < plot_.y + plot_.height - 2;
                const auto meets = [&](const Box& other) {
                    return box.x < other.x + other.width && other.x < box.x + box.width &&
                           box.y < other.y + other.height && other.y < box.y + box.height;
                };
                const auto is_crossed = [&](const auto& line) { return crosses(line.first, line.second, box); };
                if (inside && drawn < kMostLabels && std::ranges::none_of(taken, meets) &&
                    std::ranges::none_of(lines_, is_crossed)) {
                    canvas.text(text, {box.x, box.y + box.height / 2}, kChartLabelStyle);
                    taken.push_back(box);
                    ++drawn;
                    break;
                }
            }
        }
    }

    const Chart& chart_;
    Cells cells_;
    std::vector<std::size_t> numbers_;                        // of the series, for colour and mark
    std::vector<std::pair<std::string, std::size_t>> shapes_; // of points that have their own
    Range x_, y_;
    std::array<bool, 2> counted_{}; // whether x, y are whole numbers
    Axis x_axis_, y_axis_;
    Box plot_;
    std::size_t left_out_ = 0; // points
    std::vector<std::pair<std::string, Point>> labels_;
    std::vector<Point> marks_;
    std::vector<std::pair<Point, Point>> lines_;
};

} // namespace

Picture draw_chart(const Chart& chart) {
    return draw_charts({chart.title, kChartWidth, 0}, {}, {chart});
}

Picture draw_charts(const Look& look, const std::vector<std::string>& notes, const std::vector<Chart>& charts) {
    constexpr double kBetween = 20;
    const Heading heading = plan_heading(look, notes);
    const double whole_width = look.width - 2 * kMargin;
    std::vector<ChartPlot> plots(charts.begin(), charts.end());
    std::vector<LegendItem> legend;
    std::size_t left_out = 0;
    for (const ChartPlot& plot : plots) {
        plot.add_to(legend);
        left_out += plot.left_out();
    }
    double legend_top = 0, end = 0, share = 1;
    for (const bool again : {false, true}) { // smaller, if it is too high
        double left = 0, top = kMargin + heading.height + 10, width = INFINITY, heights = 0;
        for (const ChartPlot& plot : plots) {
            left = std::max(left, plot.room_on_left(share));
            width = std::min(width, plot.most_width(share));
        }
        const double room = look.width - kMargin - std::ceil(kMargin + left);
        width = std::min(width, room);
        const double x = std::ceil(kMargin + left) + std::floor((room - width) / 2);
        for (ChartPlot& plot : plots) {
            plot.place({x, top, width, plot.height(share)}, look.width);
            heights += plot.box().height;
            legend_top = plot.box().y + plot.box().height + bottom_room() + 12;
            top = plot.box().y + plot.box().height + bottom_room(false) + kBetween;
        }
        end = legend_top + legend_height(legend, whole_width) + (left_out > 0 ? 24 : 0) + kMargin / 2;
        if (again || look.most_height == 0 || end <= look.most_height)
            break;
        share = std::max(heights - (std::ceil(end) - look.most_height), 80.0) / heights;
    }
    Canvas canvas(look.width, static_cast<int>(std::ceil(end)));
    draw_heading(canvas, heading);
    for (ChartPlot& plot : plots)
        plot.draw(canvas, &plot == &plots.back());
    draw_legend(canvas, legend, {kMargin, legend_top}, whole_width);
    if (left_out > 0)
        canvas.text(fmt::format("{} points have no number that these axes can show.", left_out),
                    {kMargin, end - kMargin / 2 - 8}, kChartLabelStyle, kQuietInk);
    return canvas.finish();
}

} // namespace forceshade::picture
