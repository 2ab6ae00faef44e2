// What an engine or a referee says of one voxel, channel by channel.
#pragma once

#include <array>
#include <string>

#include "host/brute/referee.h"
#include "host/reference/contact.h"
#include "host/validate/rounding_bound.h"

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

/// N: |F - F_truth|.
double force_error(const Reading& computed, const Reading& truth);

/// The first of `channels` (layout::kChannel... bits) in which a reading is further from the truth than the bound
/// allows; 0 if there is none. A facet must be the very same.
layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels);

/// One channel in words, as "depth 0.001 m".
std::string describe(const Reading& reading, layout::uint channel);

} // namespace forceshade
