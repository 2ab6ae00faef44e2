#include "host/study/error_time/fits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace forceshade::study::error_time {

OrderFit fit_order(std::span<const double> sizes, std::span<const double> errors) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < sizes.size(); ++i)
        if (sizes[i] > 0 && errors[i] > 0) {
            x.push_back(std::log(sizes[i]));
            y.push_back(std::log(errors[i]));
        }
    OrderFit fit;
    fit.points = x.size();
    if (fit.points < 2)
        return fit;
    const double count = static_cast<double>(x.size());
    const double middle_x = std::accumulate(x.begin(), x.end(), 0.0) / count;
    const double middle_y = std::accumulate(y.begin(), y.end(), 0.0) / count;
    double square = 0, product = 0, rest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        square += (x[i] - middle_x) * (x[i] - middle_x);
        product += (x[i] - middle_x) * (y[i] - middle_y);
    }
    fit.order = product / square;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double off = y[i] - middle_y - fit.order * (x[i] - middle_x);
        rest += off * off;
    }
    if (fit.points > 2)
        fit.deviation = std::sqrt(rest / (count - 2) / square);
    return fit;
}

std::vector<std::size_t> pareto_front(std::span<const double> costs, std::span<const double> errors, double least) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < costs.size(); ++i)
        if (std::isfinite(costs[i]) && std::isfinite(errors[i]))
            order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t one, std::size_t other) {
        return costs[one] != costs[other] ? costs[one] < costs[other] : errors[one] < errors[other];
    });
    std::vector<std::size_t> front;
    double below = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order)
        if (front.empty() || errors[i] < below) {
            below = (1 - least) * errors[i];
            front.push_back(i);
        }
    return front;
}

} // namespace forceshade::study::error_time
