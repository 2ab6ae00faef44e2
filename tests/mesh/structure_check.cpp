#include "tests/mesh/structure_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

namespace forceshade::shapes {
namespace {

using layout::uint;

class Checker {
public:
    explicit Checker(const MeshStructure& structure) : structure_(structure), parts_(*structure.parts) {}

    StructureCheck run() {
        std::vector<uint> all = check_node(0, 1);
        std::ranges::sort(all);
        expect(all.size() == structure_.triangles(), "the tree holds {} triangles", all.size());
        for (uint i = 0; i < all.size(); ++i)
            expect(all[i] == i, "the tree holds other triangles than {}", i);
        check_neighbours();
        return check_;
    }

private:
    template <typename... Values>
    void expect(bool holds, fmt::format_string<const Values&...> what, const Values&... values) {
        if (!holds && check_.fault.empty())
            check_.fault = fmt::format(what, values...);
    }

    glm::dvec3 place(std::size_t triangle, std::size_t corner) const {
        return reference::vector_at(std::span<const double>(structure_.reals->vertices),
                                    parts_.triangle_corners[3 * triangle + corner % 3]);
    }

    /// The triangles below a node.
    std::vector<uint> check_node(uint node, unsigned depth) {
        check_.depth = std::max(check_.depth, depth);
        std::vector<uint> all;
        for (std::size_t i = 0; i < layout::kMeshChildren; ++i) {
            const uint child = parts_.nodes[node].child[i];
            if (child == layout::kMeshNoChild)
                continue;
            std::vector<uint> below;
            if ((child & layout::kMeshLeaf) == 0)
                below = check_node(child, depth + 1);
            else
                for (uint k = 0; k <= child % layout::kMeshLeafTriangles; ++k)
                    below.push_back((child & ~layout::kMeshLeaf) / layout::kMeshLeafTriangles + k);
            check_bounds(node, i, below);
            all.insert(all.end(), below.begin(), below.end());
        }
        return all;
    }

    /// Of a node's child. A slab is measured in double: a search allows for more than the rounding of its products.
    void check_bounds(uint node, std::size_t i, const std::vector<uint>& below) {
        const layout::MeshNode& box = parts_.nodes[node];
        const layout::MeshSlabs& slabs = parts_.slabs[node];
        const glm::dvec3 low(box.low_x[i], box.low_y[i], box.low_z[i]),
            high(box.high_x[i], box.high_y[i], box.high_z[i]),
            normal(slabs.normal_x[i], slabs.normal_y[i], slabs.normal_z[i]);
        expect(reference::dot(normal, normal) <= 1, "the normal of a slab is longer than 1");
        for (const uint triangle : below)
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const glm::dvec3 at = place(triangle, corner);
                long double along = 0, rounding = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    expect(low[axis] <= at[axis] && at[axis] <= high[axis], "triangle {} is not in its box", triangle);
                    along += static_cast<long double>(normal[axis]) * at[axis];
                    rounding += 4e-16L * std::abs(at[axis]);
                }
                expect(slabs.low[i] - rounding <= along && along <= slabs.high[i] + rounding,
                       "triangle {} is not in its slab", triangle);
            }
    }

    void check_neighbours() {
        std::map<std::array<double, 6>, std::vector<std::size_t>> sides;
        const auto ends = [&](std::size_t side) {
            glm::dvec3 from = place(side / 3, side % 3) + 0.0, to = place(side / 3, side % 3 + 1) + 0.0; // no -0
            if (std::tie(to.x, to.y, to.z) < std::tie(from.x, from.y, from.z))
                std::swap(from, to);
            return std::array{from.x, from.y, from.z, to.x, to.y, to.z};
        };
        for (std::size_t side = 0; side < 3 * structure_.triangles(); ++side)
            sides[ends(side)].push_back(side / 3);
        for (std::size_t side = 0; side < 3 * structure_.triangles(); ++side) {
            const std::vector<std::size_t>& there = sides[ends(side)];
            const uint across = parts_.triangle_neighbours[side];
            if (there.size() == 1)
                expect(across == layout::kMeshBorder, "triangle {} is next to {} on a border", side / 3, across);
            else if (there.size() == 2 && there[0] != there[1])
                expect(across == there[0] + there[1] - side / 3, "triangle {} is not next to {}", side / 3, across);
            else
                expect(across != layout::kMeshBorder && (across & layout::kMeshManyBit) != 0,
                       "triangle {} is next to {} alone", side / 3, across);
        }
    }

    const MeshStructure& structure_;
    const MeshParts& parts_;
    StructureCheck check_;
};

} // namespace

StructureCheck check_structure(const MeshStructure& structure) {
    return Checker(structure).run();
}

} // namespace forceshade::shapes
