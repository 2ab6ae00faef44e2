#include "host/reference/paths.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"

namespace forceshade::reference {
namespace {

// Samples of some steps of a batch, and what they are told to.
template <typename T> struct Samples {
    std::vector<T> position, force, depth, proxy;
    std::vector<layout::uint> facet;

    void resize(layout::uint channels, std::size_t count) {
        position.resize(channels & layout::kChannelPosition ? 3 * count : 0);
        force.resize(channels & layout::kChannelForce ? 3 * count : 0);
        depth.resize(channels & layout::kChannelDepth ? count : 0);
        facet.resize(channels & layout::kChannelFacet ? count : 0);
        proxy.resize(channels & layout::kChannelProxy ? 3 * count : 0);
    }

    void store(std::size_t at, const PathSampled<T>& sampled) {
        put(position, at, sampled.position);
        put(force, at, sampled.force);
        put(proxy, at, sampled.contact.proxy);
        if (!depth.empty())
            depth[at] = sampled.contact.depth;
        if (!facet.empty())
            facet[at] = sampled.contact.facet;
    }

private:
    static void put(std::vector<T>& buffer, std::size_t at, const Vector<T>& value) {
        if (buffer.empty())
            return;
        buffer[3 * at] = value.x;
        buffer[3 * at + 1] = value.y;
        buffer[3 * at + 2] = value.z;
    }
};

std::size_t sample_bytes(layout::uint channels, std::size_t real_size) {
    return (channels & layout::kChannelPosition ? 3 * real_size : 0) +
           (channels & layout::kChannelForce ? 3 * real_size : 0) + (channels & layout::kChannelDepth ? real_size : 0) +
           (channels & layout::kChannelFacet ? sizeof(layout::uint) : 0) +
           (channels & layout::kChannelProxy ? 3 * real_size : 0);
}

// Evaluated from one callback to the next: a second or so.
constexpr std::size_t kMostSamples = std::size_t(1) << 22;
// Likewise of a path: more at once are no quicker, and take memory.
constexpr std::size_t kMostSteps = std::size_t(1) << 16;

} // namespace

template <typename T> struct PathWalk<T>::State {
    State(const layout::PathInput<T>& input, const PathOptions& options)
        : input_(input), options_(options),
          threads_(options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency())),
          recorded_(input.features.motion == layout::kMotionRecorded) {}

    void begin(std::size_t first, std::size_t count) {
        batch_ = input_.source->batch(first, count);
        states_.assign(batch_.count, {});
        proxies_.assign(on_mesh() ? batch_.count : 0, {});
        step_ = 0;
    }

    std::size_t steps() const { return batch_.longest ? batch_.longest : input_.steps; }

    layout::PathChunk<T> walk(std::size_t most) {
        const std::size_t row = std::max<std::size_t>(1, batch_.count * bytes_per_sample());
        const std::size_t soon = std::clamp<std::size_t>(kMostSamples / batch_.count, 1, kMostSteps);
        layout::PathChunk<T> chunk{};
        chunk.path_first = batch_.first;
        chunk.path_count = chunk.pitch = batch_.count;
        chunk.step_first = step_;
        chunk.step_count =
            std::clamp<std::size_t>(options_.chunk_bytes / row, 1, std::min({most, soon, steps() - step_}));
        run_chunk(chunk);
        step_ += chunk.step_count;
        chunk.position = samples_.position;
        chunk.force = samples_.force;
        chunk.depth = samples_.depth;
        chunk.facet = samples_.facet;
        chunk.proxy = samples_.proxy;
        return chunk;
    }

    bool on_mesh() const { return input_.law.features.surface == layout::kSurfaceMesh; }

    std::size_t bytes_per_sample() const {
        return sample_bytes(input_.features.channels, sizeof(T)) + (recorded_ ? 3 * sizeof(T) : 0);
    }

    // Shares the batch's paths out among threads.
    void run_chunk(const layout::PathChunk<T>& chunk) {
        constexpr std::size_t kShare = 16; // paths that a thread takes at once
        samples_.resize(input_.features.channels, chunk.step_count * chunk.pitch);
        if (recorded_)
            positions_ =
                input_.source->positions(chunk.step_first, std::min(chunk.step_count + 1, steps() - chunk.step_first));
        std::atomic<std::size_t> next{0};
        const auto work = [&] {
            Neighbourhood<T> neighbourhood;
            for (std::size_t begin; (begin = kShare * next++) < chunk.path_count;)
                for (std::size_t path = begin; path < std::min(begin + kShare, chunk.path_count); ++path)
                    run_path(chunk, path, neighbourhood);
        };
        std::vector<std::jthread> helpers;
        for (std::size_t i = 1; i < threads_; ++i)
            helpers.emplace_back(work);
        work();
    }

    std::size_t steps_of(std::size_t path) const {
        return batch_.steps.empty() ? input_.steps : std::size_t(batch_.steps[path]);
    }

