#include "host/experiment/statistics.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <nlopt.hpp>

#include "host/random.h"
#include "host/study/study_run.h"

namespace forceshade::experiment {

namespace {

constexpr double kTail = 0.025; // of 95 %

constexpr std::size_t kSpreads = 10;
constexpr std::array<double, 4> kLapses{0, 0.02, 0.04, 0.06};
constexpr std::size_t kEach = kSpreads * kLapses.size();   // parameters of a threshold
constexpr double kStep = 1.5 / 80;                         // of the levels' range, from threshold to threshold
constexpr double kBeyond = 0.25, kMostBeyond = 1.5;        // of that range, on either side
constexpr double kWider = 0.25;                            // of that range, at a time
constexpr unsigned kInformed = 10;                         // answers, before which the prior decides
constexpr double kNarrowest = 1.0 / 30, kWidest = 1.0 / 3; // of that range: spreads

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

namespace {

// std::lgamma writes a global sign.
double log_gamma(double x) {
    int sign = 0;
    return ::lgamma_r(x, &sign);
}

// Of each subject: the answers that are a certain one, and all.
struct Group {
    std::vector<std::pair<double, double>> counts;
};

// Up to what does not depend on the parameters: log of the beta-binomial probability of a group's counts.
double log_likelihood(const Group& group, double share, double correlation) {
    const double spread = 1 / correlation - 1, a = share * spread, b = (1 - share) * spread;
    double sum = static_cast<double>(group.counts.size()) * (log_gamma(a + b) - log_gamma(a) - log_gamma(b));
    for (const auto& [count, all] : group.counts)
        sum += log_gamma(a + count) + log_gamma(b + all - count) - log_gamma(a + b + all);
    return sum;
}

// Shares and the correlation, as the search has them: their logits.
double of_logit(double logit) {
    return 1 / (1 + std::exp(-logit));
}

struct ShareFit {
    double likelihood = 0; // its logarithm
    double share = 0.5, correlation = 0;
};

// The likelihood at its maximum, of one share for all groups, or of one each; `share` is the first group's.
ShareFit fitted_shares(const std::vector<Group>& groups, bool equal) {
    constexpr double kLogit = 8, kLeastCorrelation = -7; // 0.03 %; 0.1 %: as good as binomial
    const std::size_t shares = equal ? 1 : groups.size();
    std::function<double(const std::vector<double>&)> cost = [&](const std::vector<double>& at) {
        double sum = 0;
        for (std::size_t i = 0; i < groups.size(); ++i)
            sum += log_likelihood(groups[i], of_logit(at[equal ? 0 : i]), of_logit(at.back()));
        return -sum;
    };
    nlopt::opt search(nlopt::LN_NELDERMEAD, static_cast<unsigned>(shares + 1));
    search.set_min_objective(
        [](const std::vector<double>& at, std::vector<double>&, void* data) {
            return (*static_cast<std::function<double(const std::vector<double>&)>*>(data))(at);
        },
        &cost);
    std::vector<double> low(shares + 1, -kLogit), high(shares + 1, kLogit), at;
    low.back() = kLeastCorrelation;
    for (std::size_t i = 0; i < shares; ++i) {
        double count = 0.5, all = 1; // half an answer each: no share is 0 or 1
        for (std::size_t g = equal ? 0 : i; g < (equal ? groups.size() : i + 1); ++g)
            for (const auto& [one, of] : groups[g].counts) {
                count += one;
                all += of;
            }
        at.push_back(std::clamp(std::log(count / (all - count)), -kLogit, kLogit));
    }
    at.push_back(-2.5);
    search.set_lower_bounds(low);
    search.set_upper_bounds(high);
    search.set_initial_step(0.5);
    search.set_ftol_abs(1e-4);
    search.set_maxeval(600);
    double reached = 0;
    search.optimize(at, reached);
    return {-reached, of_logit(at.front()), of_logit(at.back())};
}

double likelihood_ratio(const std::vector<Group>& groups, const ShareFit& equal) {
    return fitted_shares(groups, false).likelihood - equal.likelihood;
}

} // namespace

BetaBinomial::BetaBinomial(double share, double correlation, unsigned trials) {
    const double spread = 1 / correlation - 1, a = share * spread, b = (1 - share) * spread;
    const auto log_beta = [](double x, double y) { return log_gamma(x) + log_gamma(y) - log_gamma(x + y); };
    double below = 0;
    for (unsigned k = 0; k <= trials; ++k) {
        const double ways = -std::log(trials + 1.0) - log_beta(trials - k + 1.0, k + 1.0);
        below += std::exp(ways + log_beta(k + a, trials - k + b) - log_beta(a, b));
        below_.push_back(below);
    }
}

unsigned BetaBinomial::operator()(Random& random) const {
    const auto count = std::ranges::upper_bound(below_, random.uniform()) - below_.begin();
    return static_cast<unsigned>(std::min(count, std::ssize(below_) - 1));
}

double likelihood_ratio_p(const std::vector<SubjectCounts>& subjects, unsigned bootstraps) {
    std::vector<Group> groups(2);
    for (const SubjectCounts& one : subjects) {
        if (one.of_more > 0)
            groups[0].counts.emplace_back(one.more, one.of_more);
        if (one.of_less > 0)
            groups[1].counts.emplace_back(one.less, one.of_less);
    }
    if (groups[0].counts.empty() || groups[1].counts.empty())
        return 1;
    const ShareFit equal = fitted_shares(groups, true);
    const double found = likelihood_ratio(groups, equal);
    std::map<double, BetaBinomial> draws; // by the trials
    for (const Group& group : groups)
        for (const auto& [count, all] : group.counts)
            draws.try_emplace(all, equal.share, equal.correlation, static_cast<unsigned>(all));
    std::atomic<unsigned> as_large = 0;
    study::on_all_cores(bootstraps, [&](std::size_t i) {
        constexpr double kSame = 1e-3; // what the searches leave
        Random random(i, "likelihood ratios");
        std::vector<Group> drawn = groups;
        for (Group& group : drawn)
            for (auto& [count, all] : group.counts)
                count = draws.at(all)(random);
        as_large += likelihood_ratio(drawn, fitted_shares(drawn, true)) >= found - kSame;
    });
    return (1.0 + as_large) / (1.0 + bootstraps);
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

ThresholdTrack::ThresholdTrack(const std::vector<double>& levels, bool rises)
    : answers_(levels.size()), below_(kBeyond), above_(kBeyond), rises_(rises) {
    for (const double level : levels)
        x_.push_back(std::log(level));
    const double span = x_.back() - x_.front();
    for (const double exponent : steps(std::log(kNarrowest * span), std::log(kWidest * span), kSpreads))
        spreads_.push_back(std::exp(exponent));
    lay_grid();
}

// The prior, and what the answers make of it.
void ThresholdTrack::lay_grid() {
    const double span = x_.back() - x_.front();
    const auto count = static_cast<std::size_t>(std::lround((below_ + 1 + above_) / kStep)) + 1;
    thresholds_ = steps(x_.front() - below_ * span, x_.back() + above_ * span, count);
    weights_.assign(count * kEach, 1.0 / static_cast<double>(count * kEach));
    right_.clear();
    entropy_.clear();
    for (const double x : x_) {
        std::vector<double>&shares = right_.emplace_back(), &entropies = entropy_.emplace_back();
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            shares.push_back(right(i, x));
            entropies.push_back(entropy_of(shares.back()));
        }
    }
    for (std::size_t level = 0; level < x_.size(); ++level)
        for (const auto& [count_of, is_right] :
             {std::pair(answers_[level].right, true), {answers_[level].wrong, false}})
            for (unsigned i = 0; i < count_of; ++i)
                learn(level, is_right);
}

double ThresholdTrack::weight_of(std::size_t threshold) const {
    const auto first = weights_.begin() + static_cast<std::ptrdiff_t>(threshold * kEach);
    return std::accumulate(first, first + kEach, 0.0);
}

bool ThresholdTrack::is_informed() const {
    unsigned all = 0;
    for (const Answers& one : answers_)
        all += one.right + one.wrong;
    return all >= kInformed;
}

// Whether the threshold at the end of the grid is at least half as likely as the likeliest.
bool ThresholdTrack::favours(bool high) const {
    double most = 0;
    for (std::size_t i = 0; i < thresholds_.size(); ++i)
        most = std::max(most, weight_of(i));
    return weight_of(high ? thresholds_.size() - 1 : 0) > most / 2;
}

double ThresholdTrack::right(std::size_t parameters, double x) const {
    const double threshold = thresholds_[parameters / (kSpreads * kLapses.size())];
    const double spread = spreads_[parameters / kLapses.size() % kSpreads],
                 lapse = kLapses[parameters % kLapses.size()];
    const double easier = (rises_ ? x - threshold : threshold - x) / spread;
    return 0.5 + (0.5 - lapse) / (1 + std::exp(-easier));
}

void ThresholdTrack::add(std::size_t level, bool right) {
    (right ? answers_[level].right : answers_[level].wrong) += 1;
    learn(level, right);
    if (!is_informed())
        return;
    for (const bool high : {false, true})
        while (favours(high) && (high ? above_ : below_) < kMostBeyond) {
            (high ? above_ : below_) += kWider;
            lay_grid();
        }
}

void ThresholdTrack::learn(std::size_t level, bool right) {
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
        for (std::size_t i = 0; i < thresholds_.size(); ++i) {
            const double weight = weight_of(i);
            if (below + weight >= share)
                return std::exp(thresholds_[i] + step * ((share - below) / weight - 0.5));
            below += weight;
        }
        return std::exp(thresholds_.back());
    };
    const int beyond = !is_informed() ? 0 : favours(false) ? -1 : favours(true) ? 1 : 0;
    return {quantile(0.5), {quantile(0.025), quantile(0.975)}, beyond};
}

double ThresholdTrack::share_right(double level) const {
    double share = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i)
        share += weights_[i] * right(i, std::log(level));
    return share;
}

} // namespace forceshade::experiment
