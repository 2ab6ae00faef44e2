// How far rounding may take a computed voxel of a mesh from the exact one, and which facets it may have meant.
#pragma once

#include <algorithm>
#include <cstring>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "host/referee/reading.h"
#include "host/referee/rounding_bound.h"
#include "host/referee/validate.h"
#include "host/reference/contact.h"

namespace forceshade {

/// In the mesh's frame no coordinate exceeds 1, and with u the unit roundoff of the precision and P the probe's largest
/// coordinate, or 1, every distance, offset and proxy is off by at most e = 64 u (1 + P): the longest chain is that of
/// a face, 42 u (1 + P) (host/reference/mesh_nearest.h), and the mesh's vertices and centre are rounded too. Then:
///  - any triangle within 2 e of the nearest may be taken for it, with its own facet, proxy and direction;
///  - a probe within 2 e of the surface may be taken for inside or outside; so may one whose offset is so nearly in the
///  plane of a triangle taken for the nearest that the exact law says otherwise there;
///  - the interpolated normal moves with the proxy: by at most 8 e / (height of the facet) of the length it had before
///  it was normalised, and that length is no less than the least component of a vertex normal along their sum;
///  - a gradient of a height map is taken at a proxy that is off by e: what that changes is looked up on either side.
class MeshBound {
public:
    /// The case must outlive the bound.
    MeshBound(const PreparedCase& prepared, Precision precision);

    enum class Verdict { within, on_edge, beyond };

    /// Whether a reading is the law's at the probe (mesh frame), allowing for the rounding of so many `sides`.
    Verdict judge(const Reading& computed, const reference::Vector<double>& probe, double sides,
                  layout::uint channels) const;

    /// True if rounding, of the probe's position too, decides which point of the mesh an exact force near `probe`
    /// and one computed there belong to: the difference between them then says nothing.
    bool parts(const Triple& computed, const reference::Vector<double>& probe, const Triple& exact) const;

    /// The bound where the law touches a given point of a facet.
    Bound at(const reference::Vector<double>& probe, const reference::MeshTouch<double>& touch) const;

    /// 1: e at a probe.
    double reach(const reference::Vector<double>& probe) const;

    const layout::Law<double>& law() const { return law_; }

private:
    double direction_error(const reference::MeshTouch<double>& touch, double reach) const;
    double slope_error(layout::uint kind, const layout::MapParams<double>& map, std::span<const double> samples,
                       const reference::Vector<double>& world, double reach) const;

    FieldTables<double> tables_;
    layout::Law<double> law_;
    double unit_; // 64 u
    double tiny_; // smallest normal number, four times
};

// What the judges of bumps and of meshes have in common: comparing bits, and sharing a chunk's rows out among threads.

struct VoxelIndex {
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
inline void note_failure(Comparison& partial, VoxelIndex at, const Reading& computed, const Reading& expected,
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

// An engine's field of a mesh held against the oracles on every voxel, and against plain loops on some.

/// Adds what compare_case counts, for a case whose surface is a mesh, evaluated in T. The closed form's place takes the
/// brute referee, which loops over all triangles: on evenly chosen voxels, so many that the loops stay within some
/// seconds.
template <typename T> void compare_mesh(Engine& engine, const PreparedCase& prepared, Comparison& result);

extern template void compare_mesh<float>(Engine&, const PreparedCase&, Comparison&);
extern template void compare_mesh<double>(Engine&, const PreparedCase&, Comparison&);

} // namespace forceshade
