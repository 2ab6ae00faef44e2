// A mesh, a grid and what the law uses, ready for the kernel and for the oracle.
#pragma once

#include <memory>

#include "compute/kernels.h"
#include "host/mesh/structure.h"
#include "tests/gpu/software_device.h"
#include "tests/mesh/shapes.h"

namespace forceshade::test {

/// Samples of a grid: their number, and what part of the mesh's frame they span; [-1.05, 1.05] covers the mesh.
struct MeshGrid {
    std::array<std::size_t, 3> size{33, 34, 35};
    glm::dvec3 from{-1.05}, to{1.05};
};

template <typename T> struct MeshCase {
    MeshTables<T> tables;
    layout::Features features;
    layout::LawParams<T> params{};
    std::vector<T> map_gradients, texture_gradients;
    std::vector<T> x, y, z;

    MeshCase(const MeshStructure& structure, const MeshGrid& grid, layout::uint shading = layout::kShadingNone)
        : tables(make_mesh_tables<T>(structure, 1000)), x(axis(grid, 0)), y(axis(grid, 1)), z(axis(grid, 2)) {
        features.surface = layout::kSurfaceMesh;
        features.shading = shading;
        features.channels = kAllChannels;
    }

    layout::FieldInput<T> input() const {
        layout::FieldInput<T> input{};
        input.law.features = features;
        input.law.params = params;
        input.law.map_gradients = map_gradients;
        input.law.texture_gradients = texture_gradients;
        input.law.mesh = tables.view();
        input.x = x;
        input.y = y;
        input.z = z;
        return input;
    }

private:
    static std::vector<T> axis(const MeshGrid& grid, int i) {
        std::vector<T> samples;
        const std::size_t count = grid.size[static_cast<std::size_t>(i)];
        const double step = count > 1 ? (grid.to[i] - grid.from[i]) / static_cast<double>(count - 1) : 0;
        for (std::size_t k = 0; k < count; ++k)
            samples.push_back(static_cast<T>(grid.from[i] + step * static_cast<double>(k)));
        return samples;
    }
};

/// Every block, each with every triangle: what no planner can get wrong.
struct WholePlan {
    std::vector<layout::MeshBlock> blocks;
    std::vector<layout::uint> candidates;

    template <typename T> explicit WholePlan(const layout::FieldInput<T>& input) {
        constexpr layout::uint kStep = layout::kMeshBlock;
        const layout::uint triangles = input.law.mesh.params.triangles;
        for (layout::uint t = 0; t < triangles; ++t)
            candidates.push_back(t);
        for (layout::uint z = 0; z < input.z.size(); z += kStep)
            for (layout::uint y = 0; y < input.y.size(); y += kStep)
                for (layout::uint x = 0; x < input.x.size(); x += kStep)
                    blocks.push_back({x, y, z, 0, triangles});
    }
    layout::MeshPlan view() const { return {blocks, candidates, {}}; }
};

/// Evaluates a field on the device and, chunk by chunk, on the oracle.
template <typename T>
BitComparison hold_against_oracle(compute::MeshKernel& kernel, const layout::FieldInput<T>& input,
                                  const compute::PlanSlab& plan = {}) {
    BitComparer<T> comparer(input);
    kernel.evaluate<T>(
        input, [&](const layout::FieldChunk<T>& chunk) { comparer.add(chunk); }, plan);
    return comparer.result();
}

} // namespace forceshade::test
