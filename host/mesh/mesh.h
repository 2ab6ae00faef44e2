// A polygon mesh in double precision: facets as the file has them, and the triangles that the probe touches.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace forceshade {

/// Polygons as a file has them, in the file's unit. Facet f has the vertices corners[begins[f]] to
/// corners[begins[f + 1] - 1], counterclockwise seen from outside.
struct PolygonSoup {
    std::vector<glm::dvec3> vertices;
    std::vector<std::uint32_t> begins{0};
    std::vector<std::uint32_t> corners;

    std::size_t facets() const { return begins.size() - 1; }
};

/// A mesh prepared for the laws, in metres. Facets and vertices keep the order of the file.
struct Mesh {
    PolygonSoup polygons;                                /* m */
    std::vector<std::uint32_t> redundant_facets;         /* ascending: coincide with others, count for nothing
                                                            (coincident.h) */
    std::vector<glm::dvec3> facet_normals;               /* 1: unit Newell normals; 0 where a facet has no area */
    std::vector<glm::dvec3> vertex_normals;              /* 1: unit, what L7 interpolates; 0 where they cancel */
    std::vector<std::array<std::uint32_t, 3>> triangles; /* vertices; by facet */
    std::vector<std::uint32_t> triangle_facets;          /* facet of each triangle, ascending */
    std::vector<glm::dvec3> triangle_normals;            /* 1: unit, good to a few ULP whatever the triangle's shape; 0
                                                            where it has no area */
};

} // namespace forceshade
