#include "host/study/omission/field_side.h"

#include "host/clock.h"

namespace forceshade::study {
namespace {

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

} // namespace

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

template class FieldSide<float>;
template class FieldSide<double>;

} // namespace forceshade::study
