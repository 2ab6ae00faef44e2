// Paths over analytic surfaces and on meshes.
#include <algorithm>
#include <cstring>
#include <optional>

#include "compute/dispatch.h"
#include "compute/plan.h"
#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

using layout::uint;

// What the states of a batch's paths hold.
template <typename T> std::vector<layout::PathMetrics<T>> metrics_of(const std::byte* states, std::size_t paths) {
    const std::span all(reinterpret_cast<const layout::PathState<T>*>(states), paths);
    std::vector<layout::PathMetrics<T>> metrics(paths);
    std::ranges::transform(all, metrics.begin(), &layout::PathState<T>::metrics);
    return metrics;
}

// Batches of paths on their way through the device.
template <typename T> struct Paths {
    Dispatcher& dispatcher;
    const KernelOptions& options;
    const layout::PathInput<T>& input;
    const TakePaths<T>& take;
    FieldTimes& times;
    std::size_t pipeline;
    layout::PathBatch<T> batch{};

    std::size_t steps() const { return batch.longest ? batch.longest : input.steps; }
    std::size_t batch_paths() const;
    uint window() const;
    std::size_t submit(std::size_t step, std::size_t most);
    void run_batch(std::size_t first);
    std::vector<layout::PathMetrics<T>> metrics() const {
        return metrics_of<T>(dispatcher.kept(layout::kPathBindStates), batch.count);
    }
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
    const std::uint64_t bytes =
        std::min<std::uint64_t>(dispatcher.fitting(options.chunk_bytes), dispatcher.report().buffer_range);
    const uint most = steps_of_dispatch(
        step_work(input.law.features, input.features, input.law.params.facets, sizeof(T)), batch.count, steps(), bytes);
    return options.in_parts ? std::min(most, static_cast<uint>(part_of_steps(steps()))) : most;
}

// Up to `most` steps from `step` on, fewer where the device is short of memory; returns how many.
template <typename T> std::size_t Paths<T>::submit(std::size_t step, std::size_t most) {
    dispatcher.begin(times);
    const Clock::time_point start = Clock::now();
    std::size_t count = most;
    const auto reserve = [&] {
        if (input.features.motion == layout::kMotionRecorded)
            dispatcher.put(layout::kPathBindRecorded,
                           std::as_bytes(input.source->positions(step, std::min(count + 1, steps() - step))));
        dispatcher.expect_channels(layout::kPathBindForce, input.features.channels, batch.count * count, sizeof(T));
    };
    dispatcher.fit(reserve, [&] { return (count /= 2) != 0; });
    if (input.features.motion == layout::kMotionRecorded)
        times.uploaded += 3 * sizeof(T) * batch.count * std::min(count + 1, steps() - step);
    layout::PathChunkParams chunk{};
    chunk.paths = static_cast<uint>(batch.count);
    chunk.step_first = static_cast<uint>(step);
    chunk.step_end = static_cast<uint>(step + count);
    chunk.steps = static_cast<uint>(steps());
    chunk.own_lengths = !batch.steps.empty();
    chunk.own_hands = input.hands.size() > 1;
    chunk.stretch = input.stretch;
    times.upload += seconds_since(start);
    // The dispatch before this one wrote the states.
    const Dispatcher::Run run{pipeline, batch.count, bytes_of(chunk), true, true};
    dispatcher.submit({&run, 1}, count, [this, step, count] {
        layout::PathChunk<T> results{};
        results.path_first = batch.first;
        results.path_count = results.pitch = batch.count;
        results.step_first = step;
        results.step_count = count;
        results.position = dispatcher.results<T>(layout::kPathBindPosition);
        dispatcher.put_results<T>(layout::kPathBindForce, results);
        take(results);
    });
    return count;
}

