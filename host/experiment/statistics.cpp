#include "host/experiment/statistics.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/beta.hpp>

#include "host/random.h"

namespace forceshade::experiment {

Range jeffreys(double count, double all) {
    constexpr double kTail = 0.025;
    const boost::math::beta_distribution<> beta(count + 0.5, all - count + 0.5);
    return {count > 0 ? boost::math::quantile(beta, kTail) : 0,
            count < all ? boost::math::quantile(beta, 1 - kTail) : 1};
}

Range bootstrap_mean(const std::vector<double>& values) {
    constexpr std::size_t kSamples = 4000;
    if (values.empty())
        return {};
    Random random(1, "bootstrap over subjects");
    std::vector<double> means;
    for (std::size_t i = 0; i < kSamples; ++i) {
        double sum = 0;
        for (std::size_t j = 0; j < values.size(); ++j)
            sum += values[random.below(values.size())];
        means.push_back(sum / static_cast<double>(values.size()));
    }
    std::ranges::sort(means);
    return {means[kSamples / 40], means[kSamples - 1 - kSamples / 40]};
}

double sign_flip_p(const std::vector<double>& values) {
    constexpr std::size_t kMostExact = 16;
    double whole = 0, size = 0;
    for (const double value : values) {
        whole += value;
        size += std::abs(value);
    }
    const std::uint64_t count = std::uint64_t{1} << std::min(values.size(), kMostExact);
    Random random(1, "sign flips");
    std::uint64_t as_far = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t signs = values.size() <= kMostExact ? i : random.word();
        double sum = 0;
        for (std::size_t j = 0; j < values.size(); ++j)
            sum += (signs >> (j % 64) & 1u) ? -values[j] : values[j];
        as_far += std::abs(sum) >= std::abs(whole) - 1e-12 * size;
    }
    return static_cast<double>(as_far) / static_cast<double>(count);
}

} // namespace forceshade::experiment
