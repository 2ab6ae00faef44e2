// Plans of which triangles are asked where, held against the tree and against loops over all triangles.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "host/mesh/block_plan.h"
#include "host/mesh/findings.h"
#include "host/mesh/structure.h"
#include "host/reference/mesh_contact.h"
#include "tests/mesh/shapes.h"

namespace forceshade::shapes {

template <typename T> struct Samples { std::array<std::vector<T>, 3> axes; };

/// In the mesh's frame, from and to of each axis.
template <typename T>
Samples<T> samples(const std::array<std::size_t, 3>& counts, const glm::dvec3& from, const glm::dvec3& to) {
    Samples<T> result;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < counts[axis]; ++i) {
            const int a = static_cast<int>(axis);
            const double share = counts[axis] > 1 ? static_cast<double>(i) / static_cast<double>(counts[axis] - 1) : 0;
            result.axes[axis].push_back(static_cast<T>(from[a] + (to[a] - from[a]) * share));
        }
    return result;
}

/// Tables of polygons, and of a solid as such: what keeps apart is known.
template <typename T> MeshTables<T> tables_of(const PolygonSoup& polygons, bool winding = false) {
    MeshStructure structure = build_structure(mesh_of(polygons), {.winding = winding});
    if (is_solid(inspect(polygons)))
        assume_solid(structure);
    return make_mesh_tables<T>(structure, 1000);
}

/// Every triangle as near as the nearest is a candidate: whichever of them a kernel prefers is there.
template <typename T>
bool lists_all_nearest(const layout::MeshView<T>& mesh, std::span<const layout::uint> candidates,
                       const reference::Vector<T>& probe, T least) {
    for (layout::uint t = 0; t < mesh.params.triangles; ++t)
        if (reference::nearest_on_triangle(probe, reference::triangle_at(mesh, t)).square == least &&
            std::find(candidates.begin(), candidates.end(), t) == candidates.end())
            return false;
    return true;
}

struct PlanCounts {
    std::size_t samples = 0, inside = 0, wanted = 0, candidates = 0, blocks = 0;
};

/// What is inside is wanted, and what is nearest there is listed; of lists of more than `long_list` all that is as
/// near.
template <typename T>
PlanCounts hold_plan(const layout::MeshView<T>& mesh, const Samples<T>& grid, layout::uint inside,
                     const BlockPlan& plan, std::size_t long_list = 8) {
    const auto& [x, y, z] = grid.axes;
    PlanCounts counts;
    std::map<std::array<std::size_t, 3>, std::size_t> blocks;
    for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
        const layout::MeshBlock& block = plan.blocks[b];
        EXPECT_TRUE(blocks.try_emplace({block.x, block.y, block.z}, b).second);
        EXPECT_TRUE(block.count > 0 && block.count <= kMostCandidates);
        EXPECT_TRUE(b == 0 || plan.blocks[b - 1].z <= block.z);
        counts.candidates += block.count;
    }
    counts.blocks = plan.blocks.size();
    layout::uint hint = 0;
    std::size_t missed = 0, unlisted = 0, other_side = 0;
    for (std::size_t k = 0; k < z.size(); ++k)
        for (std::size_t j = 0; j < y.size(); ++j)
            for (std::size_t i = 0; i < x.size(); ++i) {
                const reference::Vector<T> probe(x[i], y[j], z[k]);
                const auto nearest = reference::nearest(mesh, probe, hint);
                hint = nearest.triangle;
                const bool by_winding = inside == layout::kInsideWinding;
                const bool is_inside = by_winding ? reference::inside_by_winding(mesh, probe)
                                                  : reference::inside_by_pseudonormal(mesh, nearest);
                const auto at = blocks.find({i / 2 * 2, j / 2 * 2, k / 2 * 2});
                const std::size_t bit = k % 2 * 4 + j % 2 * 2 + i % 2;
                const bool is_wanted =
                    at != blocks.end() && (plan.wanted.empty() || (plan.wanted[at->second] >> bit & 1u) != 0);
                ++counts.samples;
                counts.inside += is_inside;
                counts.wanted += is_wanted;
                missed += is_inside && !is_wanted;
                if (!is_wanted)
                    continue;
                other_side += by_winding && (plan.inside[at->second] >> bit & 1u) != (is_inside ? 1u : 0u);
                const layout::MeshBlock& block = plan.blocks[at->second];
                // By the planner's own choice of the nearest, one of equals is enough.
                const std::span<const layout::uint> candidates(&plan.candidates[block.first], block.count);
                unlisted += std::ranges::find(candidates, hint) == candidates.end() ||
                            (block.count > long_list && !lists_all_nearest(mesh, candidates, probe, nearest.square));
            }
    EXPECT_EQ(missed, 0u);
    EXPECT_EQ(unlisted, 0u);
    EXPECT_EQ(other_side, 0u);
    EXPECT_EQ(counts.wanted, plan.voxels_evaluated);
    return counts;
}

} // namespace forceshade::shapes
