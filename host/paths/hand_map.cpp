#include "host/paths/hand_map.h"

#include <cmath>

namespace forceshade {
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
