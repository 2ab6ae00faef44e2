// Referees of the god-object (L6): exact tests of what a proxy's way may not cross and of what may hold it, and a
// solver derived differently. Plain loops; shares no code with the oracle.
#pragma once

#include <array>
#include <cstdint>
#include <span>
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

    /// Whether the straight way from `from` to `to` touches a triangle: in exact arithmetic, so a way that ends on one
    /// touches it.
    bool touches(const glm::dvec3& from, const glm::dvec3& to) const;

private:
    std::array<int, 3> cell_of(const glm::dvec3& point) const;
    bool touches_in(std::size_t cell, const glm::dvec3& from, const glm::dvec3& to) const;

    const Triangles& triangles_;
    glm::dvec3 low_, high_;
    double cell_;
    std::array<int, 3> size_;
    std::vector<std::vector<std::uint32_t>> cells_;
};

/// Whether the segment and the triangle have a point in common, in exact arithmetic.
bool segment_touches_triangle(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle);

/// How far `pull` is from the cone of the reverses of up to three normals, as long as the difference is.
double distance_from_cone(const glm::dvec3& pull, std::span<const glm::dvec3> normals);

} // namespace forceshade::brute
