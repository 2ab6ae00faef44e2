#include "host/output/path_rows.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/core.h>

namespace forceshade {

namespace {

constexpr std::size_t kMostPaths = 16384; // tables of more need not be there at once

// Where the steps of a chunk go in rows of `width` samples.
struct Window {
    std::size_t paths, pitch, first, count, width;
};

// From step after step to path after path, in tiles so that what is read stays in the nearest memory.
template <typename Value>
void transpose(const Window& window, std::span<const Value> from, std::size_t components, std::vector<Value>& to) {
    constexpr std::size_t kTile = 128; // steps
    if (from.empty())
        return;
    to.resize(window.paths * window.width * components);
    for (std::size_t tile = 0; tile < window.count; tile += kTile)
        for (std::size_t path = 0; path < window.paths; ++path)
            for (std::size_t step = tile; step < std::min(tile + kTile, window.count); ++step)
                for (std::size_t c = 0; c < components; ++c)
                    to[(path * window.width + window.first + step) * components + c] =
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

template <typename T> std::size_t samples_that_fit(const layout::PathInput<T>& input) {
    const bool mesh = input.law.features.surface == layout::kSurfaceMesh;
    const std::size_t bytes = path_sample_bytes(input.features.channels, sizeof(T));
    return bytes ? kRowBytes / bytes : mesh ? kMeshMetricSamples : kMetricSamples;
}
template std::size_t samples_that_fit<float>(const layout::PathInput<float>&);
template std::size_t samples_that_fit<double>(const layout::PathInput<double>&);

template <typename T> std::size_t paths_that_fit(const layout::PathInput<T>& input) {
    constexpr std::size_t kAbreast = 256; // fewer leave a device idle
    if (input.features.motion == layout::kMotionRecorded)
        return kMostPaths;
    const std::size_t least = input.features.channels ? 1 : kAbreast;
    return std::clamp(samples_that_fit(input) / input.steps, least, kMostPaths);
}
template std::size_t paths_that_fit<float>(const layout::PathInput<float>&);
template std::size_t paths_that_fit<double>(const layout::PathInput<double>&);

template <typename T> layout::PathBatch<T> BatchedSource<T>::batch(std::size_t first, std::size_t count) {
    layout::PathBatch<T> batch = paths_.batch(first, std::min(count, most_));
    lengths_.assign(batch.steps.begin(), batch.steps.end());
    if (batch.steps.empty())
        lengths_.assign(batch.count, static_cast<layout::uint>(steps_));
    batch.longest = *std::ranges::max_element(lengths_);
    longest_ = batch.longest;
    inside_.clear();
    for (const layout::ProxyStart<T>& proxy : batch.proxies)
        inside_.push_back(proxy.inside != 0);
    return batch;
}

template <typename T>
RowGatherer<T>::RowGatherer(const BatchedSource<T>& source, Take take) : source_(source), take_(std::move(take)) {}

template <typename T> void RowGatherer<T>::add(const layout::PathChunk<T>& chunk) {
    if (chunk.step_first != next_step_ || chunk.path_count != source_.lengths().size())
        throw std::logic_error(fmt::format("steps from {} of {} paths are not what follows step {} of {}",
                                           chunk.step_first, chunk.path_count, next_step_, source_.lengths().size()));
    const bool alone = chunk.path_count == 1;
    const std::size_t begin = alone ? chunk.step_first : 0; // of the rows
    const std::size_t width = alone ? chunk.step_count : source_.longest();
    const Window window{chunk.path_count, chunk.pitch, chunk.step_first - begin, chunk.step_count, width};
    transpose(window, chunk.position, 3, rows_.position);
    transpose(window, chunk.force, 3, rows_.force);
    transpose(window, chunk.depth, 1, rows_.depth);
    transpose(window, chunk.facet, 1, rows_.facet);
    transpose(window, chunk.proxy, 3, rows_.proxy);
    next_step_ += chunk.step_count;
    const bool whole = next_step_ >= source_.longest();
    if (whole)
        next_step_ = 0;
    if (whole || alone)
        take_({chunk.path_first, chunk.path_count, width, source_.lengths(), rows_.position, rows_.force, rows_.depth,
               rows_.facet, rows_.proxy, begin});
}

template class BatchedSource<float>;
template class BatchedSource<double>;
template class RowGatherer<float>;
template class RowGatherer<double>;

} // namespace forceshade
