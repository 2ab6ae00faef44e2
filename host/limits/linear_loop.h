// A sampled loop near its place of rest, as a linear map: the expected stability on any surface, without the engine.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "host/limits/critical_stiffness.h"
#include "host/paths/scene_paths.h"

namespace forceshade {

/// Boundary condition of the hand: its spring acts across `along`, along which it presses with a constant force; on all
/// sides if `along` is 0.
struct Hold {
    std::string name; /* "down", "on all sides" */
    glm::dvec3 along{0};
};

/// Whether the surface supports a hand that presses `along`, with at least a fifth of the force and of a wall's
/// stiffness: a choice, beyond which limits may fall to 0, where the probe gives way at any stiffness.
bool supports(const glm::dvec3& along, const glm::dvec3& force, const glm::dmat3& slope);

/// By its name: "down", "14 deg from straight down".
Hold pressed_along(const glm::dvec3& along);

/// On all sides; and pressed down, and straight against the force, where the surface supports that.
std::vector<Hold> usual_holds(const glm::dvec3& force, const glm::dmat3& slope);

/// Pressed 6 to 78 deg off the force in sixteen directions, where the surface supports that.
std::vector<Hold> all_presses(const glm::dvec3& force, const glm::dmat3& slope);

/// Columns: two directions across, and the one along which the hand presses (z where it is held on all sides).
glm::dmat3 axes_of(const Hold& hold);

/// The hand along those axes: across it is sprung, along only where it is held on all sides.
std::array<Axis, 3> axes_of(const Hold& hold, const HandSpec& hand);

/// A hand in a loop.
struct LoopCell {
    HandSpec hand;
    double rate = 1000;   /* Hz */
    double stiffness = 1; /* N/m */
    double lag = 0;       /* s: time constant with which the device's force follows what it is given */
};

/// Over a sample the device is given one force, and its own approaches that. Of each newton by which it is above that
/// at the start:
struct LagMap {
    double place = 0; /* m: what it adds to the place */
    double speed = 0; /* m/s: to the speed */
    double left = 0;  /* N: still there at the end */
};
/// Exactly, of the axis; all 0 without a lag.
LagMap lag_map(const Axis& axis, double period, double lag);

/// The hand with a virtual coupling, N/m and N s/m.
inline HandSpec coupled(HandSpec hand, double stiffness, double damping) {
    hand.coupling_stiffness = stiffness;
    hand.coupling_damping = damping;
    return hand;
}

/// N/m: of a scene and a coupling in line.
inline double displayed_stiffness(double scene, double coupling) {
    return scene * coupling / (scene + coupling);
}

/// Of the law's force at rest in a scene of `stiffness`, N/m, what is left through the hand's virtual coupling.
inline double coupled_share(const HandSpec& hand, double stiffness) {
    return hand.coupled() ? hand.coupling_stiffness / (stiffness + hand.coupling_stiffness) : 1;
}

/// N s/m: of the device and of the hand that grips it.
inline double damping_of(const HandSpec& hand) {
    return hand.damping + hand.grip_damping;
}

/// The force around a place of rest, for a stiffness of 1 N/m.
struct ForceAround {
    glm::dmat3 slope;              /* 1: -dF/dp, columns first */
    glm::dvec3 direction{0, 0, 1}; /* unit: of the force there, along which a virtual coupling is pressed */
};

/// Whether the loop of a hand at `rate` Hz grows at `stiffness` N/m; `lag` as LoopCell's. A virtual coupling takes the
/// force over the stiffness for the depth, which two-pass shading and textures are not.
bool grows(const HandSpec& hand, double rate, const Hold& hold, const ForceAround& force, double stiffness,
           double lag = 0);

/// Where a condition changes between two numbers, to a ratio of `close`: it holds at the first, and not at the second.
template <typename Holds>
std::pair<double, double> narrowed(double low, double high, double close, const Holds& holds) {
    while (high > close * low) {
        const double middle = std::sqrt(low * high);
        (holds(middle) ? low : high) = middle;
    }
    return {low, high};
}

/// The least stiffness from `from` to `to`, N/m, at which a loop grows(stiffness): up in steps of a tenth, then between
/// two whose ratio is `close`; empty: it does not grow.
template <typename Grows>
std::optional<double> least_growing(double from, double to, double close, const Grows& grows) {
    double below = from, above = from;
    while (!grows(above)) {
        below = above;
        above *= 1.1;
        if (above > to)
            return std::nullopt;
    }
    std::tie(below, above) = narrowed(below, above, close, [&](double middle) { return !grows(middle); });
    return std::sqrt(below * above);
}

/// The least stiffness, N/m, at which it grows, to a hundredth of a percent: 0 if it grows at a ten-thousandth of the
/// largest passive stiffness already, empty if it does not at eight times that.
std::optional<double> linear_limit(const HandSpec& hand, double rate, const Hold& hold, const ForceAround& force,
                                   double lag = 0);

/// The stiffness, N/m, at which the balance of the surface's force and the grip's spring turns, whatever the sampling:
/// the least K > 0 at which the grip's stiffness and K times the slope are singular together. On a crest of radius R,
/// pressed d deep at an angle t off the force, K d = k_g R cos(t)^2. Empty: the surface turns nowhere outwards.
std::optional<double> grip_limit(const HandSpec& hand, const Hold& hold, const ForceAround& force);

/// K_crit of a wall with this hand, N/m, without its coupling. NaN: none below eight times the passive one.
double wall_limit(const HandSpec& hand, double rate, double lag = 0);

} // namespace forceshade
