// Numbers as colours: the map of the pictures from the least to the largest number; for numbers of both signs blue
// (below zero), white, red (above), with equal lightness on either side.
#pragma once

#include <string>
#include <vector>

#include "host/plot/scale.h"
#include "host/plot/svg.h"

namespace forceshade::plot {

/// 256 colours "rrggbb" one after the other, from the least to the largest.
std::string sequential_colours();
std::string diverging_colours();

class ColourScale {
public:
    /// Of the numbers to be shown. Both signs: linear and symmetric about zero. With a `limit` > 0 the colours end at
    /// that size, and begin at zero where no number is below and the scale is linear.
    ColourScale(const std::vector<double>& values, bool logarithmic, double limit = 0);

    bool has(double value) const { return scale_.has(value); }
    /// "#rrggbb"; the number must have a place.
    std::string colour(double value) const;

    /// A bar with ticks and its label, `bar` without them; returns where all of it ends at the right.
    double draw(Svg& svg, const Box& bar, const std::string& label) const;

private:
    std::string colour_at(double fraction) const;

    Scale scale_;
    bool diverging_ = false;
};

} // namespace forceshade::plot
