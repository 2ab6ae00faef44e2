// What stands round a plot: axes with labels that keep clear of each other, colour bar, title.
#pragma once

#include "host/picture/canvas.h"
#include "host/picture/ticks.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace forceshade::picture {

inline constexpr double kMargin = 24; // pixels
inline constexpr double kBarGap = 34; // between a plot and its colour bar
inline constexpr double kTickLength = 6;
inline constexpr Rgb8 kQuietInk{110, 110, 110};
inline constexpr Rgb8 kGridInk{226, 229, 233};
inline constexpr TextStyle kNoteStyle{kTextSize, false, Horizontal::centre, Vertical::middle, false};

/// The axes of a slice in the plane of the picture, at most kMaxAspect apart in length.
struct PlaneAxes {
    std::string u_name, v_name;
    SliceAxes samples;
    Unit u_unit, v_unit;      // the same unless the extents are far apart
    Unit longer_unit;         // that of the longer axis
    double aspect = 1;        // height over width to draw: the true one, unless one axis is stretched
    std::string stretch_note; // says so if one is, else empty
};

PlaneAxes plan_axes(const SliceAxes& samples);

/// "256 of 1024 samples along x" for each axis that is shown sub-sampled; empty if none is.
std::string sampling_note(const PlaneAxes& axes);

/// How long a plot side of so many samples may be, at most `room` pixels: a handful of samples needs no whole sheet.
double most_pixels(std::size_t samples, double room);

/// Of the axes that make(most ticks) returns the one with as many ticks as so many pixels leave room for.
Axis fit_axis(double pixels, bool vertical, const std::function<Axis(std::size_t most)>& make);
Axis fit_horizontal(const PlaneAxes& axes, double pixels);
Axis fit_vertical(const PlaneAxes& axes, double pixels);

struct AxesStyle {
    bool bottom_labels = true, left_labels = true, grid = false;
};

/// Pixels that labels and title take left of a plot, or below it.
double left_room(const Axis& axis, bool title = true);
double bottom_room(bool title = true);
/// The frame of a plot, ticks and labels.
void draw_axes(Canvas& canvas, const Box& plot, const Axis& x, const Axis& y, const AxesStyle& style = {});
/// The titles beside that, unless they are empty.
void draw_axis_titles(Canvas& canvas, const Box& plot, const Axis& x, const Axis& y);

/// A vertical bar of the scale's colours with ticks and title on its right; nothing and no width without values.
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

} // namespace forceshade::picture
