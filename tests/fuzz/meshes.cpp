#include "tests/fuzz/meshes.h"

#include <map>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

#include "host/error.h"
#include "host/mesh/connectivity.h"
#include "host/mesh/findings.h"
#include "host/referee/referee.h"
#include "host/reference/mesh_contact.h"
#include "tests/mesh/god_object_walks.h"
#include "tests/mesh/structure_check.h"

namespace forceshade::fuzz {

using reference::Nearest;
using reference::Vector;

void check_sound(const PolygonSoup& soup) {
    require(soup.begins.front() == 0 && soup.begins.back() == soup.corners.size(), "facets do not hold all corners");
    for (std::size_t facet = 0; facet < soup.facets(); ++facet)
        require(soup.begins[facet + 1] >= soup.begins[facet] + 3, "facet {} has too few corners", facet);
    for (const std::uint32_t corner : soup.corners)
        require(corner < soup.vertices.size(), "there is no vertex {}", corner);
    for (const glm::dvec3& vertex : soup.vertices)
        require(std::isfinite(vertex.x) && std::isfinite(vertex.y) && std::isfinite(vertex.z),
                "a vertex is not finite");
    require(soup.normals.empty() || soup.normals.size() == soup.corners.size(), "not a normal for each corner");
}

PolygonSoup take_soup(Bytes& bytes) {
    PolygonSoup soup;
    const std::size_t vertices = 3 + bytes.below(22);
    for (std::size_t i = 0; i < vertices; ++i)
        soup.vertices.emplace_back(bytes.number(), bytes.number(), bytes.number());
    for (std::size_t facets = 1 + bytes.below(40); facets > 0; --facets) {
        const std::uint8_t kind = bytes.byte();
        for (std::size_t corners = kind < 160 ? 3 : kind < 240 ? 4 : 5 + kind % 8; corners > 0; --corners)
            soup.corners.push_back(static_cast<std::uint32_t>(bytes.below(vertices)));
        soup.end_facet();
    }
    return soup;
}

namespace {

/// Two cones of up to 32 triangles on one rim, the upper one pointing up or down.
PolygonSoup take_cones(Bytes& bytes) {
    PolygonSoup soup;
    const std::size_t count = 5 + bytes.below(28);
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        soup.vertices.emplace_back(4 * std::cos(angle), 4 * std::sin(angle), 0);
    }
    soup.vertices.emplace_back(0, 0, bytes.number());
    soup.vertices.emplace_back(0, 0, -3);
    for (std::size_t i = 0; i < count; ++i)
        for (const bool upper : {true, false}) {
            const auto one = static_cast<std::uint32_t>(i), next = static_cast<std::uint32_t>((i + 1) % count);
            const auto tip = static_cast<std::uint32_t>(upper ? count : count + 1);
            soup.corners.insert(soup.corners.end(), {upper ? one : next, upper ? next : one, tip});
            soup.end_facet();
        }
    return soup;
}

} // namespace

PolygonSoup take_solid(Bytes& bytes) {
    static const std::vector<walks::Terrain> solids = walks::solids();
    const std::size_t kind = bytes.below(solids.size() + 2);
    PolygonSoup soup = kind < solids.size() ? solids[kind].polygons : take_cones(bytes);
    for (std::size_t moves = bytes.below(8); moves > 0; --moves) {
        glm::dvec3& vertex = soup.vertices[bytes.below(soup.vertices.size())];
        vertex += glm::dvec3(bytes.number(), bytes.number(), bytes.number()) / 4.0;
    }
    return soup;
}

