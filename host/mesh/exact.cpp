#include "host/mesh/exact.h"

#include <algorithm>
#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/intersections.h>

namespace forceshade {

namespace {

using Rational = CGAL::Exact_rational;
using RationalVector = std::array<Rational, 3>;

RationalVector difference(const glm::dvec3& a, const glm::dvec3& b) {
    return {Rational(a.x) - Rational(b.x), Rational(a.y) - Rational(b.y), Rational(a.z) - Rational(b.z)};
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Faces =
    CGAL::Triangulation_face_base_with_info_2<bool, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;

// False where two corners coincide or two edges cross.
bool insert_polygon(Delaunay& delaunay, std::span<const std::array<double, 2>> polygon) {
    std::vector<std::pair<Delaunay::Point, std::uint32_t>> points;
    points.reserve(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i)
        points.emplace_back(Delaunay::Point(polygon[i][0], polygon[i][1]), static_cast<std::uint32_t>(i));
    delaunay.insert(points.begin(), points.end());
    if (delaunay.number_of_vertices() != polygon.size() || delaunay.dimension() != 2)
        return false;
    std::vector<Delaunay::Vertex_handle> corners(polygon.size());
    for (const auto vertex : delaunay.finite_vertex_handles())
        corners[vertex->info()] = vertex;
    try {
        for (std::size_t i = 0; i < corners.size(); ++i)
            delaunay.insert_constraint(corners[i], corners[(i + 1) % corners.size()]);
    } catch (const Delaunay::Intersection_of_constraints_exception&) {
        return false;
    }
    return true;
}

// Faces that are reached from outside without crossing the polygon are outside.
void mark_outside(Delaunay& delaunay) {
    for (const auto face : delaunay.all_face_handles())
        face->info() = false;
    std::vector<Delaunay::Face_handle> waiting{delaunay.infinite_face()};
    delaunay.infinite_face()->info() = true;
    while (!waiting.empty()) {
        const Delaunay::Face_handle face = waiting.back();
        waiting.pop_back();
        for (int edge = 0; edge < 3; ++edge) {
            const Delaunay::Face_handle across = face->neighbor(edge);
            if (across->info() || face->is_constrained(edge))
                continue;
            across->info() = true;
            waiting.push_back(across);
        }
    }
}

Kernel::Point_3 point(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

} // namespace

glm::dvec3 exact_cross_direction(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const RationalVector u = difference(b, a), v = difference(c, a);
    RationalVector cross;
    Rational largest(0);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        cross[i] = u[j] * v[k] - u[k] * v[j];
        const Rational size = CGAL::abs(cross[i]);
        if (size > largest)
            largest = size;
    }
    if (largest == 0)
        return glm::dvec3(0);
    return {CGAL::to_double(Rational(cross[0] / largest)), CGAL::to_double(Rational(cross[1] / largest)),
            CGAL::to_double(Rational(cross[2] / largest))};
}

bool planar_delaunay(std::span<const std::array<double, 2>> polygon,
                     std::vector<std::array<std::uint32_t, 3>>& triangles) {
    Delaunay delaunay;
    if (!insert_polygon(delaunay, polygon))
        return false;
    mark_outside(delaunay);
    const std::size_t before = triangles.size();
    for (const auto face : delaunay.finite_face_handles()) {
        if (face->info())
            continue;
        std::array<std::uint32_t, 3> triangle{face->vertex(0)->info(), face->vertex(1)->info(),
                                              face->vertex(2)->info()};
        std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
        triangles.push_back(triangle);
    }
    if (triangles.size() - before != polygon.size() - 2) {
        triangles.resize(before);
        return false;
    }
    std::sort(triangles.begin() + static_cast<std::ptrdiff_t>(before), triangles.end());
    return true;
}

int turn_of(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
    return CGAL::orientation(Kernel::Point_2(a[0], a[1]), Kernel::Point_2(b[0], b[1]), Kernel::Point_2(c[0], c[1]));
}

bool triangles_meet(const std::array<glm::dvec3, 3>& one, const std::array<glm::dvec3, 3>& other) {
    const auto triangle = [](const std::array<glm::dvec3, 3>& corners) {
        return Kernel::Triangle_3(point(corners[0]), point(corners[1]), point(corners[2]));
    };
    return CGAL::do_intersect(triangle(one), triangle(other));
}

} // namespace forceshade
