// Which vertices of a mesh are one place: those with equal coordinates, and those nearer to each other than a distance.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
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
