#include "host/study/energy/loop_cases.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/prepare/tables.h"
#include "host/reference/elementary.h"
#include "host/study/energy/closed_forms.h"
#include "host/study/energy/scenes.h"

namespace forceshade::study {
namespace {

constexpr double kEnd = kLoopEnd * kHalfWidth; /* m */
constexpr double kMeshRadius = 1000;           /* mil */
constexpr int kMeshPieces = 2;                 /* of an arc between facets */
constexpr int kMeshSteps = 1024;

std::function<Vector(double, double)> normals_of(double radius) {
    return [radius](double x, double) {
        return std::abs(x) < kHalfWidth ? Vector(x, 0, reference::circle_rise(radius, x)) : Vector(0, 0, 1);
    };
}

Section flat_section() {
    return {{0, kEnd}, [](double) { return 0.0; }, [](double) { return 0.0; }};
}

/// Below the circle; cut where a probe at one of the depths comes through the plane.
Section round_section(double radius, std::initializer_list<double> depths = {}) {
    const double foot = reference::circle_rise(radius, kHalfWidth);
    std::vector<double> breaks{0};
    for (const double depth : depths)
        breaks.push_back(reference::circle_rise(radius, foot + depth));
    breaks.push_back(kEnd);
    return {breaks, [=](double x) { return reference::circle_rise(radius, x) - foot; },
            [=](double x) { return -x / reference::circle_rise(radius, x); }};
}

/// Below the facets, cut where they meet.
Section faceted_section(double radius, const std::vector<double>& vertices) {
    Section section;
    section.breaks.push_back(0);
    for (const double vertex : vertices)
        if (vertex > 0 && vertex < kEnd)
            section.breaks.push_back(vertex);
    section.breaks.push_back(kEnd);
    const double foot = reference::circle_rise(radius, kHalfWidth);
    const auto facet = [=](double x) {
        const auto after = std::upper_bound(vertices.begin() + 1, vertices.end() - 1, x);
        return std::pair(*(after - 1), *after);
    };
    const auto slope = [=](double x) {
        const auto [left, right] = facet(x);
        return -(left + right) / (reference::circle_rise(radius, left) + reference::circle_rise(radius, right));
    };
    section.slope = slope;
    section.height = [=](double x) {
        const double left = facet(x).first;
        return reference::circle_rise(radius, left) - foot + slope(x) * (x - left);
    };
    return section;
}

BumpLoop loop_of(double radius, const LoopCase& one) {
    return {kStiffness, radius, kEnd, one.out, one.back};
}

LoopCase bump_case(const char* surface, const char* scheme, double radius_mil, PreparedCase prepared, Section section) {
    LoopCase one;
    one.surface = surface;
    one.scheme = scheme;
    one.radius_mil = radius_mil;
    one.prepared = std::move(prepared);
    one.sections = {std::move(section)};
    one.smooth = normals_of(radius_mil * kMil);
    return one;
}

struct BumpScheme {
    const char* name;
    BumpForce force;
};

const BumpScheme kBumpSchemes[] = {{"facets", {}},
                                   {"facets, normal depth", {"none", "normal", "normal"}},
                                   {"shaded", {"reference", "vertical", "normal"}},
                                   {"shaded, normal depth", {"reference", "normal", "normal"}},
                                   {"shaded, radial", {"reference", "vertical", "radial"}}};

std::optional<double> closed_form(const BumpScheme& scheme, const BumpLoop& loop, std::span<const double> vertices) {
    const bool normal_depth = scheme.force.depth == "normal";
    if (scheme.force.reference == "radial")
        return std::nullopt;
    return scheme.force.shading == "none" ? faceted_work(loop, vertices, normal_depth)
                                          : shaded_facets_work(loop, vertices, normal_depth);
}

/// Two lines that no symmetry of the cells tells apart from any other.
std::vector<Section> lines_of(const Section& section, double cell) {
    std::vector<Section> lines;
    for (const double share : {0.137, 0.618}) {
        lines.push_back(section);
        lines.back().y = share * cell;
    }
    return lines;
}

LoopCase mesh_case(const std::shared_ptr<const SceneMesh>& mesh, const std::string& name, const char* shading) {
    LoopCase one;
    one.prepared = mesh_scene(mesh, name, shading);
    one.pieces = {kMeshPieces};
    one.steps = kMeshSteps;
    return one;
}

} // namespace

std::vector<LoopCase> bump_loops(double radius_mil, const std::vector<unsigned>& facets) {
    const double radius = cylinder_bump_scene(radius_mil).one.scene.surface.radius; /* m, to the bit */
    std::vector<LoopCase> loops;
    loops.push_back(bump_case("cylinder bump", "superposed", radius_mil, cylinder_bump_scene(radius_mil),
                              round_section(radius, {0.002, 0.001})));
    loops.back().closed_form = 0;
    loops.push_back(
        bump_case("height map", "height map on the plane", radius_mil, height_map_scene(radius_mil), flat_section()));
    loops.back().closed_form = shaded_plane_work(loop_of(radius, loops.back()));
    for (const unsigned n : facets) {
        const auto vertices = facet_vertices<double>(n, kHalfWidth, radius, FacetSpacing::equal_arc);
        for (const BumpScheme& scheme : kBumpSchemes) {
            loops.push_back(bump_case("bump", scheme.name, radius_mil, bump_scene(radius_mil, n, scheme.force),
                                      faceted_section(radius, vertices)));
            LoopCase& one = loops.back();
            one.facets = n;
            one.closed_form = closed_form(scheme, loop_of(radius, one), vertices);
            one.pieces = {n < 64 ? 4 : 1};
        }
    }
    return loops;
}

std::vector<LoopCase> mesh_loops(MeshCells kind, unsigned cells) {
    const double radius = kMeshRadius * kMil;
    const bool triangles = kind == MeshCells::triangles;
    const auto mesh = bump_mesh({kHalfWidth, radius, cells, cells, kind});
    const std::string word = triangles ? "triangles" : "quads";
    std::vector<LoopCase> loops;
    for (const char* shading : {"none", "morgenbesser", "barycentric", "mean_value", "two_pass"}) {
        if (!triangles && std::string(shading) == "barycentric")
            continue;
        for (const bool god_object : {false, true}) {
            LoopCase one = mesh_case(mesh, fmt::format("bump-{}-{}.off", cells, word), shading);
            one.surface = "mesh of " + word;
            one.scheme = fmt::format("{} {}{}", word, shading, god_object ? ", god-object" : "");
            one.facets = cells;
            one.radius_mil = kMeshRadius;
            one.sections = lines_of(round_section(radius), 2 * kHalfWidth / cells);
            one.smooth = [radius](double x, double) { return Vector(x, 0, reference::circle_rise(radius, x)); };
            one.god_object = god_object;
            if (!god_object && one.scheme == word + " none")
                one.closed_form = 0; // the gradient of K/2 d^2
            loops.push_back(std::move(one));
        }
    }
    return loops;
}

std::vector<LoopCase> plane_mesh_loops(double radius_mil, unsigned cells) {
    const double radius = radius_mil * kMil;
    const auto mesh = shaded_plane_mesh({kHalfWidth, radius, cells, 4, MeshCells::triangles});
    std::vector<LoopCase> loops;
    for (const char* shading : {"barycentric", "mean_value", "two_pass"}) {
        LoopCase one = mesh_case(mesh, fmt::format("plane-{}mil-{}.off", radius_mil, cells), shading);
        one.surface = "plane as mesh";
        one.scheme = fmt::format("plane mesh {}", shading);
        one.facets = cells;
        one.radius_mil = radius_mil;
        one.sections = lines_of(flat_section(), 2 * kHalfWidth / cells);
        one.smooth = normals_of(radius);
        const BumpLoop loop = loop_of(radius, one);
        one.closed_form = std::string(shading) == "two_pass" ? two_pass_plane_work(loop) : shaded_plane_work(loop);
        loops.push_back(std::move(one));
    }
    return loops;
}

} // namespace forceshade::study
