// What the judges of bumps and of meshes have in common: comparing bits, and sharing a chunk's rows out among threads.
#pragma once

#include <algorithm>
#include <cstring>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "host/validate/reading.h"
#include "host/validate/ulp.h"
#include "host/validate/validate.h"

namespace forceshade {

struct Voxel {
    std::size_t x, y, z;
};

/// True if every channel of the sample equals the contact's bit for bit.
template <typename T>
bool same_bits(const layout::FieldChunk<T>& chunk, std::size_t sample, const reference::Contact<T>& contact) {
    const auto same = [&](std::span<const T> channel, const reference::Vector<T>& value) {
        const T bits[3] = {value.x, value.y, value.z};
        return channel.empty() || std::memcmp(&channel[3 * sample], bits, sizeof(bits)) == 0;
    };
    return same(chunk.force, contact.force) && same(chunk.proxy, contact.proxy) &&
           same(chunk.unshaded, contact.unshaded) &&
           (chunk.depth.empty() || std::memcmp(&chunk.depth[sample], &contact.depth, sizeof(T)) == 0) &&
           (chunk.facet.empty() || chunk.facet[sample] == contact.facet);
}

/// Counts a voxel whose bits differ from the oracle's in the same precision.
template <typename T>
void count_difference(const layout::FieldChunk<T>& chunk, std::size_t sample, const reference::Contact<T>& alike,
                      Comparison& partial) {
    ++partial.differing;
    const T expected[3] = {alike.force.x, alike.force.y, alike.force.z};
    for (std::size_t i = 0; i < 3; ++i)
        partial.largest_ulp = std::max(partial.largest_ulp, ulp_distance(chunk.force[3 * sample + i], expected[i]));
}

/// Keeps the first failure in words.
inline void note_failure(Comparison& partial, Voxel at, const Reading& computed, const Reading& expected,
                         layout::uint channel, const char* who) {
    if (partial.first_difference.empty())
        partial.first_difference = fmt::format("voxel ({}, {}, {}): {}, {} says {}", at.x, at.y, at.z,
                                               describe(computed, channel), who, describe(expected, channel));
}

void merge(Comparison& into, const Comparison& from);

/// judge.compare_row(chunk, row, partial) for every row of a chunk, by all cores.
template <typename Judge, typename T>
void compare_rows(const Judge& judge, const layout::FieldChunk<T>& chunk, Comparison& result) {
    const std::size_t rows = chunk.y_count * chunk.z_count;
    const std::size_t threads = std::min<std::size_t>(rows, std::max(1u, std::thread::hardware_concurrency()));
    std::vector<Comparison> partial(threads);
    std::vector<std::jthread> workers;
    for (std::size_t worker = 0; worker < threads; ++worker)
        workers.emplace_back([&, worker] {
            for (std::size_t row = worker * rows / threads; row < (worker + 1) * rows / threads; ++row)
                judge.compare_row(chunk, row, partial[worker]);
        });
    workers.clear();
    for (const Comparison& part : partial)
        merge(result, part);
}

} // namespace forceshade
