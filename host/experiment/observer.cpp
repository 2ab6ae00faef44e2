#include "host/experiment/observer.h"

#include <algorithm>
#include <cmath>

#include "host/error.h"

namespace forceshade::experiment {
namespace {

constexpr double kGap = 1e-4; // m: across which a jump is felt: a sample at 1 kHz and 100 mm/s

// The value at `at`, m, between samples.
double value_at(const StrokeSignals& signals, const std::vector<double>& values, double at) {
    const auto next = std::ranges::lower_bound(signals.x, at);
    if (next == signals.x.begin())
        return values.front();
    if (next == signals.x.end())
        return values.back();
    const auto i = static_cast<std::size_t>(next - signals.x.begin());
    const double share = (at - signals.x[i - 1]) / (signals.x[i] - signals.x[i - 1]);
    return std::lerp(values[i - 1], values[i], share);
}

double jump_at_crest(const StrokeSignals& signals, const std::vector<double>& values) {
    return std::abs(value_at(signals, values, kGap / 2) - value_at(signals, values, -kGap / 2));
}

// The share of the width, weighed by how level it is, around the crest: what of the largest |value| between the crest
// and each sample is below `least` counts as level.
double level_share(const StrokeSignals& signals, const std::vector<double>& values, double least) {
    const auto levelness = [least](double most) { return std::max(0.0, 1 - most / least); };
    const auto crest =
        static_cast<std::size_t>(std::ranges::lower_bound(signals.x, 0.0) - signals.x.begin()); // its first sample
    double sum = 0;                                                                             // m
    const auto outward = [&](std::size_t from, std::size_t to, std::ptrdiff_t step) {
        double most = std::abs(value_at(signals, values, 0)), last = 0; // m
        double before = levelness(most);
        for (std::size_t i = from; i != to && before > 0; i += static_cast<std::size_t>(step)) {
            most = std::max(most, std::abs(values[i]));
            const double level = levelness(most), x = signals.x[i];
            sum += 0.5 * (before + level) * std::abs(x - last);
            before = level;
            last = x;
        }
    };
    outward(crest, signals.x.size(), 1);
    outward(crest - 1, std::size_t(-1), -1);
    return sum / signals.width;
}

} // namespace

ObserverParameters published_observer(ObserverModel model) {
    switch (model) {
    case ObserverModel::weber_fitted:
        return {model, 0.7586, 7.141, 0.0604, 0.0753};
    case ObserverModel::two_noises:
        return {model, 0.7588, 7.162, 0.0603, 0.0754, 0.0745};
    case ObserverModel::base_kinks:
        return {model, 0.7678, 6.282, 0.0648, 0.0754, 0.3214};
    default:
        return {};
    }
}

StrokeSignals rigid_signals(double radius, double width, unsigned facets, bool shaded, Hold hold) {
    constexpr int kSamples = 2000; // apart by much less than kGap
    const double half = width / 2, opening = std::asin(half / radius);
    StrokeSignals signals;
    signals.width = width;
    for (int i = 0; i <= kSamples; ++i) {
        const double x = half * (2.0 * i / kSamples - 1), round = x / std::sqrt(radius * radius - x * x);
        double facet = round;
        if (facets > 0) {
            const double angle = 2 * opening / facets; // of each
            const double from = std::min(std::floor((std::asin(x / radius) + opening) / angle), facets - 1.0);
            facet = std::tan(-opening + (from + 0.5) * angle);
        }
        signals.x.push_back(x);
        signals.path.push_back(facets == 1 ? 0 : facet);
        const double tangent = shaded ? round : signals.path.back();
        signals.force.push_back(hold == Hold::force ? tangent : std::sin(std::atan(tangent)));
    }
    return signals;
}

Cues cues_of(const StrokeSignals& signals, double level) {
    if (signals.x.size() < 3 || !(signals.x.front() < 0 && signals.x.back() > 0))
        throw UsageError("a stroke across a feature needs samples on both sides of its middle");
    Cues cues;
    for (const double value : signals.force)
        cues.steepest = std::max(cues.steepest, std::abs(value));
    if (!(cues.steepest > 0))
        return {};
    cues.force_jump = jump_at_crest(signals, signals.force);
    cues.path_jump = jump_at_crest(signals, signals.path);
    cues.base = 0.5 * (std::abs(signals.force.front()) + std::abs(signals.force.back()));
    // What a linear ramp of lateral force has is taken off.
    const double least = level * cues.steepest;
    cues.force_level = std::max(0.0, level_share(signals, signals.force, least) - level / 2);
    cues.path_level = std::max(0.0, level_share(signals, signals.path, least) - level / 2);
    return cues;
}

Events events_of(const Cues& cues, const ObserverParameters& observer) {
    const double w = observer.path_weight;
    Events events;
    events.edges = (cues.force_jump + w * cues.path_jump + observer.weber) / observer.edge;
    events.levels = observer.level_gain * (cues.force_level + w * cues.path_level);
    if (observer.model == ObserverModel::base_kinks)
        events.levels += std::pow(observer.level * cues.base, 2);
    events.felt = -std::expm1(-std::pow(cues.steepest / observer.weber, 2) / 2);
    return events;
}

double apart(const Shares& one, const Shares& other) {
    double sum = 0;
    for (std::size_t i = 0; i < kPictures; ++i)
        sum += std::abs(one[i] - other[i]);
    return 50 * sum;
}

Shares shares_of(const Cues& cues, const ObserverParameters& observer) {
    const auto [felt, edges, levels] = events_of(cues, observer);
    const double events = edges + levels;
    const double any = -std::expm1(-events);
    Shares shares{1 - felt, felt * any * edges / events, felt * any * levels / events, felt * std::exp(-events)};
    for (double& share : shares)
        share = (1 - observer.lapse) * share + observer.lapse / kPictures;
    return shares;
}

double level_of(const ObserverParameters& observer) {
    constexpr double kExactly = 1e-3; // of the steepest
    switch (observer.model) {
    case ObserverModel::two_noises:
        return observer.level;
    case ObserverModel::base_kinks:
        return kExactly;
    default:
        return observer.weber;
    }
}

Shares shares_of(const StrokeSignals& signals, const ObserverParameters& observer) {
    return shares_of(cues_of(signals, level_of(observer)), observer);
}

} // namespace forceshade::experiment
