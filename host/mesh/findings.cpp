#include "host/mesh/findings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/mesh/places.h"
#include "host/mesh/structure.h"
#include "host/numbers.h"
#include "host/reference/elementary.h"

namespace forceshade {

namespace {

void count_facets(const PolygonSoup& polygons, MeshFindings& found) {
    found.vertices = polygons.vertices.size();
    found.facets = polygons.facets();
    std::vector<std::uint32_t> corners;
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        const auto outline = polygons.outline(facet);
        corners.assign(outline.begin(), outline.end());
        found.triangles += corners.size() == 3;
        found.quadrilaterals += corners.size() == 4;
        found.others += corners.size() != 3 && corners.size() != 4;
        found.most_corners = std::max(found.most_corners, corners.size());
        std::ranges::sort(corners);
        found.repeated_corner_facets += std::ranges::adjacent_find(corners) != corners.end();
    }
}

void measure_box(const PolygonSoup& polygons, MeshFindings& found) {
    std::vector<bool> used(polygons.vertices.size(), false);
    for (const std::uint32_t vertex : polygons.corners)
        used[vertex] = true;
    found.unused_vertices = static_cast<std::size_t>(std::ranges::count(used, false));
    if (const MeshBox box = bounding_box(polygons); !polygons.corners.empty())
        found.low = box.low, found.high = box.high;
}

// From the middle of the box, so that a mesh far from the origin loses no digits.
void measure_surface(const PolygonSoup& polygons, const MeshTriangles& triangles, MeshFindings& found) {
    const glm::dvec3 middle = found.low + 0.5 * (found.high - found.low);
    double twice_area = 0, six_volumes = 0;
    for (const auto& [i, j, k] : triangles.corners) {
        const glm::dvec3 a = polygons.vertices[i] - middle;
        const glm::dvec3 area = reference::cross<double>(polygons.vertices[j] - polygons.vertices[i],
                                                         polygons.vertices[k] - polygons.vertices[i]);
        twice_area += std::hypot(area.x, area.y, area.z);
        six_volumes += reference::dot(a, area);
    }
    found.area = twice_area / 2;
    found.volume = six_volumes / 6;
}

// Those that make_surface() leaves out; of a mesh that has nothing thicker than rounding, those without any area.
std::size_t count_degenerate(const PolygonSoup& polygons, const MeshFindings& found,
                             std::span<const glm::dvec3> normals) {
    const auto flat = static_cast<std::size_t>(std::ranges::count(normals, glm::dvec3(0)));
    if (!(reference::largest_coordinate(found.high - found.low) < 0x1p1000))
        return flat;
    const std::size_t caps = count_caps(polygons, normals);
    return caps < normals.size() ? caps : flat;
}

} // namespace

ShapeFindings inspect_shape(const PolygonSoup& all) {
    const Stage stage("checking the mesh");
    ShapeFindings shape;
    MeshFindings& found = shape.findings;
    count_facets(all, found);
    measure_box(all, found);
    std::vector<glm::dvec3> normals = facet_normals(all);
    found.degenerate_facets = count_degenerate(all, found, normals);
    CoincidentFacets coincident = find_coincident(all, normals);
    found.redundant_facets = coincident.redundant.size();
    found.opposed_facets = coincident.opposed;
    shape.redundant = std::move(coincident.redundant);
    PolygonSoup rest;
    if (!shape.redundant.empty()) {
        rest = without_facets(all, shape.redundant);
        normals = facet_normals(rest);
    }
    const PolygonSoup& polygons = shape.redundant.empty() ? all : rest;
    measure_surface(polygons, triangulate(polygons, normals), found);
    return shape;
}

void find_self_intersections(const PolygonSoup& all, ShapeFindings& shape, std::size_t most_triangles) {
    const Stage stage("looking for self-intersections");
    const PolygonSoup rest = shape.redundant.empty() ? PolygonSoup() : without_facets(all, shape.redundant);
    const PolygonSoup& polygons = shape.redundant.empty() ? all : rest;
    const MeshTriangles triangles = triangulate(polygons, facet_normals(polygons));
    if (triangles.corners.size() > most_triangles)
        return;
    constexpr std::size_t kMostPairs = 100'000;
    const SelfIntersections pairs = count_self_intersections(polygons, weld(polygons), triangles, kMostPairs);
    shape.findings.self_intersections = pairs.pairs;
    shape.findings.more_self_intersections = !pairs.complete;
}

namespace {

void name_pieces(const PolygonSoup& polygons, MeshFindings& found) {
    const MeshPieces pieces = find_pieces(polygons);
    for (std::size_t i = 0; i < pieces.pieces.size(); ++i) {
        const MeshPiece& piece = pieces.pieces[i];
        if (piece.one_sided)
            found.one_sided.push_back(name_of(i, pieces));
        else if (piece.is_inside_out())
            found.inside_out.push_back(name_of(i, pieces));
        else if (piece.is_nested() && found.self_intersections == 0U)
            found.nested.push_back(name_of(i, pieces));
    }
}

} // namespace