namespace {

void check_normals(const std::vector<glm::dvec3>& normals) {
    for (const glm::dvec3& normal : normals)
        require(normal == glm::dvec3(0) || std::abs(glm::length(normal) - 1) < 1e-12, "a normal is {} long",
                glm::length(normal));
}

/// Of a quadrilateral: no triangle is turned over if the other cut turns none over.
void check_cuts(const Mesh& mesh) {
    const auto& at = mesh.polygons.vertices;
    const auto turned = [&](std::uint32_t facet, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const glm::dvec3 area = glm::cross(at[b] - at[a], at[c] - at[a]);
        return glm::dot(area, mesh.facet_normals[facet]) /
               (1e-300 + glm::length(at[b] - at[a]) * glm::length(at[c] - at[a]));
    };
    for (std::size_t i = 0; i + 1 < mesh.triangles.corners.size(); ++i) {
        const std::uint32_t facet = mesh.triangles.facets[i];
        const auto outline = mesh.polygons.outline(facet);
        if (outline.size() != 4 || mesh.triangles.facets[i + 1] != facet || mesh.facet_normals[facet] == glm::dvec3(0))
            continue;
        const auto &one = mesh.triangles.corners[i], &other = mesh.triangles.corners[i + 1];
        const double worst =
            std::min(turned(facet, one[0], one[1], one[2]), turned(facet, other[0], other[1], other[2]));
        for (const std::size_t k : {0u, 1u})
            require(worst > -1e-9 || std::min(turned(facet, outline[k], outline[k + 1], outline[k + 2]),
                                              turned(facet, outline[k], outline[k + 2], outline[(k + 3) % 4])) < 1e-9,
                    "facet {} is cut the wrong way", facet);
    }
}

/// Edges as a map counts them.
void check_edges(const PolygonSoup& soup, const ConnectivityCounts& counts) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> sides;
    for (std::size_t facet = 0; facet < soup.facets(); ++facet) {
        const auto outline = soup.outline(facet);
        for (std::size_t i = 0; i < outline.size(); ++i)
            if (const auto [a, b] = std::minmax(outline[i], outline[(i + 1) % outline.size()]); a != b)
                ++sides[{a, b}];
    }
    ConnectivityCounts expected;
    for (const auto& [edge, count] : sides) {
        expected.boundary_edges += count == 1;
        expected.odd_edges += count % 2;
        expected.non_manifold_edges += count > 2;
    }
    require(counts.boundary_edges == expected.boundary_edges && counts.odd_edges == expected.odd_edges &&
                counts.non_manifold_edges == expected.non_manifold_edges,
            "edges are miscounted");
}

/// A normal summed corner by corner in long double. Nothing where a corner of a polygon is too sharp to tell on which
/// side of it the polygon is, or where sizes differ so much that numbers overflow, or where the normals cancel.
std::optional<glm::dvec3> vertex_normal(const Mesh& mesh, std::uint32_t vertex, VertexNormals weights) {
    using Real = long double;
    using Place = glm::vec<3, Real>;
    constexpr Real kSharp = 1e-3L, kLeast = 1e-100L, kMost = 1e100L;
    const PolygonSoup& soup = mesh.polygons;
    Place sum(0);
    Real all = 0;
    for (std::uint32_t facet = 0; facet < soup.facets(); ++facet) {
        const auto outline = soup.outline(facet);
        const Place normal(mesh.facet_normals[facet]);
        if (normal == Place(0) || std::ranges::binary_search(mesh.redundant_facets, facet))
            continue;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            if (outline[i] != vertex)
                continue;
            if (weights == VertexNormals::plain) {
                sum += normal;
                all += 1;
                break;
            }
            const auto edge_to = [&](std::size_t other) {
                return Place(soup.vertices[outline[other % outline.size()]]) - Place(soup.vertices[vertex]);
            };
            const Place next = edge_to(i + 1), previous = edge_to(i + outline.size() - 1);
            const Real one = glm::length(next), other = glm::length(previous);
            if (one == 0 || other == 0)
                continue;
            if (!(one * other > kLeast && one * other < kMost))
                return {};
            const Place difference = next / one - previous / other, both = next / one + previous / other;
            Real angle = 2 * std::atan2(glm::length(difference), glm::length(both)); // good for needles, too (Kahan)
            if (outline.size() > 3 && (angle < kSharp || angle > std::numbers::pi_v<Real> - kSharp))
                return {};
            if (outline.size() > 3 && glm::dot(glm::cross(next, previous), normal) < 0)
                angle = 2 * std::numbers::pi_v<Real> - angle;
            sum += angle * normal;
            all += angle;
        }
    }
    const Real length = glm::length(sum);
    // Angles are good to some 1e-16: where all are as small, they are no weights.
    const bool told = length > kSharp * all && (weights == VertexNormals::plain || length > 1e-8L);
    return told ? std::optional(glm::dvec3(sum / length)) : std::nullopt;
}

