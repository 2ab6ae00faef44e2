// The field of a mesh, and what it is measured by: one query of the tree a voxel.
#pragma once

#include <atomic>
#include <thread>

#include <benchmark/benchmark.h>

#include "host/field/prepared_case.h"
#include "host/mesh/findings.h"
#include "host/reference/mesh_nearest.h"
#include "tests/bench/measure.h"
#include "tests/mesh/shapes.h"

namespace forceshade::bench {

/// Spot, each triangle cut into sixteen (93 696), on 128 samples along its longest side and 5 %.
template <typename T> FieldTables<T> field_of_fine_spot() {
    const PolygonSoup polygons = shapes::subdivided(shapes::subdivided(shapes::spot()));
    const Mesh mesh = shapes::mesh_of(polygons);
    MeshStructure structure = build_structure(mesh);
    if (is_solid(inspect(polygons)))
        assume_solid(structure);
    FieldTables<T> field;
    field.features.surface = layout::kSurfaceMesh;
    field.mesh = std::make_shared<MeshTables<T>>(make_mesh_tables<T>(structure, 1000));
    const GridSpec grid = fitted_grid(128, mesh);
    std::vector<T>* const axes[] = {&field.x, &field.y, &field.z};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::uint64_t k = 0; k < grid.size[i]; ++k) {
            const double world = grid.origin[i] + grid.spacing[i] * static_cast<double>(k);
            axes[i]->push_back(static_cast<T>((world - structure.centre[int(i)]) / structure.scale));
        }
    return field;
}

template <typename T> double voxels_of(const FieldTables<T>& field) {
    return static_cast<double>(field.x.size() * field.y.size() * field.z.size());
}

/// The nearest point of every voxel, rows shared out between two threads; what was nearest to a voxel is the next one's
/// guess. s
template <typename T> double query_seconds(const FieldTables<T>& field) {
    const layout::MeshView<T> mesh = field.mesh->view();
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> sum{0};
    const auto work = [&] {
        layout::uint hint = 0;
        std::uint64_t mine = 0;
        for (std::size_t row; (row = next++) < field.y.size() * field.z.size();)
            for (const T x : field.x) {
                hint = reference::nearest(mesh, {x, field.y[row % field.y.size()], field.z[row / field.y.size()]}, hint)
                           .triangle;
                mine += hint;
            }
        sum += mine;
    };
    const double spent = seconds([&] {
        std::jthread other(work);
        work();
    });
    benchmark::DoNotOptimize(sum.load());
    return spent;
}

} // namespace forceshade::bench
