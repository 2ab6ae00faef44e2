// Keeps of a force volume, as its chunks pass by, only what the pictures show: at most 8 MiB, whatever the grid.
#pragma once

#include "host/picture/field_slice.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace forceshade::picture {

inline constexpr std::size_t kMaxSliceSamples = 256; // along one axis of a slice
inline constexpr std::size_t kMaxTiles = 12;

/// `wanted` of `count` indices as evenly as whole numbers allow, first and last among them; all if there are no more.
std::vector<std::uint64_t> even_indices(std::uint64_t count, std::size_t wanted);

/// Receives every chunk of a field once, in any order and of any size. Samples that never came are NaN.
class SliceCollector {
public:
    /// With `repeat_y`, chunks hold the one row y_first = 0, y_count = 1, which stands for every y of the grid.
    SliceCollector(const GridSpec& grid, bool repeat_y);

    void add(const layout::FieldChunk<float>& chunk);
    void add(const layout::FieldChunk<double>& chunk);

    /// F over x (u) and z (v) at the middle y: sample (ny - 1) / 2, rounded down.
    const FieldSlice& xz() const { return xz_; }
    /// The same of the force without shading; no samples where the chunks have no such channel.
    const FieldSlice& unshaded_xz() const { return unshaded_xz_; }
    /// |F| over x (u) and y (v) at up to kMaxTiles evenly spaced z, from the lowest z to the highest.
    const std::vector<MagnitudeSlice>& tiles() const { return tiles_; }

private:
    template <typename real> void add_chunk(const layout::FieldChunk<real>& chunk);
    template <typename real> void keep_xz(const layout::FieldChunk<real>& chunk);
    template <typename real> void keep_tile(const layout::FieldChunk<real>& chunk, std::size_t tile);

    bool repeat_y_;
    std::uint64_t middle_y_;
    std::vector<std::uint64_t> columns_; // x indices kept
    std::vector<std::uint64_t> rows_;    // y indices kept
    std::vector<std::uint64_t> levels_;  // z indices kept in xz_
    std::vector<std::uint64_t> tile_at_; // z indices that have a tile
    FieldSlice xz_, unshaded_xz_;
    std::vector<MagnitudeSlice> tiles_;
};

} // namespace forceshade::picture
