#include "host/study/omission/path_side.h"

#include <chrono>

#include "host/study/omission/field_side.h"

namespace forceshade::study {
namespace {

using Clock = std::chrono::steady_clock;

// A chunk's channel, by step, to its places by path.
template <typename Value, typename T>
void take(const layout::PathChunk<T>& chunk, std::span<const Value> channel, std::size_t components, std::size_t steps,
          std::size_t paths, std::vector<Value>& into) {
    if (channel.empty())
        return;
    into.resize(paths * steps * components);
    for (std::size_t step = 0; step < chunk.step_count; ++step)
        for (std::size_t path = 0; path < chunk.path_count; ++path) {
            const auto from = channel.subspan((step * chunk.pitch + path) * components, components);
            const std::size_t to = (chunk.path_first + path) * steps + chunk.step_first + step;
            std::ranges::copy(from, into.begin() + std::ptrdiff_t(to * components));
        }
}

} // namespace

template <typename T> PathSide<T>::PathSide(const Setup& setup) : setup_(setup) {
    paths_ = std::make_unique<ScenePaths<T>>(setup.prepared);
}

template <typename T> layout::PathInput<T> PathSide<T>::input() {
    layout::PathInput<T> input = paths_->input();
    if (!setup_.samples)
        input.features.channels = 0;
    return input;
}

template <typename T> std::size_t PathSide<T>::samples() const {
    const PathsSpec& paths = *setup_.prepared.one.scene.paths;
    return paths.count * paths.steps;
}

template <typename T> Cost PathSide<T>::measure(Engine& engine) {
    Cost cost;
    const layout::PathInput<T> input = this->input();
    const Clock::time_point start = Clock::now();
    const EngineTimes times = engine.explore(
        input,
        [&](const layout::PathChunk<T>& chunk) {
            cost.received += chunk.position.size_bytes() + chunk.force.size_bytes() + chunk.depth.size_bytes() +
                             chunk.facet.size_bytes() + chunk.proxy.size_bytes();
        },
        [&](std::size_t, std::span<const layout::PathMetrics<T>> metrics) { cost.received += metrics.size_bytes(); });
    cost.whole = std::chrono::duration<double>(Clock::now() - start).count();
    cost.kernel = times.kernel;
    cost.uploaded = times.uploaded;
    cost.evaluated = samples();
    return cost;
}

template <typename T> Captured<T> PathSide<T>::capture(Engine& engine, std::uint32_t channels) {
    layout::PathInput<T> input = this->input();
    if (setup_.samples)
        input.features.channels |= channels & ~layout::kChannelUnshaded;
    Captured<T> captured;
    engine.explore(
        input,
        [&](const layout::PathChunk<T>& chunk) {
            take(chunk, chunk.force, 3, input.steps, input.paths, captured.force);
            take(chunk, chunk.depth, 1, input.steps, input.paths, captured.depth);
            take(chunk, chunk.facet, 1, input.steps, input.paths, captured.facet);
            take(chunk, chunk.proxy, 3, input.steps, input.paths, captured.proxy);
            take(chunk, chunk.position, 3, input.steps, input.paths, captured.position);
        },
        [&](std::size_t, std::span<const layout::PathMetrics<T>> metrics) {
            captured.metrics.insert(captured.metrics.end(), metrics.begin(), metrics.end());
        });
    return captured;
}

template <typename T> std::unique_ptr<Side<T>> make_side(const Setup& setup, bool paths) {
    if (paths)
        return std::make_unique<PathSide<T>>(setup);
    return std::make_unique<FieldSide<T>>(setup);
}

template class PathSide<float>;
template class PathSide<double>;
template std::unique_ptr<Side<float>> make_side<float>(const Setup&, bool);
template std::unique_ptr<Side<double>> make_side<double>(const Setup&, bool);

} // namespace forceshade::study
