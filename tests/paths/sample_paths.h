// Paths with samples that tell where they belong, handed over as an engine does.
#pragma once

#include <vector>

#include "host/output/rows.h"

namespace forceshade::testing {

inline constexpr std::uint32_t kPathChannels = layout::kChannelForce | layout::kChannelPosition |
                                               layout::kChannelDepth | layout::kChannelFacet | layout::kChannelProxy;

/// A source of nothing but lengths: of path i, lengths[i].
template <typename T> struct LengthSource final : layout::PathSource<T> {
    std::vector<layout::uint> lengths;
    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        layout::PathBatch<T> made;
        made.first = first;
        made.count = count;
        made.steps = std::span(lengths).subspan(first, count);
        return made;
    }
    std::span<const T> positions(std::size_t, std::size_t) override { return {}; }
};

/// What channel component c holds at (path, step); exact in float.
inline double sample_value(std::size_t path, std::size_t step, std::size_t component, double channel) {
    return double(path) + double(step) / 1024 + double(component) / 4 + channel * 1000;
}

/// Hands over paths in batches as `source` gives them, up to each batch's longest, `window` steps at a time; ended
/// paths hold junk.
template <typename T>
void hand_over(BatchedSource<T>& source, std::size_t paths, std::size_t window, RowGatherer<T>& gatherer) {
    for (std::size_t first = 0; first < paths;) {
        const layout::PathBatch<T> batch = source.batch(first, paths - first);
        const std::size_t steps = batch.longest;
        for (std::size_t step = 0; step < steps; step += window) {
            layout::PathChunk<T> chunk{};
            chunk.path_first = first;
            chunk.path_count = batch.count;
            chunk.pitch = batch.count + 3;
            chunk.step_first = step;
            chunk.step_count = std::min(window, steps - step);
            const std::size_t samples = chunk.step_count * chunk.pitch;
            std::vector<T> force(3 * samples, T(-7)), position = force, proxy = force, depth(samples, T(-7));
            std::vector<layout::uint> facet(samples, 77);
            for (std::size_t s = 0; s < chunk.step_count; ++s)
                for (std::size_t p = 0; p < batch.count; ++p) {
                    if (step + s >= batch.steps[p])
                        continue;
                    const std::size_t at = s * chunk.pitch + p;
                    for (std::size_t c = 0; c < 3; ++c) {
                        force[3 * at + c] = T(sample_value(first + p, step + s, c, 1));
                        position[3 * at + c] = T(sample_value(first + p, step + s, c, 2));
                        proxy[3 * at + c] = T(sample_value(first + p, step + s, c, 3));
                    }
                    depth[at] = T(sample_value(first + p, step + s, 0, 4));
                    facet[at] = step + s == 0 ? layout::kNoFacet : static_cast<layout::uint>(first + p);
                }
            chunk.force = force;
            chunk.position = position;
            chunk.proxy = proxy;
            chunk.depth = depth;
            chunk.facet = facet;
            gatherer.add(chunk);
        }
        first += batch.count;
    }
}

/// All of it into a sink.
template <typename T>
VolumeResult write_paths(PathSink& sink, const std::vector<layout::uint>& lengths, std::size_t steps, std::size_t most,
                         std::size_t window) {
    LengthSource<T> lengths_only;
    lengths_only.lengths = lengths;
    BatchedSource<T> source(lengths_only, steps, most);
    RowGatherer<T> gatherer(source, [&](const PathRows<T>& rows) { sink.write(rows); });
    hand_over(source, lengths.size(), window, gatherer);
    return sink.finish();
}

} // namespace forceshade::testing