MeshFindings with_connections(ShapeFindings shape, const Connectivity& mesh) {
    MeshFindings& found = shape.findings;
    ConnectivityCounts& counts = found;
    counts = shape.redundant.empty() ? mesh->counts()
                                     : Connectivity(without_facets(mesh.polygons(), shape.redundant))->counts();
    found.closed = found.facets > 0 && found.odd_edges == 0;
    if (!found.closed)
        found.closing_distance = closing_distance(mesh.polygons());
    if (found.components > 1 || found.misoriented_edges > 0 || (found.closed && found.volume < 0))
        name_pieces(mesh.polygons(), found);
    return found;
}

MeshFindings inspect(const PolygonSoup& polygons, std::size_t self_intersection_triangles) {
    ShapeFindings shape = inspect_shape(polygons);
    find_self_intersections(polygons, shape, self_intersection_triangles);
    return with_connections(std::move(shape), polygons);
}

bool is_solid(const MeshFindings& findings) {
    const bool sound = findings.non_manifold_edges + findings.non_manifold_vertices + findings.misoriented_edges +
                           findings.degenerate_facets + findings.redundant_facets + findings.opposed_facets +
                           findings.repeated_corner_facets ==
                       0;
    return sound && findings.closed && findings.components == 1 && findings.self_intersections == 0U;
}

namespace {

// 3 digits, rounded up: joining within what is printed does it.
std::string rounded_up(double length) {
    const double step = std::pow(10.0, std::floor(std::log10(length)) - 2);
    return fmt::format("{:.3g}", step * std::ceil(length / step));
}

std::string_view force_of_open_mesh(MeshUse use) {
    switch (use) {
    case MeshUse::path:
        return "a path's force stays on the side where it began, and a proxy may slide round the rims";
    case MeshUse::winding_field:
        return "a force is where the winding number exceeds 1/2, as if small holes were closed, and nowhere near a "
               "sheet";
    case MeshUse::pseudonormal_field:
        return "a force is wherever the nearest facet is seen from behind, however far away; inside = \"winding\" "
               "keeps it within closed shapes with holes";
    }
    throw std::logic_error("no such use");
}

MeshFault openness(const MeshFindings& found, MeshUse use, const std::string& unit, double metres) {
    MeshFault fault{fmt::format("{} along {}", numbers::counted(found.boundary_edges, "boundary edge"),
                                numbers::counted(found.holes, "hole or rim", "holes or rims")),
                    std::string(force_of_open_mesh(use))};
    if (!found.closing_distance)
        return fault;
    const std::string distance = rounded_up(*found.closing_distance * metres);
    fault.remedy = fmt::format("closes if vertices within {} {} are joined: {}", distance, unit,
                               unit == "m" ? "weld" : "weld, a length in the scene");
    fault.key = fmt::format("weld = \"{} {}\"", distance, unit == "m" ? "m" : "UNIT");
    return fault;
}

} // namespace

std::string sentence(const MeshFault& fault) {
    return fault.what + (fault.force.empty() ? "" : ": " + fault.force) +
           (fault.remedy.empty() ? "" : "; " + fault.remedy);
}

