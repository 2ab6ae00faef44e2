#include "tests/mesh/god_object_referee.h"

#include <algorithm>
#include <cmath>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <glm/geometric.hpp>

namespace forceshade::brute {

namespace {

constexpr double kMostEntries = 2e7; // of a grid: triangles times the cells that they are listed in

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactPoint = Kernel::Point_3;

ExactPoint point_of(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

Kernel::Triangle_3 face_of(const std::array<glm::dvec3, 3>& triangle) {
    return {point_of(triangle[0]), point_of(triangle[1]), point_of(triangle[2])};
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

/// Whether both ends are on one side of the triangle's plane by more than rounding can make of it. Of components up to
/// `size` for the edges and `far` for the ends, products of three are off by less than 64 roundings together.
bool on_one_side(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle) {
    const auto largest = [](const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
    const glm::dvec3 one = triangle[1] - triangle[0], other = triangle[2] - triangle[0];
    const glm::dvec3 begin = from - triangle[0], end = to - triangle[0], normal = glm::cross(one, other);
    const double size = std::max(largest(one), largest(other)), far = std::max(largest(begin), largest(end));
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * size * size * far + 1e-300;
    const double first = glm::dot(normal, begin), last = glm::dot(normal, end);
    return std::min(first, last) > rounding || std::max(first, last) < -rounding;
}

} // namespace

Triangles Triangles::of(std::span<const double> vertices, std::span<const std::uint32_t> corners) {
    return triangles_of(vertices, corners);
}

Triangles Triangles::of(std::span<const float> vertices, std::span<const std::uint32_t> corners) {
    return triangles_of(vertices, corners);
}

bool segment_touches_triangle(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle) {
    if (apart(from, to, triangle) || on_one_side(from, to, triangle))
        return false;
    const Kernel::Triangle_3 face = face_of(triangle);
    return from == to ? face.has_on(point_of(from))
                      : CGAL::do_intersect(Kernel::Segment_3(point_of(from), point_of(to)), face);
}

TriangleGrid::TriangleGrid(const Triangles& triangles) : triangles_(triangles), low_(1e300), high_(-1e300) {
    for (const auto& triangle : triangles.corners)
        for (const glm::dvec3& corner : triangle) {
            low_ = glm::dvec3(std::min(low_.x, corner.x), std::min(low_.y, corner.y), std::min(low_.z, corner.z));
            high_ = glm::dvec3(std::max(high_.x, corner.x), std::max(high_.y, corner.y), std::max(high_.z, corner.z));
        }
    double side = std::max({high_.x - low_.x, high_.y - low_.y, high_.z - low_.z});
    if (side == 0) // all in one place, to the precision at hand
        side = 1;
    const auto resize = [&](double cells) {
        cell_ = side / cells * 1.000001;
        for (int axis = 0; axis < 3; ++axis)
            size_[static_cast<std::size_t>(axis)] = static_cast<int>((high_[axis] - low_[axis]) / cell_) + 1;
    };
    const auto cells_over = [&](const std::array<glm::dvec3, 3>& triangle) {
        const auto [first, last] = cells_of(triangle);
        double cells = 1;
        for (std::size_t axis = 0; axis < 3; ++axis)
            cells *= last[axis] - first[axis] + 1;
        return cells;
    };
    // Long slanted needles, as at a pole, lie over most of a fine grid each.
    for (double cells = std::clamp(std::sqrt(double(triangles.corners.size())), 1.0, 128.0);; cells /= 2) {
        resize(std::max(cells, 1.0));
        double entries = 0;
        for (const auto& triangle : triangles.corners)
            entries += cells_over(triangle);
        if (entries <= kMostEntries || cells <= 1)
            break;
    }
    cells_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
    for (std::uint32_t t = 0; t < triangles.corners.size(); ++t) {
        if (face_of(triangles.corners[t]).is_degenerate())
            continue; // the structure leaves it out: its neighbours cover it
        const auto [first, last] = cells_of(triangles.corners[t]);
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

std::pair<std::array<int, 3>, std::array<int, 3>>
TriangleGrid::cells_of(const std::array<glm::dvec3, 3>& triangle) const {
    const auto& [a, b, c] = triangle;
    return {cell_of({std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})}),
            cell_of({std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})})};
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

namespace {

using Real = SurfaceWalker::Real;
using Point = SurfaceWalker::Point;

constexpr Real kFlush = 1e-15L; // two features this close are one
constexpr Real kRest = 1e-16L;  // of the pull: less is rounding

std::pair<std::uint32_t, std::uint32_t> key(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

} // namespace

SurfaceWalker::SurfaceWalker(std::vector<glm::dvec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                             std::vector<std::uint32_t> facets)
    : vertices_(vertices.begin(), vertices.end()), triangles_(std::move(triangles)), facets_(std::move(facets)),
      around_(vertices_.size()) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        const auto& [a, b, c] = triangles_[t];
        normals_.push_back(glm::normalize(glm::cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a])));
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            edges_[key(triangles_[t][k], triangles_[t][(k + 1) % 3])].push_back(t);
            around_[triangles_[t][k]].push_back(t);
        }
    }
}

