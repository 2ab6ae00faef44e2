#include "host/mesh/prepare_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "host/error.h"
#include "host/mesh/findings.h"
#include "host/mesh/triangulate.h"

namespace forceshade {

MeshFrame frame_of(const PolygonSoup& polygons) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t corner : polygons.corners) {
        low = glm::min(low, polygons.vertices[corner]);
        high = glm::max(high, polygons.vertices[corner]);
    }
    const glm::dvec3 centre = low / 2.0 + high / 2.0;
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis)
        reach = std::max({reach, centre[axis] - low[axis], high[axis] - centre[axis]});
    if (!std::isfinite(reach))
        throw UsageError("the mesh is too large: its bounding box is no finite number of metres");
    int exponent = 0;
    if (std::frexp(reach, &exponent) == 0.5)
        --exponent;
    const double scale = reach > 0 ? std::ldexp(1.0, exponent) : 1.0;
    if (!std::isfinite(scale))
        throw UsageError("the mesh is too large: its bounding box is no finite number of metres");
    return {centre, scale};
}

namespace {

struct Turn {
    double cosine = 1, sine = 0;
};

// A quarter turn in radians is no binary number, but a mesh turned by one should keep its zeros.
Turn turn_of(double angle) {
    const double quarters = angle / (M_PI / 2), nearest = std::nearbyint(quarters);
    if (std::abs(quarters - nearest) > 4e-16 * std::abs(quarters))
        return {std::cos(angle), std::sin(angle)};
    switch (static_cast<int>(std::fmod(nearest, 4) + 4) % 4) {
    case 0:
        return {1, 0};
    case 1:
        return {0, 1};
    case 2:
        return {-1, 0};
    default:
        return {0, -1};
    }
}

void turn(double& first, double& second, const Turn& by) {
    const double before = first;
    first = by.cosine * before - by.sine * second;
    second = by.sine * before + by.cosine * second;
}

void check(const MeshPlacement& placement) {
    const double factor = placement.unit * placement.scale;
    if (!(factor > 0) || !std::isfinite(factor))
        throw UsageError(fmt::format("a mesh's unit times its scale must be positive, got {} * {}", placement.unit,
                                     placement.scale));
    for (int axis = 0; axis < 3; ++axis)
        if (const auto i = static_cast<std::size_t>(axis);
            !std::isfinite(placement.rotate[i]) || !std::isfinite(placement.translate[i]))
            throw UsageError("a mesh's rotation and translation must be finite");
}

void place(std::vector<glm::dvec3>& vertices, const MeshPlacement& placement) {
    check(placement);
    const double factor = placement.unit * placement.scale;
    const std::array<Turn, 3> turns{turn_of(placement.rotate[0]), turn_of(placement.rotate[1]),
                                    turn_of(placement.rotate[2])};
    const glm::dvec3 shift(placement.translate[0], placement.translate[1], placement.translate[2]);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        glm::dvec3& v = vertices[i];
        v *= factor;
        turn(v.y, v.z, turns[0]);
        turn(v.z, v.x, turns[1]);
        turn(v.x, v.y, turns[2]);
        v += shift;
        constexpr double kFarthest = 1e100; // m: volumes and squares stay finite
        if (!(std::abs(v.x) < kFarthest && std::abs(v.y) < kFarthest && std::abs(v.z) < kFarthest))
            throw UsageError(fmt::format("vertex {} (counted from 1) lies at ({}, {}, {}) m; a coordinate may not be "
                                         "beyond {} m",
                                         i + 1, v.x, v.y, v.z, kFarthest));
    }
}

std::vector<glm::dvec3> triangle_normals(const Mesh& mesh) {
    const PolygonSoup& polygons = mesh.polygons;
    std::vector<glm::dvec3> normals;
    normals.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t facet = mesh.triangle_facets[i];
        const auto& [a, b, c] = mesh.triangles[i];
        normals.push_back(polygons.begins[facet + 1] - polygons.begins[facet] == 3
                              ? mesh.facet_normals[facet]
                              : triangle_normal(polygons.vertices[a], polygons.vertices[b], polygons.vertices[c]));
    }
    return normals;
}

} // namespace

Mesh prepare_mesh(PolygonSoup polygons, const MeshPlacement& placement, VertexNormals weights) {
    Mesh mesh;
    mesh.polygons = std::move(polygons);
    place(mesh.polygons.vertices, placement);
    mesh.facet_normals = facet_normals(mesh.polygons);
    mesh.redundant_facets = find_coincident(mesh.polygons, mesh.facet_normals).redundant;
    mesh.vertex_normals = vertex_normals(mesh.polygons, mesh.facet_normals, weights, mesh.redundant_facets);
    Triangles triangles = triangulate(mesh.polygons, mesh.facet_normals);
    mesh.triangles = std::move(triangles.corners);
    mesh.triangle_facets = std::move(triangles.facets);
    mesh.triangle_normals = triangle_normals(mesh);
    return mesh;
}

} // namespace forceshade
