#include "host/mesh/thin_parts.h"

#include <algorithm>

#include <glm/common.hpp>

#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

constexpr std::size_t kMostLooks = std::size_t(1) << 16;
constexpr double kTouching = 1e-9; /* nearer facets coincide, as the two sides of a sheet */
constexpr double kBeside = 1e-12;  /* what rounding makes of a place on a triangle */

using Place = reference::Vector<double>;

bool is_crossed(const reference::Triangle<double>& triangle, const Place& from, const Place& to, double reach) {
    const double begin = reference::dot(triangle.normal, from - triangle.corners[0]);
    const double end = reference::dot(triangle.normal, to - triangle.corners[0]);
    if (!(begin * end <= 0) || begin == end)
        return false;
    const double time = begin / (begin - end);
    const Place crossing = from + time * (to - from);
    return time * reach > kTouching && reference::nearest_on_triangle(crossing, triangle).square < kBeside * kBeside;
}

bool meets(const layout::MeshNode& node, layout::uint child, const Place& low, const Place& high) {
    return node.low_x[child] <= high.x && node.high_x[child] >= low.x && node.low_y[child] <= high.y &&
           node.high_y[child] >= low.y && node.low_z[child] <= high.z && node.high_z[child] >= low.z;
}

/// Whether a triangle other than this one crosses a straight line from its middle.
bool is_faced(const layout::MeshView<double>& mesh, layout::uint index, double reach) {
    const reference::Triangle<double> triangle = reference::triangle_at(mesh, index);
    const Place middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
    bool faced = false;
    for (const double side : {-reach, reach}) {
        const Place end = middle + side * triangle.normal;
        const Place low = glm::min(middle, end), high = glm::max(middle, end);
        reference::visit_tree(
            mesh, [&](layout::uint) { return !faced; },
            [&](const layout::MeshNode& node, layout::uint child) { return meets(node, child, low, high); },
            [&](layout::uint first, layout::uint last) {
                for (; first < last; ++first)
                    faced = faced ||
                            (first != index && is_crossed(reference::triangle_at(mesh, first), middle, end, reach));
            });
    }
    return faced;
}

} // namespace

bool has_thin_parts(const MeshStructure& structure, double reach) {
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 0);
    const layout::MeshView<double> mesh = tables.view();
    const std::size_t every = std::max<std::size_t>(1, structure.triangles() / kMostLooks);
    for (std::size_t i = 0; i < structure.triangles(); i += every)
        if (is_faced(mesh, static_cast<layout::uint>(i), reach))
            return true;
    return false;
}

} // namespace forceshade
