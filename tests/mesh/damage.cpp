#include "tests/mesh/damage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "tests/mesh/shapes.h"

namespace forceshade::shapes {
namespace {

using Corners = std::array<std::uint32_t, 3>;

class Breaking {
public:
    Breaking(PolygonSoup triangles, std::mt19937& random) : vertices_(std::move(triangles.vertices)), random_(random) {
        for (std::size_t i = 0; i < triangles.corners.size(); i += 3)
            facets_.push_back({triangles.corners[i], triangles.corners[i + 1], triangles.corners[i + 2]});
    }

    /// Q, P, S becomes Q, V, S and V, P, S; what is across keeps P, Q.
    void add_cap() {
        const std::size_t facet = below(facets_.size());
        const auto [q, p, s] = turned(facets_[facet], below(3));
        if (vertices_[q] == vertices_[p])
            return;
        const auto v = static_cast<std::uint32_t>(vertices_.size());
        // At the middle, a quarter or three: cuts of both sides need not meet.
        const glm::dvec3 middle = 0.5 * (vertices_[p] + vertices_[q]);
        const std::size_t place = below(4);
        vertices_.push_back(place < 2 ? middle : 0.5 * (middle + vertices_[place == 2 ? p : q]));
        facets_[facet] = {q, v, s};
        facets_.push_back({v, p, s});
        facets_.push_back(turned({v, q, p}, below(3)));
    }

    /// P, Q, R becomes P', Q, R with P' at P.
    void add_needles() {
        const std::size_t facet = below(facets_.size());
        const auto [p, q, r] = turned(facets_[facet], below(3));
        const auto doubled = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(glm::dvec3(vertices_[p]));
        facets_[facet] = {doubled, q, r};
        facets_.push_back(turned({q, doubled, p}, below(3)));
        facets_.push_back(turned({doubled, r, p}, below(3)));
    }

    /// Of one of the first `count` facets.
    void add_repeat(std::size_t count, bool turned_over) {
        Corners corners = turned(facets_[below(count)], below(3));
        if (turned_over)
            std::swap(corners[0], corners[1]);
        if (below(2) == 0)
            for (std::uint32_t& corner : corners) {
                vertices_.push_back(glm::dvec3(vertices_[corner]));
                corner = static_cast<std::uint32_t>(vertices_.size() - 1);
            }
        facets_.push_back(corners);
    }

    std::size_t facets() const { return facets_.size(); }

    void shuffle() {
        for (std::size_t i = facets_.size(); i > 1; --i)
            std::swap(facets_[i - 1], facets_[below(i)]);
    }

    PolygonSoup take() {
        PolygonSoup result;
        result.vertices = std::move(vertices_);
        for (const Corners& corners : facets_)
            add_facet(result, {corners[0], corners[1], corners[2]});
        return result;
    }

private:
    std::size_t below(std::size_t count) { return random_() % count; }

    static Corners turned(const Corners& corners, std::size_t by) {
        return {corners[by], corners[(by + 1) % 3], corners[(by + 2) % 3]};
    }

    std::vector<glm::dvec3> vertices_;
    std::vector<Corners> facets_;
    std::mt19937& random_;
};

} // namespace

PolygonSoup rounded(PolygonSoup polygons) {
    for (glm::dvec3& vertex : polygons.vertices)
        for (int axis = 0; axis < 3; ++axis)
            vertex[axis] = std::nearbyint(std::ldexp(vertex[axis], 20)) * 0x1p-20;
    return polygons;
}

PolygonSoup damaged(PolygonSoup triangles, const Damage& damage, std::mt19937& random) {
    Breaking breaking(rounded(std::move(triangles)), random);
    for (unsigned i = 0; i < std::max(damage.caps, damage.needles); ++i) {
        if (i < damage.caps)
            breaking.add_cap();
        if (i < damage.needles)
            breaking.add_needles();
    }
    const std::size_t facets = breaking.facets();
    for (unsigned i = 0; i < damage.repeats; ++i)
        breaking.add_repeat(facets, false);
    for (unsigned i = 0; i < damage.strays; ++i)
        breaking.add_repeat(facets, true);
    if (damage.shuffled)
        breaking.shuffle();
    return breaking.take();
}

PolygonSoup lumpy_sphere(unsigned levels, std::mt19937& random) {
    PolygonSoup sphere = icosphere(levels);
    for (glm::dvec3& vertex : sphere.vertices)
        vertex *= 0.6 + 0.8 * double(random()) / 4294967296.0;
    return sphere;
}

} // namespace forceshade::shapes
