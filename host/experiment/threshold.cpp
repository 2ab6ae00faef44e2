#include "host/experiment/threshold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace forceshade::experiment {
namespace {

constexpr std::size_t kThresholds = 81, kSpreads = 10;
constexpr std::array<double, 4> kLapses{0, 0.02, 0.04, 0.06};
constexpr std::size_t kEach = kSpreads * kLapses.size();   // parameters of a threshold
constexpr double kBeyond = 0.25;                           // of the levels' range, on either side: thresholds
constexpr double kNarrowest = 1.0 / 30, kWidest = 1.0 / 3; // likewise: spreads

std::vector<double> steps(double from, double to, std::size_t count) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(std::lerp(from, to, static_cast<double>(i) / static_cast<double>(count - 1)));
    return values;
}

// Nats.
double entropy_of(double share) {
    const auto part = [](double p) { return p > 0 ? -p * std::log(p) : 0; };
    return part(share) + part(1 - share);
}

} // namespace

ThresholdTrack::ThresholdTrack(const std::vector<double>& levels, bool rises) : rises_(rises) {
    for (const double level : levels)
        x_.push_back(std::log(level));
    const double span = x_.back() - x_.front();
    thresholds_ = steps(x_.front() - kBeyond * span, x_.back() + kBeyond * span, kThresholds);
    for (const double exponent : steps(std::log(kNarrowest * span), std::log(kWidest * span), kSpreads))
        spreads_.push_back(std::exp(exponent));
    weights_.assign(kThresholds * kSpreads * kLapses.size(), 1.0 / (kThresholds * kSpreads * kLapses.size()));
    for (const double x : x_) {
        std::vector<double>&shares = right_.emplace_back(), &entropies = entropy_.emplace_back();
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            shares.push_back(right(i, x));
            entropies.push_back(entropy_of(shares.back()));
        }
    }
}

double ThresholdTrack::right(std::size_t parameters, double x) const {
    const double threshold = thresholds_[parameters / (kSpreads * kLapses.size())];
    const double spread = spreads_[parameters / kLapses.size() % kSpreads],
                 lapse = kLapses[parameters % kLapses.size()];
    const double easier = (rises_ ? x - threshold : threshold - x) / spread;
    return 0.5 + (0.5 - lapse) / (1 + std::exp(-easier));
}

void ThresholdTrack::add(std::size_t level, bool right) {
    double sum = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        weights_[i] *= right ? right_[level][i] : 1 - right_[level][i];
        sum += weights_[i];
    }
    for (double& weight : weights_)
        weight /= sum;
}

// The least expected entropy of the posterior is the most information that the answer has about the parameters.
std::size_t ThresholdTrack::next() const {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t level = 0; level < x_.size(); ++level) {
        const double share = std::inner_product(weights_.begin(), weights_.end(), right_[level].begin(), 0.0);
        const double known = std::inner_product(weights_.begin(), weights_.end(), entropy_[level].begin(), 0.0);
        if (const double information = entropy_of(share) - known; information > most) {
            most = information;
            best = level;
        }
    }
    return best;
}

Threshold ThresholdTrack::threshold() const {
    const double step = thresholds_[1] - thresholds_[0];
    // Each weight is spread over its step of the grid.
    const auto quantile = [&](double share) {
        double below = 0;
        for (std::size_t i = 0; i < kThresholds; ++i) {
            const auto first = weights_.begin() + static_cast<std::ptrdiff_t>(i * kEach);
            const double weight = std::accumulate(first, first + kEach, 0.0);
            if (below + weight >= share)
                return std::exp(thresholds_[i] + step * ((share - below) / weight - 0.5));
            below += weight;
        }
        return std::exp(thresholds_.back());
    };
    return {quantile(0.5), {quantile(0.025), quantile(0.975)}};
}

double ThresholdTrack::share_right(double level) const {
    double share = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i)
        share += weights_[i] * right(i, std::log(level));
    return share;
}

} // namespace forceshade::experiment
