// Slices of |F| side by side under one colour scale.
#include "host/picture/frame.h"
#include "host/picture/legend.h"
#include "host/picture/picture.h"
#include "host/picture/raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>

namespace forceshade::picture {
namespace {

constexpr double kMostTilesHeight = 1000; // pixels, of all tiles together
constexpr double kMostTileWidth = 900;
constexpr double kLeastTileSide = 8;
constexpr TextStyle kLabelStyle{kSmallTextSize, false, Horizontal::centre, Vertical::middle, false};
constexpr TextStyle kTileStyle{kSmallTextSize, false, Horizontal::left, Vertical::bottom, false};

struct Mosaic {
    std::span<const MagnitudeSlice> tiles;
    Census census;
    PlaneAxes axes;
    std::vector<std::string> labels{};

    std::size_t columns = 1, rows = 1;
    double tile_width = 0, tile_height = 0; // whole pixels
    double column_pitch = 0, row_pitch = 0; // whole pixels
    double label_height = 0;                // above each tile
    Point first{};                          // upper left corner of the first tile
    Axis horizontal{}, vertical{};

    double grid_width() const { return static_cast<double>(columns - 1) * column_pitch + tile_width; }
    double grid_height() const { return static_cast<double>(rows - 1) * row_pitch + tile_height; }
    Box tile(std::size_t i) const {
        return {first.x + static_cast<double>(i % columns) * column_pitch,
                first.y + static_cast<double>(i / columns) * row_pitch, tile_width, tile_height};
    }
};

double widest_of(const std::vector<std::string>& labels) {
    double widest = 0;
    for (const std::string& label : labels)
        widest = std::max(widest, measure(label, kTileStyle).width);
    return widest;
}

// Tries every number of columns and keeps the one with the largest tiles.
void arrange(Mosaic& mosaic, double available_width) {
    const double label_width = widest_of(mosaic.labels);
    const double gap = std::ceil(widest_label(fit_horizontal(mosaic.axes, kMostTileWidth)) + 12);
    mosaic.label_height = std::ceil(measure("z", kTileStyle).height + 4);
    double best = 0;
    const std::size_t count = mosaic.tiles.size();
    for (std::size_t columns = 1; columns <= count; ++columns) {
        const std::size_t rows = (count + columns - 1) / columns;
        const double across = static_cast<double>(columns), down = static_cast<double>(rows);
        const double room_x = (available_width - (across - 1) * gap) / across;
        const double room_y = kMostTilesHeight / down - mosaic.label_height - 10;
        const double most_x = most_pixels(mosaic.axes.samples.u.size(), std::min(room_x, kMostTileWidth));
        const double most_y = most_pixels(mosaic.axes.samples.v.size(), room_y);
        const double scale = std::min(most_x, most_y * mosaic.axes.u_length / mosaic.axes.v_length);
        const double width = std::max(std::floor(scale), kLeastTileSide);
        const double pitch = std::ceil(std::max(width, label_width) + gap);
        if (width <= best || (columns > 1 && pitch * (across - 1) + width > available_width))
            continue;
        best = width;
        mosaic.columns = columns;
        mosaic.rows = rows;
        mosaic.tile_width = width;
        mosaic.column_pitch = pitch;
    }
    const double height = mosaic.tile_width * mosaic.axes.v_length / mosaic.axes.u_length;
    mosaic.tile_height = std::max(std::round(height), kLeastTileSide);
    mosaic.row_pitch = mosaic.tile_height + mosaic.label_height + 10;
}

std::string empty_text(double width) {
    for (const char* text : {"no force in this slice", "no force", "0 N"})
        if (measure(text, kLabelStyle).width + 8 <= width)
            return text;
    return "";
}

void draw_tile(Canvas& canvas, const Mosaic& mosaic, std::size_t i) {
    const MagnitudeSlice& slice = mosaic.tiles[i];
    const Box box = mosaic.tile(i);
    const auto width = static_cast<int>(box.width), height = static_cast<int>(box.height);
    canvas.image(static_cast<int>(box.x), static_cast<int>(box.y), width, height,
                 rasterise(slice, width, height, mosaic.census.largest));
    canvas.outline({box.x - 0.5, box.y - 0.5, box.width + 1, box.height + 1}, {});
    canvas.text(mosaic.labels[i], {box.x, box.y - 4}, kTileStyle);
    const Census census = take_census(slice.magnitude);
    if (census.zero == census.samples && box.height >= measure("0", kLabelStyle).height)
        canvas.text(empty_text(box.width), {box.x + box.width / 2, box.y + box.height / 2}, kLabelStyle, kQuietInk);
    const bool lowest = i + mosaic.columns >= mosaic.tiles.size();
    draw_bottom_ticks(canvas, box, mosaic.horizontal, lowest);
    draw_left_ticks(canvas, box, mosaic.vertical, i % mosaic.columns == 0);
}

std::vector<std::string> notes_of(const Mosaic& mosaic) {
    const std::size_t count = mosaic.tiles.size();
    std::vector<std::string> notes{
        count == 1 ? "force magnitude |F| in one slice of constant z"
                   : fmt::format("force magnitude |F| in {} slices of constant z, one colour scale", count)};
    notes[0] += largest_note(mosaic.census.largest);
    const std::string sampling = sampling_note(mosaic.axes);
    if (!mosaic.axes.stretch_note.empty())
        notes.push_back(mosaic.axes.stretch_note);
    if (!sampling.empty())
        notes.push_back(sampling);
    if (mosaic.census.zero == mosaic.census.samples)
        notes.push_back("no force in this field");
    return notes;
}

std::vector<LegendItem> legend_of(const Census& census) {
    std::vector<LegendItem> items;
    if (census.zero > 0)
        items.push_back({Sign::no_force, "no force (|F| = 0)"});
    if (census.non_finite > 0)
        items.push_back({Sign::non_finite,
                         fmt::format("not a finite number ({} of {} samples)", census.non_finite, census.samples)});
    return items;
}

double left_room(const PlaneAxes& axes) {
    double widest = 0;
    for (const double pixels : {60.0, 250.0, kMostTilesHeight}) // the tiles' height is not known yet
        widest = std::max(widest, left_labels_width(fit_vertical(axes, pixels)));
    return widest + 8 + measure("y", kUpAxisStyle).width;
}

Mosaic plan_mosaic(std::span<const MagnitudeSlice> tiles) {
    Mosaic mosaic{.tiles = tiles, .census = {}, .axes = plan_axes("x", "y", tiles[0].axes)};
    std::vector<double> heights;
    for (const MagnitudeSlice& tile : tiles) {
        mosaic.census = mosaic.census + take_census(tile.magnitude);
        heights.push_back(tile.axes.at);
    }
    mosaic.labels = position_labels("z", heights, tiles[0].axes.at_spacing, mosaic.axes.longer_unit);
    const double bar = kBarGap + colour_bar_width(mosaic.census.largest, kMostTilesHeight);
    arrange(mosaic, kSheetWidth - 2 * kMargin - left_room(mosaic.axes) - bar);
    mosaic.horizontal = fit_horizontal(mosaic.axes, mosaic.tile_width);
    mosaic.vertical = fit_vertical(mosaic.axes, mosaic.tile_height);
    return mosaic;
}

void draw_axis_titles(Canvas& canvas, const Mosaic& mosaic, double labels_width) {
    const double bottom = mosaic.first.y + mosaic.grid_height() + bottom_labels_height() + 4;
    canvas.text(mosaic.horizontal.title, {mosaic.first.x + mosaic.grid_width() / 2, bottom}, kAxisStyle);
    canvas.text(mosaic.vertical.title, {mosaic.first.x - labels_width - 8, mosaic.first.y + mosaic.grid_height() / 2},
                kUpAxisStyle);
}

} // namespace

Picture draw_mosaic(const std::string& name, std::span<const MagnitudeSlice> tiles) {
    assert(!tiles.empty());
    Mosaic mosaic = plan_mosaic(tiles);
    const double largest = mosaic.census.largest;
    const Heading heading = plan_heading(name, notes_of(mosaic));
    const std::vector<LegendItem> legend = legend_of(mosaic.census);
    const double legend_width = kSheetWidth - 2 * kMargin;

    const double labels_width = left_labels_width(mosaic.vertical);
    const double left = labels_width + 8 + measure(mosaic.vertical.title, kUpAxisStyle).width;
    const double body = std::ceil(std::max(
        {mosaic.grid_height(), colour_bar_least_height(largest), measure(mosaic.vertical.title, kUpAxisStyle).height}));
    const double bar_gap = kBarGap + std::max(0.0, mosaic.column_pitch - mosaic.tile_width - kBarGap);
    const double width = left + mosaic.grid_width() + bar_gap + colour_bar_width(largest, body);
    const double top = std::ceil(kMargin + heading.height + 12 + mosaic.label_height);
    mosaic.first = {std::round((kSheetWidth - width) / 2 + left), top + std::round((body - mosaic.grid_height()) / 2)};
    const double below = top + body + bottom_labels_height() + 4 + measure("x", kAxisStyle).height + 14;

    Canvas canvas(static_cast<int>(kSheetWidth),
                  static_cast<int>(std::ceil(below + legend_height(legend, legend_width) + kMargin / 2)));
    draw_heading(canvas, heading);
    for (std::size_t i = 0; i < tiles.size(); ++i)
        draw_tile(canvas, mosaic, i);
    draw_axis_titles(canvas, mosaic, labels_width);
    draw_colour_bar(canvas, {std::round(mosaic.first.x + mosaic.grid_width() + bar_gap), top}, body, largest);
    draw_legend(canvas, legend, {kMargin, below}, legend_width);
    return canvas.finish();
}

} // namespace forceshade::picture
