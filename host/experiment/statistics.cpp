#include "host/experiment/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "host/random.h"

namespace forceshade::experiment {

namespace {

constexpr double kTail = 0.025; // of 95 %

} // namespace

Range jeffreys(double count, double all) {
    const boost::math::beta_distribution<> beta(count + 0.5, all - count + 0.5);
    return {count > 0 ? boost::math::quantile(beta, kTail) : 0,
            count < all ? boost::math::quantile(beta, 1 - kTail) : 1};
}

Range mean_interval(const std::vector<double>& values) {
    if (values.size() < 2)
        return {NAN, NAN};
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0;
    for (const double value : values)
        squares += (value - mean) * (value - mean);
    const double t = boost::math::quantile(boost::math::complement(boost::math::students_t(count - 1), kTail));
    const double half = t * std::sqrt(squares / (count * (count - 1)));
    return {mean - half, mean + half};
}

// Signs are taken eight subjects at a time: each eight have 256 sums, which are added up once.
double sign_flip_p(const std::vector<double>& values) {
    constexpr std::size_t kMostExact = 14, kAtATime = 8;
    double whole = 0, size = 0;
    for (const double value : values) {
        whole += value;
        size += std::abs(value);
    }
    std::vector<std::array<double, 256>> sums((values.size() + kAtATime - 1) / kAtATime);
    for (std::size_t part = 0; part < sums.size(); ++part)
        for (unsigned signs = 0; signs < 256; ++signs) {
            double& sum = sums[part][signs] = 0;
            for (std::size_t i = part * kAtATime; i < std::min(values.size(), (part + 1) * kAtATime); ++i)
                sum += (signs >> i % kAtATime & 1u) ? -values[i] : values[i];
        }
    const std::uint64_t count = std::uint64_t{1} << std::min(values.size(), kMostExact);
    const double as_far = std::abs(whole) - 1e-12 * size;
    Random random(1, "sign flips");
    std::uint64_t found = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        std::uint64_t signs = i;
        double sum = 0;
        for (std::size_t part = 0; part < sums.size(); ++part, signs >>= kAtATime) {
            if (values.size() > kMostExact && part % 8 == 0)
                signs = random.word();
            sum += sums[part][signs & 0xFF];
        }
        found += std::abs(sum) >= as_far;
    }
    return static_cast<double>(found) / static_cast<double>(count);
}

std::vector<double> holm(const std::vector<double>& p) {
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return p[i]; });
    std::vector<double> corrected(p.size());
    double least = 0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        least = std::max(least, std::min(1.0, static_cast<double>(p.size() - rank) * p[order[rank]]));
        corrected[order[rank]] = least;
    }
    return corrected;
}

} // namespace forceshade::experiment
