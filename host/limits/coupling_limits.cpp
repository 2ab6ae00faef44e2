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

namespace {

// The search for the stiffest spring with a damper.
class CouplingSearch {
public:
    CouplingSearch(const HandSpec& hand, double rate, double stiffness, const std::vector<RestPlace>& places)
        : hand_(hand), trials_(rate, stiffness, places),
          passive_(passive_stiffness(damping_of(hand), 1 / rate, hand.delay_samples)) {}

    double passive() const { return passive_; }        /* N/m */
    double softest() const { return 1e-3 * passive_; } /* N/m */
    bool possible() const { return !trials_.empty() && passive_ > 0; }
    bool rests(double stiffness, double damping) { return trials_.all_rest(coupled(hand_, stiffness, damping)); }

    // From a stiffness `low`, with which it rests, to at most `high`.
    HoldingCoupling stiffest(double low, double high, double damping) {
        constexpr double kClose = 1.001;
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
            found.weakest = trials_.failed(coupled(hand_, found.stiffness, damping));
        return found;
    }

private:
    HandSpec hand_;
    RestTrials trials_;
    double passive_;
};

constexpr double kStiffest = 32; // of what is passive

} // namespace

std::optional<HoldingCoupling> safe_coupling(const HandSpec& hand, double rate, double stiffness,
                                             const std::vector<RestPlace>& places) {
    CouplingSearch search(hand, rate, stiffness, places);
    if (!search.possible() || !search.rests(search.softest(), 0))
        return std::nullopt;
    const double passive = search.passive(); // in line with the scene no stiffer
    return search.stiffest(search.softest(),
                           stiffness > passive ? stiffness * passive / (stiffness - passive) : kStiffest * passive, 0);
}

std::optional<HoldingCoupling> stiffest_coupling(const HandSpec& hand, double rate, double stiffness,
                                                 const std::vector<RestPlace>& places) {
    constexpr int kDampings = 40;
    constexpr double kLeastDamping = 1e-4; // of the largest
    CouplingSearch search(hand, rate, stiffness, places);
    std::optional<HoldingCoupling> found;
    for (int i = 0; i <= kDampings && search.possible(); ++i) {
        const double damping = i == 0 ? 0 : hand.mass * rate * std::pow(kLeastDamping, 1 - double(i) / kDampings);
        const double least = found ? 1.01 * found->stiffness : search.softest();
        if (search.rests(least, damping))
            found = search.stiffest(least, std::max(kStiffest * search.passive(), least), damping);
    }
    return found;
}

} // namespace forceshade
