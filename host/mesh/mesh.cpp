#include "host/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "host/error.h"
#include "host/mesh/connectivity.h"
#include "host/mesh/findings.h"
#include "host/mesh/surface.h"
#include "host/reference/elementary.h"

namespace forceshade {

MeshBox bounding_box(const PolygonSoup& polygons) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t corner : polygons.corners) {
        low = glm::min(low, polygons.vertices[corner]);
        high = glm::max(high, polygons.vertices[corner]);
    }
    return {low, high};
}

MeshFrame frame_of(const PolygonSoup& polygons) {
    const auto [low, high] = bounding_box(polygons);
    const glm::dvec3 centre = low / 2.0 + high / 2.0;
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis)
        reach = std::max({reach, centre[axis] - low[axis], high[axis] - centre[axis]});
    int exponent = 0;
    if (std::frexp(reach, &exponent) == 0.5)
        --exponent;
    const double scale = reach > 0 ? std::ldexp(1.0, exponent) : 1.0;
    if (!std::isfinite(reach) || !std::isfinite(scale))
        throw UsageError("the mesh is too large: its bounding box is not finite in metres");
    return {centre, scale};
}

namespace {

struct Turn {
    double cosine = 1, sine = 0;
};
using Turns = std::array<Turn, 3>; // about x, then y, then z

// A quarter turn in radians is not a binary number, but a mesh turned by one should keep its zeros.
Turn turn_of(double angle) {
    const double quarters = angle / (M_PI / 2), nearest = std::nearbyint(quarters);
    if (std::abs(quarters - nearest) > 4e-16 * std::abs(quarters))
        return {std::cos(angle), std::sin(angle)};
    constexpr std::array<Turn, 4> kQuarters{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    return kQuarters[static_cast<std::size_t>(std::fmod(nearest, 4) + 4) % 4];
}

void turn(double& first, double& second, const Turn& by) {
    const double before = first;
    first = by.cosine * before - by.sine * second;
    second = by.sine * before + by.cosine * second;
}

void turn(glm::dvec3& v, const Turns& turns) {
    turn(v.y, v.z, turns[0]);
    turn(v.z, v.x, turns[1]);
    turn(v.x, v.y, turns[2]);
}

Turns turns_of(const MeshPlacement& placement) {
    return {turn_of(placement.rotate[0]), turn_of(placement.rotate[1]), turn_of(placement.rotate[2])};
}

void place(std::vector<glm::dvec3>& vertices, const MeshPlacement& placement) {
    const double factor = placement.unit * placement.scale;
    if (!(factor > 0) || !std::isfinite(factor))
        throw UsageError(fmt::format("a mesh's unit times its scale must be positive, got {} * {}", placement.unit,
                                     placement.scale));
    const auto is_finite = [](double value) { return std::isfinite(value); };
    if (!std::ranges::all_of(placement.rotate, is_finite) || !std::ranges::all_of(placement.translate, is_finite))
        throw UsageError("a mesh's rotation and translation must be finite");
    const Turns turns = turns_of(placement);
    const glm::dvec3 shift(placement.translate[0], placement.translate[1], placement.translate[2]);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        glm::dvec3& v = vertices[i];
        v *= factor;
        turn(v, turns);
        v += shift;
        constexpr double kFarthest = 1e100; // m: volumes and squares stay finite
        if (!(std::abs(v.x) < kFarthest && std::abs(v.y) < kFarthest && std::abs(v.z) < kFarthest))
            throw UsageError(
                fmt::format("vertex {} (counted from 1) lies at ({}, {}, {}) m; a coordinate may not be beyond {} m",
                            i + 1, v.x, v.y, v.z, kFarthest));
    }
}

std::size_t count_opposed(const Mesh& mesh) {
    std::size_t opposed = 0;
    for (std::size_t facet = 0; facet < mesh.polygons.facets(); ++facet)
        for (const std::uint32_t vertex : mesh.polygons.outline(facet))
            opposed += reference::dot(mesh.vertex_normals[vertex], mesh.facet_normals[facet]) < 0;
    return opposed;
}

// Gives each vertex its corners' normal; corners with another one get a vertex of their own at the same place.
// Triangles stay as they are. `given`: a unit vector a corner.
void split_by_normals(Mesh& mesh, const std::vector<glm::dvec3>& given) {
    constexpr std::uint32_t kLast = 0xFFFFFFFF;
    PolygonSoup& polygons = mesh.polygons;
    std::vector<std::uint32_t> next(polygons.vertices.size(), kLast); // vertex at the same place
    std::vector<bool> known(next.size());
    mesh.vertex_normals.assign(next.size(), glm::dvec3(0));
    for (std::size_t i = 0; i < polygons.corners.size(); ++i) {
        const glm::dvec3& normal = given[i];
        std::uint32_t vertex = polygons.corners[i];
        while (known[vertex] && mesh.vertex_normals[vertex] != normal && next[vertex] != kLast)
            vertex = next[vertex];
        if (known[vertex] && mesh.vertex_normals[vertex] != normal) {
            next[vertex] = static_cast<std::uint32_t>(polygons.vertices.size());
            polygons.vertices.push_back(glm::dvec3(polygons.vertices[vertex]));
            mesh.vertex_normals.emplace_back(0);
            known.push_back(false);
            next.push_back(kLast);
            vertex = next[vertex];
        }
        mesh.vertex_normals[vertex] = normal;
        known[vertex] = true;
        polygons.corners[i] = vertex;
    }
    mesh.opposed_normals = count_opposed(mesh);
}

// Those of the file, turned with the mesh.
std::vector<glm::dvec3> take_file_normals(Mesh& mesh, const MeshPlacement& placement) {
    std::vector<glm::dvec3> normals = std::exchange(mesh.polygons.normals, {});
    const Turns turns = turns_of(placement);
    for (glm::dvec3& normal : normals) {
        turn(normal, turns);
        normal = unit_vector(normal);
    }
    return normals;
}

} // namespace

Mesh prepare_mesh(PolygonSoup polygons, const MeshPlacement& placement, const Smoothing& smoothing,
                  const Connectivity* known) {
    Mesh mesh;
    mesh.polygons = std::move(polygons);
    place(mesh.polygons.vertices, placement);
    mesh.facet_normals = facet_normals(mesh.polygons);
    mesh.redundant_facets = find_coincident(mesh.polygons, mesh.facet_normals).redundant;
    mesh.triangles = triangulate(mesh.polygons, mesh.facet_normals);
    if (smoothing.weights == VertexNormals::file) {
        split_by_normals(mesh, take_file_normals(mesh, placement));
        return mesh;
    }
    const Connectivity connected = known ? Connectivity(mesh.polygons, *known) : Connectivity(mesh.polygons);
    if (smoothing.weights == VertexNormals::groups || smoothing.weights == VertexNormals::crease)
        split_by_normals(mesh, corner_normals(connected, mesh.facet_normals, smoothing, mesh.redundant_facets));
    else
        mesh.vertex_normals = vertex_normals(connected, mesh.facet_normals, smoothing.weights, mesh.redundant_facets);
    return mesh;
}

} // namespace forceshade