    // The motion's place at a step; a recorded path rests where it ends.
    Vector<T> target(const layout::PathChunk<T>& chunk, std::size_t path, std::size_t step) const {
        if (!recorded_)
            return motion_at(input_.law, input_.features, batch_, path, static_cast<layout::uint>(step));
        const std::size_t last = std::min(step, steps_of(path) - 1);
        return vector_at(positions_, (last - chunk.step_first) * batch_.count + path);
    }

    void run_path(const layout::PathChunk<T>& chunk, std::size_t path, Neighbourhood<T>& neighbourhood) {
        const std::size_t steps = steps_of(path), end = std::min(chunk.step_first + chunk.step_count, steps);
        if (chunk.step_first >= end)
            return;
        const bool closed = input_.features.loop == layout::kLoopClosed;
        const std::size_t hands = input_.hands.size();
        const layout::HandParams<T> hand =
            hands == 0 ? layout::HandParams<T>{} : input_.hands[hands == 1 ? 0 : batch_.first + path];
        const layout::MotionParams<T> motion = recorded_ ? layout::MotionParams<T>{} : batch_.motions[path];
        layout::PathState<T> state = states_[path];
        Vector<T> here = target(chunk, path, chunk.step_first);
        if (chunk.step_first == 0) {
            state = begin_state(input_.features, hand, here);
            if (on_mesh())
                proxies_[path] = god_object_at(batch_.proxies[path]);
        }
        const auto evaluate_law = [&](const Vector<T>& probe) { return evaluate_at(path, probe, neighbourhood); };
        for (std::size_t step = chunk.step_first; step < end; ++step) {
            const bool last = step + 1 == steps;
            const Vector<T> next = closed || !last ? target(chunk, path, last && recorded_ ? step : step + 1) : here;
            const PathSampled<T> sampled =
                take_step(input_, hand, motion, state, here, next, static_cast<layout::uint>(steps), evaluate_law);
            samples_.store((step - chunk.step_first) * chunk.pitch + path, sampled);
            here = next;
        }
        states_[path] = state;
    }

    LawContact<T> evaluate_at(std::size_t path, const Vector<T>& probe, Neighbourhood<T>& neighbourhood) {
        if (!on_mesh())
            return {evaluate(input_.law, probe), true};
        const Vector<T> local = to_mesh_frame(input_.law.mesh.params, probe);
        const GodObjectContact<T> rest = update(input_.law.mesh, proxies_[path], neighbourhood, local);
        LawContact<T> evaluated{mesh_contact(input_.law, rest, local), rest.finished};
        if (evaluated.contact.facet == layout::kNoFacet)
            evaluated.contact.proxy = probe; // not there and back through the mesh's frame
        return evaluated;
    }

    const layout::PathInput<T>& input_;
    const PathOptions& options_;
    const std::size_t threads_;
    const bool recorded_;
    layout::PathBatch<T> batch_{};
    std::size_t step_ = 0; // the next
    std::vector<layout::PathState<T>> states_;
    std::vector<GodObject<T>> proxies_;
    std::span<const T> positions_; // of a recorded batch, from the chunk's first step on
    Samples<T> samples_;
};

template <typename T>
PathWalk<T>::PathWalk(const layout::PathInput<T>& input, const PathOptions& options)
    : state_(std::make_unique<State>(input, options)) {}
template <typename T> PathWalk<T>::~PathWalk() = default;

template <typename T> std::size_t PathWalk<T>::begin(std::size_t first, std::size_t count) {
    state_->begin(first, count);
    return state_->batch_.count;
}

template <typename T> std::size_t PathWalk<T>::steps() const {
    return state_->steps();
}

template <typename T> layout::PathChunk<T> PathWalk<T>::walk(std::size_t most) {
    return state_->walk(most);
}

template <typename T> std::vector<layout::PathMetrics<T>> PathWalk<T>::metrics() const {
    std::vector<layout::PathMetrics<T>> metrics;
    metrics.reserve(state_->states_.size());
    for (const layout::PathState<T>& path : state_->states_)
        metrics.push_back(path.metrics);
    return metrics;
}

template <typename T>
void evaluate_paths(const layout::PathInput<T>& input, const PathOptions& options, const TakePaths<T>& take,
                    const TakeMetrics<T>& take_metrics) {
    PathWalk<T> walk(input, options);
    for (std::size_t first = 0, count = 0; first < input.paths; first += count) {
        count = walk.begin(first, std::min(options.batch_paths, input.paths - first));
        for (std::size_t step = 0; step < walk.steps();) {
            const layout::PathChunk<T> chunk = walk.walk(walk.steps() - step);
            take(chunk);
            step += chunk.step_count;
        }
        take_metrics(first, walk.metrics());
    }
}

template class PathWalk<float>;
template class PathWalk<double>;
template void evaluate_paths<float>(const layout::PathInput<float>&, const PathOptions&, const TakePaths<float>&,
                                    const TakeMetrics<float>&);
template void evaluate_paths<double>(const layout::PathInput<double>&, const PathOptions&, const TakePaths<double>&,
                                     const TakeMetrics<double>&);

} // namespace forceshade::reference
