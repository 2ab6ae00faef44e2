// Orders of convergence and Pareto fronts.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace forceshade::study::error_time {

/// A power law error = c * size^order, by least squares of the logarithms.
struct OrderFit {
    double order = 0;
    double deviation = 0;   /* standard deviation of the order; 0 of two points */
    std::size_t points = 0; /* that were used; below two there is no order */
};

/// Points whose size or error is not above 0 are left out.
OrderFit fit_order(std::span<const double> sizes, std::span<const double> errors);

/// The points that no cheaper one comes up to, by rising cost: each is closer by `least` of the error before it, or
/// more, so that what differs by rounding does not count as closer. Values that are no numbers never belong.
std::vector<std::size_t> pareto_front(std::span<const double> costs, std::span<const double> errors,
                                      double least = 0.01);

} // namespace forceshade::study::error_time
