// Medians with their intervals, the same on every machine.
#pragma once

#include <string>
#include <vector>

namespace forceshade::study {

/// The median of some values, and where 95 % of the medians of bootstrap samples lie (Efron 1979, percentiles).
struct Interval {
    double low = 0, median = 0, high = 0;
};
Interval bootstrap_median(const std::vector<double>& values);

/// Whether a ratio differs from 1: only then is it a finding.
inline bool is_significant(const Interval& ratio) {
    return ratio.high < 1 || ratio.low > 1;
}

/// "takes 1.30 [1.21, 1.42] times as long as the other", or that the difference is not significant.
std::string times_as_long(const Interval& ratio, const char* other);

/// The quantile at this share, the middle of neighbours between ranks; 0 without values.
double quantile(std::vector<double> values, double share);

} // namespace forceshade::study
