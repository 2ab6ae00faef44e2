// The field kernel and the CPU engine against memset by two threads over the same number of bytes, and what evaluating
// a field once in y saves. Each iteration measures both sides, so that the ratio holds while the machine's speed
// drifts. The device's share depends on memset's rate, not its own: a voxel takes its driver about 2.5 ns on two
// threads of a Xeon (f32), whether memset writes 20 GB/s or, while others use the memory, 10.
#include <cstring>
#include <thread>

#include <benchmark/benchmark.h>

#include "compute/kernels.h"
#include "host/field/prepared_case.h"
#include "host/reference/field.h"
#include "host/sweep/sweep.h"
#include "tests/bench/measure.h"

namespace forceshade::bench {
namespace {

constexpr double kMil = 25.4e-6; /* m */

Scene scene_of(std::uint64_t side, double lowest_z) {
    Scene scene;
    scene.surface.radius = 600 * kMil;
    scene.surface.width = 1000 * kMil;
    scene.surface.facets = 3;
    scene.force.shading = Shading::reference;
    const double spacing = 0.0512 / static_cast<double>(side);
    scene.grid.size = {side, side, side};
    scene.grid.origin = {-0.0256, -0.0256, lowest_z};
    scene.grid.spacing = {spacing, spacing, spacing};
    return scene;
}

// Two threads fill `bytes` bytes.
double fill(std::vector<char>& memory, std::size_t bytes) {
    memory.resize(std::max(memory.size(), bytes));
    return seconds([&] {
        std::jthread half([&] { std::memset(memory.data(), 1, bytes / 2); });
        std::memset(memory.data() + bytes / 2, 1, bytes - bytes / 2);
    });
}

template <typename T> double kernel_seconds(compute::FieldKernel& kernel, const FieldTables<T>& tables) {
    return kernel.evaluate<T>(tables.input(), [](const layout::FieldChunk<T>&) {}).kernel;
}

template <typename T> double cpu_engine_seconds(const FieldTables<T>& tables) {
    return seconds([&] { reference::evaluate_field<T>(tables.input(), {}, [](const layout::FieldChunk<T>&) {}); });
}

// `lowest_z`: -0.0612 m puts every voxel below the plane, -0.0256 m half of them.
template <typename T> void dense_field(benchmark::State& state, SurfaceKind kind, double lowest_z) {
    compute::Device device;
    compute::FieldKernel kernel(device);
    Scene scene = scene_of(256, lowest_z);
    scene.surface.kind = kind;
    if (kind == SurfaceKind::cylinder_bump)
        scene.force.shading = Shading::none;
    if (kind == SurfaceKind::height_map) { // differs from y to y, so that no row can be had from another
        scene.force.shading = Shading::height_map;
        scene.surface.map.function = MapFunction::gaussian;
        scene.surface.map.radius = 0.005;
    }
    const FieldTables<T> tables = make_tables<T>(scene, {}, Extent::everything);
    const std::size_t voxels = tables.x.size() * tables.y.size() * tables.z.size(), bytes = voxels * 3 * sizeof(T);
    static std::vector<char> memory;
    fill(memory, bytes);
    kernel_seconds(kernel, tables);
    std::vector<double> kernels, cpus, fills;
    for (auto _ : state) {
        fills.push_back(fill(memory, bytes));
        kernels.push_back(kernel_seconds(kernel, tables));
        cpus.push_back(cpu_engine_seconds(tables));
        state.SetIterationTime(kernels.back());
    }
    state.SetLabel(device.report().name);
    state.counters["of_memset"] = median(fills) / median(kernels);
    state.counters["cpu_of_memset"] = median(fills) / median(cpus);
    state.counters["cpu_ns_per_voxel"] = median(cpus) * 1e9 / static_cast<double>(voxels);
    state.counters["bytes_per_voxel"] = 3 * sizeof(T);
    state.counters["ns_per_voxel"] = median(kernels) * 1e9 / static_cast<double>(voxels);
    state.counters["memset_GB_per_s"] = static_cast<double>(bytes) * 1e-9 / median(fills);
}

const auto f32 = dense_field<float>;
const auto f64 = dense_field<double>;
BENCHMARK_CAPTURE(f32, bump_all_in_contact, SurfaceKind::bump, -0.0612)->UseManualTime()->Iterations(15);
BENCHMARK_CAPTURE(f32, bump_half_in_contact, SurfaceKind::bump, -0.0256)->UseManualTime()->Iterations(15);
BENCHMARK_CAPTURE(f32, cylinder_bump, SurfaceKind::cylinder_bump, -0.0256)->UseManualTime()->Iterations(15);
BENCHMARK_CAPTURE(f32, gaussian_map_all_in_contact, SurfaceKind::height_map, -0.0612)->UseManualTime()->Iterations(15);
BENCHMARK_CAPTURE(f64, bump_all_in_contact, SurfaceKind::bump, -0.0612)->UseManualTime()->Iterations(9);

// The default grid, every y evaluated against one y.
void once_in_y(benchmark::State& state) {
    compute::Device device;
    compute::FieldKernel kernel(device);
    Scene scene = scene_of(256, -0.0256);
    scene.grid = GridSpec{};
    const FieldTables<float> full = make_tables<float>(scene, {}, Extent::everything);
    const FieldTables<float> once = make_tables<float>(scene, {}, Extent::what_varies);
    kernel_seconds(kernel, full);
    kernel_seconds(kernel, once);
    std::vector<double> full_seconds, once_seconds;
    for (auto _ : state) {
        full_seconds.push_back(kernel_seconds(kernel, full));
        once_seconds.push_back(kernel_seconds(kernel, once));
        state.SetIterationTime(once_seconds.back());
    }
    const double allowed = 1.2 / static_cast<double>(full.y.size()) * median(full_seconds) + 1e-4;
    state.counters["full_ms"] = median(full_seconds) * 1e3;
    state.counters["once_ms"] = median(once_seconds) * 1e3;
    state.counters["of_allowed"] = median(once_seconds) / allowed;
}

BENCHMARK(once_in_y)->UseManualTime()->Iterations(31);

} // namespace
} // namespace forceshade::bench
