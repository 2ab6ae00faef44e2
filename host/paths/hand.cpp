#include "host/paths/hand.h"

#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "host/error.h"

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

namespace {

using real = long double; // so that what a coefficient is made of is exact to double's last digit

// The answer h(t) to a unit of speed at the beginning, time in samples: h'' + 2 a h' + c h = 0, h(0) = 0, h'(0) = 1.
struct Answer {
    real at_end, speed, sum; // h(1), h'(1), and the integral of h from 0 to 1
};

// h is the sum over n of (-1)^n s_n t^(n+1) / (n+1)!, where s_n, the complete symmetric polynomial of the two roots,
// is 2 a s_(n-1) - c s_(n-2). For small a and c.
Answer by_series(real a, real c) {
    constexpr int kTerms = 40;
    Answer answer{0, 0, 0};
    real symmetric = 1, before = 0, factorial = 1; // s_n, s_(n-1), (-1)^n / n!
    for (int n = 0; n < kTerms; ++n) {
        answer.speed += symmetric * factorial;
        answer.at_end += symmetric * factorial / real(n + 1);
        answer.sum += symmetric * factorial / real((n + 1) * (n + 2));
        const real next = 2 * a * symmetric - c * before;
        before = symmetric;
        symmetric = next;
        factorial /= -real(n + 1);
    }
    return answer;
}

// The mean of e^-rt over a sample.
real mean_decay(real rate) {
    return rate > 0 ? -std::expm1(-rate) / rate : 1;
}

// Two real rates of decay, slow and fast: none is a difference of like numbers.
Answer overdamped(real a, real c) {
    const real half = std::sqrt(a * a - c), fast = a + half, slow = c / fast;
    const real between = mean_decay(2 * half);
    Answer answer;
    answer.at_end = std::exp(-slow) * between;
    answer.speed = std::exp(-slow) * (std::exp(-2 * half) - slow * between);
    if (fast >= 2 * slow)
        answer.sum = (mean_decay(slow) - mean_decay(fast)) / (2 * half);
    else
        answer.sum = (1 - std::exp(-slow) * (1 + slow * between)) / c;
    return answer;
}

Answer underdamped(real a, real c) {
    const real turn = std::sqrt(c - a * a), decay = std::exp(-a);
    const real swing = std::sin(turn) / turn, back = std::sin(turn / 2);
    Answer answer;
    answer.at_end = decay * swing;
    answer.speed = decay * (std::cos(turn) - a * swing);
    answer.sum = (-std::expm1(-a) + decay * (2 * back * back - a * swing)) / c;
    return answer;
}

Answer answer_of(real a, real c) {
    if (a <= real(0.5) && c <= 1)
        return by_series(a, c);
    return a * a >= c ? overdamped(a, c) : underdamped(a, c);
}

} // namespace

layout::AxisMap<double> axis_map(const Axis& axis, double period) {
    const real t = period, m = axis.mass;
    const real a = axis.damping * t / (2 * m), c = axis.stiffness * t * t / m; // 1
    const Answer answer = answer_of(a, c);
    return {static_cast<double>(-c * answer.sum),        static_cast<double>(t * answer.at_end),
            static_cast<double>(t * t / m * answer.sum), static_cast<double>(-c / t * answer.at_end),
            static_cast<double>(answer.speed),           static_cast<double>(t / m * answer.at_end)};
}

} // namespace forceshade
