// What an engine or a referee says of one voxel, channel by channel, and how far two of them are apart.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>

#include "host/referee/referee.h"
#include "host/reference/contact.h"

namespace forceshade {

using Triple = std::array<double, 3>;

struct Reading {
    Triple force{}, unshaded{}; /* N */
    Triple proxy{};             /* m */
    double depth = 0;           /* m */
    layout::uint facet = layout::kNoFacet;
};

template <typename T> Reading reading_of(const reference::Contact<T>& contact) {
    const auto triple = [](const reference::Vector<T>& value) {
        return Triple{double(value.x), double(value.y), double(value.z)};
    };
    return {triple(contact.force), triple(contact.unshaded), triple(contact.proxy), double(contact.depth),
            contact.facet};
}

Reading reading_of(const brute::Answer& answer);

/// Channels that the chunk lacks stay empty.
template <typename T> Reading reading_of(const layout::FieldChunk<T>& chunk, std::size_t sample) {
    const auto triple = [&](std::span<const T> channel) {
        return channel.empty() ? Triple{}
                               : Triple{double(channel[3 * sample]), double(channel[3 * sample + 1]),
                                        double(channel[3 * sample + 2])};
    };
    return {triple(chunk.force), triple(chunk.unshaded), triple(chunk.proxy),
            chunk.depth.empty() ? 0 : double(chunk.depth[sample]),
            chunk.facet.empty() ? layout::kNoFacet : chunk.facet[sample]};
}

/// How far each channel of a voxel may be off.
struct Bound {
    double force = 0;     /* N: |F - F_exact| */
    double magnitude = 0; /* N: | |F| - |F_exact| |; says more than `force` where the direction is ill conditioned */
    double unshaded = 0;  /* N */
    double depth = 0;     /* m */
    double proxy = 0;     /* m */
};

/// The sum of the bounds.
Bound operator+(const Bound& a, const Bound& b);
Bound operator*(double factor, const Bound& bound);

/// N: |F - F_truth|.
double force_error(const Reading& computed, const Reading& truth);

/// The first of `channels` (layout::kChannel... bits) in which a reading is further from the truth than the bound
/// allows; 0 if there is none. A facet must be the very same.
layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels);

/// One channel in words, as "depth 0.001 m".
std::string describe(const Reading& reading, layout::uint channel);

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
