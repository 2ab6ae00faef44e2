#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "host/mesh/connectivity.h"
#include "host/mesh/disjoint_sets.h"

namespace forceshade {
namespace {

// One facet's side along an edge: the corners (places in PolygonSoup::corners) where it begins and ends.
struct Side {
    std::uint64_t edge; // lesser vertex * 2^32 + greater vertex
    std::uint32_t begin, end;
};

class EdgeMatching {
public:
    explicit EdgeMatching(const PolygonSoup& polygons)
        : polygons_(polygons), fans_(polygons.corners.size()), pieces_(polygons.facets()),
          facet_of_(polygons.corners.size()) {}

    Connectivity run() {
        collect_sides();
        std::ranges::sort(sides_, {}, [](const Side& side) { return std::pair(side.edge, side.begin); });
        for (std::size_t i = 0; i < sides_.size();) {
            std::size_t end = i + 1;
            while (end < sides_.size() && sides_[end].edge == sides_[i].edge)
                ++end;
            match(std::span(sides_).subspan(i, end - i));
            i = end;
        }
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet)
            found_.components += pieces_.find(facet) == facet;
        count_fans();
        count_holes();
        return found_;
    }

private:
    std::uint32_t vertex(std::uint32_t corner) const { return polygons_.corners[corner]; }

    void collect_sides() {
        sides_.reserve(polygons_.corners.size());
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            const std::uint32_t first = polygons_.begins[facet], last = polygons_.begins[facet + 1] - 1;
            for (std::uint32_t begin = first; begin <= last; ++begin) {
                const std::uint32_t end = begin == last ? first : begin + 1;
                const std::uint64_t a = vertex(begin), b = vertex(end);
                facet_of_[begin] = facet;
                if (a == b)
                    fans_.join(begin, end);
                else
                    sides_.push_back({std::min(a, b) << 32 | std::max(a, b), begin, end});
            }
        }
    }

    void match(std::span<const Side> sides) {
        found_.non_manifold_edges += sides.size() > 2;
        found_.odd_edges += sides.size() % 2;
        found_.misoriented_edges += sides.size() == 2 && vertex(sides[0].begin) == vertex(sides[1].begin);
        if (sides.size() == 1) {
            ++found_.boundary_edges;
            border_.push_back(sides[0]);
        }
        for (const Side& side : sides.subspan(1)) {
            const bool same = vertex(side.begin) == vertex(sides[0].begin);
            fans_.join(sides[0].begin, same ? side.begin : side.end);
            fans_.join(sides[0].end, same ? side.end : side.begin);
            pieces_.join(facet_of_[sides[0].begin], facet_of_[side.begin]);
        }
    }

    void count_fans() {
        std::vector<std::uint32_t> fans(polygons_.vertices.size(), 0);
        for (std::uint32_t corner = 0; corner < polygons_.corners.size(); ++corner)
            if (fans_.find(corner) == corner && ++fans[vertex(corner)] == 2)
                ++found_.non_manifold_vertices;
    }

    // Boundary edges that end in the same fan belong to the same loop.
    void count_holes() {
        DisjointSets loops(polygons_.corners.size());
        for (const Side& side : border_)
            loops.join(fans_.find(side.begin), fans_.find(side.end));
        std::vector<std::uint32_t> names;
        names.reserve(border_.size());
        for (const Side& side : border_)
            names.push_back(loops.find(fans_.find(side.begin)));
        std::ranges::sort(names);
        const auto repeated = std::ranges::unique(names);
        found_.holes = names.size() - repeated.size();
    }

    const PolygonSoup& polygons_;
    DisjointSets fans_;   // corners of a vertex, joined across edges
    DisjointSets pieces_; // facets
    std::vector<std::uint32_t> facet_of_;
    std::vector<Side> sides_, border_;
    Connectivity found_;
};

} // namespace

Connectivity connectivity_by_edges(const PolygonSoup& polygons) {
    return EdgeMatching(polygons).run();
}

Connectivity connectivity(const PolygonSoup& polygons) {
    if (const auto found = connectivity_by_half_edges(polygons))
        return *found;
    return connectivity_by_edges(polygons);
}

} // namespace forceshade
