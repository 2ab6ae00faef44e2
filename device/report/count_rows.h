// How often which times occurred, as lines of text.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device/loop/sample.h"

namespace forceshade::device {

struct NamedTimes {
    std::string_view name;
    const Histogram& times;
};

/// Lines of bars of '#' side by side, one row for the times from 1, 2 or 5 times a power of ten on to the next, with
/// counts; at least one '#' where there is any. Times up to 3 % short of the next row may count there: the histogram
/// does not tell them apart. Rows without any are gathered, and so are the shortest times
/// as long as they are no more than 1 %. Within 100 columns for up to two; empty where there is
/// nothing to count.
std::vector<std::string> count_rows(std::span<const NamedTimes> columns);

} // namespace forceshade::device
