// The triangles that a mesh's facets are cut into, and those of them that the laws use.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/mesh/mesh.h"
#include "host/mesh/places.h"

namespace forceshade {

/// A key that is the same for two pairs of places if and only if they are the ends of the same edge.
inline std::uint64_t edge_of(std::uint32_t place, std::uint32_t other) noexcept {
    return place < other ? std::uint64_t(place) << 32 | other : std::uint64_t(other) << 32 | place;
}

/// Calls use(numbers) for all edges between one pair of places, pair by pair, by the lower place, then the higher one;
/// the numbers ascend. `ends(number)`: the places of an edge's two ends, below `places`.
template <typename Ends, typename Use>
void for_each_bundle(std::size_t places, std::size_t edges, const Ends& ends, const Use& use) {
    struct FiledEdge {
        std::uint32_t higher, number;
    };
    const auto lower = [&](std::size_t edge) { return std::min(ends(edge).first, ends(edge).second); };
    std::vector<std::uint32_t> begins(places + 1, 0), bundle;
    for (std::size_t edge = 0; edge < edges; ++edge)
        ++begins[lower(edge) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<FiledEdge> filed(edges); // by lower place
    std::vector<std::uint32_t> next(begins.begin(), begins.end() - 1);
    for (std::size_t edge = 0; edge < edges; ++edge)
        filed[next[lower(edge)]++] = {std::max(ends(edge).first, ends(edge).second), static_cast<std::uint32_t>(edge)};
    for (std::size_t place = 0; place < places; ++place) {
        const auto here = std::span(filed).subspan(begins[place], begins[place + 1] - begins[place]);
        std::ranges::sort(here, {}, [](const FiledEdge& edge) { return std::pair(edge.higher, edge.number); });
        for (auto edge = here.begin(); edge != here.end(); use(std::span<const std::uint32_t>(bundle))) {
            bundle.clear();
            for (const std::uint32_t higher = edge->higher; edge != here.end() && edge->higher == higher; ++edge)
                bundle.push_back(edge->number);
        }
    }
}

/// K - 2 triangles for each facet of K corners, the same ones in every run:
/// - a triangle as it is, from its first corner;
/// - a convex quadrilateral cut along its shorter diagonal, along the one from its first corner if they are equal; one
///   with a reflex or straight corner, from that corner;
/// - more corners: the constrained Delaunay triangulation of the facet's projection along its Newell normal;
/// - a fan from the first corner where that is impossible: the projection crosses or touches itself, or the facet has
///   no area.
/// \param facet_normals unit Newell normals, 0 where a facet has no area
MeshTriangles triangulate(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals);

/// Number of facets that are caps or have no area at all, which make_surface() leaves out.
/// \throws UsageError if the box is not finite in metres
std::size_t count_caps(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals);

/// The mesh's triangles without redundant facets and without needles of two equal corners (their two sides are one
/// edge), closed over its caps. A cap has a corner on its longest side: exactly, or to within the rounding of the
/// world's coordinates, where its normal is noise. It says that this corner lies on that side, and goes; every other
/// triangle with that side is cut in two there, through caps of caps too, so that edges match whose triangles met
/// across caps. The pieces keep plane, normal and facet. \returns empty if these are the mesh's triangles as they are
std::optional<MeshTriangles> make_surface(const Mesh& mesh, const MeshFrame& frame);

} // namespace forceshade
