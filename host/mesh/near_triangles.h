// Which triangles may be nearest to the samples of a block, from those that sweeps found.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/mesh/region_sweep.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// The samples of a block, of which (z * 2 + y) * 2 + x stands at (x, y, z), and what sweeps found of each.
struct BlockCells {
    static constexpr std::size_t kCount = 8;
    std::array<float, kCount> x, y, z;
    std::array<std::uint64_t, kCount> cells;
};

class NearTriangles {
public:
    NearTriangles(const SweptSurface& surface, const DistanceSlack& slack) : surface_(surface), slack_(slack) {}

    /// Appends all of the surface that is connected with what sweeps found and no further away from some sample than
    /// the nearest, by the slack. Within that, a path goes down the surface from each triangle to where sweeps find it.
    /// Each triangle once, in some order. False if there are more than `most`.
    bool find(const BlockCells& block, std::span<const SweptTie> ties, std::size_t most,
              std::vector<layout::uint>& triangles) const;

private:
    const SweptSurface& surface_;
    const DistanceSlack& slack_;
};

} // namespace forceshade
