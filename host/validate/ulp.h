// Distances between floating-point numbers in units in the last place.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <type_traits>

namespace forceshade {

/// How many representable numbers lie between a and b, counting one end; +0 and -0 are one apart. NaN is far from
/// everything, itself too.
template <typename T> std::uint64_t ulp_distance(T a, T b) {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    if (a != a || b != b)
        return UINT64_MAX;
    // Numbers in order, so that their places subtract: negative ones count down from the middle.
    const auto place = [](T value) {
        constexpr Bits kSign = Bits(1) << (8 * sizeof(T) - 1);
        const Bits bits = std::bit_cast<Bits>(value);
        return bits & kSign ? kSign - 1 - (bits & ~kSign) : bits + kSign;
    };
    const Bits first = place(a), second = place(b);
    return first > second ? first - second : second - first;
}

} // namespace forceshade
