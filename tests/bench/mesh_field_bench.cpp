// The static field of a mesh, planned and computed on the software device, against one query of the tree a voxel by two
// threads. Each iteration measures both, so that the ratio holds while the machine's speed drifts.
#include "compute/kernels.h"
#include "host/mesh/block_plan.h"
#include "host/sweep/sweep.h"
#include "tests/bench/tree_queries.h"

namespace forceshade::bench {
namespace {

template <typename T> void static_field(benchmark::State& state) {
    const FieldTables<T> field = field_of_fine_spot<T>();
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
        const double start = cpu_seconds();
        tree.push_back(query_seconds(field));
        const double middle = cpu_seconds();
        compute::FieldTimes times;
        whole.push_back(seconds([&] { times = compute_field(); }));
        processor_ratios.push_back((middle - start) / (cpu_seconds() - middle));
        ratios.push_back(tree.back() / whole.back());
        plans.push_back(planning);
        uploads.push_back(times.upload);
        kernels.push_back(times.kernel);
        state.SetIterationTime(whole.back());
    }
    const double voxels = voxels_of(field);
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
