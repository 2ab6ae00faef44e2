#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/findings.h"

namespace forceshade {
namespace {

// "1 hole", "3 holes"
std::string counted(std::size_t count, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

// What an open surface means for what is done with it.
std::string openness(MeshUse use) {
    switch (use) {
    case MeshUse::path:
        return "the surface is open, and a proxy may slide round its rims";
    case MeshUse::winding_field:
        return "the surface is open; inside is where its winding number exceeds 1/2, which is nowhere near a sheet";
    default:
        return "the surface is open, so which side is inside is a matter of convention; inside = \"winding\" serves "
               "closed shapes with holes best, and explore needs no inside";
    }
}

void add_topology(const MeshFindings& found, MeshUse use, std::vector<std::string>& text) {
    const bool field = use != MeshUse::path;
    if (found.boundary_edges > 0)
        text.push_back(fmt::format("{} along {}: {}", counted(found.boundary_edges, "boundary edge", "boundary edges"),
                                   counted(found.holes, "hole or rim", "holes or rims"), openness(use)));
    if (found.non_manifold_edges > 0)
        text.push_back(fmt::format("{} of more than two facets{}", counted(found.non_manifold_edges, "edge", "edges"),
                                   use == MeshUse::any || use == MeshUse::pseudonormal_field
                                       ? ": near them what is inside may be wrong by pseudonormals; inside = "
                                         "\"winding\" is the safer choice"
                                       : ""));
    if (found.non_manifold_vertices > 0)
        text.push_back(fmt::format("{} where surfaces touch in a point only: shading mixes their normals there",
                                   counted(found.non_manifold_vertices, "vertex", "vertices")));
    if (found.misoriented_edges > 0)
        text.push_back(
            fmt::format("{} between facets of opposite orientation: {}shading cancels normals there",
                        counted(found.misoriented_edges, "edge", "edges"),
                        field ? "one of each two pushes the probe the wrong way in static fields, and " : ""));
    if (found.components > 1)
        text.push_back(fmt::format("{} separate pieces{}", found.components,
                                   field ? ": in a static field the probe touches whichever is nearest" : ""));
    if (field && found.closed && found.misoriented_edges == 0 && found.volume < 0)
        text.push_back(fmt::format("the facets are oriented inward (the signed volume is negative): static forces {}; "
                                   "reverse the facets",
                                   use == MeshUse::winding_field ? "appear nowhere, since no winding number exceeds 1/2"
                                                                 : "appear outside and not inside"));
}

void add_facets(const MeshFindings& found, MeshUse use, std::vector<std::string>& text) {
    const bool by_normals = use == MeshUse::any || use == MeshUse::pseudonormal_field;
    if (found.degenerate_facets > 0)
        text.push_back(fmt::format("{} without area: left out, and what lies on both sides of them is joined",
                                   counted(found.degenerate_facets, "facet", "facets")));
    if (found.repeated_corner_facets > 0)
        text.push_back(
            fmt::format("{} coming to a vertex twice", counted(found.repeated_corner_facets, "facet", "facets")));
    if (found.redundant_facets > 0)
        text.push_back(fmt::format("{} given once more: left out", counted(found.redundant_facets, "facet", "facets")));
    if (found.opposed_facets > 0)
        text.push_back(
            fmt::format("{} that coincide and face opposite ways: the first in the file is the one touched, and both "
                        "weigh in the vertex normals{}",
                        counted(found.opposed_facets, "pair of facets", "pairs of facets"),
                        by_normals ? "; what is inside may be wrong wherever they are the nearest, and inside = "
                                     "\"winding\", for which they cancel, is the safer choice"
                                   : ""));
    if (found.unused_vertices > 0)
        text.push_back(
            fmt::format("{} that no facet uses: ignored", counted(found.unused_vertices, "vertex", "vertices")));
    if (found.more_self_intersections && *found.self_intersections == 0)
        text.push_back("so many triangles lie close to each other that the search for self-intersections was given up");
    if (found.self_intersections.value_or(0) > 0)
        text.push_back(fmt::format("{}{} that touch or cross without a common corner{}",
                                   found.more_self_intersections ? "at least " : "",
                                   counted(*found.self_intersections, "pair of triangles", "pairs of triangles"),
                                   use == MeshUse::path ? ""
                                                        : ": in a static field the probe feels only the nearest "
                                                          "surface, so parts within the solid are felt as well"));
}

} // namespace

bool is_solid(const MeshFindings& findings) {
    const bool sound = findings.non_manifold_edges + findings.non_manifold_vertices + findings.misoriented_edges +
                           findings.degenerate_facets + findings.redundant_facets + findings.opposed_facets +
                           findings.repeated_corner_facets ==
                       0;
    return sound && findings.closed && findings.components == 1 && findings.self_intersections == 0U;
}

std::vector<std::string> warnings(const MeshFindings& found, MeshUse use) {
    std::vector<std::string> text;
    add_topology(found, use, text);
    add_facets(found, use, text);
    return text;
}

void refuse_if_meaningless(const MeshFindings& found, const std::string& mesh) {
    if (found.facets == 0)
        throw UsageError(fmt::format(
            "{}: no facets, so there is nothing to touch; a mesh needs one or more (was the file cut off?)", mesh));
    if (!std::isfinite(found.area) || !std::isfinite(found.volume))
        throw UsageError(
            fmt::format("{}: coordinates up to ({}, {}, {}) are so large that areas and volumes overflow; is "
                        "this the right file?",
                        mesh, found.high.x, found.high.y, found.high.z));
    if (found.degenerate_facets == found.facets)
        throw UsageError(fmt::format("{}: none of the {} facets has an area, so no force has a direction; is this the "
                                     "right file?",
                                     mesh, found.facets));
}

} // namespace forceshade
