// A polygon mesh in double precision: facets as the file has them, the normals of its parts, and the triangles that the
// probe touches, placed in the world.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "host/scene/scene.h"

namespace forceshade {

class Connectivity;

/// Polygons as a file has them, in the file's unit. Facet f has the vertices corners[begins[f]] to
/// corners[begins[f + 1] - 1], counterclockwise seen from outside.
struct PolygonSoup {
    std::vector<glm::dvec3> vertices;
    std::vector<std::uint32_t> begins{0};
    std::vector<std::uint32_t> corners;
    std::vector<glm::dvec3> normals;   /* one a corner, of any length; empty unless they were asked for */
    std::vector<std::uint32_t> groups; /* one a facet: its smoothing group, 0 for none; empty if the file has none */

    std::size_t facets() const { return begins.size() - 1; }
    std::uint32_t corners_of(std::size_t facet) const { return begins[facet + 1] - begins[facet]; }
    std::span<const std::uint32_t> outline(std::size_t facet) const {
        return std::span(corners).subspan(begins[facet], corners_of(facet));
    }
    /// The corners added last are a facet.
    void end_facet() { begins.push_back(static_cast<std::uint32_t>(corners.size())); }
};

using VertexNormals = NormalWeights;

struct Smoothing {
    Smoothing(VertexNormals by = VertexNormals::plain, double angle = 0) : weights(by), crease(angle) {}

    VertexNormals weights;
    double crease; // rad: of weights `crease`
};

/// The direction of a vector of any size; 0 of 0.
glm::dvec3 unit_vector(glm::dvec3 v);

/// The unit normal of a triangle, counterclockwise seen from where it points; good to a few units in the last place
/// whatever the triangle's shape, place and size. 0 if and only if the corners are collinear.
glm::dvec3 triangle_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// The unit Newell normal of each facet: that of the area vector, which is the plane's where the facet is plane. 0
/// where the area vector is 0 to within the rounding of twice double's precision.
std::vector<glm::dvec3> facet_normals(const PolygonSoup& polygons);

/// The unit normal of each vertex, of weights `plain` or `angle` (see VertexNormals). 0 where the facets' normals
/// cancel to within 1e-12 of the sum of their weights, and where there is no facet with an area. A facet that has a
/// vertex twice counts once in `plain`, with the sum of its angles in `angle`; a reflex corner has an angle beyond pi.
/// Facets in `left_out` (ascending) are ignored.
std::vector<glm::dvec3> vertex_normals(const Connectivity& mesh, std::span<const glm::dvec3> facet_normals,
                                       VertexNormals weights, std::span<const std::uint32_t> left_out = {});

/// The unit normal of each corner: the plain average over those facets at its vertex that are smooth with its own. By
/// `groups` those of the same smoothing group (PolygonSoup::groups; a facet of group 0 is smooth with none). By
/// `crease` those that are connected with it across edges there at which the facets' normals differ by no more than
/// the angle. 0 where they cancel, and at corners of facets that have no area or are left out.
/// \param smoothing weights must be `groups` or `crease`
std::vector<glm::dvec3> corner_normals(const Connectivity& mesh, std::span<const glm::dvec3> facet_normals,
                                       const Smoothing& smoothing, std::span<const std::uint32_t> left_out);

/// The triangles that a mesh's facets are cut into.
struct MeshTriangles {
    std::vector<std::array<std::uint32_t, 3>> corners; /* vertices, wound as their facet */
    std::vector<std::uint32_t> facets;                 /* of each triangle, ascending */
    std::vector<glm::dvec3> normals; /* 1: unit, good to a few ULP whatever the shape; 0 where there is no area */
};

/// K - 2 triangles for each facet of K corners, the same ones in every run:
/// - a triangle as it is, from its first corner;
/// - a convex quadrilateral cut along its shorter diagonal, along the one from its first corner if they are equal; one
///   with a reflex or straight corner, from that corner;
/// - more corners: the constrained Delaunay triangulation of the facet's projection along its Newell normal;
/// - a fan from the first corner where that is impossible: the projection crosses or touches itself, or the facet has
///   no area.
/// \param facet_normals unit Newell normals, 0 where a facet has no area
MeshTriangles triangulate(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals);

/// A mesh prepared for the laws, in metres. Facets and vertices keep the order of the file.
struct Mesh {
    PolygonSoup polygons;                        /* m; where corners at a vertex have several normals, a
                                                    vertex for each, the further ones behind all others */
    std::vector<std::uint32_t> redundant_facets; /* ascending: coincide with others, ignored */
    std::vector<glm::dvec3> facet_normals;       /* 1: unit Newell normals; 0 where a facet has no area */
    std::vector<glm::dvec3> vertex_normals;      /* 1: unit, what L7 interpolates; 0 where they cancel */
    MeshTriangles triangles;
    std::size_t opposed_normals = 0; /* corners whose normal points behind their facet, where a vertex has several */
};

/// Where a mesh stands in the world: scaled by unit * scale about the file's origin, then rotated about the fixed axes
/// x, y and z in this order, then moved.
struct MeshPlacement {
    double unit = 1;                   /* m: what a coordinate of 1 means */
    double scale = 1;                  /* 1 */
    std::array<double, 3> rotate{};    /* rad; quarter turns are exact */
    std::array<double, 3> translate{}; /* m */
};

/// Facets keep their order and numbers, vertices too. How facets are cut: triangulate(). Corners must be in range, and
/// normals not 0. \throws UsageError if unit * scale is not positive, or a coordinate is beyond 1e100 m or
/// not finite
/// \param known how these facets are connected, if that is known
Mesh prepare_mesh(PolygonSoup polygons, const MeshPlacement& placement, const Smoothing& smoothing = {},
                  const Connectivity* known = nullptr);

struct MeshBox {
    glm::dvec3 low, high; /* in the polygons' unit */
};

/// Of the vertices that some facet uses; infinite and inverted without any.
MeshBox bounding_box(const PolygonSoup& polygons);

/// (world - centre) / scale: centre the middle of the bounding box, scale the least power of two that leaves no
/// coordinate beyond 1.
struct MeshFrame {
    glm::dvec3 centre; /* m, world */
    double scale;      /* m */

    glm::dvec3 local(const glm::dvec3& world) const { return (world - centre) / scale; }
};

/// Of the corners of facets only: a vertex that none uses has no say.
/// \throws UsageError if the box is not finite in metres
MeshFrame frame_of(const PolygonSoup& polygons);

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