Point SurfaceWalker::normal(std::uint32_t triangle) const {
    return side_ * normals_[triangle];
}

void SurfaceWalker::begin(const glm::dvec3& probe) {
    proxy_ = probe;
    fan_.clear();
}

void SurfaceWalker::begin_on(std::uint32_t triangle, const glm::dvec3& proxy, bool in_front, double flush) {
    proxy_ = proxy;
    side_ = in_front ? 1 : -1;
    settle_on({triangle}, flush);
}

void SurfaceWalker::offer(Descent& best, Descent descent) {
    if (!(descent.gain > kRest))
        return;
    const Real ahead = descent.gain - best.gain;
    const Real scale = std::max(descent.gain, best.gain);
    const bool tied = std::abs(ahead) <= 1e-14L * scale;
    if (best.facet != ~0U && descent.on != best.on)
        margin_ = std::min(margin_, std::abs(ahead) / scale);
    if ((!tied && ahead > 0) || (tied && descent.facet < best.facet))
        best = std::move(descent);
}

// Over a face, away from the edges that the proxy is on.
void SurfaceWalker::offer_face(Descent& best, std::uint32_t triangle, const Point& pull) {
    const Point n = normals_[triangle];
    Point displacement = pull - glm::dot(pull, n) * n;
    displacement -= glm::dot(displacement, n) * n;
    const Real length = glm::length(displacement);
    if (!(length > kRest * glm::length(pull)))
        return;
    const auto& corners = triangles_[triangle];
    for (std::size_t i = 0; i < 3; ++i) {
        const Point start = vertices_[corners[i]], edge = vertices_[corners[(i + 1) % 3]] - start;
        const Point inward = glm::normalize(glm::cross(n, edge));
        const bool on_edge = std::abs(glm::dot(inward, proxy_ - start)) <= kFlush;
        if (corners_ < 3 && on_edge && !(glm::dot(inward, displacement) > 0))
            return;
    }
    offer(best, {displacement / length, length, normal(triangle), facets_[triangle], {triangle}});
}

// Along an edge, in either direction.
void SurfaceWalker::offer_edge(Descent& best, const std::array<std::uint32_t, 2>& edge, const Point& pull) {
    const std::vector<std::uint32_t>& on = edges_.at(key(edge[0], edge[1]));
    Point together{0};
    std::uint32_t facet = ~0U;
    for (const std::uint32_t t : on) {
        together += normal(t);
        facet = std::min(facet, facets_[t]);
    }
    const Point along = glm::normalize(vertices_[edge[1]] - vertices_[edge[0]]);
    const Real gain = glm::dot(along, pull);
    if (corners_ == 2 && gain < 0)
        offer(best, {-along, -gain, together, facet, on});
    else if (gain > 0)
        offer(best, {along, gain, together, facet, on});
}

SurfaceWalker::Descent SurfaceWalker::steepest(const Point& pull) {
    Descent best;
    for (const std::uint32_t t : fan_)
        offer_face(best, t, pull);
    if (corners_ == 2)
        offer_edge(best, {feature_[0], feature_[1]}, pull);
    if (corners_ == 1)
        for (const std::uint32_t t : fan_)
            for (std::size_t i = 0; i < 3; ++i)
                if (triangles_[t][i] != feature_[0])
                    offer_edge(best, {feature_[0], triangles_[t][i]}, pull);
    return best;
}

// The angle-weighted normal of the feature: tells the side where no descent leads towards the probe.
Point SurfaceWalker::rest_normal() const {
    Point sum{0};
    for (const std::uint32_t t : fan_) {
        Real weight = 1;
        if (corners_ == 1) {
            Point ends[2];
            int found = 0;
            for (const std::uint32_t v : triangles_[t])
                if (v != feature_[0])
                    ends[found++] = glm::normalize(vertices_[v] - vertices_[feature_[0]]);
            weight = std::acos(std::clamp(glm::dot(ends[0], ends[1]), Real(-1), Real(1)));
        }
        sum += weight * normal(t);
    }
    return sum;
}

