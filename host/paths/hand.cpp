#include "host/paths/hand.h"

#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "host/error.h"
#include "host/paths/hand_map.h"

namespace forceshade {
namespace {

template <typename T> T rounded(double value, const char* what) {
    const T result = static_cast<T>(value);
    if (!std::isfinite(result))
        throw UsageError(fmt::format("{} = {} is beyond {} precision{}", what, value,
                                     std::is_same_v<T, float> ? "single" : "double",
                                     std::is_same_v<T, float> ? ": use precision f64" : ""));
    return result;
}

template <typename T> layout::AxisMap<T> rounded_map(const layout::AxisMap<double>& map) {
    return {rounded<T>(map.x_error, "the hand's map of error to place"),
            rounded<T>(map.x_speed, "the hand's map of speed to place"),
            rounded<T>(map.x_force, "the hand's map of force to place, about period^2 / (2 mass),"),
            rounded<T>(map.v_error, "the hand's map of error to speed, about stiffness period / mass,"),
            rounded<T>(map.v_speed, "the hand's map of speed to speed"),
            rounded<T>(map.v_force, "the hand's map of force to speed, about period / mass,")};
}

} // namespace

template <typename T> layout::HandParams<T> hand_params(const HandSpec& hand, const PathsSpec& paths, double bound) {
    const bool held = paths.drive == PathDrive::depth; // along z
    const double period = 1 / paths.rate;
    Axis axis{hand.mass, hand.damping + hand.grip_damping, hand.grip_stiffness};
    layout::HandParams<T> params{};
    params.lateral = rounded_map<T>(axis_map(axis, period));
    axis.stiffness = held ? hand.grip_stiffness : 0;
    params.vertical = rounded_map<T>(axis_map(axis, period));
    params.rate = rounded<T>(paths.rate, "paths.rate");
    params.period = rounded<T>(period, "1 / paths.rate");
    params.stiffness = rounded<T>(hand.grip_stiffness, "hand.grip_stiffness");
    params.stiffness_z = rounded<T>(axis.stiffness, "hand.grip_stiffness");
    params.damping = rounded<T>(hand.grip_damping, "hand.grip_damping");
    if (paths.drive == PathDrive::press)
        params.push_z = rounded<T>(-paths.press, "paths.press");
    if (paths.drive == PathDrive::push) {
        params.push_x = rounded<T>(paths.push[0], "paths.push");
        params.push_y = rounded<T>(paths.push[1], "paths.push");
        params.push_z = rounded<T>(paths.push[2], "paths.push");
    }
    params.quantum = rounded<T>(hand.quantisation, "hand.quantisation");
    params.coulomb = rounded<T>(hand.coulomb, "hand.coulomb");
    params.max_force = rounded<T>(hand.max_force, "hand.max_force");
    params.gain = T(1);
    params.bound = rounded<T>(bound, "paths.bound");
    params.start_depth = rounded<T>(paths.start_depth, "paths.start_depth");
    params.delay = static_cast<layout::uint>(hand.delay_samples);
    return params;
}

template layout::HandParams<float> hand_params<float>(const HandSpec&, const PathsSpec&, double);
template layout::HandParams<double> hand_params<double>(const HandSpec&, const PathsSpec&, double);

} // namespace forceshade