template <typename T> void Paths<T>::run_batch(std::size_t first) {
    dispatcher.upload(times, [&](const PutTable& put) {
        batch = input.source->batch(first, std::min(batch_paths(), input.paths - first));
        put_batch_tables(input, batch, layout::kPathBindMotions, put);
        put(layout::kPathBindLengths, std::as_bytes(batch.steps));
        dispatcher.keep(layout::kPathBindStates, batch.count * sizeof(layout::PathState<T>), false);
    });
    const uint most = window();
    for (std::size_t step = 0, count = 0; step < steps(); step += count) {
        count = submit(step, std::min<std::size_t>(dispatcher.paced(most), steps() - step));
    }
    dispatcher.finish(times);
}

constexpr std::uint32_t kLeastListed = 64;                     // paths of a dispatch
constexpr std::size_t kMostPathSamples = std::size_t(1) << 24; // from one callback to the next

// A batch of paths on its way through its steps: what the kernels remember of each, and what they wrote. Memory that
// the host sees.
template <typename T> class Batch {
public:
    // The paths before their first steps, and room for `rows` steps of results and, if recorded, of positions.
    Batch(Dispatcher& dispatcher, const layout::PathInput<T>& input, const layout::PathBatch<T>& paths,
          const KernelOptions& options)
        : dispatcher_(dispatcher), channels_(input.features.channels), poisoned_(options.in_parts), first_(paths.first),
          paths_(paths.count), steps_(paths.longest ? paths.longest : input.steps) {
        const bool recorded = input.features.motion == layout::kMotionRecorded;
        const std::size_t facet = channels_ & layout::kChannelFacet ? sizeof(uint) : 0;
        const std::size_t reals = bytes_per_sample(channels_, sizeof(T)).all - facet;
        const std::size_t row = paths_ * (reals + facet + (recorded ? 3 * sizeof(T) : 0));
        const std::size_t wanted = options.in_parts ? part_of_steps(steps_) : steps_;
        const std::size_t most = std::clamp<std::size_t>(kMostPathSamples / paths_, 1, wanted);
        rows_ = std::clamp<std::size_t>(options.chunk_bytes / std::max<std::size_t>(row, 1), 1, most);
        const std::size_t words = layout::kWalkWordCount * paths_;
        words_ = share<uint>(layout::kMeshPathBindWalkWords, words + 1 + paths_);
        reals_ = share<T>(layout::kMeshPathBindWalkReals, layout::kWalkRealCount * paths_);
        states_ = share<layout::PathState<T>>(layout::kMeshPathBindStates, paths_);
        const auto reserve = [&] {
            recorded_ = share<T>(layout::kMeshPathBindRecorded, recorded ? 3 * (rows_ + 1) * paths_ : 0);
            samples_ = share_results(layout::kMeshPathBindSamples, reals);
            facets_ = share_results(layout::kMeshPathBindFacet, facet);
        };
        dispatcher.fit(reserve, [&] { return (rows_ /= 2) != 0; });
        std::memset(words_, 0, (words + 1) * sizeof(uint));
        std::memset(reals_, 0, layout::kWalkRealCount * paths_ * sizeof(T));
        std::memset(static_cast<void*>(states_), 0, paths_ * sizeof(layout::PathState<T>));
        for (std::size_t path = 0; path < paths_; ++path) {
            const layout::ProxyStart<T>& start = paths.proxies[path];
            word(layout::kWalkWordSteps, path) = paths.steps.empty() ? static_cast<uint>(steps_) : paths.steps[path];
            real(layout::kWalkRealProxy, path) = start.x;
            real(layout::kWalkRealProxy + 1, path) = start.y;
            real(layout::kWalkRealProxy + 2, path) = start.z;
        }
        flush(layout::kMeshPathBindStates);
    }

    std::size_t first() const { return first_; }
    std::size_t paths() const { return paths_; }
    std::size_t rows() const { return rows_; }
    std::size_t steps() const { return steps_; }

    // Before the first dispatch of some steps.
    void poison() {
        if (!poisoned_)
            return;
        std::ranges::fill(samples_, Dispatcher::kPoison);
        std::ranges::fill(facets_, Dispatcher::kPoison);
        dispatcher_.flush(layout::kMeshPathBindSamples);
        dispatcher_.flush(layout::kMeshPathBindFacet);
    }

    void put_positions(std::span<const T> positions) {
        std::memcpy(recorded_, positions.data(), positions.size_bytes());
        dispatcher_.flush(layout::kMeshPathBindRecorded);
    }

    // Lists the paths that have not reached `step_end` or their end; returns their number.
    std::size_t list_waiting(std::uint32_t step_end) {
        dispatcher_.kept(layout::kMeshPathBindWalkWords);
        uint* const list = words_ + layout::kWalkWordCount * paths_ + 1;
        std::size_t count = 0;
        for (std::size_t path = 0; path < paths_; ++path)
            if (word(layout::kWalkWordStep, path) < std::min(step_end, word(layout::kWalkWordSteps, path)))
                list[count++] = static_cast<uint>(path);
        dispatcher_.flush(layout::kMeshPathBindWalkWords);
        return count;
    }

    // Loops that a driver ended. \throws DeviceError (unfinished).
    void check_status() const {
        dispatcher_.kept(layout::kMeshPathBindWalkWords);
        if (word(layout::kWalkWordCount, 0) & layout::kStatusUnfinished)
            throw DeviceError(DeviceError::Kind::unfinished,
                              "the device's driver ended a loop of the kernel before its work was done; do "
                              "not trust these paths");
    }

    // Lets the host do the updates that are left to it; gives how many they were.
    std::size_t finish_updates(const FinishUpdates<T>& finish);

    // The results of steps [step_first, step_first + step_count).
    layout::PathChunk<T> chunk(std::size_t step_first, std::size_t step_count) const;

    std::vector<layout::PathMetrics<T>> metrics() const {
        return metrics_of<T>(dispatcher_.kept(layout::kMeshPathBindStates), paths_);
    }

private:
    uint& word(uint field, std::size_t path) const { return words_[field * paths_ + path]; }
    T& real(uint field, std::size_t path) const { return reals_[field * paths_ + path]; }
    template <typename Value> Value* share(uint binding, std::size_t values) {
        const std::size_t bytes = std::max<std::size_t>(values * sizeof(Value), 16);
        return reinterpret_cast<Value*>(dispatcher_.keep(binding, bytes, true));
    }
    std::span<uint> share_results(uint binding, std::size_t sample_bytes) {
        const std::size_t behind = poisoned_ && sample_bytes != 0 ? Dispatcher::kPoisonBehind : 0;
        const std::size_t words = (sample_bytes * rows_ * paths_ + behind) / sizeof(uint);
        return {share<uint>(binding, words), words};
    }
    void flush(uint more) {
        for (const uint binding : {layout::kMeshPathBindWalkWords, layout::kMeshPathBindWalkReals, more})
            dispatcher_.flush(binding);
    }

    Dispatcher& dispatcher_;
    uint channels_;
    bool poisoned_;
    std::size_t first_, paths_, steps_, rows_ = 0;
    std::span<uint> samples_, facets_; // results, as words
    uint* words_;
    T *reals_, *recorded_;
    layout::PathState<T>* states_;
};