void check_vertex_normals(const Mesh& mesh, VertexNormals weights) {
    for (std::uint32_t vertex = 0; vertex < mesh.polygons.vertices.size(); ++vertex)
        if (const auto expected = vertex_normal(mesh, vertex, weights))
            require(glm::length(mesh.vertex_normals[vertex] - *expected) < 1e-6, "the normal of vertex {} is another",
                    vertex);
}

/// A placed mesh has each vertex where rotations about x, y and z by their half angles (Rodrigues) take it.
void check_placement(const PolygonSoup& soup, Bytes& bytes) {
    MeshPlacement placement;
    placement.unit = 0.5;
    placement.scale = 1 + static_cast<double>(bytes.below(4));
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t turn = bytes.below(16); // the first ones quarters
        placement.rotate[static_cast<std::size_t>(axis)] =
            turn < 8 ? static_cast<double>(turn) * std::numbers::pi / 2 - std::numbers::pi : static_cast<double>(turn);
        placement.translate[static_cast<std::size_t>(axis)] = static_cast<double>(bytes.below(5));
    }
    const Mesh mesh = prepare_mesh(soup, placement, VertexNormals::plain);
    for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
        glm::dvec3 place = 0.5 * placement.scale * soup.vertices[i];
        const double size = glm::length(place);
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 about(0);
            about[axis] = std::sin(placement.rotate[static_cast<std::size_t>(axis)] / 2);
            const glm::dvec3 twice = 2.0 * glm::cross(about, place);
            place += std::cos(placement.rotate[static_cast<std::size_t>(axis)] / 2) * twice + glm::cross(about, twice);
        }
        place += glm::dvec3(placement.translate[0], placement.translate[1], placement.translate[2]);
        require(glm::length(mesh.polygons.vertices[i] - place) <= 1e-12 * (10 + size) || !(size < 1e150),
                "vertex {} is placed elsewhere", i);
    }
}

void check_mesh(const Mesh& mesh) {
    check_cuts(mesh);
    check_sound(mesh.polygons);
    check_normals(mesh.facet_normals);
    check_normals(mesh.vertex_normals);
    check_normals(mesh.triangles.normals);
    require(mesh.triangles.corners.size() == mesh.polygons.corners.size() - 2 * mesh.polygons.facets(),
            "{} triangles of {} corners and {} facets", mesh.triangles.corners.size(), mesh.polygons.corners.size(),
            mesh.polygons.facets());
    require(std::ranges::is_sorted(mesh.triangles.facets), "triangles are not in the order of their facets");
    for (const auto& corners : mesh.triangles.corners)
        for (const std::uint32_t corner : corners)
            require(corner < mesh.polygons.vertices.size(), "a triangle has no vertex {}", corner);
}

/// Places of the mesh's frame: anywhere, on vertices, on lines between them.
glm::dvec3 take_place(Bytes& bytes, const MeshStructure& structure) {
    const auto vertex = [&] {
        const std::size_t at = 3 * bytes.below(std::min<std::size_t>(256, structure.reals->vertices.size() / 3));
        return glm::dvec3(structure.reals->vertices[at], structure.reals->vertices[at + 1],
                          structure.reals->vertices[at + 2]);
    };
    switch (bytes.below(4)) {
    case 0:
        return vertex();
    case 1: {
        const glm::dvec3 one = vertex();
        return one + bytes.number() * (vertex() - one);
    }
    default:
        return {bytes.number(), bytes.number(), bytes.number()};
    }
}

template <typename T> void check_nearest(const MeshTables<T>& tables, const glm::dvec3& place) {
    const layout::MeshView<T> mesh = tables.view();
    const Vector<T> probe(place);
    if (!(std::abs(probe.x) + std::abs(probe.y) + std::abs(probe.z) < T(1e15)))
        return;
    const Nearest<T> expected = shapes::nearest_by_loop(mesh, probe);
    for (const layout::uint hint : {0U, mesh.params.triangles - 1, expected.triangle}) {
        const Nearest<T> found = reference::nearest(mesh, probe, hint);
        require(shapes::same(found, expected), "at {} {} {} triangle {} is the nearest (square {}), not {} (square {})",
                place.x, place.y, place.z, expected.triangle, expected.square, found.triangle, found.square);
    }
}

/// What distances of a referee in the world's metres may differ by, in units of the frame.
constexpr double kRounding = 1e-11;

