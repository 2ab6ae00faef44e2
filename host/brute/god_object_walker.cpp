#include "host/brute/god_object_walker.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace forceshade::brute {

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

void SurfaceWalker::offer(Way& best, Way way) {
    if (!(way.gain > kRest))
        return;
    const Real ahead = way.gain - best.gain;
    const Real scale = std::max(way.gain, best.gain);
    const bool tied = std::abs(ahead) <= 1e-14L * scale;
    if (best.facet != ~0U && way.on != best.on)
        margin_ = std::min(margin_, std::abs(ahead) / scale);
    if ((!tied && ahead > 0) || (tied && way.facet < best.facet))
        best = std::move(way);
}

// Over a face, away from the edges that the proxy is on.
void SurfaceWalker::offer_face(Way& best, std::uint32_t triangle, const Point& pull) {
    const Point n = normals_[triangle];
    Point way = pull - glm::dot(pull, n) * n;
    way -= glm::dot(way, n) * n;
    const Real length = glm::length(way);
    if (!(length > kRest * glm::length(pull)))
        return;
    const auto& corners = triangles_[triangle];
    for (std::size_t i = 0; i < 3; ++i) {
        const Point start = vertices_[corners[i]], edge = vertices_[corners[(i + 1) % 3]] - start;
        const Point inward = glm::normalize(glm::cross(n, edge));
        const bool on_edge = std::abs(glm::dot(inward, proxy_ - start)) <= kFlush;
        if (corners_ < 3 && on_edge && !(glm::dot(inward, way) > 0))
            return;
    }
    offer(best, {way / length, length, normal(triangle), facets_[triangle], {triangle}});
}

// Along an edge, either way.
void SurfaceWalker::offer_edge(Way& best, const std::array<std::uint32_t, 2>& edge, const Point& pull) {
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

SurfaceWalker::Way SurfaceWalker::steepest(const Point& pull) {
    Way best;
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

// The angle-weighted normal of the feature: tells the side where no way leads towards the probe.
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

void SurfaceWalker::slide(const Way& way, const Point& probe) {
    Real length = glm::dot(way.direction, probe - proxy_);
    for (const std::uint32_t t : way.on)
        for (std::size_t i = 0; i < 3; ++i) {
            const Point start = vertices_[triangles_[t][i]], edge = vertices_[triangles_[t][(i + 1) % 3]] - start;
            const Point inward = glm::normalize(glm::cross(normals_[t], edge));
            const Real rate = glm::dot(inward, way.direction), inside = glm::dot(inward, proxy_ - start);
            if (rate < -1e-17L && inside > kFlush)
                length = std::min(length, inside / -rate);
        }
    proxy_ += length * way.direction;
    settle_on(way.on, kFlush);
}

// Straight towards the probe; false if nothing is in the way.
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
            margin_ = 0; // round a corner of the rim there is more than one way
        Way way;
        if (!leaves) {
            way = steepest(pull);
            const Point front = way.gain > 0 ? way.normal : rest_normal();
            leaves = glm::dot(front, pull) > 0;
        }
        if (leaves) {
            if (fly(probe))
                continue;
            proxy_ = probe;
            fan_.clear();
            return true;
        }
        if (!(way.gain > 0))
            return true;
        slide(way, probe);
    }
    return false;
}

} // namespace forceshade::brute
