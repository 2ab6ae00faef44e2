// What must hold of the structure of any mesh, by loops over all of it: for tests and fuzz targets.
#pragma once

#include <cstring>
#include <limits>
#include <string>

#include "host/mesh/structure.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade::shapes {

struct StructureCheck {
    std::string fault;  /* the first one; empty if there is none */
    unsigned depth = 0; /* nodes on the longest path from the root */
};

/// Whether every triangle is in one leaf, within all boxes and slabs above it, and next to the other triangle between
/// the same two places if there is exactly one.
StructureCheck check_structure(const MeshStructure& structure);

/// By a loop over all triangles: of equally near ones that of the lowest facet, then the first.
template <typename T>
reference::Nearest<T> nearest_by_loop(const layout::MeshView<T>& mesh, const reference::Vector<T>& probe) {
    reference::Nearest<T> best{0, 0, 0, {}, std::numeric_limits<T>::infinity()};
    for (layout::uint triangle = 0; triangle < mesh.params.triangles; ++triangle) {
        const auto point = reference::nearest_on_triangle(probe, reference::triangle_at(mesh, triangle));
        const layout::uint facet = mesh.triangle_facets[triangle];
        if (point.square < best.square ||
            (point.square == best.square && (facet < best.facet || (facet == best.facet && triangle < best.triangle))))
            best = {triangle, facet, point.feature, point.offset, point.square};
    }
    return best;
}

/// Bit for bit.
template <typename T> bool same(const reference::Nearest<T>& one, const reference::Nearest<T>& other) {
    return one.triangle == other.triangle && one.facet == other.facet && one.feature == other.feature &&
           std::memcmp(&one.offset, &other.offset, sizeof one.offset) == 0 && one.square == other.square;
}

} // namespace forceshade::shapes