std::vector<MeshFault> faults(const MeshFindings& found, MeshUse use, const std::string& unit, double metres) {
    const bool field = use != MeshUse::path, winding = use == MeshUse::winding_field;
    const bool by_normals = use == MeshUse::pseudonormal_field;
    const auto if_by_normals = [&](std::string_view text) { return std::string(by_normals ? text : ""); };
    const std::string turns = "orient = \"outward\"";
    std::vector<MeshFault> all;
    const auto add = [&](std::size_t count, std::string_view one, std::string_view many, std::string_view what,
                         std::string force = "", std::string remedy = "", std::string key = "") {
        if (count > 0)
            all.push_back({numbers::counted(count, one, many) + std::string(what), std::move(force), std::move(remedy),
                           std::move(key)});
    };
    if (found.boundary_edges > 0)
        all.push_back(openness(found, use, unit, metres));
    add(found.non_manifold_edges, "edge", "edges", " of more than two facets",
        by_normals ? "near them a static force may be missing, or appear outside"
        : winding  ? "the winding number counts all of them"
                   : "a proxy is stopped by each of them",
        if_by_normals("inside = \"winding\" is the safer choice"));
    add(found.non_manifold_vertices, "vertex", "vertices", " where surfaces touch in a point only",
        "shading mixes their normals there");
    add(found.misoriented_edges, "edge", "edges", " between facets of opposite orientation",
        fmt::format("{}shading cancels normals there",
                    by_normals ? "on one side of each the static force points the wrong way, and "
                    : winding  ? "the static force is missing where the winding number falls below 1/2, and "
                               : ""),
        found.one_sided.empty() ? turns + " turns facets so that they agree" : "",
        found.one_sided.empty() ? turns : "");
    for (const std::string& piece : found.one_sided)
        all.push_back({piece + " has one side only, as a Moebius strip has", "it has no inside"});
    if (found.components > 1) {
        add(found.components, "", "separate pieces", "",
            field ? "a static force leads out of the nearest facet, whichever piece that is of"
                  : "a proxy is stopped by each of them");
        all.back().is_wrong = false;
    }
    if (field)
        for (const std::string& piece : found.inside_out)
            all.push_back({piece + " faces inward and no other piece is around it",
                           by_normals ? "static forces appear outside of it and not inside"
                                      : "static forces are missing in it (inside = \"winding\")",
                           turns + " turns it", turns});
    if (field)
        for (const std::string& piece : found.nested)
            all.push_back({piece + " faces outward within another piece",
                           by_normals ? "static forces are missing where its facets are the nearest"
                                      : "where its facets are the nearest a static force leads there and not out",
                           by_normals ? "inside = \"winding\" (or \"auto\") gives them; a cavity faces inward"
                                      : "a cavity faces inward"});
    add(found.degenerate_facets, "facet", "facets", " without area",
        "left out, and what lies on both sides of them is joined");
    add(found.vanished_facets, "facet", "facets", " without area by joining vertices",
        "weld is larger than their edges");
    add(found.repeated_corner_facets, "facet", "facets", " coming to a vertex twice");
    add(found.redundant_facets, "facet", "facets", " given once more", "left out");
    add(found.opposed_facets, "pair of facets", "pairs of facets", " that coincide and face opposite ways",
        "the first in the file is the one touched, and both weigh in the vertex normals" +
            if_by_normals("; where they are the nearest a static force may be missing, or appear outside"),
        if_by_normals("inside = \"winding\", for which they cancel, is the safer choice"));
    add(found.unused_vertices, "vertex", "vertices", " that no facet uses", "ignored");
    if (found.more_self_intersections && *found.self_intersections == 0)
        all.push_back({"too many triangles lie close to each other: the search for self-intersections was given up"});
    add(found.self_intersections.value_or(0), "pair of triangles", "pairs of triangles",
        " that touch or cross without a common corner",
        by_normals ? "the static force is missing in parts of the inside, where the nearest facet is within the solid"
        : winding  ? "where the nearest facet is within the solid, a static force leads there and not out"
                   : "a proxy is stopped by each of them, and by what lies within the solid",
        if_by_normals("inside = \"winding\" (or \"auto\") gives it"));
    if (found.more_self_intersections && *found.self_intersections > 0)
        all.back().what.insert(0, "at least ");
    return all;
}

void refuse_if_meaningless(const MeshFindings& found, const std::string& mesh) {
    if (found.facets == 0)
        throw UsageError("{}: no facets; a mesh needs one or more (was the file cut off?)", mesh);
    if (!std::isfinite(found.area) || !std::isfinite(found.volume))
        throw UsageError(
            "{}: coordinates up to ({}, {}, {}) are so large that areas and volumes overflow; is this the right file?",
            mesh, found.high.x, found.high.y, found.high.z);
    if (found.degenerate_facets == found.facets)
        throw UsageError("{}: none of the {} facets has an area, so no force has a direction; is this the right file?",
                         mesh, found.facets);
}

namespace {

void mark_edges(const MeshStructure& structure, MeshMarks& marks) {
    const MeshParts& parts = *structure.parts;
    const MeshReals<double>& reals = *structure.reals;
    const double cosine = std::cos(MeshMarks::kSharp * std::numbers::pi / 180);
    const auto world = [&](layout::uint corner) {
        return structure.centre +
               structure.scale * reference::vector_at<double>(reals.vertices, parts.triangle_corners[corner]);
    };
    for (layout::uint edge = 0; edge < parts.triangle_neighbours.size(); ++edge) {
        const layout::uint triangle = edge / 3, across = parts.triangle_neighbours[edge];
        std::vector<MeshMarks::Edge>* into = nullptr;
        if (across == layout::kMeshBorder)
            into = &marks.rims;
        else if ((across & layout::kMeshManyBit) != 0)
            into = &marks.crowded;
        else if (triangle < across && parts.triangle_facets[triangle] != parts.triangle_facets[across] &&
                 reference::dot(reference::vector_at<double>(reals.triangle_normals, triangle),
                                reference::vector_at<double>(reals.triangle_normals, across)) < cosine)
            into = &marks.sharp;
        if (into)
            into->push_back({world(edge), world(edge % 3 == 2 ? edge - 2 : edge + 1)});
    }
}

} // namespace

MeshMarks find_marks(const Mesh& mesh, const MeshStructure& structure, const MeshFindings& findings) {
    MeshMarks marks;
    mark_edges(structure, marks);
    marks.inward.resize(mesh.polygons.facets());
    if (findings.misoriented_edges > 0 || !findings.inside_out.empty() || findings.volume < 0) {
        const MeshPieces pieces = find_pieces(mesh.polygons);
        for (std::size_t facet = 0; facet < marks.inward.size(); ++facet)
            marks.inward[facet] = pieces.opposed[facet] || pieces.pieces[pieces.of_facet[facet]].is_inside_out();
    }
    if (findings.self_intersections.value_or(0) > 0) {
        constexpr std::size_t kMostPairs = 100'000;
        marks.crossing =
            count_self_intersections(mesh.polygons, weld(mesh.polygons), mesh.triangles, kMostPairs).triangles;
    }
    return marks;
}

} // namespace forceshade
