#include "host/study/omission/side.h"

#include "host/clock.h"
#include "host/paths/scene_paths.h"

namespace forceshade::study {
namespace {

// The field of a setup's scene on its grid.
template <typename T> class FieldSide final : public Side<T> {
public:
    /// `setup` must outlive it.
    explicit FieldSide(const Setup& setup);

    Cost measure(Engine& engine) override;
    Captured<T> capture(Engine& engine, std::uint32_t channels) override;
    std::size_t samples() const override;

private:
    EngineTimes evaluate(Engine& engine, layout::FieldInput<T> input,
                         const std::function<void(const layout::FieldChunk<T>&)>& consume) const;

    const Setup& setup_;
    FieldTables<T> tables_;
};

// The paths of a setup's scene.
template <typename T> class PathSide final : public Side<T> {
public:
    /// `setup` must outlive it.
    explicit PathSide(const Setup& setup);

    Cost measure(Engine& engine) override;
    Captured<T> capture(Engine& engine, std::uint32_t channels) override;
    std::size_t samples() const override;

private:
    layout::PathInput<T> input();

    const Setup& setup_;
    std::unique_ptr<ScenePaths<T>> paths_;
};

// A chunk's channel into the whole grid's, each of its rows `repeats` times.
template <typename Value, typename T>
void take(const layout::FieldChunk<T>& chunk, std::span<const Value> channel, std::size_t components,
          std::size_t repeats, std::vector<Value>& into) {
    if (channel.empty())
        return;
    for (std::size_t row = 0; row < chunk.y_count * chunk.z_count; ++row) {
        const auto values = channel.subspan(row * chunk.x_pitch * components, chunk.x_count * components);
        for (std::size_t i = 0; i < repeats; ++i)
            into.insert(into.end(), values.begin(), values.end());
    }
}

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

template <typename T>
FieldSide<T>::FieldSide(const Setup& setup)
    : setup_(setup), tables_(make_tables<T>(setup.prepared.one.scene, setup.prepared.images, setup.extent)) {}

template <typename T> std::size_t FieldSide<T>::samples() const {
    const auto& size = setup_.prepared.one.scene.grid.size;
    return size[0] * size[1] * size[2];
}

// A mesh's blocks are planned here where free space is visited; else by the engine, slab by slab.
template <typename T>
EngineTimes FieldSide<T>::evaluate(Engine& engine, layout::FieldInput<T> input,
                                   const std::function<void(const layout::FieldChunk<T>&)>& consume) const {
    if (setup_.free == FreeSpace::skipped)
        return engine.evaluate(input, consume);
    const Clock::time_point start = Clock::now();
    const BlockPlan plan =
        plan_blocks<T>(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 0, setup_.free);
    const double planning = seconds_since(start);
    input.plan = plan.view();
    EngineTimes times = engine.evaluate(input, consume);
    times.plan = planning;
    times.voxels_evaluated = plan.voxels_evaluated;
    return times;
}

template <typename T> Cost FieldSide<T>::measure(Engine& engine) {
    Cost cost;
    const layout::FieldInput<T> input = tables_.input();
    const Clock::time_point start = Clock::now();
    const EngineTimes times = evaluate(engine, input, [&](const layout::FieldChunk<T>& chunk) {
        cost.received += chunk.force.size_bytes() + chunk.depth.size_bytes() + chunk.facet.size_bytes() +
                         chunk.proxy.size_bytes() + chunk.unshaded.size_bytes();
    });
    cost.whole = seconds_since(start);
    cost.kernel = times.kernel;
    cost.uploaded = times.uploaded;
    cost.evaluated = times.voxels_evaluated ? times.voxels_evaluated : input.x.size() * input.y.size() * input.z.size();
    return cost;
}

template <typename T> Captured<T> FieldSide<T>::capture(Engine& engine, std::uint32_t channels) {
    layout::FieldInput<T> input = tables_.input();
    input.law.features.channels |= channels;
    const std::size_t repeats = setup_.prepared.one.scene.grid.size[1] / input.y.size();
    Captured<T> captured;
    evaluate(engine, input, [&](const layout::FieldChunk<T>& chunk) {
        take(chunk, chunk.force, 3, repeats, captured.force);
        take(chunk, chunk.depth, 1, repeats, captured.depth);
        take(chunk, chunk.facet, 1, repeats, captured.facet);
        take(chunk, chunk.proxy, 3, repeats, captured.proxy);
        take(chunk, chunk.unshaded, 3, repeats, captured.unshaded);
    });
    return captured;
}

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
    cost.whole = seconds_since(start);
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

} // namespace

template <typename T> std::unique_ptr<Side<T>> make_side(const Setup& setup, bool paths) {
    if (paths)
        return std::make_unique<PathSide<T>>(setup);
    return std::make_unique<FieldSide<T>>(setup);
}

template std::unique_ptr<Side<float>> make_side<float>(const Setup&, bool);
template std::unique_ptr<Side<double>> make_side<double>(const Setup&, bool);

} // namespace forceshade::study
