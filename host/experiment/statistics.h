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

/// 95 % interval of the mean of values, one a subject (Student's t); no numbers for less than two.
Range mean_interval(const std::vector<double>& values);

/// The share of all changes of signs with a mean as far from 0 as that of the values, one a subject, or farther: two
/// sides. All 2^n of up to 14 subjects, else 16 384 drawn. 1 without values.
double sign_flip_p(const std::vector<double>& values);

/// The fewest subjects of whom changes of signs can be significant (5 %): p is no less than 2^(1 - n).
inline constexpr unsigned kLeastSubjects = 6;

/// What the tests' p become where any of them may be the one that is reported (Holm 1979), in the same order.
std::vector<double> holm(const std::vector<double>& p);

} // namespace forceshade::experiment
