#include "host/mesh/near_triangles.h"

#include <algorithm>
#include <cstring>

#include "host/reference/wide.h"

namespace forceshade {

using layout::uint;
using Real3 = reference::Vector<float>;

namespace {

using Reals = float __attribute__((vector_size(32)));
using Bits = std::int32_t __attribute__((vector_size(32)));

} // namespace

/// Which of a triangle's edges are within the limit (a square) of some of the samples: bit i of the edge from corner i.
FS_WIDE unsigned near_edges(const BlockCells& block, const std::array<float, BlockCells::kCount>& limits,
                            const std::array<Real3, 3>& corners) noexcept {
    Reals x, y, z, limit;
    std::memcpy(&x, block.x.data(), sizeof x);
    std::memcpy(&y, block.y.data(), sizeof y);
    std::memcpy(&z, block.z.data(), sizeof z);
    std::memcpy(&limit, limits.data(), sizeof limit);
    const Reals zero{}, one = zero + 1.0f;
    unsigned edges = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Real3 &start = corners[i], &end = corners[i == 2 ? 0 : i + 1];
        const float ex = end.x - start.x, ey = end.y - start.y, ez = end.z - start.z;
        const float square = ex * ex + ey * ey + ez * ez, per_square = square > 0.0f ? 1.0f / square : 0.0f;
        const Reals px = x - start.x, py = y - start.y, pz = z - start.z;
        Reals share = (px * ex + py * ey + pz * ez) * per_square;
        share = share > zero ? share : zero;
        share = share < one ? share : one;
        const Reals dx = px - share * ex, dy = py - share * ey, dz = pz - share * ez;
        Bits near = dx * dx + dy * dy + dz * dz <= limit;
        for (std::size_t half = BlockCells::kCount / 2; half > 0; half /= 2)
            for (std::size_t k = 0; k < half; ++k)
                near[k] |= near[k + half];
        edges |= near[0] != 0 ? 1u << i : 0;
    }
    return edges;
}

bool NearTriangles::find(const BlockCells& block, std::span<const SweptTie> ties, std::size_t most,
                         std::vector<uint>& triangles) const {
    const auto first = static_cast<std::ptrdiff_t>(triangles.size());
    const auto add = [&](uint triangle) {
        if (std::find(triangles.begin() + first, triangles.end(), triangle) == triangles.end())
            triangles.push_back(triangle);
        return triangles.size() - std::size_t(first) <= most;
    };
    std::array<float, BlockCells::kCount> limits;
    for (std::size_t i = 0; i < BlockCells::kCount; ++i) {
        const std::uint64_t cell = block.cells[i];
        limits[i] = cell == kOutsideCell ? -1.0f : slack_.limit(square_of(cell));
        if (cell != kOutsideCell && !add(triangle_of(cell)))
            return false;
    }
    for (const SweptTie& tie : ties)
        if (tie.square <= limits[tie.cell % BlockCells::kCount] && !add(tie.triangle))
            return false;
    for (std::size_t i = std::size_t(first); i < triangles.size(); ++i) {
        const std::size_t corner = 3 * std::size_t(triangles[i]);
        const unsigned edges = near_edges(block, limits, surface_.triangle_corners(triangles[i]));
        for (std::size_t j = 0; j < 3; ++j)
            if ((edges >> j & 1u) != 0 && !add(surface_.neighbours[corner + j]))
                return false;
    }
    return true;
}

} // namespace forceshade
