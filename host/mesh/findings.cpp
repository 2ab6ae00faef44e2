#include "host/mesh/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "host/mesh/coincident.h"
#include "host/mesh/connectivity.h"
#include "host/mesh/normals.h"
#include "host/mesh/self_intersections.h"
#include "host/mesh/triangulate.h"

namespace forceshade {
namespace {

void count_kinds(const PolygonSoup& polygons, MeshFindings& found) {
    found.vertices = polygons.vertices.size();
    found.facets = polygons.facets();
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        const std::size_t corners = polygons.begins[facet + 1] - polygons.begins[facet];
        found.triangles += corners == 3;
        found.quadrilaterals += corners == 4;
        found.others += corners != 3 && corners != 4;
        found.most_corners = std::max(found.most_corners, corners);
    }
}

void measure_box(const PolygonSoup& polygons, MeshFindings& found) {
    std::vector<bool> used(polygons.vertices.size(), false);
    for (const std::uint32_t vertex : polygons.corners)
        used[vertex] = true;
    bool first = true;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) {
            ++found.unused_vertices;
            continue;
        }
        const glm::dvec3& v = polygons.vertices[i];
        for (int axis = 0; axis < 3; ++axis) {
            found.low[axis] = first ? v[axis] : std::min(found.low[axis], v[axis]);
            found.high[axis] = first ? v[axis] : std::max(found.high[axis], v[axis]);
        }
        first = false;
    }
}

void count_repeated_corners(const PolygonSoup& polygons, MeshFindings& found) {
    std::vector<std::uint32_t> corners = polygons.corners;
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        const auto mine =
            std::span(corners).subspan(polygons.begins[facet], polygons.begins[facet + 1] - polygons.begins[facet]);
        std::ranges::sort(mine);
        found.repeated_corner_facets += std::ranges::adjacent_find(mine) != mine.end();
    }
}

// From the middle of the box, so that a mesh far from the origin loses no digits.
void measure_surface(const PolygonSoup& polygons, const Triangles& triangles, MeshFindings& found) {
    const glm::dvec3 middle = found.low + 0.5 * (found.high - found.low);
    double twice_area = 0, six_volumes = 0;
    for (const auto& [i, j, k] : triangles.corners) {
        const glm::dvec3 a = polygons.vertices[i] - middle;
        const glm::dvec3 u = polygons.vertices[j] - polygons.vertices[i],
                         v = polygons.vertices[k] - polygons.vertices[i];
        const glm::dvec3 cross(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
        twice_area += std::hypot(cross.x, cross.y, cross.z);
        six_volumes += a.x * cross.x + a.y * cross.y + a.z * cross.z;
    }
    found.area = twice_area / 2;
    found.volume = six_volumes / 6;
}

void look_for_self_intersections(const PolygonSoup& polygons, const Triangles& triangles, MeshFindings& found) {
    std::vector<glm::dvec3> normals;
    normals.reserve(triangles.corners.size());
    for (const auto& [a, b, c] : triangles.corners)
        normals.push_back(triangle_normal(polygons.vertices[a], polygons.vertices[b], polygons.vertices[c]));
    constexpr std::size_t kMostPairs = 100'000;
    const SelfIntersections pairs = count_self_intersections(polygons.vertices, triangles.corners, normals, kMostPairs);
    found.self_intersections = pairs.pairs;
    found.more_self_intersections = !pairs.complete;
}

} // namespace

MeshFindings inspect(const PolygonSoup& all, const InspectionLimits& limits) {
    MeshFindings found;
    count_kinds(all, found);
    measure_box(all, found);
    count_repeated_corners(all, found);
    std::vector<glm::dvec3> normals = facet_normals(all);
    found.degenerate_facets = static_cast<std::size_t>(std::ranges::count(normals, glm::dvec3(0)));
    const CoincidentFacets coincident = find_coincident(all, normals);
    found.redundant_facets = coincident.redundant.size();
    found.opposed_facets = coincident.opposed;
    PolygonSoup rest;
    if (!coincident.redundant.empty()) {
        rest = without_facets(all, coincident.redundant);
        normals = facet_normals(rest);
    }
    const PolygonSoup& polygons = coincident.redundant.empty() ? all : rest;

    const Connectivity connected = connectivity(polygons);
    found.components = connected.components;
    found.boundary_edges = connected.boundary_edges;
    found.holes = connected.holes;
    found.non_manifold_edges = connected.non_manifold_edges;
    found.non_manifold_vertices = connected.non_manifold_vertices;
    found.misoriented_edges = connected.misoriented_edges;
    found.closed = found.facets > 0 && connected.odd_edges == 0;

    const Triangles triangles = triangulate(polygons, normals);
    measure_surface(polygons, triangles, found);
    if (triangles.corners.size() <= limits.self_intersection_triangles)
        look_for_self_intersections(polygons, triangles, found);
    return found;
}

} // namespace forceshade
