#include "host/path_output/row_gatherer.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/core.h>

namespace forceshade {
namespace {

constexpr std::size_t kMostPaths = 16384; // tables of more need not be there at once

struct Window {
    std::size_t paths, pitch, first, count, steps;
};

// From step after step to path after path, in tiles so that what is read stays in the nearest memory.
template <typename Value>
void transpose(const Window& window, std::span<const Value> from, std::size_t components, std::vector<Value>& to) {
    constexpr std::size_t kTile = 128; // steps
    if (from.empty())
        return;
    to.resize(window.paths * window.steps * components);
    for (std::size_t tile = 0; tile < window.count; tile += kTile)
        for (std::size_t path = 0; path < window.paths; ++path)
            for (std::size_t step = tile; step < std::min(tile + kTile, window.count); ++step)
                for (std::size_t c = 0; c < components; ++c)
                    to[(path * window.steps + window.first + step) * components + c] =
                        from[(step * window.pitch + path) * components + c];
}

} // namespace

std::size_t path_sample_bytes(layout::uint channels, std::size_t real_bytes) {
    std::size_t bytes = 0;
    for (const layout::uint vector : {layout::kChannelForce, layout::kChannelPosition, layout::kChannelProxy})
        bytes += channels & vector ? 3 * real_bytes : 0;
    bytes += channels & layout::kChannelDepth ? real_bytes : 0;
    return bytes + (channels & layout::kChannelFacet ? sizeof(layout::uint) : 0);
}

template <typename T> std::size_t paths_that_fit(const layout::PathInput<T>& input) {
    constexpr std::size_t kAbreast = 256; // fewer leave a device idle
    const bool mesh = input.law.features.surface == layout::kSurfaceMesh;
    const std::size_t row = path_sample_bytes(input.features.channels, sizeof(T)) * input.steps;
    const std::size_t fit =
        row ? kRowBytes / row
            : std::max<std::size_t>(kAbreast, (mesh ? kMeshMetricSamples : kMetricSamples) / input.steps);
    return std::clamp<std::size_t>(fit, 1, kMostPaths);
}
template std::size_t paths_that_fit<float>(const layout::PathInput<float>&);
template std::size_t paths_that_fit<double>(const layout::PathInput<double>&);

template <typename T> layout::PathBatch<T> BatchedSource<T>::batch(std::size_t first, std::size_t count) {
    const layout::PathBatch<T> batch = paths_.batch(first, std::min(count, most_));
    lengths_.assign(batch.steps.begin(), batch.steps.end());
    if (batch.steps.empty())
        lengths_.assign(batch.count, static_cast<layout::uint>(steps_));
    inside_.clear();
    for (const layout::ProxyStart<T>& proxy : batch.proxies)
        inside_.push_back(proxy.inside != 0);
    return batch;
}

template <typename T>
RowGatherer<T>::RowGatherer(const BatchedSource<T>& source, std::size_t steps, Take take)
    : source_(source), steps_(steps), take_(std::move(take)) {}

template <typename T> void RowGatherer<T>::add(const layout::PathChunk<T>& chunk) {
    if (chunk.step_first != next_step_ || chunk.path_count != source_.lengths().size())
        throw std::logic_error(fmt::format("steps from {} of {} paths are not what follows step {} of {}",
                                           chunk.step_first, chunk.path_count, next_step_, source_.lengths().size()));
    const Window window{chunk.path_count, chunk.pitch, chunk.step_first, chunk.step_count, steps_};
    transpose(window, chunk.position, 3, rows_.position);
    transpose(window, chunk.force, 3, rows_.force);
    transpose(window, chunk.depth, 1, rows_.depth);
    transpose(window, chunk.facet, 1, rows_.facet);
    transpose(window, chunk.proxy, 3, rows_.proxy);
    next_step_ += chunk.step_count;
    if (next_step_ < steps_)
        return;
    next_step_ = 0;
    take_({chunk.path_first, chunk.path_count, steps_, source_.lengths(), rows_.position, rows_.force, rows_.depth,
           rows_.facet, rows_.proxy});
}

template class BatchedSource<float>;
template class BatchedSource<double>;
template class RowGatherer<float>;
template class RowGatherer<double>;

} // namespace forceshade
