// Paths over a shaded bump of three facets: strokes at 100 mm/s and 1 kHz, 10 000 paths of 1 000 steps, on the device
// and on the CPU engine in turn, so that the ratio holds while the machine's speed drifts.
#include <cmath>
#include <ctime>

#include <benchmark/benchmark.h>

#include "compute/kernels.h"
#include "host/prepare/tables.h"
#include "host/reference/paths.h"
#include "tests/bench/measure.h"

namespace forceshade::bench {
namespace {

constexpr double kMil = 25.4e-6; /* m */
constexpr std::size_t kPaths = 10000, kSteps = 1000;

// Every path with a phase, a depth and a heading of its own.
template <typename T> class Strokes final : public layout::PathSource<T> {
public:
    explicit Strokes(std::size_t harmonics) {
        for (std::size_t i = 0; i < kPaths; ++i) {
            const double share = static_cast<double>(i) / kPaths, heading = 0.2 * (share - 0.5);
            layout::MotionParams<T> motion{};
            motion.heading_x = T(std::cos(heading));
            motion.heading_y = T(std::sin(heading));
            motion.reach = T(600 * kMil);
            motion.depth = motion.depth_back = T(1e-3 * (1 + share));
            motion.phase = static_cast<layout::uint>(share * 0x1p32);
            motion.phase_step = static_cast<layout::uint>(0x1p31 / 305);
            motions_.push_back(motion);
        }
        for (std::size_t i = 0; i < 3 * kPaths * harmonics; ++i) {
            amplitudes_.push_back(T(1e-5));
            phases_.push_back(static_cast<layout::uint>(i * 2654435761u));
            phase_steps_.push_back(static_cast<layout::uint>(0x1p32 / 100 * (1 + 1e-7 * static_cast<double>(i))));
        }
    }
    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        layout::PathBatch<T> batch{};
        batch.first = first;
        batch.count = count;
        batch.motions = motions_; // all of them: there is one batch
        batch.amplitudes = amplitudes_;
        batch.phases = phases_;
        batch.phase_steps = phase_steps_;
        return batch;
    }
    std::span<const T> positions(std::size_t, std::size_t) override { return {}; }

private:
    std::vector<layout::MotionParams<T>> motions_;
    std::vector<T> amplitudes_;
    std::vector<layout::uint> phases_, phase_steps_;
};

// 0.1 kg, 3 N s/m along all axes, no spring: the exact map over 1 ms. Pressed with 1 N.
template <typename T> layout::HandParams<T> hand() {
    constexpr double kMass = 0.1, kDamping = 3, kPeriod = 1e-3;
    const double decay = std::exp(-kDamping * kPeriod / kMass);
    const double q = kMass / kDamping * (1 - decay), p = (kPeriod - q) / kDamping, r = (1 - decay) / kDamping;
    layout::HandParams<T> hand{};
    hand.lateral = hand.vertical = {T(0), T(q), T(p), T(0), T(decay), T(r)};
    hand.rate = T(1 / kPeriod);
    hand.period = T(kPeriod);
    hand.damping = T(2);
    hand.push_z = T(-1);
    hand.max_force = T(8.5);
    hand.gain = T(1);
    hand.bound = T(1);
    return hand;
}

template <typename T> FieldTables<T> tables() {
    Scene scene;
    scene.surface.radius = 600 * kMil;
    scene.surface.width = 1000 * kMil;
    scene.surface.facets = 3;
    scene.force.shading = Shading::reference;
    scene.grid.size = {1, 1, 1};
    return make_tables<T>(scene, {}, Extent::everything);
}

// Time that the process had on all cores: what is left to compare by where others use them too.
template <typename Work> double core_seconds(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

template <typename T>
void paths(benchmark::State& state, layout::uint loop, layout::uint channels, layout::uint harmonics) {
    compute::Device device;
    compute::PathKernel kernel(device);
    const FieldTables<T> law = tables<T>();
    Strokes<T> source(harmonics);
    const layout::HandParams<T> one = hand<T>();
    layout::PathInput<T> input{law.law(), {}, {}, kPaths, kSteps, &source};
    input.features.loop = loop;
    input.features.channels = channels;
    input.features.harmonics = harmonics;
    input.stretch = 3e-5f; // what a scene's default would be
    if (loop == layout::kLoopClosed)
        input.hands = {&one, 1};
    std::uint64_t touched = 0;
    const auto take = [](const layout::PathChunk<T>&) {};
    const auto take_metrics = [&](std::size_t, std::span<const layout::PathMetrics<T>> metrics) {
        for (const layout::PathMetrics<T>& path : metrics)
            touched += path.contact_samples;
    };
    std::vector<double> gpu, cpu, gpu_core, cpu_core;
    const auto on_device = [&] { kernel.explore<T>(input, take, take_metrics); };
    on_device();
    for (auto _ : state) {
        gpu_core.push_back(core_seconds([&] { gpu.push_back(seconds(on_device)); }));
        cpu_core.push_back(core_seconds(
            [&] { cpu.push_back(seconds([&] { reference::evaluate_paths<T>(input, {}, take, take_metrics); })); }));
        state.SetIterationTime(gpu.back());
    }
    const double steps = static_cast<double>(kPaths * kSteps);
    state.SetLabel(device.report().name);
    state.counters["M_steps_per_s"] = 1e-6 * steps / median(gpu);
    state.counters["cpu_M_steps_per_s"] = 1e-6 * steps / median(cpu);
    state.counters["of_cpu"] = median(cpu) / median(gpu);
    state.counters["M_steps_per_core_s"] = 1e-6 * steps / median(gpu_core);
    state.counters["of_cpu_by_core_s"] = median(cpu_core) / median(gpu_core);
    state.counters["in_contact"] =
        static_cast<double>(touched) / steps / static_cast<double>(2 * gpu.size() + 1); // of all runs
}

// `harmonics` of each axis are added to the strokes: four are a tremor, sixteen as many as a random walk has.
constexpr layout::uint kSamples = layout::kChannelForce | layout::kChannelPosition;
const auto f32 = paths<float>;
const auto f64 = paths<double>;
BENCHMARK_CAPTURE(f32, open_metrics, layout::kLoopOpen, 0, 0)->UseManualTime()->Iterations(5);
BENCHMARK_CAPTURE(f32, open_samples, layout::kLoopOpen, kSamples, 0)->UseManualTime()->Iterations(5);
BENCHMARK_CAPTURE(f32, closed_metrics, layout::kLoopClosed, 0, 0)->UseManualTime()->Iterations(5);
BENCHMARK_CAPTURE(f32, closed_samples, layout::kLoopClosed, kSamples, 0)->UseManualTime()->Iterations(5);
BENCHMARK_CAPTURE(f32, tremor_metrics, layout::kLoopOpen, 0, 4)->UseManualTime()->Iterations(3);
BENCHMARK_CAPTURE(f32, sixteen_harmonics, layout::kLoopOpen, 0, 16)->UseManualTime()->Iterations(1);
BENCHMARK_CAPTURE(f64, open_metrics, layout::kLoopOpen, 0, 0)->UseManualTime()->Iterations(5);
BENCHMARK_CAPTURE(f64, closed_metrics, layout::kLoopClosed, 0, 0)->UseManualTime()->Iterations(5);

} // namespace
} // namespace forceshade::bench

BENCHMARK_MAIN();