template <typename T> std::size_t Batch<T>::finish_updates(const FinishUpdates<T>& finish) {
    dispatcher_.kept(layout::kMeshPathBindWalkReals);
    std::vector<std::size_t> paths;
    std::vector<layout::MeshUpdate<T>> updates;
    for (std::size_t path = 0; path < paths_; ++path) {
        if (word(layout::kWalkWordPhase, path) != layout::kPhaseHost)
            continue;
        layout::MeshUpdate<T> update{};
        for (uint i = 0; i < 3; ++i) {
            update.probe[i] = real(layout::kWalkRealProbe + i, path);
            update.proxy[i] = real(layout::kWalkRealProxy + i, path);
            update.triangles[i] = word(layout::kWalkWordTriangles + i, path);
        }
        update.count = word(layout::kWalkWordConstraints, path) & layout::kConstraintCount;
        update.cornered = (word(layout::kWalkWordConstraints, path) & layout::kConstraintCornered) != 0;
        paths.push_back(path);
        updates.push_back(update);
    }
    if (paths.empty())
        return 0;
    finish(updates);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const std::size_t path = paths[i];
        const layout::MeshUpdate<T>& update = updates[i];
        for (uint axis = 0; axis < 3; ++axis) {
            real(layout::kWalkRealProxy + axis, path) = update.proxy[axis];
            real(layout::kWalkRealContact + axis, path) = update.rest[axis];
            word(layout::kWalkWordTriangles + axis, path) = update.triangles[axis];
            real(layout::kWalkRealFree + axis, path) = update.proxy[axis];
        }
        real(layout::kWalkRealReach, path) = update.reach;
        word(layout::kWalkWordContact, path) = update.triangle;
        word(layout::kWalkWordTrail, path) = update.trail;
        word(layout::kWalkWordConstraints, path) = update.count | (update.cornered ? layout::kConstraintCornered : 0) |
                                                   (update.touching ? layout::kContactTouching : 0) |
                                                   (update.back ? layout::kContactBack : 0) |
                                                   (update.finished ? 0 : layout::kContactUnfinished);
        word(layout::kWalkWordPhase, path) = layout::kPhaseContact;
    }
    flush(layout::kMeshPathBindWalkReals);
    return paths.size();
}

