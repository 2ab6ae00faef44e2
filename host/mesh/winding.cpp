#include "host/mesh/winding.h"

#include <algorithm>
#include <cmath>

#include "host/mesh/structure.h"
#include "host/mesh/triangulate.h"
#include "host/reference/elementary.h"

namespace forceshade {
namespace {

using layout::uint;
using Vector = reference::Vector<double>;

Vector vector_of(const double (&numbers)[3]) {
    return {numbers[0], numbers[1], numbers[2]};
}

/// Where the part i, j (or i, j, k) of a symmetric moment stands.
std::size_t place(std::size_t i, std::size_t j) {
    constexpr std::size_t kPlaces[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    return kPlaces[i][j];
}
std::size_t place(std::size_t i, std::size_t j, std::size_t k) {
    // By how often y and z come.
    constexpr std::size_t kPlaces[4][4] = {{0, 4, 7, 2}, {3, 9, 8, 0}, {5, 6, 0, 0}, {1, 0, 0, 0}};
    const std::size_t y = (i == 1) + (j == 1) + (k == 1), z = (i == 2) + (j == 2) + (k == 2);
    return kPlaces[y][z];
}

/// One of the triangles or nodes below a node: its moments about its own centre.
struct Part {
    layout::MeshMoment moment;
    double area;
};

/// Adds a part's moments to those about another centre.
void add(const layout::MeshMoment& part, layout::MeshMoment& sum) {
    double t[3];
    for (std::size_t i = 0; i < 3; ++i)
        t[i] = part.centre[i] - sum.centre[i];
    const double* d = part.dipole;
    const double* q = part.quadrupole;
    for (std::size_t i = 0; i < 3; ++i) {
        sum.dipole[i] += d[i];
        for (std::size_t j = i; j < 3; ++j) {
            sum.quadrupole[place(i, j)] += q[place(i, j)] + (d[i] * t[j] + d[j] * t[i]) / 2;
            for (std::size_t k = j; k < 3; ++k)
                sum.octupole[place(i, j, k)] +=
                    part.octupole[place(i, j, k)] +
                    (2 * (q[place(i, j)] * t[k] + q[place(i, k)] * t[j] + q[place(j, k)] * t[i]) +
                     (d[i] * t[j] * t[k] + d[j] * t[i] * t[k] + d[k] * t[i] * t[j])) /
                        3;
        }
    }
    sum.radius = std::max(sum.radius, reference::length(Vector(t[0], t[1], t[2])) + part.radius);
}

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
        Vector corners[3];
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = reference::vector_at<double>(structure_.reals->vertices,
                                                      structure_.parts->triangle_corners[3 * triangle + i]);
        const Vector centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        const Vector area = reference::cross(Vector(corners[1] - corners[0]), Vector(corners[2] - corners[0])) / 2.0;
        Part part{{{centre.x, centre.y, centre.z}, 0, {area.x, area.y, area.z}, {}, {}}, reference::length(area)};
        double spread[3][3] = {}; // mean of x_j x_k over the triangle
        for (const Vector& corner : corners) {
            const Vector from = corner - centre;
            part.moment.radius = std::max(part.moment.radius, reference::length(from));
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k)
                    spread[j][k] += from[j] * from[k] / 12;
        }
        const double* d = part.moment.dipole;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i; j < 3; ++j)
                for (std::size_t k = j; k < 3; ++k)
                    part.moment.octupole[place(i, j, k)] =
                        (d[i] * spread[j][k] + d[j] * spread[i][k] + d[k] * spread[i][j]) / 3;
        return part;
    }

    std::vector<Part> parts_of(const layout::MeshNode& node) const {
        std::vector<Part> parts;
        for (const uint child : node.child) {
            if (child == layout::kMeshNoChild)
                continue;
            if ((child & layout::kMeshLeaf) == 0) {
                parts.push_back({moments_[child], areas_[child]});
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
        Vector centre(0.0);
        for (const Part& part : parts) {
            area += part.area;
            centre += part.area * vector_of(part.moment.centre);
        }
        centre = area > 0 ? centre / area : vector_of(parts.front().moment.centre);
        layout::MeshMoment moment{{centre.x, centre.y, centre.z}, 0, {}, {}, {}};
        for (const Part& part : parts)
            add(part.moment, moment);
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
