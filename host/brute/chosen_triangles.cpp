#include "host/brute/chosen_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace forceshade::brute {
namespace {

Real length(const std::array<Real, 3>& v) {
    return std::hypot(v[0], v[1], v[2]);
}

/// Twice the area over the longest side.
Real height(const Mesh& mesh, std::size_t triangle) {
    std::array<Real, 3> sides[3];
    Real longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3& start = mesh.polygons.vertices[mesh.triangles[triangle][i]];
        const glm::dvec3& end = mesh.polygons.vertices[mesh.triangles[triangle][(i + 1) % 3]];
        sides[i] = {Real(end.x) - Real(start.x), Real(end.y) - Real(start.y), Real(end.z) - Real(start.z)};
        longest = std::max(longest, length(sides[i]));
    }
    const auto& [u, v, w] = sides;
    const Real area = length({u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]});
    return longest > 0 ? area / longest : 0;
}

} // namespace

ChosenTriangles choose_triangles(const Mesh& mesh) {
    Real farthest = 0;
    for (const std::uint32_t corner : mesh.polygons.corners) {
        const glm::dvec3& at = mesh.polygons.vertices[corner];
        farthest = std::max(farthest, length({Real(at.x), Real(at.y), Real(at.z)}));
    }
    // Placing a mesh rounds each coordinate a few times: a height of that order is none.
    const Real noise = Real(4e-15) * farthest;
    ChosenTriangles chosen;
    std::vector<std::size_t> thin;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (std::ranges::binary_search(mesh.redundant_facets, mesh.triangle_facets[i]))
            continue;
        chosen.once.push_back(i);
        const bool is_thin = !(height(mesh, i) > noise);
        chosen.noise = is_thin ? noise : chosen.noise;
        if (mesh.triangle_normals[i] != glm::dvec3(0))
            (is_thin ? thin : chosen.touched).push_back(i);
    }
    if (chosen.touched.empty())
        chosen.touched = std::move(thin);
    return chosen;
}

} // namespace forceshade::brute