template <typename T> layout::PathChunk<T> Batch<T>::chunk(std::size_t step_first, std::size_t step_count) const {
    layout::PathChunk<T> chunk{};
    chunk.path_first = first_;
    chunk.path_count = chunk.pitch = paths_;
    chunk.step_first = step_first;
    chunk.step_count = step_count;
    const T* from = reinterpret_cast<const T*>(dispatcher_.kept(layout::kMeshPathBindSamples));
    dispatcher_.kept(layout::kMeshPathBindFacet);
    for (const std::span<uint> results : {samples_, facets_})
        if (poisoned_ && !results.empty())
            require_poison(std::as_bytes(results).last(Dispatcher::kPoisonBehind));
    const auto take = [&](uint bit, std::size_t width, std::span<const T>& values) {
        if (!(channels_ & bit))
            return;
        values = {from, width * step_count * paths_};
        from += width * rows_ * paths_;
    };
    take(layout::kChannelPosition, 3, chunk.position);
    take(layout::kChannelForce, 3, chunk.force);
    take(layout::kChannelDepth, 1, chunk.depth);
    take(layout::kChannelProxy, 3, chunk.proxy);
    if (channels_ & layout::kChannelFacet)
        chunk.facet = {reinterpret_cast<const uint*>(dispatcher_.kept(layout::kMeshPathBindFacet)),
                       step_count * paths_};
    return chunk;
}

} // namespace

PathKernel::PathKernel(Device& device, const KernelOptions& options)
    : Kernel(device, options, {layout::kPathBindCount, layout::kPathBindStatus, sizeof(layout::PathChunkParams), 32}) {}

template <typename T>
FieldTimes PathKernel::explore(const layout::PathInput<T>& input, const TakePaths<T>& take,
                               const TakeMetrics<T>& take_metrics) {
    Dispatcher& dispatcher = *dispatcher_;
    return run_kernel<T>(dispatcher, options_.in_parts, "evaluating paths", [&](FieldTimes& times) {
        dispatcher.upload(times, [&](const PutTable& put) { put_path_tables(input.law, put); });
        const Code code =
            code_for<T>(dispatcher.report(), kernels::path_f32(), kernels::path_f32_exact(), kernels::path_f64());
        const std::size_t pipeline = dispatcher.pipeline(code, constants_of(input), times);
        Paths<T> paths{dispatcher, options_, input, take, times, pipeline};
        dispatcher.complete(times, [&] {
            for (std::size_t first = 0; first < input.paths; first += paths.batch.count) {
                paths.run_batch(first);
                take_metrics(paths.batch.first, paths.metrics());
            }
        });
    });
}

template FieldTimes PathKernel::explore<float>(const layout::PathInput<float>&, const TakePaths<float>&,
                                               const TakeMetrics<float>&);
template FieldTimes PathKernel::explore<double>(const layout::PathInput<double>&, const TakePaths<double>&,
                                                const TakeMetrics<double>&);

