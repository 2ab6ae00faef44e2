// The middle of repeated measurements, and how far they lie apart.
#pragma once

#include <vector>

namespace forceshade::study {

/// Quartiles, by the middle of neighbours where the rank is none; 0 of nothing.
struct Quartiles {
    double low = 0, median = 0, high = 0;
};

Quartiles quartiles(std::vector<double> values);

/// Quartiles of a[i] / b[i]: what was measured in the same round.
Quartiles ratios(const std::vector<double>& a, const std::vector<double>& b);

} // namespace forceshade::study