bool SurfaceWalker::at_border() const {
    for (const std::uint32_t t : fan_)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = triangles_[t][i], b = triangles_[t][(i + 1) % 3];
            const bool here = corners_ == 1   ? a == feature_[0] || b == feature_[0]
                              : corners_ == 2 ? key(a, b) == key(feature_[0], feature_[1])
                                              : false;
            if (here && edges_.at(key(a, b)).size() == 1)
                return true;
        }
    return false;
}

// What the proxy is on, of these triangles.
void SurfaceWalker::settle_on(const std::vector<std::uint32_t>& candidates, Real flush) {
    fan_ = candidates;
    corners_ = 3;
    const Point& n = normals_[candidates[0]];
    proxy_ -= glm::dot(n, proxy_ - vertices_[triangles_[candidates[0]][0]]) * n;
    for (const std::uint32_t t : candidates)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = triangles_[t][i], b = triangles_[t][(i + 1) % 3];
            if (glm::length(proxy_ - vertices_[a]) <= 4 * flush) {
                corners_ = 1;
                feature_ = {a, a, a};
                proxy_ = vertices_[a];
                fan_ = around_[a];
                return;
            }
            const Point edge = glm::normalize(vertices_[b] - vertices_[a]);
            const Point to = proxy_ - vertices_[a];
            const Real along = glm::dot(to, edge);
            if (glm::length(to - along * edge) <= flush && along > 0 &&
                along < glm::length(vertices_[b] - vertices_[a])) {
                corners_ = 2;
                feature_ = {a, b, b};
                proxy_ = vertices_[a] + along * edge;
                fan_ = edges_.at(key(a, b));
            }
        }
}

void SurfaceWalker::slide(const Descent& descent, const Point& probe) {
    Real length = glm::dot(descent.direction, probe - proxy_);
    for (const std::uint32_t t : descent.on)
        for (std::size_t i = 0; i < 3; ++i) {
            const Point start = vertices_[triangles_[t][i]], edge = vertices_[triangles_[t][(i + 1) % 3]] - start;
            const Point inward = glm::normalize(glm::cross(normals_[t], edge));
            const Real rate = glm::dot(inward, descent.direction), inside = glm::dot(inward, proxy_ - start);
            if (rate < -1e-17L && inside > kFlush)
                length = std::min(length, inside / -rate);
        }
    proxy_ += length * descent.direction;
    settle_on(descent.on, kFlush);
}

// Straight towards the probe; false if nothing stands between.
bool SurfaceWalker::fly(const Point& probe) {
    const Point pull = probe - proxy_;
    Real first = 2;
    std::uint32_t hit = 0;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        if (std::find(fan_.begin(), fan_.end(), t) != fan_.end())
            continue;
        const auto& [a, b, c] = triangles_[t];
        const Real rate = glm::dot(normals_[t], pull), height = glm::dot(normals_[t], proxy_ - vertices_[a]);
        if (rate == 0)
            continue;
        const Real time = -height / rate;
        if (!(time > 0 && time <= 1 && time < first))
            continue;
        const Point place = proxy_ + time * pull;
        const auto inside = [&](std::uint32_t from, std::uint32_t to) {
            return glm::dot(glm::cross(normals_[t], vertices_[to] - vertices_[from]), place - vertices_[from]) >= 0;
        };
        if (inside(a, b) && inside(b, c) && inside(c, a)) {
            first = time;
            hit = t;
        }
    }
    if (first > 1)
        return false;
    proxy_ += first * pull;
    side_ = glm::dot(normals_[hit], pull) < 0 ? 1 : -1;
    settle_on({hit}, kFlush);
    return true;
}

bool SurfaceWalker::update(const glm::dvec3& position) {
    constexpr int kMost = 100000;
    const Point probe(position);
    margin_ = 1;
    for (int i = 0; i < kMost; ++i) {
        const Point pull = probe - proxy_;
        const bool rim = at_border();
        bool leaves = fan_.empty() || rim;
        if (rim && corners_ == 1)
            margin_ = 0; // round a corner of the rim there is more than one descent
        Descent descent;
        if (!leaves) {
            descent = steepest(pull);
            const Point front = descent.gain > 0 ? descent.normal : rest_normal();
            leaves = glm::dot(front, pull) > 0;
        }
        if (leaves) {
            if (fly(probe))
                continue;
            proxy_ = probe;
            fan_.clear();
            return true;
        }
        if (!(descent.gain > 0))
            return true;
        slide(descent, probe);
    }
    return false;
}

} // namespace forceshade::brute
