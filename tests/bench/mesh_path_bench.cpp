// Paths over a sphere of 25 mm radius and 100 820 triangles: circles 1 mm deep round it in every direction, 0.1 mm a
// step, 10 000 paths of 1 000 steps, on the device and on the CPU engine in turn, so that the ratio holds while the
// machine's speed drifts. And circles through the model spot, over edges and corners, where the host finishes the
// updates.
#include <cmath>
#include <ctime>

#include <benchmark/benchmark.h>

#include "compute/kernels.h"
#include "host/mesh/mesh_file.h"
#include "host/mesh/structure.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"
#include "host/reference/paths.h"
#include "tests/bench/geodesic.h"
#include "tests/bench/measure.h"
#include "tests/mesh/shapes.h"

namespace forceshade::bench {
namespace {

constexpr std::size_t kPaths = 10000, kSteps = 1000;
constexpr double kRadius = 0.025; /* m */
constexpr double kDepth = 0.001;  /* m */
constexpr double kStep = 0.0001;  /* m a step */

// What circles lead round or through.
struct Course {
    const MeshStructure& structure;
    double radius; /* m: of the sphere that the circles are on */
    double step;   /* m */
    std::size_t paths, steps;
};

const MeshStructure& ball() {
    static const MeshStructure structure = [] {
        PolygonSoup sphere = geodesic(71);
        for (glm::dvec3& vertex : sphere.vertices)
            vertex *= kRadius;
        return build_structure(shapes::mesh_of(std::move(sphere)));
    }();
    return structure;
}

const MeshStructure& spot() {
    static const MeshStructure structure =
        build_structure(shapes::mesh_of(read_polygons(FORCESHADE_DATA "/spot.obj").polygons));
    return structure;
}

// Circles about the vertical, at every latitude but near the poles, each begun at a longitude of its own.
template <typename T> class Circles final : public layout::PathSource<T> {
public:
    Circles(const layout::Law<T>& law, const Course& course) {
        reference::Neighbourhood<T> around;
        layout::PathFeatures features;
        features.motion = layout::kMotionCircle;
        for (std::size_t i = 0; i < course.paths; ++i) {
            const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(course.paths);
            const double height = 1.6 * share - 0.8, ring = course.radius * std::sqrt(1 - height * height);
            layout::MotionParams<T> motion{};
            motion.heading_x = T(1);
            motion.reach = T(ring);
            motion.centre_z = T(course.radius * height);
            motion.phase = static_cast<layout::uint>(std::fmod(share * 6180.3, 1.0) * 0x1p32);
            motion.phase_step = static_cast<layout::uint>(course.step / (2 * 3.141592653589793 * ring) * 0x1p32);
            motions_.push_back(motion);
            layout::PathBatch<T> one{};
            one.count = 1;
            one.motions = {&motion, 1};
            const reference::Vector<T> probe = reference::motion_at(law, features, one, 0, 0U);
            proxies_.push_back(reference::proxy_start(law, around, reference::to_mesh_frame(law.mesh.params, probe)));
        }
    }
    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        layout::PathBatch<T> batch{};
        batch.first = first;
        batch.count = count;
        batch.motions = std::span(motions_).subspan(first, count);
        batch.proxies = std::span(proxies_).subspan(first, count);
        return batch;
    }
    std::span<const T> positions(std::size_t, std::size_t) override { return {}; }

private:
    std::vector<layout::MotionParams<T>> motions_;
    std::vector<layout::ProxyStart<T>> proxies_;
};

// Time that the process had on all cores: what is left to compare by where others use them too.
template <typename Work> double core_seconds(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

template <typename T> void run(benchmark::State& state, const Course& course, layout::uint channels) {
    const MeshTables<T> tables = make_mesh_tables<T>(course.structure, 500.0);
    layout::PathInput<T> input{};
    input.law.features.surface = layout::kSurfaceMesh;
    input.law.mesh = tables.view();
    input.features.motion = layout::kMotionCircle;
    input.features.channels = channels;
    input.paths = course.paths;
    Circles<T> source(input.law, course);
    input.source = &source;
    compute::Device device;
    compute::MeshPathKernel kernel(device);
    std::uint64_t touched = 0;
    const auto take = [](const layout::PathChunk<T>&) {};
    const auto take_metrics = [&](std::size_t, std::span<const layout::PathMetrics<T>> metrics) {
        for (const layout::PathMetrics<T>& path : metrics)
            touched += path.contact_samples;
    };
    const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> updates) {
        reference::finish_updates(input.law.mesh, updates, 2);
    };
    compute::MeshPathTimes times;
    const auto on_device = [&] { times = kernel.explore<T>(input, finish, take, take_metrics); };
    input.steps = 20; // compiles
    on_device();
    input.steps = course.steps;
    touched = 0;
    std::vector<double> gpu, cpu, gpu_core, cpu_core;
    for (auto _ : state) {
        gpu_core.push_back(core_seconds([&] { gpu.push_back(seconds(on_device)); }));
        cpu_core.push_back(core_seconds(
            [&] { cpu.push_back(seconds([&] { reference::evaluate_paths<T>(input, {}, take, take_metrics); })); }));
        state.SetIterationTime(gpu.back());
    }
    const double steps = static_cast<double>(course.paths * course.steps);
    state.SetLabel(device.report().name);
    state.counters["M_steps_per_s"] = 1e-6 * steps / median(gpu);
    state.counters["cpu_M_steps_per_s"] = 1e-6 * steps / median(cpu);
    state.counters["of_cpu"] = median(cpu) / median(gpu);
    state.counters["M_steps_per_core_s"] = 1e-6 * steps / median(gpu_core);
    state.counters["of_cpu_by_core_s"] = median(cpu_core) / median(gpu_core);
    state.counters["in_contact"] = static_cast<double>(touched) / steps / static_cast<double>(2 * gpu.size());
    state.counters["upload_s"] = times.upload;
    state.counters["host_updates"] = static_cast<double>(times.host_updates) / steps;
}

template <typename T> void circles(benchmark::State& state, layout::uint channels) {
    run<T>(state, {ball(), kRadius - kDepth, kStep, kPaths, kSteps}, channels);
}

template <typename T> void through_spot(benchmark::State& state, layout::uint channels) {
    run<T>(state, {spot(), 0.4, 0.005, kPaths, 300}, channels);
}

const auto f32 = circles<float>;
const auto f64 = circles<double>;
BENCHMARK_CAPTURE(f32, metrics, 0)->UseManualTime()->Iterations(3);
BENCHMARK_CAPTURE(f32, force, layout::kChannelForce)->UseManualTime()->Iterations(3);
BENCHMARK_CAPTURE(f64, metrics, 0)->UseManualTime()->Iterations(3);
const auto spot_f32 = through_spot<float>;
const auto spot_f64 = through_spot<double>;
BENCHMARK_CAPTURE(spot_f32, metrics, 0)->UseManualTime()->Iterations(3);
BENCHMARK_CAPTURE(spot_f64, metrics, 0)->UseManualTime()->Iterations(3);

} // namespace
} // namespace forceshade::bench

BENCHMARK_MAIN();