void check_against_referee(const MeshStructure& structure, const layout::MeshView<double>& view,
                           const brute::MeshReferee& referee, bool solid, const glm::dvec3& place) {
    const glm::dvec3 world = structure.centre + structure.scale * place;
    if (!(glm::length(place) < 1e3) || !(glm::length(structure.centre) < 1e3 * structure.scale) ||
        !(structure.scale > 1e-90) || !(structure.scale < 1e90))
        return;
    const Vector<double> probe(to_mesh_frame(structure, world));
    const Nearest<double> found = reference::nearest(view, probe);
    const double distance = std::sqrt(found.square);
    const auto expected = static_cast<double>(referee.nearest(world).distance) / structure.scale;
    require(std::abs(distance - expected) <= kRounding * (1 + glm::length(place)), "{} away, not {}", expected,
            distance);
    if (distance < 1e-3)
        return;
    const auto winding = static_cast<double>(referee.winding_number(world));
    // From far the moments of all of it count. They leave out 4 r^3 / R^5 and less of an area at most r from their
    // centre.
    double allowed = reference::kWindingFine.error;
    if (const double far = glm::length(place) - 2; far > 8) {
        double area = 0;
        for (layout::uint triangle = 0; triangle < view.params.triangles; ++triangle) {
            const auto& [a, b, c] = reference::triangle_at(view, triangle).corners;
            area += glm::length(glm::cross(b - a, c - a)) / 2;
        }
        allowed = std::min(allowed, 15 * area / std::pow(far, 5) + 1e-12);
    }
    require(std::abs(reference::winding_number(view, probe) - winding) < allowed, "the winding number is {}, not {}",
            winding, reference::winding_number(view, probe));
    const double rough = reference::winding_number(view, probe, reference::kWindingRough);
    // It leaves out what shrinks with the fourth power of the reach.
    const double more = std::pow(reference::kWindingFine.reach / reference::kWindingRough.reach, 4);
    require(std::abs(rough - winding) < more * reference::kWindingFine.error,
            "roughly, the winding number is {}, not {}", rough, winding);
    if (solid) {
        require(std::abs(winding - std::round(winding)) < 1e-9, "a solid's winding number is {}", winding);
        require(reference::inside_by_pseudonormal(view, found) == (winding > 0.5),
                "pseudonormals say {}, the winding number is {}", reference::inside_by_pseudonormal(view, found),
                winding);
    }
}

} // namespace

void check_preparation(const PolygonSoup& soup, Bytes& bytes) {
    check_sound(soup);
    const MeshFindings findings = inspect(soup);
    faults(findings);
    const Connectivity connected(soup), matched(soup, Connectivity::Method::matched_edges);
    require(connected->counts() == matched->counts(), "half-edges and matched edges are counted otherwise");
    check_edges(soup, connected->counts());
    const std::uint8_t kind = bytes.byte();
    try {
        refuse_if_meaningless(findings, "a mesh");
        const VertexNormals weights = kind & 1 ? VertexNormals::plain : VertexNormals::angle;
        const Mesh mesh = prepare_mesh(soup, {}, weights, &connected);
        check_mesh(mesh);
        check_vertex_normals(mesh, weights);
        check_placement(soup, bytes);
        MeshStructure structure =
            build_structure(mesh, {.threads = 1, .winding = true, .leaf_triangles = kind & 2 ? 1U : 4U});
        const std::string fault = shapes::check_structure(structure).fault;
        require(fault.empty(), "{}", fault);
        if (is_solid(findings))
            assume_solid(structure);
        const bool solid = is_solid(findings) && findings.volume > 0; // its outside out
        const auto wide = make_mesh_tables<double>(structure, 1);
        const auto narrow = make_mesh_tables<float>(structure, 1);
        const brute::MeshReferee referee(mesh, {});
        // Of triangles that are flat to within rounding tree and referee pass over different ones.
        const bool has_flat = brute::choose_triangles(mesh).noise > 0;
        for (int i = 0; i < 7; ++i) {
            glm::dvec3 place = take_place(bytes, structure);
            if (i == 6) // from far
                place = 200.0 * glm::normalize(glm::dvec3(kind, kind / 8 % 16, 60) - 50.0);
            check_nearest<double>(wide, place);
            check_nearest<float>(narrow, place);
            if (!has_flat)
                check_against_referee(structure, wide.view(), referee, solid, place);
        }
    } catch (const UsageError&) {
    }
}

} // namespace forceshade::fuzz
