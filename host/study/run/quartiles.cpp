#include "host/study/run/quartiles.h"

#include <algorithm>
#include <cmath>

namespace forceshade::study {

Quartiles quartiles(std::vector<double> values) {
    if (values.empty())
        return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double part) {
        const double rank = part * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(rank);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
    };
    return {at(0.25), at(0.5), at(0.75)};
}

Quartiles ratios(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> of;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (b[i] > 0)
            of.push_back(a[i] / b[i]);
    return quartiles(std::move(of));
}

} // namespace forceshade::study
