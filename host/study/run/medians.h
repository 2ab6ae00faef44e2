// Medians with their intervals, the same on every machine.
#pragma once

#include <vector>

namespace forceshade::study {

/// The median of some values, and where 95 % of the medians of bootstrap samples lie (Efron 1979, percentiles).
struct Interval {
    double low = 0, median = 0, high = 0;
};
Interval bootstrap_median(const std::vector<double>& values);

/// The quantile at this share, the middle of neighbours between ranks; 0 without values.
double quantile(std::vector<double> values, double share);

} // namespace forceshade::study
