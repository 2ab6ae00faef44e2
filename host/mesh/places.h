// Which vertices of a mesh are one place: those with equal coordinates, and those nearer to each other than a distance;
// and which edges run between the same two.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

/// Finds equal ones among numbered things by an open hash table.
class FirstOfEqual {
public:
    explicit FirstOfEqual(std::size_t count) : table_(std::bit_ceil(2 * count + 1), kFree) {}

    /// The number added first of those for which equals(number) is true; else `number` itself.
    template <typename Equals> std::uint32_t add(std::uint64_t hash, std::uint32_t number, const Equals& equals) {
        std::size_t slot = hash & (table_.size() - 1);
        for (; table_[slot] != kFree; slot = (slot + 1) & (table_.size() - 1))
            if (equals(table_[slot]))
                return table_[slot];
        return table_[slot] = number;
    }

private:
    static constexpr std::uint32_t kFree = 0xFFFFFFFFu;
    std::vector<std::uint32_t> table_;
};

/// Things joined into sets (union-find with path halving).
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count);

    /// The set's least member.
    std::uint32_t find(std::uint32_t member) noexcept {
        while (parents_[member] != member)
            member = parents_[member] = parents_[parents_[member]];
        return member;
    }

    void join(std::uint32_t a, std::uint32_t b) noexcept {
        a = find(a);
        b = find(b);
        if (a != b)
            parents_[a > b ? a : b] = a > b ? b : a;
    }

    std::size_t count() const noexcept;

private:
    std::vector<std::uint32_t> parents_;
};

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

/// The sides of facets, numbered by the corners where they begin. The polygons must outlive it.
class FacetSides {
public:
    explicit FacetSides(const PolygonSoup& polygons);

    std::uint32_t facet(std::size_t side) const { return facets_[side]; }
    /// The next one of the same facet.
    std::uint32_t after(std::uint32_t side) const {
        const std::uint32_t facet = facets_[side];
        return side + 1 == polygons_.begins[facet + 1] ? polygons_.begins[facet] : side + 1;
    }
    std::uint32_t start(std::uint32_t side) const { return polygons_.corners[side]; }
    std::uint32_t end(std::uint32_t side) const { return start(after(side)); }

    /// Calls use(sides) for those along each edge (see for_each_bundle), and for those without length at each vertex.
    template <typename Use> void for_each_edge(const Use& use) const {
        const auto ends = [&](std::size_t number) {
            const auto side = static_cast<std::uint32_t>(number);
            return std::pair(start(side), end(side));
        };
        for_each_bundle(polygons_.vertices.size(), polygons_.corners.size(), ends, use);
    }

private:
    const PolygonSoup& polygons_;
    std::vector<std::uint32_t> facets_; // of each side
};

/// One representative for all vertices at the same place: the lowest. `vertices` has three numbers a vertex; 0 and -0
/// are one.
std::vector<std::uint32_t> weld(std::span<const double> vertices);
std::vector<std::uint32_t> weld(const PolygonSoup& polygons);

/// The same for vertices no further apart than `distance`, and for chains of them: of a chain, whose ends may be
/// further apart, all are one place. Does not depend on the order of the vertices.
std::vector<std::uint32_t> weld_within(const PolygonSoup& polygons, double distance);

struct JoinedVertices {
    std::size_t vertices = 0; // that are gone: others stand for them
    std::size_t facets = 0;   // that had three places and have fewer: without area from now on
};

/// Makes one vertex of all that are one place, where the one of them is that is least by x, then y, then z; keeps the
/// order of those left. A corner that moves to the place of the one before it is dropped, as long as three are left.
/// \param distance in the polygons' unit; 0: of equal coordinates only
JoinedVertices join_vertices(PolygonSoup& polygons, double distance = 0);

/// The least distance within which vertices must be joined for the surface to close, up to 1 % of the box's diagonal;
/// empty if none does, or if it is closed. Of polygons whose vertices of equal coordinates are joined.
std::optional<double> closing_distance(const PolygonSoup& polygons);

} // namespace forceshade
