#include <algorithm>

#include "compute/dispatch.h"
#include "compute/inputs.h"
#include "compute/plan.h"
#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

using layout::uint;

constexpr std::uint32_t kPathGroup = kGroup / 2;

// Batches of paths on their way through the device.
template <typename T> struct Paths {
    Dispatcher& dispatcher;
    const PathKernelOptions& options;
    const layout::PathInput<T>& input;
    const TakePaths<T>& take;
    FieldTimes& times;
    std::size_t pipeline;
    layout::PathBatch<T> batch{};

    std::size_t steps() const { return batch.longest ? batch.longest : input.steps; }
    std::size_t batch_paths() const;
    uint window() const;
    void submit(std::size_t step, uint window);
    void run_batch(std::size_t first);
    std::vector<layout::PathMetrics<T>> metrics() const;
};

// As many as the options say, and as tables fit into a buffer for.
template <typename T> std::size_t Paths<T>::batch_paths() const {
    const std::uint64_t harmonics = std::uint64_t(3) * input.features.harmonics * sizeof(layout::Harmonic<T>);
    const std::uint64_t most =
        dispatcher.report().buffer_range / std::max<std::uint64_t>(harmonics, sizeof(layout::PathState<T>));
    const std::size_t wanted = options.in_parts ? part_of(input.paths) : input.paths;
    return static_cast<std::size_t>(std::clamp<std::uint64_t>(most, 1, std::min(wanted, options.batch_paths)));
}

template <typename T> uint Paths<T>::window() const {
    if (options.steps != 0)
        return options.steps;
    // Each dispatch loads and stores every state: short windows would be mostly that.
    const std::uint64_t bytes = std::min<std::uint64_t>(options.chunk_bytes, dispatcher.report().buffer_range);
    const uint most = steps_of_dispatch(
        step_work(input.law.features, input.features, input.law.params.facets, sizeof(T)), batch.count, steps(), bytes);
    return options.in_parts ? std::min(most, static_cast<uint>(part_of_steps(steps()))) : most;
}

template <typename T> void Paths<T>::submit(std::size_t step, uint window) {
    dispatcher.begin(times);
    const Clock::time_point start = Clock::now();
    const std::size_t count = std::min<std::size_t>(window, steps() - step);
    layout::PathChunkParams chunk{};
    chunk.paths = static_cast<uint>(batch.count);
    chunk.step_first = static_cast<uint>(step);
    chunk.step_end = static_cast<uint>(step + count);
    chunk.steps = static_cast<uint>(steps());
    chunk.own_lengths = !batch.steps.empty();
    chunk.own_hands = input.hands.size() > 1;
    chunk.stretch = input.stretch;
    if (input.features.motion == layout::kMotionRecorded) {
        const Bytes positions = std::as_bytes(input.source->positions(step, std::min(count + 1, steps() - step)));
        dispatcher.put(layout::kPathBindRecorded, positions);
        times.uploaded += positions.size();
    }
    dispatcher.expect_channels(layout::kPathBindForce, input.features.channels, batch.count * count, sizeof(T));
    times.upload += seconds_since(start);
    // The dispatch before this one wrote the states.
    const Dispatcher::Run run{pipeline, divide_up(batch.count, kPathGroup), bytes_of(chunk), true, true};
    dispatcher.submit({&run, 1}, [this, step, count] {
        layout::PathChunk<T> results{};
        results.path_first = batch.first;
        results.path_count = results.pitch = batch.count;
        results.step_first = step;
        results.step_count = count;
        results.position = dispatcher.results<T>(layout::kPathBindPosition);
        dispatcher.put_results<T>(layout::kPathBindForce, results);
        take(results);
    });
}

template <typename T> void Paths<T>::run_batch(std::size_t first) {
    dispatcher.upload(times, [&](const PutTable& put) {
        batch = input.source->batch(first, std::min(batch_paths(), input.paths - first));
        put_batch_tables(input, batch, layout::kPathBindMotions, put);
        put(layout::kPathBindLengths, std::as_bytes(batch.steps));
        dispatcher.keep(layout::kPathBindStates, batch.count * sizeof(layout::PathState<T>), false);
    });
    const uint most = window();
    for (std::size_t step = 0; step < steps(); step += most)
        submit(step, most);
    dispatcher.finish(times);
}

template <typename T> std::vector<layout::PathMetrics<T>> Paths<T>::metrics() const {
    const auto* const states = reinterpret_cast<const layout::PathState<T>*>(dispatcher.kept(layout::kPathBindStates));
    std::vector<layout::PathMetrics<T>> metrics;
    metrics.reserve(batch.count);
    for (std::size_t path = 0; path < batch.count; ++path)
        metrics.push_back(states[path].metrics);
    return metrics;
}

} // namespace

PathKernel::PathKernel(Device& device, const PathKernelOptions& options)
    : dispatcher_(new Dispatcher(device, {layout::kPathBindCount, layout::kPathBindStatus,
                                          sizeof(layout::PathChunkParams), 2, options.force_staging})),
      options_(options) {}

PathKernel::~PathKernel() = default;

template <typename T>
FieldTimes PathKernel::explore(const layout::PathInput<T>& input, const TakePaths<T>& take,
                               const TakeMetrics<T>& take_metrics) {
    Dispatcher& dispatcher = *dispatcher_;
    check_precision<T>(dispatcher.report());
    dispatcher.poison(options_.in_parts);
    FieldTimes times;
    run_checked("evaluating paths", [&] {
        dispatcher.upload(times, [&](const PutTable& put) { put_path_tables(input.law, put); });
        const Code code =
            code_for<T>(dispatcher.report(), kernels::path_f32(), kernels::path_f32_exact(), kernels::path_f64());
        const std::size_t pipeline = dispatcher.pipeline(code, constants_of(kPathGroup, input), times);
        Paths<T> paths{dispatcher, options_, input, take, times, pipeline};
        dispatcher.complete(times, [&] {
            for (std::size_t first = 0; first < input.paths; first += paths.batch.count) {
                paths.run_batch(first);
                take_metrics(paths.batch.first, paths.metrics());
            }
        });
    });
    return times;
}

template FieldTimes PathKernel::explore<float>(const layout::PathInput<float>&, const TakePaths<float>&,
                                               const TakeMetrics<float>&);
template FieldTimes PathKernel::explore<double>(const layout::PathInput<double>&, const TakePaths<double>&,
                                                const TakeMetrics<double>&);

} // namespace forceshade::compute
