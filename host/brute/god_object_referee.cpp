#include "host/brute/god_object_referee.h"

#include <algorithm>
#include <cmath>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <glm/geometric.hpp>

namespace forceshade::brute {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point point_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

template <typename T> Triangles triangles_of(std::span<const T> vertices, std::span<const std::uint32_t> corners) {
    Triangles triangles;
    const auto at = [&](std::uint32_t v) {
        return glm::dvec3(vertices[3 * std::size_t(v)], vertices[3 * std::size_t(v) + 1],
                          vertices[3 * std::size_t(v) + 2]);
    };
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        triangles.corners.push_back({at(corners[i]), at(corners[i + 1]), at(corners[i + 2])});
    return triangles;
}

bool apart(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle) {
    for (int axis = 0; axis < 3; ++axis) {
        const double a = triangle[0][axis], b = triangle[1][axis], c = triangle[2][axis];
        if (std::max(from[axis], to[axis]) < std::min({a, b, c}) ||
            std::min(from[axis], to[axis]) > std::max({a, b, c}))
            return true;
    }
    return false;
}

} // namespace

Triangles Triangles::of(std::span<const double> vertices, std::span<const std::uint32_t> corners) {
    return triangles_of(vertices, corners);
}

Triangles Triangles::of(std::span<const float> vertices, std::span<const std::uint32_t> corners) {
    return triangles_of(vertices, corners);
}

bool segment_touches_triangle(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle) {
    if (apart(from, to, triangle))
        return false;
    const Kernel::Triangle_3 face(point_of(triangle[0]), point_of(triangle[1]), point_of(triangle[2]));
    if (from == to)
        return !face.is_degenerate() && face.has_on(point_of(from));
    const Kernel::Segment_3 way(point_of(from), point_of(to));
    if (face.is_degenerate())
        return false; // the structure leaves it out: its neighbours cover it
    return CGAL::do_intersect(way, face);
}

TriangleGrid::TriangleGrid(const Triangles& triangles) : triangles_(triangles), low_(1e300), high_(-1e300) {
    for (const auto& triangle : triangles.corners)
        for (const glm::dvec3& corner : triangle) {
            low_ = glm::dvec3(std::min(low_.x, corner.x), std::min(low_.y, corner.y), std::min(low_.z, corner.z));
            high_ = glm::dvec3(std::max(high_.x, corner.x), std::max(high_.y, corner.y), std::max(high_.z, corner.z));
        }
    const double side = std::max({high_.x - low_.x, high_.y - low_.y, high_.z - low_.z});
    cell_ = side / std::clamp(std::sqrt(static_cast<double>(triangles.corners.size())), 1.0, 128.0) * 1.000001;
    for (int axis = 0; axis < 3; ++axis)
        size_[static_cast<std::size_t>(axis)] = static_cast<int>((high_[axis] - low_[axis]) / cell_) + 1;
    cells_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
    for (std::uint32_t t = 0; t < triangles.corners.size(); ++t) {
        const auto& [a, b, c] = triangles.corners[t];
        const auto first = cell_of({std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})});
        const auto last = cell_of({std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})});
        for (int z = first[2]; z <= last[2]; ++z)
            for (int y = first[1]; y <= last[1]; ++y)
                for (int x = first[0]; x <= last[0]; ++x)
                    cells_[(std::size_t(z) * std::size_t(size_[1]) + std::size_t(y)) * std::size_t(size_[0]) +
                           std::size_t(x)]
                        .push_back(t);
    }
}

std::array<int, 3> TriangleGrid::cell_of(const glm::dvec3& point) const {
    std::array<int, 3> cell;
    for (int axis = 0; axis < 3; ++axis) {
        const double place = std::floor((point[axis] - low_[axis]) / cell_);
        cell[static_cast<std::size_t>(axis)] =
            static_cast<int>(std::clamp(place, 0.0, size_[static_cast<std::size_t>(axis)] - 1.0));
    }
    return cell;
}

bool TriangleGrid::touches_in(std::size_t cell, const glm::dvec3& from, const glm::dvec3& to) const {
    return std::any_of(cells_[cell].begin(), cells_[cell].end(),
                       [&](std::uint32_t t) { return segment_touches_triangle(from, to, triangles_.corners[t]); });
}

bool TriangleGrid::touches(const glm::dvec3& from, const glm::dvec3& to) const {
    const auto first = cell_of({std::min(from.x, to.x), std::min(from.y, to.y), std::min(from.z, to.z)});
    const auto last = cell_of({std::max(from.x, to.x), std::max(from.y, to.y), std::max(from.z, to.z)});
    for (int z = first[2]; z <= last[2]; ++z)
        for (int y = first[1]; y <= last[1]; ++y)
            for (int x = first[0]; x <= last[0]; ++x)
                if (touches_in((std::size_t(z) * std::size_t(size_[1]) + std::size_t(y)) * std::size_t(size_[0]) +
                                   std::size_t(x),
                               from, to))
                    return true;
    return false;
}

double distance_from_cone(const glm::dvec3& pull, std::span<const glm::dvec3> normals) {
    // The nearest point of the cone is on one of its faces: the plain span of some of the normals, none of them pushed.
    double least = glm::length(pull);
    const std::size_t count = normals.size();
    for (unsigned subset = 1; subset < 1U << count; ++subset) {
        // Gram-Schmidt over the subset, then back substitution for the weights.
        std::array<glm::dvec3, 3> axes{};
        std::array<std::array<double, 3>, 3> parts{};
        std::array<std::size_t, 3> members{};
        std::size_t rank = 0;
        for (std::size_t i = 0; i < count; ++i) {
            if ((subset >> i & 1U) == 0)
                continue;
            glm::dvec3 axis = -normals[i];
            for (std::size_t j = 0; j < rank; ++j) {
                parts[j][rank] = glm::dot(axes[j], axis);
                axis -= parts[j][rank] * axes[j];
            }
            const double length = glm::length(axis);
            if (!(length > 1e-14))
                break;
            parts[rank][rank] = length;
            axes[rank] = axis / length;
            members[rank++] = i;
        }
        std::array<double, 3> weights{};
        glm::dvec3 rest = pull;
        for (std::size_t i = rank; i-- > 0;) {
            weights[i] = glm::dot(axes[i], pull);
            for (std::size_t j = i + 1; j < rank; ++j)
                weights[i] -= parts[i][j] * weights[j];
            weights[i] /= parts[i][i];
        }
        for (std::size_t i = 0; i < rank; ++i) {
            weights[i] = std::max(weights[i], 0.0);
            rest += weights[i] * normals[members[i]];
        }
        least = std::min(least, glm::length(rest));
    }
    return least;
}

} // namespace forceshade::brute
