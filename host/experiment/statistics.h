// Intervals and tests of answers: shares of trials, and differences between conditions with subjects as clusters.
#pragma once

#include <cstdint>
#include <vector>

namespace forceshade::experiment {

struct Range {
    double low = 0, high = 0;
};

/// 95 % of a share of `count` of `all` trials (Jeffreys; Brown, Cai & DasGupta 2001): 0 or 1 where all are alike.
Range jeffreys(double count, double all);

/// 95 % of means of values drawn anew, one a subject (bootstrap, percentiles); the value itself of a single one.
Range bootstrap_mean(const std::vector<double>& values);

/// The share of all changes of signs with a mean as far from 0 as that of the values, one a subject, or farther: two
/// sides. All 2^n of up to 16 subjects, else 65 536 drawn. 1 without values.
double sign_flip_p(const std::vector<double>& values);

} // namespace forceshade::experiment
