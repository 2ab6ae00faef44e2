#include "host/limits/coupling_limits.h"

#include <algorithm>
#include <cmath>

namespace forceshade {

RestTrials::RestTrials(double rate, double stiffness, const std::vector<RestPlace>& places)
    : rate_(rate), stiffness_(stiffness) {
    for (const RestPlace& place : places)
        if (!jumps(place.kind))
            for (const Hold& hold : usual_holds(place.force, place.slope))
                trials_.push_back({&place, hold});
}

bool RestTrials::all_rest(const HandSpec& hand) {
    const auto failed = std::ranges::find_if(
        trials_, [&](const Trial& one) { return grows(hand, rate_, one.hold, one.place->force_around(), stiffness_); });
    if (failed == trials_.end())
        return true;
    std::rotate(trials_.begin(), failed, failed + 1);
    return false;
}

LeastLimit RestTrials::failed(const HandSpec& hand) const {
    LeastLimit found;
    found.place = *trials_.front().place;
    found.hold = trials_.front().hold;
    found.cell = {hand, rate_, stiffness_};
    found.limit = stiffness_;
    return found;
}

std::optional<CouplingLimits> coupling_limits(const HandSpec& hand, double rate, double scene,
                                              const std::vector<RestPlace>& places) {
    constexpr int kDampings = 40;
    constexpr double kClose = 1.001, kLeast = 1e-3, kMost = 32, kLeastDamping = 1e-4; // of the largest
    const double passive = passive_stiffness(damping_of(hand), 1 / rate, hand.delay_samples);
    RestTrials trials(rate, scene, places);
    if (trials.empty() || !(passive > 0))
        return std::nullopt;
    const auto rests = [&](double stiffness, double damping) {
        return trials.all_rest(coupled(hand, stiffness, damping));
    };
    // From a stiffness with which it rests.
    const auto largest = [&](double low, double high, double damping) {
        HoldingCoupling found{low, damping, {}};
        if (rests(high, damping)) {
            found.stiffness = high;
            return found;
        }
        while (high > kClose * found.stiffness) {
            const double middle = std::sqrt(found.stiffness * high);
            (rests(middle, damping) ? found.stiffness : high) = middle;
        }
        if (!rests(high, damping)) // the last trial that failed
            found.weakest = trials.failed(coupled(hand, found.stiffness, damping));
        return found;
    };
    CouplingLimits found;
    found.scene = scene;
    if (!rests(kLeast * passive, 0))
        return std::nullopt;
    if (scene > passive || !trials.all_rest(hand)) { // in line with the scene no stiffer than what is passive
        const double most = scene > passive ? scene * passive / (scene - passive) : kMost * passive;
        found.safe = largest(kLeast * passive, most, 0);
    }
    for (int i = 0; i <= kDampings; ++i) {
        const double damping = i == 0 ? 0 : hand.mass * rate * std::pow(kLeastDamping, 1 - double(i) / kDampings);
        const double least = std::max(1.01 * found.stiffest.stiffness, kLeast * passive);
        if (rests(least, damping))
            found.stiffest = largest(least, std::max(kMost * passive, least), damping);
    }
    return found;
}

} // namespace forceshade
