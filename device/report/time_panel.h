// A histogram of times in a picture, its quantiles marked.
#pragma once

#include <string>

#include "device/report/time_axis.h"
#include "host/picture/canvas.h"

namespace forceshade::device {

struct TimePanel {
    std::string title;
    const Histogram* times = nullptr;
    picture::Rgb8 colour;
    LogAxis axis;
    double period = 0; /* ns; 0: none is drawn */
};

/// Pixels from the top of the title to below the labels of the axis.
double time_panel_height();

/// With its upper left corner at `corner` and this wide, labels of counts included.
void draw_time_panel(picture::Canvas& canvas, const TimePanel& panel, picture::Point corner, double width);

} // namespace forceshade::device
