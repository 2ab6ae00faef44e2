// Which vertices of a mesh are at the same place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

/// One representative for all vertices at the same place: the lowest. `vertices` has three numbers a vertex.
std::vector<std::uint32_t> weld(std::span<const double> vertices);

std::vector<std::uint32_t> weld(const PolygonSoup& polygons);

/// What is the same for two pairs of places if and only if they are the ends of the same edge.
inline std::uint64_t edge_of(std::uint32_t place, std::uint32_t other) noexcept {
    return place < other ? std::uint64_t(place) << 32 | other : std::uint64_t(other) << 32 | place;
}

} // namespace forceshade
