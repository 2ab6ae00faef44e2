// How a row of the table is run: its law's tables, and kernels that are kept from row to row.
#include "host/mesh/solid_scan.h"
#include "host/paths/scene_paths.h"
#include "host/reference/field.h"
#include "tests/gpu/rows.h"

namespace forceshade::test {
namespace {

template <typename T> layout::MapParams<T> mesh_map(T side) {
    layout::MapParams<T> params{};
    params.half_width = params.half_length = T(0.7) * side;
    params.radius = side;
    params.slope = T(0.6);
    params.inverse_length = T(4) / side;
    params.columns = 5;
    params.rows = 4;
    params.nodes_per_x = T(4) / (params.half_width + params.half_width);
    params.nodes_per_y = T(3) / (params.half_length + params.half_length);
    return params;
}

template <typename T> void add_maps(FieldTables<T>& tables, const Maps& maps) {
    tables.features.map = maps.map;
    tables.features.texture = maps.texture;
    MeshTables<T> mesh = *tables.mesh;
    if (maps.map_x)
        mesh.params.map_x = T(*maps.map_x);
    tables.params.map = tables.params.texture = mesh_map(mesh.params.scale);
    tables.params.texture_stiffness = T(300);
    for (int i = 0; i < 40; ++i) {
        tables.map_gradients.push_back(T(i * 7 % 11) / T(11) - T(0.5));
        tables.texture_gradients.push_back(T(i * 5 % 13) / T(13) - T(0.5));
    }
    tables.mesh = std::make_shared<const MeshTables<T>>(std::move(mesh));
}

compute::KernelOptions options_of(const Way& way) {
    compute::KernelOptions options;
    const auto set = [](auto& option, auto value) {
        if (value)
            option = value;
    };
    set(options.chunk_bytes, way.chunk_bytes);
    set(options.software_chunk_bytes, way.chunk_bytes);
    set(options.rows, way.rows);
    set(options.steps, way.rows);
    set(options.slab_voxels, way.batch);
    set(options.batch_paths, way.batch);
    set(options.pause, way.pause);
    set(options.limit, way.limit);
    options.packed_stores = way.packed;
    options.force_staging = way.staged;
    return options;
}

} // namespace

Ground analytic(const Scene& scene, const SceneImages& images) {
    Ground ground;
    ground.prepared.one.scene = scene;
    ground.prepared.images = images;
    return ground;
}

Ground mesh_of(const PolygonSoup& polygons, Shading shading, const Maps& maps) {
    const std::shared_ptr<SceneMesh> mesh = made_mesh(polygons, maps.inside == InsideTest::winding);
    mesh->inside = maps.inside;
    if (!maps.known_solid) {
        mesh->structure.solid = false;
        mesh->structure.clearance = nullptr;
    }
    Ground ground;
    ground.maps = maps;
    ground.prepared.images.mesh = mesh;
    Scene& scene = ground.prepared.one.scene;
    scene.surface.kind = SurfaceKind::mesh;
    scene.surface.mesh.inside = maps.inside;
    scene.force.shading = shading;
    scene.output.channels = kAllChannels;
    scene.field = false;
    return ground;
}

template <typename T> FieldTables<T> tables_of(const Ground& ground, const MeshGrid& grid) {
    const Extent extent = ground.prepared.images.mesh ? Extent::nothing : Extent::everything; // the row gives a mesh's
    FieldTables<T> tables = make_tables<T>(ground.prepared.one.scene, ground.prepared.images, extent);
    if (!tables.mesh)
        return tables;
    std::vector<T>* const axes[] = {&tables.x, &tables.y, &tables.z};
    for (int i = 0; i < 3; ++i) {
        const std::size_t count = grid.size[static_cast<std::size_t>(i)];
        const double step = count > 1 ? (grid.to[i] - grid.from[i]) / static_cast<double>(count - 1) : 0;
        axes[i]->clear();
        for (std::size_t k = 0; k < count; ++k)
            axes[i]->push_back(static_cast<T>(grid.from[i] + step * static_cast<double>(k)));
    }
    if (ground.maps.map != layout::kMapNone || ground.maps.texture != layout::kMapNone)
        add_maps(tables, ground.maps);
    return tables;
}
template FieldTables<float> tables_of<float>(const Ground&, const MeshGrid&);
template FieldTables<double> tables_of<double>(const Ground&, const MeshGrid&);

// The channels of paths on meshes stand one behind the other in a buffer.
template <typename Kernel>
Kernels::Kept<Kernel>::Kept(compute::Device& device, const Way& way)
    : kernel(device, options_of(way)), sentinels(std::is_same_v<Kernel, compute::MeshPathKernel>) {}

template <typename Kernel> Kernels::Kept<Kernel>& Kernels::kept(const Way& way) {
    auto& all = std::get<std::map<Way, Kept<Kernel>>>(kept_);
    if (const auto found = all.find(way); found != all.end())
        return found->second;
    return all.try_emplace(way, device_, way).first->second;
}

template <typename T> Held Kernels::field(const Way& way, const FieldTables<T>& tables) {
    auto& [kernel, sentinels] = kept<compute::FieldKernel>(way);
    const layout::FieldInput<T> input = tables.input();
    HeldField<T> held(input, &sentinels);
    kernel.template evaluate<T>(input, [&](const layout::FieldChunk<T>& chunk) { held.add(chunk); });
    return held.result();
}

// The kernel and the CPU engine. Where scans serve, the kernel's plan is one; the CPU engine's
// is made by halving boxes, of grids as small as these.
template <typename T> Held Kernels::mesh_field(const Way& way, const FieldTables<T>& tables, FreeSpace free) {
    auto& [kernel, sentinels] = kept<compute::MeshKernel>(way);
    const layout::FieldInput<T> input = tables.input();
    const BlockPlanner<T> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 0, free);
    const auto scan = free == FreeSpace::skipped
                          ? SolidScan<T>::make(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 2)
                          : nullptr;
    BlockPlan plan;
    const auto layers = [&](std::size_t z_first, std::size_t z_count) {
        plan = planner.plan(z_first, z_count);
        return plan.view();
    };
    const auto scanned = [&](std::size_t z_first, std::size_t z_count) {
        plan = scan->plan(z_first, z_count);
        return plan.view();
    };
    HeldField<T> held(input, &sentinels);
    const auto take = [&](const layout::FieldChunk<T>& chunk) { held.add(chunk); };
    scan ? kernel.template evaluate<T>(input, take, scanned) : kernel.template evaluate<T>(input, take, layers);
    // On the CPU in chunks of many layers, or of few rows of one.
    HeldField<T> on_cpu(input);
    const std::size_t chunk_bytes = std::size_t(1) << (sizeof(T) == sizeof(float) ? 25 : 13);
    if (way == Way{})
        reference::evaluate_mesh_field<T>(input, {.threads = 2, .chunk_bytes = chunk_bytes}, layers,
                                          [&](const layout::FieldChunk<T>& chunk) { on_cpu.add(chunk); });
    EXPECT_TRUE(way != Way{} || is_equal(on_cpu.result())) << "on the CPU";
    return held.result();
}

