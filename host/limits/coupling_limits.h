// The virtual couplings through which a hand may feel a scene.
#pragma once

#include <optional>
#include <vector>

#include "host/limits/limits.h"

namespace forceshade {

/// All places, and the ways to be held there, at which a loop at `rate` Hz in a scene of `stiffness`, N/m, is to come
/// to rest by the linearised loop; jumps are left out. Those that failed last are tried first.
class RestTrials {
public:
    RestTrials(double rate, double stiffness, const std::vector<RestPlace>& places);

    bool empty() const { return trials_.empty(); }
    bool all_rest(const HandSpec& hand);
    /// Where the hand that was tried last did not rest, for this one.
    LeastLimit failed(const HandSpec& hand) const;

private:
    struct Trial {
        const RestPlace* place;
        Hold hold;
    };
    double rate_, stiffness_;
    std::vector<Trial> trials_;
};

/// A virtual coupling with which a hand comes to rest everywhere.
struct HoldingCoupling {
    double stiffness = 0, damping = 0; /* N/m, N s/m */
    std::optional<LeastLimit> weakest; /* where a stiffer one grows, with the hand and the scene's stiffness; empty: it
                                          is another reason that keeps it from being stiffer */
};

/// Of a hand without coupling in a scene of `stiffness`, N/m: the stiffest spring alone with which it rests everywhere,
/// and which is passive with this hand: in line with a wall it gives no energy. Empty: none holds.
std::optional<HoldingCoupling> safe_coupling(const HandSpec& hand, double rate, double stiffness,
                                             const std::vector<RestPlace>& places);

/// The stiffest spring with any damper, from none to the mass over the sample. Impacts on it may give energy.
std::optional<HoldingCoupling> stiffest_coupling(const HandSpec& hand, double rate, double stiffness,
                                                 const std::vector<RestPlace>& places);

} // namespace forceshade
