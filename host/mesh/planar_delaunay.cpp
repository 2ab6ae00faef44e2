#include "host/mesh/planar_delaunay.h"

#include <algorithm>
#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace forceshade {
namespace {

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

} // namespace

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
        std::ranges::rotate(triangle, std::ranges::min_element(triangle));
        triangles.push_back(triangle);
    }
    if (triangles.size() - before != polygon.size() - 2) {
        triangles.resize(before);
        return false;
    }
    std::sort(triangles.begin() + static_cast<std::ptrdiff_t>(before), triangles.end());
    return true;
}

} // namespace forceshade
