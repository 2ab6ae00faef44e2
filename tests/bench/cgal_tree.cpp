#include "tests/bench/cgal_tree.h"

#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

namespace forceshade::bench {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Faces = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Faces::const_iterator>;

} // namespace

struct CgalTree::Tree {
    Faces faces;
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree;
};

CgalTree::CgalTree(std::span<const double> vertices, std::span<const std::uint32_t> corners) : tree_(new Tree) {
    const auto at = [&](std::uint32_t v) {
        return Kernel::Point_3(vertices[3 * std::size_t(v)], vertices[3 * std::size_t(v) + 1],
                               vertices[3 * std::size_t(v) + 2]);
    };
    for (std::size_t i = 0; i < corners.size(); i += 3)
        tree_->faces.emplace_back(at(corners[i]), at(corners[i + 1]), at(corners[i + 2]));
    tree_->tree.insert(tree_->faces.cbegin(), tree_->faces.cend());
    tree_->tree.accelerate_distance_queries();
}

CgalTree::~CgalTree() = default;

CgalTree::Nearest CgalTree::nearest(const glm::dvec3& place) const {
    const Kernel::Point_3 at(place.x, place.y, place.z);
    const auto [point, face] = tree_->tree.closest_point_and_primitive(at);
    return {static_cast<std::uint32_t>(face - tree_->faces.cbegin()), CGAL::squared_distance(at, point)};
}

} // namespace forceshade::bench
