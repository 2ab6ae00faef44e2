// A histogram of times in a picture: its logarithmic axes, its bars, and its quantiles marked.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "device/loop/sample.h"
#include "host/picture/canvas.h"
#include "host/picture/ticks.h"

namespace forceshade::device {

struct Mark {
    std::string label;
    double at = 0;     // where the mark is, pixels
    double width = 0;  // of the label, pixels
    double centre = 0; // where the label's middle goes: set by place_labels
    bool is_period = false;
};

/// Orders the marks along the axis and places their labels between `low` and `high` (pixels) as near to them as goes,
/// `gap` apart, in the order of the marks. They fit if their widths and gaps do.
void place_labels(std::vector<Mark>& marks, double low, double high, double gap);

/// The logarithmic axis that all times (ns) fit on, and a period (ns) if there is one; at least a decade, from a power
/// of ten.
picture::Range time_range(std::span<const Histogram* const> shown, double period = 0);

/// Times of [from, to) ns and how many there were.
struct TimeBar {
    std::uint64_t from = 0, to = 0, count = 0;
};

/// Neighbouring bins of a histogram put together, about `per_decade` of them to a power of ten; those with a count.
std::vector<TimeBar> time_bars(const Histogram& times, unsigned per_decade);

struct TimePanel {
    std::string title;
    const Histogram* times = nullptr;
    picture::Rgb8 colour;
    picture::Range range; // ns
    double period = 0;    /* ns; 0: none is drawn */
};

/// Pixels from the top of the title to below the labels of the axis.
double time_panel_height();

/// With its upper left corner at `corner` and this wide, labels of counts included.
void draw_time_panel(picture::Canvas& canvas, const TimePanel& panel, picture::Point corner, double width);

} // namespace forceshade::device
