// The generalized winding number (Jacobson et al. 2013): how often a surface, open ones too, goes round a point. Far
// parts through their moments (Barill et al. 2018), near triangles exactly (van Oosterom & Strackee 1983). Always in
// double, whatever the tables' precision, and on the host only: kernels receive bits.
#pragma once

#include <cmath>
#include <numbers>

#include "host/reference/mesh_nearest.h"

namespace forceshade::reference {

/// A part is far beyond so many times its radius. The winding number is then good to 1e-4 (tests: 4e-5 at worst).
constexpr double kWindingReach = 5;

template <typename T> Vector<double> double_at(std::span<const T> table, std::size_t index) noexcept {
    return Vector<double>(vector_at(table, index));
}

/// The solid angle of a triangle seen from the origin, positive from inside; 2 pi at most. 0 at its own corners.
inline double solid_angle(const Vector<double>& a, const Vector<double>& b, const Vector<double>& c) noexcept {
    const double at_a = std::sqrt(dot(a, a)), at_b = std::sqrt(dot(b, b)), at_c = std::sqrt(dot(c, c));
    const double volume = dot(a, cross(b, c));
    const double spread = at_a * at_b * at_c + dot(a, b) * at_c + dot(b, c) * at_a + dot(c, a) * at_b;
    return 2 * std::atan2(volume, spread);
}

template <typename T>
double solid_angle(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<double>& probe) noexcept {
    const layout::uint* corners = &mesh.triangle_corners[3 * std::size_t(triangle)];
    return solid_angle(double_at(mesh.vertices, corners[0]) - probe, double_at(mesh.vertices, corners[1]) - probe,
                       double_at(mesh.vertices, corners[2]) - probe);
}

/// The solid angle of everything below a node, from `away` = its centre - probe, a long way off: the field of a dipole
/// layer to third order. Only symmetric parts count, since all derivatives of 1 / distance are symmetric.
inline double solid_angle(const layout::MeshMoment& moment, const Vector<double>& away, double square) noexcept {
    const double x = away.x, y = away.y, z = away.z;
    const double* q = moment.quadrupole;
    const double* o = moment.octupole;
    const double first = moment.dipole[0] * x + moment.dipole[1] * y + moment.dipole[2] * z;
    const double second = q[0] * x * x + q[1] * y * y + q[2] * z * z + 2 * (q[3] * x * y + q[4] * x * z + q[5] * y * z);
    const double second_trace = q[0] + q[1] + q[2];
    const double third = o[0] * x * x * x + o[1] * y * y * y + o[2] * z * z * z +
                         3 * (o[3] * x * x * y + o[4] * x * x * z + o[5] * x * y * y + o[6] * y * y * z +
                              o[7] * x * z * z + o[8] * y * z * z) +
                         6 * o[9] * x * y * z;
    const double third_trace = (o[0] + o[5] + o[7]) * x + (o[3] + o[1] + o[8]) * y + (o[4] + o[6] + o[2]) * z;
    const double sum = first + second_trace - 3 * second / square + (7.5 * third / square - 4.5 * third_trace) / square;
    return sum / (square * std::sqrt(square));
}

/// 1 inside a closed surface, 0 outside; needs mesh.moments. The probe is in the mesh's frame.
template <typename T> double winding_number(const layout::MeshView<T>& mesh, const Vector<double>& probe) noexcept {
    double sum = 0;
    layout::uint stack[kMeshStack];
    layout::uint height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const layout::uint index = stack[--height];
        const layout::MeshMoment& moment = mesh.moments[index];
        const Vector<double> away = Vector<double>(moment.centre[0], moment.centre[1], moment.centre[2]) - probe;
        const double square = dot(away, away);
        if (square > kWindingReach * kWindingReach * moment.radius * moment.radius) {
            sum += solid_angle(moment, away, square);
            continue;
        }
        for (const layout::uint child : mesh.nodes[index].child) {
            if (child == layout::kMeshNoChild)
                continue;
            if ((child & layout::kMeshLeaf) == 0) {
                stack[height++] = child;
                continue;
            }
            const layout::uint run = child & ~layout::kMeshLeaf;
            for (layout::uint i = 0; i <= run % layout::kMeshLeafTriangles; ++i)
                sum += solid_angle(mesh, run / layout::kMeshLeafTriangles + i, probe);
        }
    }
    return sum / (4 * std::numbers::pi);
}

/// Whether the winding number is above one half.
template <typename T> bool inside_by_winding(const layout::MeshView<T>& mesh, const Vector<T>& probe) noexcept {
    return winding_number(mesh, Vector<double>(probe)) > 0.5;
}

/// How much the winding number can change within `radius` of a probe that has no triangle so near: 0 for a closed mesh,
/// otherwise by what a walk of that length sees of the rims, since |grad w| <= integral of |dl| / distance^2 / (4 pi)
/// along them (Biot and Savart). Stops adding at `enough`. Infinite if a rim is nearer than the radius.
template <typename T>
double winding_change(const layout::MeshView<T>& mesh, const Vector<double>& probe, double radius,
                      double enough = 1) noexcept {
    double change = 0;
    for (std::size_t i = 0; i < mesh.rims.size() && change < enough; i += 3) {
        const Vector<double> start = double_at(mesh.vertices, mesh.rims[i]) - probe;
        const Vector<double> edge = double_at(mesh.vertices, mesh.rims[i + 1]) - probe - start;
        const EdgePoint<double> point = nearest_on_edge(start, Vector<double>(start + edge), edge, dot(edge, edge));
        const double distance = std::sqrt(point.square);
        if (!(distance > radius))
            return std::numeric_limits<double>::infinity();
        const double nearer = distance - radius; // after the walk
        const double along = std::sqrt(dot(edge, edge)) / (nearer * nearer);
        change += mesh.rims[i + 2] * along * radius / (4 * std::numbers::pi);
    }
    return change;
}

} // namespace forceshade::reference
