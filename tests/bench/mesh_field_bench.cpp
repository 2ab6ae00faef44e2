// The static field of a mesh, planned and computed on the software device, against one query of the tree a voxel by two
// threads. Each iteration measures both, so that the ratio holds while the machine's speed drifts.
#include <atomic>
#include <ctime>
#include <thread>

#include <benchmark/benchmark.h>

#include "compute/kernels.h"
#include "host/field/prepared_case.h"
#include "host/mesh/block_plan.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "host/mesh/mesh_file.h"
#include "host/reference/mesh_nearest.h"
#include "tests/bench/measure.h"
#include "tests/mesh/shapes.h"

namespace forceshade::bench {
namespace {

// Spot, each triangle cut into sixteen, on 128 samples along its longest side and 5 %.
template <typename T> struct Field {
    MeshTables<T> tables;
    std::vector<T> x, y, z;

    Field() {
        PolygonSoup polygons = read_polygons(FORCESHADE_DATA "/spot.obj").polygons;
        const PolygonSoup fine = shapes::subdivided(shapes::subdivided(polygons));
        const Mesh mesh = shapes::mesh_of(fine);
        MeshStructure structure = build_structure(mesh);
        if (is_solid(inspect(fine)))
            assume_solid(structure);
        tables = make_mesh_tables<T>(structure, 1000);
        const GridSpec grid = fitted_grid(128, mesh);
        std::vector<T>* const axes[3] = {&x, &y, &z};
        for (int i = 0; i < 3; ++i)
            for (std::uint64_t k = 0; k < grid.size[static_cast<std::size_t>(i)]; ++k) {
                const double world = grid.origin[static_cast<std::size_t>(i)] +
                                     grid.spacing[static_cast<std::size_t>(i)] * static_cast<double>(k);
                axes[i]->push_back(static_cast<T>((world - structure.centre[i]) / structure.scale));
            }
    }

    std::size_t voxels() const { return x.size() * y.size() * z.size(); }

    layout::FieldInput<T> input() const {
        layout::FieldInput<T> input{};
        input.law.features.surface = layout::kSurfaceMesh;
        input.law.mesh = tables.view();
        input.x = x;
        input.y = y;
        input.z = z;
        return input;
    }
};

// The nearest point of every voxel, rows shared out between two threads; what was nearest to a voxel is the next one's
// guess.
template <typename T> std::uint64_t queries(const Field<T>& field) {
    const layout::MeshView<T> mesh = field.tables.view();
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> sum{0};
    const auto work = [&] {
        std::uint64_t mine = 0;
        layout::uint hint = 0;
        for (std::size_t row; (row = next++) < field.y.size() * field.z.size();)
            for (const T x : field.x) {
                hint = reference::nearest(mesh, {x, field.y[row % field.y.size()], field.z[row / field.y.size()]}, hint)
                           .triangle;
                mine += hint;
            }
        sum += mine;
    };
    {
        std::jthread other(work);
        work();
    }
    return sum;
}

// Of all threads of this process, s: what load of others does not change much.
double processor_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <typename T> void static_field(benchmark::State& state) {
    const Field<T> field;
    compute::Device device;
    compute::MeshKernel kernel(device);
    const layout::FieldInput<T> input = field.input();
    double planning = 0;
    std::uint64_t evaluated = 0;
    const auto compute_field = [&] {
        planning = 0;
        evaluated = 0;
        BlockPlan plan;
        std::unique_ptr<BlockPlanner<T>> planner;
        planning += seconds([&] {
            planner = std::make_unique<BlockPlanner<T>>(input.law.mesh, input.x, input.y, input.z, layout::uint(0));
        });
        return kernel.evaluate<T>(
            input, [](const layout::FieldChunk<T>&) {},
            [&](std::size_t first, std::size_t count) {
                planning += seconds([&] { plan = planner->plan(first, count); });
                evaluated += plan.voxels_evaluated;
                return plan.view();
            });
    };
    compute_field(); // compiles
    std::vector<double> tree, whole, plans, uploads, kernels, ratios, processor_ratios;
    for (auto _ : state) {
        const double start = processor_seconds();
        tree.push_back(seconds([&] { benchmark::DoNotOptimize(queries(field)); }));
        const double middle = processor_seconds();
        compute::FieldTimes times;
        whole.push_back(seconds([&] { times = compute_field(); }));
        processor_ratios.push_back((middle - start) / (processor_seconds() - middle));
        ratios.push_back(tree.back() / whole.back());
        plans.push_back(planning);
        uploads.push_back(times.upload);
        kernels.push_back(times.kernel);
        state.SetIterationTime(whole.back());
    }
    const auto voxels = static_cast<double>(field.voxels());
    state.SetLabel(device.report().name);
    state.counters["triangles"] = static_cast<double>(input.law.mesh.params.triangles);
    state.counters["evaluated_share"] = static_cast<double>(evaluated) / voxels;
    state.counters["queries_M_per_s"] = voxels * 1e-6 / median(tree);
    state.counters["field_ms"] = median(whole) * 1e3;
    state.counters["plan_ms"] = median(plans) * 1e3;
    state.counters["upload_ms"] = median(uploads) * 1e3;
    state.counters["kernel_ms"] = median(kernels) * 1e3;
    state.counters["of_queries"] = median(ratios);
    state.counters["of_queries_processor_time"] = median(processor_ratios);
}

BENCHMARK(static_field<float>)->UseManualTime()->Iterations(7);
BENCHMARK(static_field<double>)->UseManualTime()->Iterations(5);

} // namespace
} // namespace forceshade::bench
