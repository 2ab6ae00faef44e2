// The stiffness up to which a hand's loop is stable on a surface: the least over the places where it may rest and the
// ways in which it may be held. And the virtual couplings through which a hand may feel a stiffer one.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/limits/linear_loop.h"
#include "host/limits/rest_places.h"

namespace forceshade {

// Friction of the hand, and steps of its measured position.

/// N/m: up to here friction holds a step of the measured position, 2 f_c / quantum (Abbott & Okamura 2005).
inline double held_by_friction(const HandSpec& hand) {
    return 2 * hand.coulomb / hand.quantisation;
}

/// m: kicks up to here die out by friction, N, alone: of a mass, kg, without damping on a wall of `stiffness`, N/m,
/// whose force is held for a sample, s, and `delay` samples late. Hold and delay feed pi K T w A^2 (1/2 + delay) a
/// cycle, w = sqrt(K / m), and friction takes 4 f_c A, so that A = 4 f_c / (pi K T w (1/2 + delay)). Needs w T (1/2 +
/// delay) far below 1.
double friction_basin(double mass, double friction, double stiffness, double sample_time, std::uint64_t delay);

/// m: the same of a loop of `cell` without damping at a place of any surface, for a kick straight down, at any w T: the
/// probe swings along the force, where the grip's spring holds it, too, at the w of harmonic balance, m w^2 = k_g + K s
/// cos(p), p = w T (1/2 + delay), s = sin(w T / 2) / (w T / 2); A = 4 f_c / (pi K s sin(p)). Friction on each axis
/// takes what its components cover.
double friction_basin(const LoopCell& cell, const RestPlace& place, const Hold& hold);

/// N/m: the stiffness up to which a loop of `cell` with friction and a measured position in steps comes to rest on a
/// wall after a kick, m: min(2 f_c / quantum, K_crit with the damping b + 4 f_c / (pi w kick), w = sqrt(K / m)),
/// friction by its describing function.
double rounded_limit(const LoopCell& cell, double kick);

// The least over places.

/// The limit of a hand that is held so at a place.
struct HoldLimit {
    double limit = 0; /* N/m */
    Hold hold;
    RestPlace place;
    std::optional<double> simulated{}; /* N/m: as LeastLimit's */
};

/// The least limit of all places of a kind at a depth.
struct LeastLimit {
    std::string surface;
    RestPlace place;                    /* the worst */
    Hold hold;                          /* the worst */
    LoopCell cell;                      /* hand and rate */
    bool own = false;                   /* with the hand's own damping and delay, at its own rate */
    double wall = 0;                    /* N/m: K_crit with this hand */
    std::optional<double> limit;        /* N/m: of the linearised loop; empty: none below eight times the passive one */
    std::optional<HoldLimit> any_press; /* of the hand that presses in any direction that the surface supports, where
                                           that was searched */
    std::optional<double> simulated; /* N/m: of the loop stepped through the surface's own force, where that was done */
    std::optional<double> kick;      /* m: largest_kick, where that was done */
    std::size_t places = 0;          /* examined */
};

/// The least of some places, at least one, over the usual holds.
LeastLimit least_of(const LoopSurface& surface, const std::vector<const RestPlace*>& places, const LoopCell& cell);

/// From which of the drawn places a search begins: the least of each kind and depth, or the least of all.
enum class Searched { of_each_kind, of_all };
/// rest_places, and the places to which the limit with the surface's own hand falls along the surface from there, over
/// the usual holds and over any press. \throws what rest_places throws.
std::vector<RestPlace> searched_places(const LoopSurface& surface, std::size_t count, Searched from);

/// A row for each kind but jumps, depth and cell.
/// The first of `cells` is marked as the hand's own. `any_press` is searched if asked for: of the first at all places,
/// of the others where the first has its least one and where their own least limit is.
std::vector<LeastLimit> least_limits(const LoopSurface& surface, const std::vector<RestPlace>& places,
                                     const std::vector<LoopCell>& cells, bool any_press = false);

/// The stiffness, N/m, at which a disturbance of a millionth of the depth begins to grow when the loop is stepped
/// through the surface's own force, of a mesh along the path, from 0.3 of the linearised limit on; empty: none up to
/// three times that.
std::optional<double> simulated_limit(const LoopSurface& surface, const LeastLimit& least);

/// Whether a disturbance of a millionth of the depth decays there when the loop of its cell is stepped through the
/// surface's own force.
bool decays(const LoopSurface& surface, const LeastLimit& there);

/// N: the force of a law on a path, given its probes, m, one after the other, each a sample after the last.
using PathForce = std::function<glm::dvec3(const glm::dvec3& probe)>;
/// A law with a stiffness, N/m, at the begin of a path.
using MakePathForce = std::function<PathForce(double stiffness)>;

/// Whether a limit was found within the range that was searched.
enum class LimitEnd { within, below, above, no_force };
struct SteppedLimit {
    double limit = 0; /* N/m; the end of the range where it is below or above that; NaN without a force */
    LimitEnd end = LimitEnd::within;
};

/// The stiffness up to which a probe comes to rest, within 30 times the kick, after one of a thousandth of the depth,
/// when the loop of `there` is stepped through a law's forces, by bisection from 10 to 1e7 N/m to 1 %. The probe comes
/// down to the place first, where the hand balances the law's own force; a law without a force there has no limit.
/// \throws what the law throws.
SteppedLimit stepped_limit(const LoopSurface& surface, const LeastLimit& there, const MakePathForce& make);

/// The last quarter of a stepped loop. Infinite where the probe went three depths away, NaN without a force.
struct SteppedRest {
    double swing = NAN; /* m: about the mean place, root mean square: by how much a law without rest shakes the hand */
    double moved = NAN; /* m: from the place to the mean one: where friction holds the probe */
};

/// After the same kick, at one stiffness, N/m. \throws what the law throws.
SteppedRest stepped_rest(const LoopSurface& surface, const LeastLimit& there, const MakePathForce& make,
                         double stiffness);

/// m: of 0.1, 0.2, 0.5, 1 ... 100 um the largest displacement that decays at half the linearised limit, as all smaller
/// ones do; 0 if none does.
std::optional<double> largest_kick(const LoopSurface& surface, const LeastLimit& least);

/// m: up to which kicks straight down die out by the hand's Coulomb friction, when the loop is stepped through the
/// surface's own force; from a quarter to four times of what is `expected`, m, by bisection to 0.1 %. Empty: they do at
/// neither end or at both.
std::optional<double> dying_kick(const LoopSurface& surface, const LeastLimit& there, double expected);

/// Samples in which a loop near its limit shows by its speeds on which side it is: `patience` times the time that
/// damping takes. With 400 a loop 0.3 % below its limit still decays by a quarter from the second quarter of its time
/// to the last.
std::size_t settling_steps(const LoopCell& cell, double patience);

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

/// Whether a scene's stiffness is stable with its [hand].
struct SceneLimits {
    double stiffness = 0;            /* N/m: the scene's, as the hand feels it */
    double wall = 0;                 /* N/m: K_crit of a wall without coupling; 0 without damping */
    std::optional<LeastLimit> least; /* the lowest on the scene's surface without coupling; none where nothing is
                                        touched */
    std::optional<HoldLimit> turned; /* the lowest of a hand that presses in any direction that the surface supports */
    std::string hand;                /* hand_text */
    std::optional<double> coupling;  /* N/m: of the hand's virtual coupling */
    bool coupled_rests = false;      // with it, everywhere
    std::optional<double> safe;      /* N/m: of the safe coupling, where the loop is unstable */
    double foot = 0;                 /* rad: the sharpest jump of the direction inwards, as at the foot of a bump, where
                                        the limits do not hold; 0: none found */
    std::optional<double> buzz;      /* N/m: above this friction does not hold a step of the measured position, 2 f_c /
                                        quantum (Abbott & Okamura 2005); empty: it is not measured in steps */
    std::optional<double> bristle;   /* N/m: of [friction], a spring along the surface, as it is displayed */

