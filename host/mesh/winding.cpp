#include "host/mesh/winding.h"

#include <algorithm>
#include <cmath>

#include "host/mesh/structure_edges.h"
#include "host/reference/vector.h"

namespace forceshade {
namespace {

using layout::uint;
using Vector = reference::Vector<double>;

double length(const Vector& v) {
    return std::sqrt(reference::dot(v, v));
}

Vector vector_of(const double (&numbers)[3]) {
    return {numbers[0], numbers[1], numbers[2]};
}

/// A child of a node: a triangle, or the moments of a node below.
struct Part {
    double area;
    Vector centre, dipole;
    double radius;
    const layout::MeshMoment* below = nullptr;
};

/// Triangle by triangle and node by node, the deepest first.
class Moments {
public:
    explicit Moments(const MeshStructure& structure) : structure_(structure) {
        const std::vector<layout::MeshNode>& nodes = structure.parts->nodes;
        moments_.resize(nodes.size());
        areas_.resize(nodes.size());
        for (std::size_t i = nodes.size(); i-- > 0;) // children stand behind their parents
            sum(i);
    }

    std::vector<layout::MeshMoment> take() { return std::move(moments_); }

private:
    Part part_of_triangle(std::size_t triangle) const {
        const auto corner = [&](std::size_t i) {
            return reference::vector_at<double>(structure_.reals->vertices,
                                                structure_.parts->triangle_corners[3 * triangle + i]);
        };
        const Vector a = corner(0), b = corner(1), c = corner(2);
        const Vector centre = (a + b + c) / 3.0, dipole = reference::cross(Vector(b - a), Vector(c - a)) / 2.0;
        const double radius = std::max({length(a - centre), length(b - centre), length(c - centre)});
        return {length(dipole), centre, dipole, radius};
    }

    std::vector<Part> parts_of(const layout::MeshNode& node) const {
        std::vector<Part> parts;
        for (const uint child : node.child) {
            if (child == layout::kMeshNoChild)
                continue;
            if ((child & layout::kMeshLeaf) == 0) {
                const layout::MeshMoment& moment = moments_[child];
                parts.push_back(
                    {areas_[child], vector_of(moment.centre), vector_of(moment.dipole), moment.radius, &moment});
                continue;
            }
            const uint run = child & ~layout::kMeshLeaf;
            for (uint i = 0; i <= run % layout::kMeshLeafTriangles; ++i)
                parts.push_back(part_of_triangle(run / layout::kMeshLeafTriangles + i));
        }
        return parts;
    }

    void sum(std::size_t index) {
        const std::vector<Part> parts = parts_of(structure_.parts->nodes[index]);
        double area = 0;
        Vector centre(0.0), dipole(0.0);
        for (const Part& part : parts) {
            area += part.area;
            centre += part.area * part.centre;
            dipole += part.dipole;
        }
        centre = area > 0 ? centre / area : parts.front().centre;
        layout::MeshMoment moment{{centre.x, centre.y, centre.z}, 0, {dipole.x, dipole.y, dipole.z}, {}};
        for (const Part& part : parts) {
            const Vector shift = part.centre - centre;
            moment.radius = std::max(moment.radius, length(shift) + part.radius);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    moment.quadrupole[3 * i + j] +=
                        part.dipole[i] * shift[j] + (part.below ? part.below->quadrupole[3 * i + j] : 0);
        }
        moments_[index] = moment;
        areas_[index] = area;
    }

    const MeshStructure& structure_;
    std::vector<layout::MeshMoment> moments_;
    std::vector<double> areas_;
};

} // namespace

std::shared_ptr<const MeshWinding> make_winding(const MeshStructure& structure) {
    return std::make_shared<const MeshWinding>(
        MeshWinding{Moments(structure).take(), find_rims(*structure.parts, weld(structure.reals->vertices))});
}

} // namespace forceshade
