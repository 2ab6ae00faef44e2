// Numbers as unevaluated sums of two doubles: differences and products of doubles without rounding (Dekker 1971, Knuth
// TAOCP 2, 4.2.2). Needs a compiler that neither contracts nor reorders.
#pragma once

#include <cmath>

namespace forceshade {

struct Twofold {
    double high = 0, low = 0;
};

/// a + b, exactly.
inline Twofold exact_sum(double a, double b) noexcept {
    const double sum = a + b, b_part = sum - a;
    return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// a - b, exactly.
inline Twofold exact_difference(double a, double b) noexcept {
    return exact_sum(a, -b);
}

/// a + b to about 2^-104 of |a| + |b|, its high part being the whole rounded to double.
inline Twofold sum(const Twofold& a, const Twofold& b) noexcept {
    const Twofold high = exact_sum(a.high, b.high);
    return exact_sum(high.high, high.low + (a.low + b.low));
}

/// a * b to about 2^-104 of itself; exactly if both low parts are 0.
inline Twofold product(const Twofold& a, const Twofold& b) noexcept {
    const double high = a.high * b.high;
    return {high, std::fma(a.high, b.high, -high) + (a.high * b.low + a.low * b.high)};
}

/// a - b to about 2^-104 of |a| + |b|; 0 if they are the same.
inline Twofold difference(const Twofold& a, const Twofold& b) noexcept {
    return sum(a, {-b.high, -b.low});
}

} // namespace forceshade
