// Referees of the god-object (L6): exact tests of what a proxy may not cross and of what may constrain it, and a
// solver derived differently. Plain loops; shares no code with the oracle.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

namespace forceshade::brute {

/// Triangles in the mesh's frame; any order.
struct Triangles {
    std::vector<std::array<glm::dvec3, 3>> corners;

    /// Corners as tables of three coordinates a vertex and three vertices a triangle.
    static Triangles of(std::span<const double> vertices, std::span<const std::uint32_t> corners);
    static Triangles of(std::span<const float> vertices, std::span<const std::uint32_t> corners);
};

/// A plain grid of cells over triangles, for the tests below.
class TriangleGrid {
public:
    /// The triangles must outlive the grid.
    explicit TriangleGrid(const Triangles& triangles);

    /// Whether the straight line from `from` to `to` touches a triangle: in exact arithmetic, so a line that ends on
    /// one touches it.
    bool touches(const glm::dvec3& from, const glm::dvec3& to) const;

private:
    std::array<int, 3> cell_of(const glm::dvec3& point) const;
    /// The first and the last of those that a triangle is listed in.
    std::pair<std::array<int, 3>, std::array<int, 3>> cells_of(const std::array<glm::dvec3, 3>& triangle) const;
    bool touches_in(std::size_t cell, const glm::dvec3& from, const glm::dvec3& to) const;

    const Triangles& triangles_;
    glm::dvec3 low_, high_;
    double cell_;
    std::array<int, 3> size_;
    std::vector<std::vector<std::uint32_t>> cells_;
};

/// Whether the segment and the triangle, which has an area, have a point in common, in exact arithmetic.
bool segment_touches_triangle(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle);

/// How far `pull` is from the cone of the reverses of up to three normals, as long as the difference is.
double distance_from_cone(const glm::dvec3& pull, std::span<const glm::dvec3> normals);

// A god-object (L6) derived differently, for meshes that do not touch themselves: no skin, no planes held, no tree. The
// proxy walks on the surface itself from face to edge to corner, in extended precision, by the steepest descent of all
// that leave its feature; in the open it flies straight and is stopped by a loop over all triangles.

class SurfaceWalker {
public:
    using Real = long double;
    using Point = glm::vec<3, Real>;

    /// Triangles consistently oriented, of facets that break ties.
    SurfaceWalker(std::vector<glm::dvec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                  std::vector<std::uint32_t> facets);

    /// Puts the proxy in the open.
    void begin(const glm::dvec3& probe);
    /// Puts the proxy on a triangle, or on that corner or edge of it that is within a flush of it, in front or behind.
    void begin_on(std::uint32_t triangle, const glm::dvec3& proxy, bool in_front, double flush);
    /// Moves the probe and lets the proxy follow to rest. False if it does not come to rest.
    bool update(const glm::dvec3& probe);

    glm::dvec3 proxy() const { return glm::dvec3(proxy_); }
    bool touching() const { return !fan_.empty(); }
    /// Smallest margin by which a descent was chosen during the last update, relative: near 0, rounding decides.
    Real margin() const { return margin_; }

private:
    struct Descent {
        Point direction{0};
        Real gain = 0;   /* of the unit direction */
        Point normal{0}; /* what the probe is in front of or behind */
        std::uint32_t facet = ~0U;
        std::vector<std::uint32_t> on; /* triangles that it stays on */
    };

    Point normal(std::uint32_t triangle) const;
    Descent steepest(const Point& pull);
    void offer(Descent& best, Descent descent);
    void offer_face(Descent& best, std::uint32_t triangle, const Point& pull);
    void offer_edge(Descent& best, const std::array<std::uint32_t, 2>& edge, const Point& pull);
    Point rest_normal() const;
    bool at_border() const;
    void slide(const Descent& descent, const Point& probe);
    bool fly(const Point& probe);
    void settle_on(const std::vector<std::uint32_t>& candidates, Real flush);

    std::vector<Point> vertices_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::vector<std::uint32_t> facets_;
    std::vector<Point> normals_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> edges_;
    std::vector<std::vector<std::uint32_t>> around_;
    Point proxy_{0};
    Real side_ = 1;
    std::vector<std::uint32_t> fan_; /* triangles that hold the proxy's feature; none in the open */
    int corners_ = 0;                /* of the feature: 1 corner, 2 edge, 3 face */
    std::array<std::uint32_t, 3> feature_{};
    Real margin_ = 1;
};

} // namespace forceshade::brute
