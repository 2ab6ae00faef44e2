// The middle of what a finding sums up.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace forceshade::study {

/// Of the finite ones; half way between the middle two of an even number, NaN of none.
inline double median(std::vector<double> values) {
    std::erase_if(values, [](double one) { return !std::isfinite(one); });
    if (values.empty())
        return std::numeric_limits<double>::quiet_NaN();
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

} // namespace forceshade::study
