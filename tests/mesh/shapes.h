// Meshes for tests and benches, made from formulas.
#pragma once

#include <cstdint>
#include <functional>
#include <random>

#include "host/mesh/mesh.h"

namespace forceshade::shapes {

/// Between -1 and 1.
inline double uniform(std::mt19937& random) {
    return (double(random()) + 0.5) / 2147483648.0 - 1;
}

/// Anywhere in a cube, each coordinate up to `reach`.
inline glm::dvec3 anywhere(std::mt19937& random, double reach = 1) {
    const double x = reach * uniform(random), y = reach * uniform(random);
    return {x, y, reach * uniform(random)};
}

/// A mesh in metres out of polygons in metres.
Mesh mesh_of(PolygonSoup polygons, VertexNormals normals = VertexNormals::plain);

/// Unit sphere: an icosahedron whose facets were cut into four `levels` times; 20 * 4^levels facets.
PolygonSoup icosphere(unsigned levels);
/// [-1, 1]^3 of six quads, or of twelve triangles.
PolygonSoup cube(bool triangles = false);
/// [-1, 1]^3 without the facet at z = 1.
PolygonSoup open_cube();
PolygonSoup tetrahedron(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

enum class Cells { triangles, quads, hexagons };

/// The patch [-1/2, 1/2]^2 cut into `cells` cells a side and lifted to z = height(x, y):
/// diagonals from (i, j) to (i + 1, j + 1); regular hexagons 1 / cells wide whose centres lie in the square.
PolygonSoup patch(Cells kind, unsigned cells, const std::function<double(double, double)>& height);

/// Tetrahedra at random places, sizes and orientations, apart or through each other; outsides out.
PolygonSoup random_polyhedra(unsigned count, std::uint32_t seed);
/// A cone whose apex has this many facets, closed by one facet of as many corners.
PolygonSoup needle_fan(unsigned valence, double height);
/// A closed box `aspect` times as long as it is thick, its sides cut into slivers.
PolygonSoup sliver_box(unsigned slivers, double aspect);
/// A closed plate, 1 x 1 x thickness.
PolygonSoup plate(double thickness);
/// A sphere inside a sphere, both facing outwards or the inner one inwards.
PolygonSoup nested_shells(unsigned levels, bool cavity);
/// A block with a notch of 20 degrees along y, deepest in the origin.
PolygonSoup notched_block();
/// A wedge of so many degrees, as long and as wide as 1, sharp at x = 0.
PolygonSoup sharp_wedge(double degrees);
/// Two cones on one rim, with so many facets round each pole.
PolygonSoup double_cone(unsigned facets, double height);
/// Facets, each given by its corners.
PolygonSoup soup_of(std::vector<glm::dvec3> vertices, const std::vector<std::vector<std::uint32_t>>& facets);
/// One facet of these corners.
PolygonSoup polygon(std::vector<glm::dvec3> corners);
PolygonSoup single_triangle();
/// The model of tests/data.
PolygonSoup spot();
/// One regular facet of this many corners, and its base's prism.
PolygonSoup many_gon_prism(unsigned corners);

/// Every facet a triangle fan about its first corner, then each triangle cut into four.
PolygonSoup subdivided(const PolygonSoup& polygons);

PolygonSoup merged(const PolygonSoup& one, const PolygonSoup& other);
PolygonSoup moved(PolygonSoup polygons, const glm::dvec3& scale, const glm::dvec3& shift);
/// The other side out.
PolygonSoup reversed(PolygonSoup polygons);
/// With a vertex for each corner, as files with texture coordinates have them.
PolygonSoup split(const PolygonSoup& polygons);
void add_facet(PolygonSoup& polygons, std::initializer_list<std::uint32_t> corners);
/// All vertices, and the facets whose numbers are to be kept.
PolygonSoup kept_facets(const PolygonSoup& polygons, const std::function<bool(std::size_t facet)>& keeps);

} // namespace forceshade::shapes
