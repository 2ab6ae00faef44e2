// Keeps of a force volume, as its chunks pass by, only what the pictures show: at most 24 MiB, whatever the grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/picture/values.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade::picture {

inline constexpr std::size_t kMaxSliceSamples = 256; // along one axis of a slice
inline constexpr std::size_t kMaxTiles = 36;

/// `wanted` of `count` indices as evenly as whole numbers allow, first and last among them; all if `count` is no more.
std::vector<std::uint64_t> even_indices(std::uint64_t count, std::size_t wanted);

/// Which slice is kept, and what of the tiles.
struct SliceChoice {
    std::size_t axis = 1;                    // the slice is normal to x, y or z
    std::optional<double> at;                /* m: the sample nearest to it; without: the middle one, rounded down */
    Quantity quantity = Quantity::magnitude; // an angle needs chunks with unshaded forces
};

/// Receives every chunk of a field once, in any order and of any size. Samples that never came are NaN.
class SliceCollector {
public:
    /// With `repeat_y`, chunks hold the one row y_first = 0, y_count = 1, which stands for every y of the grid.
    SliceCollector(const GridSpec& grid, bool repeat_y, const SliceChoice& choice = {});

    template <typename real> void add(const layout::FieldChunk<real>& chunk); // float or double

    /// F over the chosen slice.
    const FieldSlice& slice() const { return slice_; }
    /// The same of the force without shading; no samples where the chunks have no such channel.
    const FieldSlice& unshaded() const { return unshaded_; }
    /// The quantity over x (u) and y (v) at up to kMaxTiles evenly spaced z, from the lowest z to the highest.
    const std::vector<ValueSlice>& tiles() const { return tiles_; }

private:
    // Samples of the grid in a plane: `axis` as in SliceAxes.
    struct Plane {
        std::array<std::size_t, 3> axis;
        std::vector<std::uint64_t> u, v;
        std::uint64_t at;
    };
    Plane plane(std::size_t normal, std::uint64_t at) const;
    SliceAxes axes_of(const Plane& plane) const;
    template <typename real, typename Keep>
    void visit(const layout::FieldChunk<real>& chunk, const Plane& plane, const Keep& keep) const;

    GridSpec grid_;
    bool repeat_y_;
    SliceChoice choice_;
    Plane plane_;
    FieldSlice slice_, unshaded_;
    std::vector<Plane> tile_planes_;
    std::vector<ValueSlice> tiles_;
};

} // namespace forceshade::picture
