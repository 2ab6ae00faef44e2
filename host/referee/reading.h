// What an engine or a referee says of one voxel, channel by channel, and how far two of them are apart.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>

#include <glm/vec3.hpp>

#include "host/referee/referee.h"
#include "host/reference/contact.h"

namespace forceshade {

struct Reading {
    glm::dvec3 force{0}, unshaded{0}; /* N */
    glm::dvec3 proxy{0};              /* m */
    double depth = 0;                 /* m */
    layout::uint facet = layout::kNoFacet;
};

/// Of a reference::Contact or a brute::Answer.
template <typename Contact> Reading reading_of(const Contact& contact) {
    return {glm::dvec3(contact.force), glm::dvec3(contact.unshaded), glm::dvec3(contact.proxy), double(contact.depth),
            contact.facet};
}

/// Channels that the chunk lacks stay empty.
template <typename T> Reading reading_of(const layout::FieldChunk<T>& chunk, std::size_t sample) {
    const auto vector = [&](std::span<const T> channel) {
        return channel.empty() ? glm::dvec3(0) : glm::dvec3(reference::vector_at(channel, sample));
    };
    return {vector(chunk.force), vector(chunk.unshaded), vector(chunk.proxy),
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

/// The first of `channels` (layout::kChannel... bits) in which a reading is further from the truth than the bound
/// allows, or 0. A facet must be the very same.
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
