#include "host/mesh/self_intersections.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include <CGAL/Bbox_3.h>
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

namespace forceshade {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

struct GivenUp {};

// For each vertex the first one at the same place.
std::vector<std::uint32_t> places(std::span<const glm::dvec3> vertices) {
    const auto key = [&](std::uint32_t i) { return std::tuple(vertices[i].x, vertices[i].y, vertices[i].z); };
    std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order,
                      [&](std::uint32_t a, std::uint32_t b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
    for (std::size_t i = 0; i < order.size(); ++i)
        first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
    return first;
}

Kernel::Point_3 point(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

class PairTest {
public:
    PairTest(std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
             std::size_t most_pairs)
        : vertices_(vertices), triangles_(triangles), places_(places(vertices)), most_pairs_(most_pairs) {}

    // Needles round a vertex of high valence all overlap in their boxes: pairs grow with the square of their number.
    void test(std::uint32_t a, std::uint32_t b) {
        if (++near_ > 20'000'000 + 50 * triangles_.size())
            throw GivenUp();
        for (const std::uint32_t i : triangles_[a])
            for (const std::uint32_t j : triangles_[b])
                if (places_[i] == places_[j])
                    return;
        found_ += CGAL::do_intersect(triangle(a), triangle(b));
        if (found_ >= most_pairs_ || ++tested_ >= 50 * most_pairs_)
            throw GivenUp();
    }

    std::size_t found() const { return found_; }

private:
    Kernel::Triangle_3 triangle(std::uint32_t i) const {
        const auto& [a, b, c] = triangles_[i];
        return {point(vertices_[a]), point(vertices_[b]), point(vertices_[c])};
    }

    std::span<const glm::dvec3> vertices_;
    std::span<const std::array<std::uint32_t, 3>> triangles_;
    std::vector<std::uint32_t> places_;
    std::size_t most_pairs_, found_ = 0, tested_ = 0, near_ = 0;
};

} // namespace

SelfIntersections count_self_intersections(std::span<const glm::dvec3> vertices,
                                           std::span<const std::array<std::uint32_t, 3>> triangles,
                                           std::span<const glm::dvec3> normals, std::size_t most_pairs) {
    std::vector<Box> boxes;
    boxes.reserve(triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        const auto& [a, b, c] = triangles[i];
        if (normals[i] != glm::dvec3(0))
            boxes.emplace_back(point(vertices[a]).bbox() + point(vertices[b]).bbox() + point(vertices[c]).bbox(), i);
    }
    PairTest pairs(vertices, triangles, most_pairs);
    try {
        CGAL::box_self_intersection_d(boxes.begin(), boxes.end(),
                                      [&](const Box& a, const Box& b) { pairs.test(a.info(), b.info()); });
    } catch (const GivenUp&) {
        return {pairs.found(), false};
    }
    return {pairs.found(), true};
}

} // namespace forceshade
