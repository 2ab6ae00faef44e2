// Cones of normals: how far a force is from one, how far planes keep a proxy off a corner.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

#include "host/norm.h"
#include "host/reference/elementary.h"

namespace forceshade {

/// How far a vector is from the cone that unit vectors span; `together(i, j)`: two of them may be combined. The
/// nearest place of a cone is in the span of no more than three of its vectors, with no negative share of any: all are
/// tried, in cubic time.
template <typename Together>
double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans, const Together& together) {
    double least = norm(vector);
    for (std::size_t i = 0; i < spans.size(); ++i) {
        const glm::dvec3& u = spans[i];
        const double on_u = reference::dot(u, vector);
        if (on_u > 0)
            least = std::min(least, norm(vector - on_u * u));
        for (std::size_t j = i + 1; j < spans.size(); ++j) {
            if (!together(i, j))
                continue;
            const glm::dvec3& v = spans[j];
            const double on_v = reference::dot(v, vector), uv = reference::dot(u, v), square = 1 - uv * uv;
            if (square > 1e-14) {
                const double of_u = (on_u - uv * on_v) / square, of_v = (on_v - uv * on_u) / square;
                if (of_u >= 0 && of_v >= 0)
                    least = std::min(least, norm(vector - of_u * u - of_v * v));
            }
            for (std::size_t k = j + 1; k < spans.size(); ++k) {
                const glm::dvec3& w = spans[k];
                const glm::dvec3 vw = reference::cross(v, w);
                const double volume = reference::dot(u, vw);
                if (!(std::abs(volume) > 1e-12) || !together(i, k) || !together(j, k))
                    continue;
                if (reference::dot(vector, vw) / volume >= 0 &&
                    reference::dot(vector, reference::cross(w, u)) / volume >= 0 &&
                    reference::dot(vector, reference::cross(u, v)) / volume >= 0)
                    return 0;
            }
        }
    }
    return least;
}

/// The same where all may be combined, in time linear in their number (active set; Lawson & Hanson 1974, chapter 23).
double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans);

/// How far from the origin a place is at least that is 1 in front of each of the planes through the origin with these
/// unit normals (Lawson & Hanson 1974, LDP); infinite if there is none.
double distance_of_offset_planes(std::span<const glm::dvec3> normals);

} // namespace forceshade
