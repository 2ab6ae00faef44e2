// Of meshes.
#include "host/referee/referee.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

namespace forceshade::brute {

namespace {

constexpr Real kPi = std::numbers::pi_v<Real>;

Real length(const Vector& v) {
    return std::hypot(v[0], v[1], v[2]);
}

Vector unit(const Vector& v) {
    const Real size = length(v);
    return size > 0 ? (1 / size) * v : Vector(0);
}

/// Twice the area over the longest side.
Real height(const Mesh& mesh, std::size_t triangle) {
    Vector sides[3];
    Real longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector start(mesh.polygons.vertices[mesh.triangles.corners[triangle][i]]);
        sides[i] = Vector(mesh.polygons.vertices[mesh.triangles.corners[triangle][(i + 1) % 3]]) - start;
        longest = std::max(longest, length(sides[i]));
    }
    return longest > 0 ? length(cross(sides[0], sides[1])) / longest : 0;
}

/// The angle between two directions.
Real angle(const Vector& u, const Vector& v) {
    return std::atan2(length(cross(u, v)), dot(u, v));
}

/// Nearest point of a segment.
Vector on_segment(const Vector& p, const Vector& a, const Vector& b) {
    const Vector edge = b - a;
    const Real square = dot(edge, edge);
    return square > 0 ? a + std::clamp(dot(p - a, edge) / square, Real(0), Real(1)) * edge : a;
}

/// Barycentric coordinates by Cramer's rule: the foot if it is inside, else the nearest of the three sides.
Vector on_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
    const Vector u = b - a, v = c - a, w = p - a;
    const Vector normal = cross(u, v);
    const Real square = dot(normal, normal);
    const Real at_c = dot(cross(u, w), normal), at_b = dot(cross(w, v), normal), at_a = square - at_b - at_c;
    if (square > 0 && at_a >= 0 && at_b >= 0 && at_c >= 0)
        return p - (dot(w, normal) / square) * normal;
    const Vector sides[3] = {on_segment(p, a, b), on_segment(p, b, c), on_segment(p, c, a)};
    return *std::min_element(
        sides, sides + 3, [&](const Vector& one, const Vector& other) { return length(one - p) < length(other - p); });
}

/// The angle that a triangle fills round a point of its own: 2 pi on its face, pi on a side, its own at a corner.
Real angle_filled(const Vector& point, const std::array<Vector, 3>& corners, Real tolerance) {
    for (std::size_t i = 0; i < 3; ++i)
        if (length(point - corners[i]) <= tolerance)
            return angle(corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
    for (std::size_t i = 0; i < 3; ++i)
        if (length(point - on_segment(point, corners[i], corners[(i + 1) % 3])) <= tolerance)
            return kPi;
    return 2 * kPi;
}

} // namespace

ChosenTriangles choose_triangles(const Mesh& mesh) {
    Real farthest = 0;
    for (const std::uint32_t corner : mesh.polygons.corners)
        farthest = std::max(farthest, length(Vector(mesh.polygons.vertices[corner])));
    // Placing a mesh rounds each coordinate a few times: a height of that order is none.
    const Real noise = Real(4e-15) * farthest;
    ChosenTriangles chosen;
    std::vector<std::size_t> thin;
    for (std::size_t i = 0; i < mesh.triangles.corners.size(); ++i) {
        if (std::ranges::binary_search(mesh.redundant_facets, mesh.triangles.facets[i]))
            continue;
        chosen.once.push_back(i);
        const bool is_thin = !(height(mesh, i) > noise);
        chosen.noise = is_thin ? noise : chosen.noise;
        if (mesh.triangles.normals[i] != glm::dvec3(0))
            (is_thin ? thin : chosen.touched).push_back(i);
    }
    if (chosen.touched.empty())
        chosen.touched = std::move(thin);
    return chosen;
}

MeshReferee::MeshReferee(const Mesh& mesh, MeshLaw law)
    : mesh_(mesh), law_(std::move(law)), chosen_(choose_triangles(mesh)), size_(0) {
    Vector low(std::numeric_limits<Real>::infinity()), high = -low;
    for (const std::uint32_t corner : mesh.polygons.corners)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], Vector(mesh.polygons.vertices[corner])[axis]);
            high[axis] = std::max(high[axis], Vector(mesh.polygons.vertices[corner])[axis]);
        }
    size_ = length(high - low);
    for (const std::size_t triangle : chosen_.touched) {
        Box& box = boxes_.emplace_back(Box{Vector(std::numeric_limits<Real>::infinity()), Vector(0)});
        box.high = -box.low;
        for (const Vector& corner : corners_of(triangle, Vector(0)))
            for (int axis = 0; axis < 3; ++axis) {
                box.low[axis] = std::min(box.low[axis], corner[axis]);
                box.high[axis] = std::max(box.high[axis], corner[axis]);
            }
    }
}

