#include "host/mesh/triangulate.h"

#include <bit>
#include <cmath>

#include "host/mesh/exact.h"

namespace forceshade {

namespace {

constexpr std::uint32_t kFree = 0xFFFFFFFFu;

std::uint64_t mixed(std::uint64_t hash, double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value + 0.0)) * 0x9E3779B97F4A7C15u; // + 0.0: -0 is 0
    return hash ^ (hash >> 29);
}

} // namespace

std::vector<std::uint32_t> weld(std::span<const double> vertices) {
    const std::size_t count = vertices.size() / 3;
    const std::size_t slots = std::bit_ceil(2 * count + 1);
    std::vector<std::uint32_t> table(slots, kFree), places(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double* at = &vertices[3 * i];
        std::size_t slot = mixed(mixed(mixed(0, at[0]), at[1]), at[2]) & (slots - 1);
        const auto differs = [&](std::uint32_t other) {
            const double* there = &vertices[3 * std::size_t(other)];
            return at[0] != there[0] || at[1] != there[1] || at[2] != there[2];
        };
        while (table[slot] != kFree && differs(table[slot]))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == kFree)
            table[slot] = static_cast<std::uint32_t>(i);
        places[i] = table[slot];
    }
    return places;
}

std::vector<std::uint32_t> weld(const PolygonSoup& polygons) {
    if (polygons.vertices.empty())
        return {};
    return weld(std::span(&polygons.vertices[0].x, 3 * polygons.vertices.size()));
}

namespace {

double dot(const glm::dvec3& a, const glm::dvec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

glm::dvec3 cross(const glm::dvec3& a, const glm::dvec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

class Triangulation {
public:
    Triangulation(const PolygonSoup& polygons, std::span<const glm::dvec3> normals)
        : polygons_(polygons), normals_(normals) {
        const std::size_t corners = polygons.corners.size(), facets = polygons.facets();
        triangles_.corners.reserve(corners > 2 * facets ? corners - 2 * facets : 0);
        triangles_.facets.reserve(triangles_.corners.capacity());
    }

    Triangles run() {
        for (std::size_t facet = 0; facet < polygons_.facets(); ++facet) {
            const std::uint32_t begin = polygons_.begins[facet], count = polygons_.begins[facet + 1] - begin;
            corners_ = std::span(polygons_.corners).subspan(begin, count);
            const bool has_area = normals_[facet] != glm::dvec3(0);
            if (count == 4 && has_area)
                cut_quadrilateral(normals_[facet]);
            else if (count < 5 || !has_area || !cut_by_delaunay(normals_[facet]))
                cut_fan();
            triangles_.facets.resize(triangles_.corners.size(), static_cast<std::uint32_t>(facet));
        }
        return std::move(triangles_);
    }

private:
    const glm::dvec3& vertex(std::size_t corner) const { return polygons_.vertices[corners_[corner]]; }

    void add(std::size_t a, std::size_t b, std::size_t c) {
        triangles_.corners.push_back({corners_[a], corners_[b], corners_[c]});
    }

    void cut_fan() {
        for (std::size_t corner = 1; corner + 1 < corners_.size(); ++corner)
            add(0, corner, corner + 1);
    }

    void cut_quadrilateral(const glm::dvec3& normal) {
        int not_convex = 0;
        std::size_t apex = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec3& here = vertex(i);
            const glm::dvec3 turn = cross(here - vertex((i + 3) % 4), vertex((i + 1) % 4) - here);
            if (!(dot(turn, normal) > 0)) {
                ++not_convex;
                apex = i;
            }
        }
        bool from_first = true;
        if (not_convex == 0) {
            const glm::dvec3 first = vertex(2) - vertex(0), second = vertex(3) - vertex(1);
            from_first = dot(first, first) <= dot(second, second);
        } else if (not_convex == 1) {
            from_first = apex % 2 == 0;
        }
        if (from_first) {
            cut_fan();
        } else {
            add(0, 1, 3);
            add(1, 2, 3);
        }
    }

    bool cut_by_delaunay(const glm::dvec3& normal) {
        project(normal);
        cut_.clear();
        if (!planar_delaunay(projection_, cut_))
            return false;
        for (const auto& triangle : cut_)
            add(triangle[0], triangle[1], triangle[2]);
        return true;
    }

    // Onto two axes that make a right-handed frame with the normal; the one is across the normal's least component.
    void project(const glm::dvec3& normal) {
        const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
        const glm::dvec3 least = x <= y && x <= z ? glm::dvec3(1, 0, 0)
                                 : y <= z         ? glm::dvec3(0, 1, 0)
                                                  : glm::dvec3(0, 0, 1);
        glm::dvec3 right = cross(least, normal);
        right /= std::sqrt(dot(right, right));
        const glm::dvec3 up = cross(normal, right);
        projection_.clear();
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            const glm::dvec3 offset = vertex(i) - vertex(0);
            projection_.push_back({dot(offset, right), dot(offset, up)});
        }
    }

    const PolygonSoup& polygons_;
    std::span<const glm::dvec3> normals_;
    Triangles triangles_;
    std::span<const std::uint32_t> corners_; // of the facet at hand
    std::vector<std::array<double, 2>> projection_;
    std::vector<std::array<std::uint32_t, 3>> cut_;
};

} // namespace

Triangles triangulate(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals) {
    return Triangulation(polygons, facet_normals).run();
}

} // namespace forceshade