MeshPathKernel::MeshPathKernel(Device& device, const KernelOptions& options)
    : Kernel(device, options,
             {layout::kMeshPathBindCount, DispatchShape::kNoStatus, sizeof(layout::MeshPathChunkParams), 64, 1}) {}

template <typename T>
FieldTimes MeshPathKernel::explore(const layout::PathInput<T>& input, const FinishUpdates<T>& finish,
                                   const TakePaths<T>& take, const TakeMetrics<T>& take_metrics) {
    Dispatcher& dispatcher = *dispatcher_;
    return run_kernel<T>(dispatcher, options_.in_parts, "evaluating paths", [&](FieldTimes& times) {
        const FacetLoops loops = facet_loops(input.law.features, input.law.mesh.facet_begins);
        layout::MeshPathChunkParams chunk{};
        chunk.own_hands = input.hands.size() > 1;
        chunk.pause = static_cast<uint>(options_.in_parts ? part_of(options_.pause) : options_.pause);
        chunk.limit = options_.limit;
        chunk.stretch = input.stretch;
        dispatcher.upload(times, [&](const PutTable& put) { chunk.vertices = put_mesh_path_tables(input.law, put); });
        const Code code = code_for<T>(dispatcher.report(), kernels::mesh_path_f32(), kernels::mesh_path_f32_exact(),
                                      kernels::mesh_path_f64());
        const Constants constants = constants_of(input, loops);
        const std::size_t pipeline = dispatcher.pipeline(code, constants, times);
        const std::size_t most = std::min(options_.batch_paths, options_.in_parts ? part_of(input.paths) : input.paths);
        for (std::size_t first = 0; first < input.paths;) {
            std::optional<Batch<T>> begun;
            dispatcher.upload(times, [&](const PutTable& put) {
                const layout::PathBatch<T> tables = input.source->batch(first, std::min(most, input.paths - first));
                put_batch_tables(input, tables, layout::kMeshPathBindMotions, put);
                begun.emplace(dispatcher, input, tables, options_);
            });
            Batch<T>& batch = *begun;
            for (std::size_t step = 0; step < batch.steps(); step += batch.rows()) {
                const std::size_t count = std::min(batch.rows(), batch.steps() - step);
                batch.poison();
                if (input.features.motion == layout::kMotionRecorded) {
                    const auto positions = input.source->positions(step, std::min(count + 1, batch.steps() - step));
                    batch.put_positions(positions);
                    times.uploaded += positions.size_bytes();
                }
                chunk.paths = static_cast<std::uint32_t>(batch.paths());
                chunk.row_first = static_cast<std::uint32_t>(step);
                chunk.rows = static_cast<std::uint32_t>(batch.rows());
                chunk.step_end = static_cast<std::uint32_t>(step + count);
                // Every path as far as one dispatch goes, until all have reached the end.
                while ((chunk.listed = static_cast<std::uint32_t>(batch.list_waiting(chunk.step_end))) != 0) {
                    const auto next = static_cast<uint>(dispatcher.paced(chunk.listed)); // the others' turn comes
                    chunk.listed = std::min(chunk.listed, std::max(next, kLeastListed));
                    const Dispatcher::Run run{pipeline, chunk.listed, bytes_of(chunk)};
                    dispatcher.complete(times, [&] {
                        dispatcher.begin(times);
                        dispatcher.submit({&run, 1}, chunk.listed, [] {});
                    });
                    batch.check_status();
                    times.host_updates += batch.finish_updates(finish);
                }
                take(batch.chunk(step, count));
            }
            take_metrics(batch.first(), batch.metrics());
            first += batch.paths();
        }
    });
}

template FieldTimes MeshPathKernel::explore<float>(const layout::PathInput<float>&, const FinishUpdates<float>&,
                                                   const TakePaths<float>&, const TakeMetrics<float>&);
template FieldTimes MeshPathKernel::explore<double>(const layout::PathInput<double>&, const FinishUpdates<double>&,
                                                    const TakePaths<double>&, const TakeMetrics<double>&);

} // namespace forceshade::compute