Real MeshReferee::Box::distance(const Vector& place) const {
    Vector away(0);
    for (int axis = 0; axis < 3; ++axis)
        away[axis] = std::max({low[axis] - place[axis], place[axis] - high[axis], Real(0)});
    return std::sqrt(dot(away, away));
}

std::array<Vector, 3> MeshReferee::corners_of(std::size_t triangle, const Vector& place) const {
    std::array<Vector, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = Vector(mesh_.polygons.vertices[mesh_.triangles.corners[triangle][i]]) - place;
    return corners;
}

MeshPoint MeshReferee::nearest(const glm::dvec3& world) const {
    const Vector probe(world), here(0);
    const Real infinite = std::numeric_limits<Real>::infinity(),
               tolerance = std::max(size_ * Real(1e-16), chosen_.noise);
    MeshPoint best{Vector(0), Vector(0), infinite, 0xFFFFFFFFu, Vector(0), infinite};
    for (std::size_t i = 0; i < chosen_.touched.size(); ++i) {
        if (boxes_[i].distance(probe) > best.distance)
            continue;
        const auto corners = corners_of(chosen_.touched[i], probe);
        const Vector offset = on_triangle(here, corners[0], corners[1], corners[2]);
        if (const Real distance = length(offset); distance < best.distance) {
            best.distance = distance;
            best.offset = offset;
        }
    }
    // What is farther off does not hold that point.
    const Real reach = best.distance + 4 * tolerance;
    for (std::size_t i = 0; i < chosen_.touched.size(); ++i) {
        if (boxes_[i].distance(probe) > std::max(reach, best.runner_up))
            continue;
        const std::size_t triangle = chosen_.touched[i];
        const auto corners = corners_of(triangle, probe);
        const Vector there = on_triangle(best.offset, corners[0], corners[1], corners[2]);
        if (length(there - best.offset) > tolerance) {
            best.runner_up = std::min(best.runner_up, length(on_triangle(here, corners[0], corners[1], corners[2])));
            continue;
        }
        best.facet = std::min(best.facet, mesh_.triangles.facets[triangle]);
        const Real filled = angle_filled(there, corners, tolerance);
        best.outward = best.outward + filled * unit(cross(corners[1] - corners[0], corners[2] - corners[0]));
    }
    best.point = probe + best.offset;
    return best;
}

Real MeshReferee::winding_number(const glm::dvec3& world) const {
    Real sum = 0;
    for (const std::size_t number : chosen_.once) {
        const auto [a, b, c] = corners_of(number, Vector(world));
        const Vector u = unit(a), v = unit(b), w = unit(c);
        sum += 2 * std::atan2(dot(u, cross(v, w)), 1 + dot(u, v) + dot(v, w) + dot(w, u));
    }
    return sum / (4 * kPi);
}

int MeshReferee::crossings(const glm::dvec3& world) const {
    Vector ray{0.5377L, 0.1833L, -0.8226L};
    for (int attempt = 0; attempt < 100; ++attempt) {
        int count = 0;
        bool clear = true;
        for (const std::size_t number : chosen_.once) {
            const auto [a, b, c] = corners_of(number, Vector(world));
            // On which side of each edge the ray passes.
            const Real sides[3] = {dot(ray, cross(a, b)), dot(ray, cross(b, c)), dot(ray, cross(c, a))};
            const Real sum = sides[0] + sides[1] + sides[2];
            const bool through =
                (sides[0] > 0 && sides[1] > 0 && sides[2] > 0) || (sides[0] < 0 && sides[1] < 0 && sides[2] < 0);
            for (const Real side : sides)
                clear = clear && std::abs(side) > size_ * size_ * Real(1e-18);
            if (through && dot(a, cross(b - a, c - a)) * sum > 0)
                count += sum > 0 ? 1 : -1;
        }
        if (clear)
            return count;
        ray = unit({ray.x * 0.93L + ray.y * 0.37L, ray.y * 0.93L - ray.x * 0.37L, ray.z + 0.123L});
    }
    return 0;
}

Vector MeshReferee::facet_normal(std::uint32_t facet) const {
    const std::uint32_t begin = mesh_.polygons.begins[facet], end = mesh_.polygons.begins[facet + 1];
    const Vector first = Vector(mesh_.polygons.vertices[mesh_.polygons.corners[begin]]);
    Vector sum(0);
    for (std::uint32_t i = begin + 1; i + 1 < end; ++i)
        sum = sum + cross(Vector(mesh_.polygons.vertices[mesh_.polygons.corners[i]]) - first,
                          Vector(mesh_.polygons.vertices[mesh_.polygons.corners[i + 1]]) - first);
    return unit(sum);
}

