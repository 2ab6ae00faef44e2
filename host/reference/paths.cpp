#include "host/reference/field.h"

#include "host/reference/chunks.h"
#include "host/reference/contact.h"
#include "host/reference/friction.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"

namespace forceshade::reference {
namespace {

// Evaluated from one callback to the next: a second or so.
constexpr std::size_t kMostSamples = std::size_t(1) << 22;
// The same for one path: more at once are no quicker, and take memory.
constexpr std::size_t kMostSteps = std::size_t(1) << 16;

template <typename T> class ThreadedWalk final : public PathWalk<T> {
public:
    ThreadedWalk(const layout::PathInput<T>& input, const PathOptions& options)
        : input_(input), options_(options), threads_(threads_for(options.threads)),
          recorded_(input.features.motion == layout::kMotionRecorded) {}

    std::size_t begin(std::size_t first, std::size_t count) override {
        batch_ = input_.source->batch(first, count);
        states_.assign(batch_.count, {});
        proxies_.assign(on_mesh() ? batch_.count : 0, {});
        surfaces_.clear();
        if (input_.surface)
            surfaces_.assign(batch_.count, *input_.surface);
        for (std::size_t path = 0; path < surfaces_.size(); ++path)
            surfaces_[path].begin_path(batch_.first + path);
        step_ = 0;
        return batch_.count;
    }

    std::size_t steps() const override { return batch_.longest ? batch_.longest : input_.steps; }

    layout::PathChunk<T> walk(std::size_t most) override {
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
        samples_.set_spans(chunk);
        return chunk;
    }

    std::vector<layout::PathMetrics<T>> metrics() const override {
        std::vector<layout::PathMetrics<T>> metrics;
        metrics.reserve(states_.size());
        for (const layout::PathState<T>& path : states_)
            metrics.push_back(path.metrics);
        return metrics;
    }

private:
    bool on_mesh() const { return input_.law.features.surface == layout::kSurfaceMesh; }

    std::size_t bytes_per_sample() const {
        return SampleBuffers<T>::bytes_per_sample(input_.features.channels) + (recorded_ ? 3 * sizeof(T) : 0);
    }

    // Shares the batch's paths out among threads.
    void run_chunk(const layout::PathChunk<T>& chunk) {
        constexpr std::size_t kShare = 16; // paths that a thread takes at once
        samples_.resize(input_.features.channels, chunk.step_count * chunk.pitch);
        if (recorded_)
            positions_ =
                input_.source->positions(chunk.step_first, std::min(chunk.step_count + 1, steps() - chunk.step_first));
        std::vector<Neighbourhood<T>> neighbourhoods(threads_);
        share_out(threads_, (chunk.path_count + kShare - 1) / kShare, [&](std::size_t thread, std::size_t share) {
            const std::size_t end = std::min((share + 1) * kShare, chunk.path_count);
            for (std::size_t path = share * kShare; path < end; ++path)
                run_path(chunk, path, neighbourhoods[thread]);
        });
    }

    void run_path(const layout::PathChunk<T>& chunk, std::size_t path, Neighbourhood<T>& neighbourhood) {
        const BatchPath<T> moved{input_, batch_, path, positions_, chunk.step_first};
        const std::size_t steps = moved.steps(), end = std::min(chunk.step_first + chunk.step_count, steps);
        if (chunk.step_first >= end)
            return;
        const layout::HandParams<T> hand = moved.hand();
        const layout::MotionParams<T> motion = moved.motion();
        layout::PathState<T> state = states_[path];
        Vector<T> here = moved.at(chunk.step_first);
        if (chunk.step_first == 0) {
            state = begin_state(input_.features, hand, here);
            if (on_mesh())
                proxies_[path] = god_object_at(batch_.proxies[path]);
        }
        const auto evaluate_law = [&](const Vector<T>& probe) {
            LawContact<T> found = evaluate_at(path, probe, neighbourhood);
            if (!surfaces_.empty())
                surfaces_[path].add_to(found.contact, probe);
            return found;
        };
        for (std::size_t step = chunk.step_first; step < end; ++step) {
            const Vector<T> next = moved.after(step, here);
            const PathSampled<T> sampled =
                take_step(input_, hand, motion, state, here, next, static_cast<layout::uint>(steps), evaluate_law);
            const std::size_t sample = (step - chunk.step_first) * chunk.pitch + path;
            samples_.store(sample, sampled.contact, sampled.force);
            SampleBuffers<T>::put(samples_.position, sample, sampled.position);
            here = next;
        }
        states_[path] = state;
    }

    LawContact<T> evaluate_at(std::size_t path, const Vector<T>& probe, Neighbourhood<T>& neighbourhood) {
        if (!on_mesh())
            return {evaluate(input_.law, probe)};
        const Vector<T> local = to_mesh_frame(input_.law.mesh.params, probe);
        const auto [rest, trail] = update_with_trail(input_.law.mesh, proxies_[path], neighbourhood, local);
        return law_contact(input_.law, rest, probe, local, trail);
    }

    const layout::PathInput<T>& input_;
    const PathOptions& options_;
    const std::size_t threads_;
    const bool recorded_;
    layout::PathBatch<T> batch_{};
    std::size_t step_ = 0; // the next
    std::vector<layout::PathState<T>> states_;
    std::vector<GodObject<T>> proxies_;
    std::vector<SurfaceForces<T>> surfaces_; // of each path; empty: neither friction nor vibration
    std::span<const T> positions_;           // of a recorded batch, from the chunk's first step on
    SampleBuffers<T> samples_;
};

} // namespace

template <typename T>
std::unique_ptr<PathWalk<T>> make_path_walk(const layout::PathInput<T>& input, const PathOptions& options) {
    return std::make_unique<ThreadedWalk<T>>(input, options);
}

template <typename T>
void evaluate_paths(const layout::PathInput<T>& input, const PathOptions& options, const TakePaths<T>& take,
                    const TakeMetrics<T>& take_metrics) {
    const std::unique_ptr<PathWalk<T>> walk = make_path_walk(input, options);
    for (std::size_t first = 0, count = 0; first < input.paths; first += count) {
        count = walk->begin(first, std::min(options.batch_paths, input.paths - first));
        for (std::size_t step = 0; step < walk->steps();) {
            const layout::PathChunk<T> chunk = walk->walk(walk->steps() - step);
            take(chunk);
            step += chunk.step_count;
        }
        take_metrics(first, walk->metrics());
    }
}

template std::unique_ptr<PathWalk<float>> make_path_walk(const layout::PathInput<float>&, const PathOptions&);
template std::unique_ptr<PathWalk<double>> make_path_walk(const layout::PathInput<double>&, const PathOptions&);
template void evaluate_paths<float>(const layout::PathInput<float>&, const PathOptions&, const TakePaths<float>&,
                                    const TakeMetrics<float>&);
template void evaluate_paths<double>(const layout::PathInput<double>&, const PathOptions&, const TakePaths<double>&,
                                     const TakeMetrics<double>&);

FORCESHADE_GOD_OBJECT(, float)
FORCESHADE_GOD_OBJECT(, double)

} // namespace forceshade::reference
