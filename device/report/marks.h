// Labels above their marks on an axis, moved aside where they would overlap.
#pragma once

#include <string>
#include <vector>

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

} // namespace forceshade::device