Vector MeshReferee::interpolated(std::uint32_t facet, const Vector& point) const {
    std::vector<Vector> corners, normals;
    for (std::uint32_t i = mesh_.polygons.begins[facet]; i < mesh_.polygons.begins[facet + 1]; ++i) {
        corners.push_back(Vector(mesh_.polygons.vertices[mesh_.polygons.corners[i]]) - point);
        normals.push_back(Vector(mesh_.vertex_normals[mesh_.polygons.corners[i]]));
    }
    const std::size_t count = corners.size();
    Vector sum(0);
    if (law_.shading == MeshShading::morgenbesser) {
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                if (j != i)
                    sum = sum + length(corners[i]) * normals[j];
        return sum;
    }
    const Vector facing = facet_normal(facet);
    if (law_.shading == MeshShading::barycentric) {
        for (std::size_t i = 0; i < 3; ++i)
            sum = sum + dot(facing, cross(corners[(i + 1) % 3], corners[(i + 2) % 3])) * normals[i];
        return sum;
    }
    // Mean value: angles in the facet's plane.
    std::vector<Real> halves(count);
    for (Vector& corner : corners)
        corner -= dot(corner, facing) * facing;
    for (std::size_t i = 0; i < count; ++i) {
        if (!(length(corners[i]) > 0))
            return normals[i];
        const Vector& next = corners[(i + 1) % count];
        halves[i] = std::atan2(dot(facing, cross(corners[i], next)), dot(corners[i], next)) / 2;
    }
    Real weights = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Real weight = (std::tan(halves[(i + count - 1) % count]) + std::tan(halves[i])) / length(corners[i]);
        sum = sum + weight * normals[i];
        weights += weight;
    }
    return (1 / weights) * sum;
}

Vector MeshReferee::direction(std::uint32_t facet, const Vector& point) const {
    const Vector facing = facet_normal(facet);
    Vector result = law_.shading == MeshShading::none ? facing : unit(interpolated(facet, point));
    if (law_.map && length(result) > 0) {
        const auto slope = law_.map(point.x, point.y);
        const Vector gradient{slope[0], slope[1], 0};
        result = unit(result - (gradient - dot(gradient, facing) * facing));
    }
    return result;
}

bool MeshReferee::is_inside(const glm::dvec3& world, const MeshPoint& nearest) const {
    return law_.inside == MeshInside::winding ? winding_number(world) > Real(0.5)
                                              : dot(nearest.offset, nearest.outward) > 0;
}

// The law at a point of a facet, `offset` away from the probe.
Answer MeshReferee::touching(std::uint32_t facet, const Vector& offset, const Vector& point) const {
    Answer answer;
    answer.depth = length(offset);
    answer.facet = facet;
    answer.proxy = point;
    answer.unshaded = law_.stiffness * offset;
    answer.force = answer.unshaded;
    const Vector facing = facet_normal(facet);
    if (law_.shading != MeshShading::none || law_.map) {
        const Vector shaded = direction(facet, point);
        const Real lift = law_.shading == MeshShading::two_pass ? dot(shaded, facing) : Real(1);
        if (length(shaded) > 0 && lift > 0)
            answer.force = (law_.stiffness * answer.depth / lift) * shaded;
    }
    if (law_.texture) {
        const auto slope = law_.texture(point.x, point.y);
        const Vector gradient{slope[0], slope[1], 0};
        const Vector pull = (law_.texture_stiffness * answer.depth) * (gradient - dot(gradient, facing) * facing);
        answer.force = answer.force - pull;
        answer.unshaded = answer.unshaded - pull;
    }
    return answer;
}

Answer MeshReferee::at(const glm::dvec3& world) const {
    const MeshPoint found = nearest(world);
    if (!is_inside(world, found))
        return {.proxy = Vector(world)};
    return touching(found.facet, found.offset, found.point);
}

std::vector<Answer> MeshReferee::all_at(const glm::dvec3& world, Real tolerance) const {
    const Vector probe(world);
    const MeshPoint found = nearest(world);
    const bool inside = is_inside(world, found), either = found.distance <= tolerance;
    std::vector<Answer> answers;
    if (!inside || either)
        answers.push_back({.proxy = probe});
    for (const std::size_t i : chosen_.touched) {
        if (!inside && !either)
            break;
        const auto [a, b, c] = corners_of(i, probe);
        const Vector offset = on_triangle(Vector(0), a, b, c);
        if (length(offset) <= found.distance + tolerance)
            answers.push_back(touching(mesh_.triangles.facets[i], offset, probe + offset));
    }
    return answers;
}

} // namespace forceshade::brute