    /// Whether that spring is stable: the same limit as a wall's holds along the surface.
    bool bristle_rests() const { return !bristle || *bristle < wall; }
    /// N/m: the lower of both.
    double limit() const { return least && least->limit ? std::min(*least->limit, wall) : wall; }
    bool stable() const { return presses_stably() && bristle_rests(); }
    bool presses_stably() const { return coupling ? coupled_rests : stiffness < limit(); } /* into the surface */
    /// "1000 N/m; a hand of ... comes to rest below 1166 N/m (slope, 2 mm deep, held down)", turned to another
    /// direction below what, but on a foot, and but for steps of the measured position.
    std::string text() const;
    /// What would hold: "a lower force.stiffness, ...".
    std::string remedy() const;
    /// What is wrong and what would hold; empty if it is stable.
    std::string warning() const;
};

/// In a loop of `rate` Hz, as deep as a force of `most` N presses, 2 mm at most, each metre of the hand's being `scale`
/// m of the scene's; takes up to some tenths of a second.
SceneLimits scene_limits(const PreparedCase& prepared, double rate, double most, double scale = 1);

/// The same for the scene's own closed loop.
SceneLimits scene_limits(const PreparedCase& prepared);

/// A place of a surface, and a way to be held there, where some hand's loop is the least stable.
struct WeakPlace {
    std::string surface; /* as readers call it */
    RestPlace place;
    Hold hold;
    bool usual = true; // of usual_holds; else pressed in another direction
};

/// Those of the least limits of a surface, each once, pressed in any direction, too.
std::vector<WeakPlace> weak_places(const std::string& name, const std::vector<LeastLimit>& limits);
/// Those of a scene, of each kind and depth, with its own hand, and with ten times its grip and a tenth of it. Empty
/// where nothing is touched, or without damping.
std::vector<WeakPlace> weak_places(const std::string& name, const PreparedCase& prepared);

/// As a JSON array for "my device": from there a page computes the limits of any hand.
std::string weak_places_text(const std::vector<WeakPlace>& places);

} // namespace forceshade
