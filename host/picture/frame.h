// What stands round a plot: frame, axes with labels that keep clear of each other, colour bar, title.
#pragma once

#include "host/picture/canvas.h"
#include "host/picture/ticks.h"

#include <cstddef>
#include <string>
#include <vector>

namespace forceshade::picture {

inline constexpr double kSheetWidth = 1400; // pixels
inline constexpr double kMargin = 24;
inline constexpr double kBarGap = 34; // between a plot and its colour bar
inline constexpr Rgb8 kQuietInk{110, 110, 110};
inline constexpr TextStyle kAxisStyle{kTextSize, false, Horizontal::centre, Vertical::top, false};
inline constexpr TextStyle kUpAxisStyle{kTextSize, false, Horizontal::right, Vertical::middle, true};
inline constexpr TextStyle kNoteStyle{kTextSize, false, Horizontal::centre, Vertical::middle, false};

/// The axes of a slice in the plane of the picture, at most kMaxAspect apart in length.
struct PlaneAxes {
    std::string u_name, v_name;
    SliceAxes samples;
    Unit u_unit, v_unit; // the same unless the extents are far apart
    Unit longer_unit;    // that of the longer axis
    double u_length = 1,
           v_length = 1;      // lengths to draw, in any common unit: the true extents, or one of them stretched
    std::string stretch_note; // says so if one is, else empty
};

/// How long a plot side of so many samples may be, at most `room` pixels: a handful of samples needs no whole sheet.
double most_pixels(std::size_t samples, double room);

PlaneAxes plan_axes(std::string u_name, std::string v_name, const SliceAxes& samples);

/// The axis of the plane with as many ticks as `pixels` leave room for.
Axis fit_horizontal(const PlaneAxes& axes, double pixels);
Axis fit_vertical(const PlaneAxes& axes, double pixels);
double widest_label(const Axis& axis);

/// Pixels that tick labels take below a plot, or left of it.
inline constexpr double kTickLength = 6;
double bottom_labels_height();
double left_labels_width(const Axis& axis);

void draw_bottom_ticks(Canvas& canvas, const Box& plot, const Axis& axis, bool labels);
void draw_left_ticks(Canvas& canvas, const Box& plot, const Axis& axis, bool labels);

/// Vertical bar from 0 to `largest` (N) with ticks and title on its right; nothing and no width if `largest` is 0.
double colour_bar_width(double largest, double height);
double colour_bar_least_height(double largest);
void draw_colour_bar(Canvas& canvas, Point upper_left, double height, double largest);

/// The case's name in bold over as many lines as it needs, then what the picture shows.
struct Heading {
    std::vector<std::string> name, notes;
    TextStyle name_style, note_style;
    double height = 0; // pixels
};
Heading plan_heading(const std::string& name, const std::vector<std::string>& notes);
void draw_heading(Canvas& canvas, const Heading& heading);

/// " (at most 16.8 N)", or nothing if there is no force.
std::string largest_note(double largest /* N */);

/// "256 of 1024 samples along x" for each axis that is shown sub-sampled; empty if none is.
std::string sampling_note(const PlaneAxes& axes);

} // namespace forceshade::picture