template <typename T>
Held Kernels::paths(const Way& way, const layout::PathInput<T>& input,
                    const std::function<std::size_t(std::size_t)>& length) {
    const auto hold = [&](Sentinels& sentinels, const auto& explore) {
        HeldPaths<T> held(input, sentinels);
        explore([&](const layout::PathChunk<T>& chunk) { held.add(chunk, length); },
                [&](std::size_t first, std::span<const layout::PathMetrics<T>> some) { held.add(first, some); });
        return held.result();
    };
    if (input.law.features.surface != layout::kSurfaceMesh) {
        auto& [kernel, sentinels] = kept<compute::PathKernel>(way);
        return hold(sentinels, [&, &on = kernel](const auto& take, const auto& metrics) {
            on.template explore<T>(input, take, metrics);
        });
    }
    auto& [kernel, sentinels] = kept<compute::MeshPathKernel>(way);
    std::uint64_t updates = 0;
    const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> some) {
        updates += some.size();
        reference::finish_updates(input.law.mesh, some, 2);
    };
    Held held = hold(sentinels, [&, &on = kernel](const auto& take, const auto& metrics) {
        on.template explore<T>(input, finish, take, metrics);
    });
    held.host_updates = updates;
    return held;
}

template <typename T> std::vector<Held> Kernels::hold(const Row& row) {
    const Ground ground = row.ground();
    const FieldTables<T> tables = tables_of<T>(ground, row.grid);
    std::vector<Held> all;
    for (const Way& way : row.ways) {
        if (ground.prepared.one.scene.paths) {
            ScenePaths<T> paths(ground.prepared);
            const layout::PathInput<T> input = paths.input();
            all.push_back(this->paths(way, input, [&](std::size_t) { return input.steps; }));
        } else if (row.shape) {
            PathShape shape = *row.shape;
            for (std::uint64_t slice = 0; slice < row.slices; ++slice, ++shape.seed) {
                PathCase<T> one(tables, ground.mesh(), shape);
                all.push_back(paths(way, one.input(), [&](std::size_t path) { return one.length(path); }));
            }
        } else {
            all.push_back(ground.mesh() ? mesh_field(way, tables, row.free) : field(way, tables));
        }
    }
    return all;
}
template std::vector<Held> Kernels::hold<float>(const Row&);
template std::vector<Held> Kernels::hold<double>(const Row&);

#define FORCESHADE_TEST_KERNELS(T)                                                                                     \
    template Held Kernels::field(const Way&, const FieldTables<T>&);                                                   \
    template Held Kernels::mesh_field(const Way&, const FieldTables<T>&, FreeSpace);                                   \
    template Held Kernels::paths(const Way&, const layout::PathInput<T>&,                                              \
                                 const std::function<std::size_t(std::size_t)>&);
FORCESHADE_TEST_KERNELS(float)
FORCESHADE_TEST_KERNELS(double)

} // namespace forceshade::test
