#include "host/study/error_time/subject.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/study/error_time/law_at.h"
#include "host/study/error_time/places.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kDeepest = 2e-3;                // m: of a hand's touch
constexpr double kDeepestShare = 0.05;           // of a scene's longest side
constexpr std::uint64_t kLongestSide = 64;       // voxels of a kernel's grid over a user's scene
constexpr double kMostSamples = 6e6;             // of a volume
constexpr double kMostMeshSamples = 1e6;         // likewise of a mesh, whose samples take longer
constexpr double kThoroughFacets = 64;           // of the own bump that everything is done with
constexpr double kThoroughCells = 16;            // likewise of the own mesh
constexpr std::size_t kPaths = 64, kSteps = 500; // of closed loops

// The paper's bump, R = 600 mil: its width and 2 mm of the plane on either side. Meshes are of its cylinder.
constexpr const char* kOwnScene = R"(
[surface]
radius = "600 mil"
width = "1000 mil"
[force]
stiffness = "1000 N/m"
[grid]
size = [256, 8, 64]
origin = ["-14.7 mm", "-2 mm", "-2.5 mm"]
spacing = ["0.1153 mm", "0.5714 mm", "0.15 mm"]
[paths]
press = "1 N"
speed = "60 mm/s"
)";
constexpr double kMeshBox[2][3] = {{-9e-3, -6e-3, 1.5e-3}, {9e-3, 6e-3, 7e-3}}; // m: away from the mesh's border

glm::dvec3 low_of(const GridSpec& grid) {
    return {grid.origin[0], grid.origin[1], grid.origin[2]};
}

glm::dvec3 high_of(const GridSpec& grid) {
    glm::dvec3 high = low_of(grid);
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        high[i] += grid.spacing[axis] * static_cast<double>(grid.size[axis] - 1);
    }
    return high;
}

struct NamedShading {
    Shading shading;
    const char* name;
};

// The shadings that a surface has; the last comes closest to what the facets stand for.
std::vector<NamedShading> shadings_of(const PreparedCase& scene) {
    switch (scene.one.scene.surface.kind) {
    case SurfaceKind::bump:
        return {{Shading::none, "none"}, {Shading::reference, "reference"}};
    case SurfaceKind::cylinder_bump:
        return {{Shading::none, "none"}};
    case SurfaceKind::height_map:
        return {{Shading::none, "none"}, {Shading::height_map, "height_map"}};
    case SurfaceKind::mesh:
        break;
    }
    std::vector<NamedShading> shadings{{Shading::none, "none"}, {Shading::morgenbesser, "morgenbesser"}};
    const PolygonSoup& polygons = scene.images.mesh->mesh.polygons;
    bool triangles = true;
    for (std::size_t i = 0; i < polygons.facets(); ++i)
        triangles = triangles && polygons.corners_of(i) == 3;
    if (triangles)
        shadings.push_back({Shading::barycentric, "barycentric"});
    shadings.push_back({Shading::two_pass, "two_pass"});
    shadings.push_back({Shading::mean_value, "mean_value"});
    return shadings;
}

// A surface of which one quantity may differ.
struct Base {
    std::shared_ptr<const PreparedCase> prepared;
    std::optional<double> elements;
};

Variant variant_of(const Base& base, const NamedShading& shading, const std::string& elements) {
    auto prepared = std::make_shared<PreparedCase>(*base.prepared);
    Scene& scene = prepared->one.scene;
    scene.force.shading = shading.shading;
    if (!scene.paths || scene.paths->kind == PathKind::recorded)
        scene.paths.emplace();
    scene.paths->count = kPaths;
    scene.paths->steps = kSteps;
    if (!scene.paths->closed() || scene.paths->drive == PathDrive::depth)
        scene.paths->drive = PathDrive::press;
    scene.paths->loop.reset();
    Variant variant;
    variant.name = base.elements ? fmt::format("{} {}, {}", *base.elements, elements, shading.name) : shading.name;
    variant.shading = shading.name;
    variant.elements = base.elements;
    variant.prepared = std::move(prepared);
    return variant;
}

// The force K (U(x) - z) of the cylinder along its normal, the depth read as the scene reads it.
Truth cylinder_truth(const Scene& scene) {
    const double half = scene.surface.width / 2, radius = scene.surface.radius, stiffness = scene.force.stiffness;
    const double centre_depth = std::sqrt((radius - half) * (radius + half));
    const bool normal = scene.force.depth == DepthReading::normal;
    return [=](const Place& place) {
        const glm::dvec3& at = place.at;
        double depth = reference::cylinder_height(half, radius, centre_depth, at.x) - at.z;
        if (!(depth > 0))
            return glm::dvec3(0);
        glm::dvec3 direction(0, 0, 1);
        if (std::abs(at.x) < half)
            direction = {at.x / radius, 0, reference::circle_rise(radius, at.x) / radius};
        if (normal)
            depth *= direction.z;
        return stiffness * depth * direction;
    };
}

// Double precision of the shading that comes closest; of a mesh the god-object's, which stays on its side.
Truth best_truth(const PreparedCase& scene, const TouchScale& scale) {
    const auto prepared = std::make_shared<PreparedCase>(scene);
    prepared->one.scene.force.shading = shadings_of(scene).back().shading;
    if (scene.images.mesh) {
        const auto law = std::make_shared<ProxyLaw<double>>(*prepared);
        return [prepared, law, scale](const Place& place) {
            return law->force(rounded_places<double>(*prepared, descent(place, scale)));
        };
    }
    const auto law = std::make_shared<DirectLaw<double>>(*prepared);
    return [prepared, law](const Place& place) {
        return law->at(rounded_places<double>(*prepared, std::span(&place.at, 1))[0]).force;
    };
}

std::vector<double> spacings_within(const Subject& subject, std::vector<double> spacings, double most) {
    const glm::dvec3 size = subject.high - subject.low;
    std::erase_if(spacings, [&](double h) { return (size.x / h + 5) * (size.y / h + 5) * (size.z / h + 5) > most; });
    return spacings;
}

// Everything but what is said to be true, and in which box.
void complete(Subject& subject, const std::vector<Base>& bases, const Extents& extents) {
    const PreparedCase& first = *bases.front().prepared;
    subject.stiffness = first.one.scene.force.stiffness;
    for (const Base& base : bases)
        for (const NamedShading& shading : shadings_of(first))
            subject.variants.push_back(variant_of(base, shading, subject.elements));
    subject.places = shared_places(subject, *bases.back().prepared, extents.places);
    if (subject.places.empty())
        throw UsageError("nothing in the scene's [grid] is touched: there is no force whose error could be told");
}

// The cylinder's patch as triangles between equal arcs.
std::shared_ptr<const SceneMesh> cylinder_mesh(const Scene& scene, unsigned cells) {
    const double half = scene.surface.width / 2, radius = scene.surface.radius;
    const double half_angle = std::asin(half / radius), centre_depth = std::sqrt((radius - half) * (radius + half));
    PolygonSoup polygons;
    const auto vertex = [&](unsigned i, unsigned j) { return j * (cells + 1) + i; };
    for (unsigned j = 0; j <= cells; ++j)
        for (unsigned i = 0; i <= cells; ++i) {
            const double angle = half_angle * (2.0 * i / cells - 1);
            polygons.vertices.emplace_back(radius * std::sin(angle), half * (2.0 * j / cells - 1),
                                           radius * std::cos(angle) - centre_depth);
        }
    for (unsigned j = 0; j < cells; ++j)
        for (unsigned i = 0; i < cells; ++i)
            for (const unsigned corner : {1U, 2U}) {
                polygons.corners.push_back(vertex(i, j));
                polygons.corners.push_back(corner == 1 ? vertex(i + 1, j) : vertex(i + 1, j + 1));
                polygons.corners.push_back(corner == 1 ? vertex(i + 1, j + 1) : vertex(i, j + 1));
                polygons.end_facet();
            }
    auto mesh = std::make_shared<SceneMesh>();
    mesh->mesh = prepare_mesh(std::move(polygons), MeshPlacement{}, VertexNormals::plain);
    mesh->structure = build_structure(mesh->mesh);
    return mesh;
}

Subject own_bump(const PreparedCase& own, const Extents& extents) {
    Subject subject;
    subject.name = "bump";
    subject.elements = "facets";
    subject.truth = cylinder_truth(own.one.scene);
    subject.grid = own.one.scene.grid;
    subject.low = low_of(subject.grid);
    subject.high = high_of(subject.grid);
    subject.spacings = extents.spacings;
    std::vector<Base> bases;
    for (const unsigned facets : extents.facets) {
        auto prepared = std::make_shared<PreparedCase>(own);
        prepared->one.scene.surface.facets = facets;
        bases.push_back({prepared, facets});
    }
    complete(subject, bases, extents);
    for (Variant& variant : subject.variants)
        variant.lookups = variant.thorough = variant.elements == kThoroughFacets;
    subject.notes = {"The bump is the paper's, R = 600 mil and W = 1000 mil on a plane, K = 1000 N/m. Its smooth shape "
                     "is the cylinder, with the force K (U(x) - z) along the normal N(x) above the probe: the depth is "
                     "read vertically, as that of the facets is."};
    return subject;
}

Subject own_mesh(const PreparedCase& own, const Extents& extents) {
    Subject subject;
    subject.name = "mesh";
    subject.elements = "cells";
    const Scene& scene = own.one.scene;
    const double radius = scene.surface.radius, half = scene.surface.width / 2, stiffness = scene.force.stiffness;
    const double centre_depth = std::sqrt((radius - half) * (radius + half));
    subject.truth = [=](const Place& place) {
        const glm::dvec3 from_axis(place.at.x, 0, place.at.z + centre_depth);
        const double r = reference::length(from_axis);
        return r < radius && r > 0 ? stiffness * (radius - r) / r * from_axis : glm::dvec3(0);
    };
    subject.grid = scene.grid;
    subject.grid.size = {64, 32, 32};
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        subject.low[i] = subject.grid.origin[axis] = kMeshBox[0][i];
        subject.high[i] = kMeshBox[1][i];
        subject.grid.spacing[axis] =
            (subject.high[i] - subject.low[i]) / static_cast<double>(subject.grid.size[axis] - 1);
    }
    subject.spacings = spacings_within(subject, extents.spacings, kMostMeshSamples);
    std::vector<Base> bases;
    for (const unsigned cells : extents.cells) {
        auto prepared = std::make_shared<PreparedCase>(own);
        prepared->one.scene.surface.kind = SurfaceKind::mesh;
        prepared->images.mesh = cylinder_mesh(scene, cells);
        bases.push_back({prepared, cells});
    }
    complete(subject, bases, extents);
    for (Variant& variant : subject.variants)
        variant.lookups = variant.thorough =
            variant.elements == kThoroughCells && (variant.shading == "none" || variant.shading == "mean_value");
    subject.notes = {"The meshes are patches of the same cylinder, cut into triangles between equal arcs. Their smooth "
                     "shape has the force K (R - r) along the radius: the depth is that of the nearest point, as the "
                     "meshes' is."};
    return subject;
}

} // namespace

Extents extents_of(bool quick) {
    if (quick)
        return {{1, 4, 16, 64, 512}, {4, 8, 16, 32}, {0.8e-3, 0.4e-3, 0.2e-3}, 1000, 150, 7};
    return {{1, 2, 3, 4, 8, 16, 32, 64, 128, 512, 4096},
            {4, 8, 16, 32, 64},
            {0.8e-3, 0.4e-3, 0.2e-3, 0.1e-3},
            4000,
            500,
            30};
}

std::vector<Subject> own_subjects(const Extents& extents) {
    const PreparedCase own = CasePreparation().prepare(parse_scene(kOwnScene, "the study's own scene"));
    return {own_bump(own, extents), own_mesh(own, extents)};
}

Subject scene_subject(const PreparedCase& given, const Extents& extents) {
    auto scene = std::make_shared<PreparedCase>(given);
    Scene& own = scene->one.scene;
    const bool bump = own.surface.kind == SurfaceKind::bump, mesh = own.surface.kind == SurfaceKind::mesh;
    if (!own.field && mesh) // of paths alone: no grid was given
        own.grid = fitted_grid(kLongestSide, scene->images.mesh->mesh);
    Subject subject;
    subject.name = "scene";
    subject.elements = bump ? "facets" : "";
    subject.low = low_of(own.grid);
    subject.high = high_of(own.grid);
    const glm::dvec3 size = subject.high - subject.low;
    subject.scale.deepest = std::min(kDeepest, kDeepestShare * std::max({size.x, size.y, size.z}));
    subject.grid = own.grid;
    subject.grid.samples = 0;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        if (subject.grid.size[axis] > kLongestSide) {
            subject.grid.size[axis] = kLongestSide;
            subject.grid.spacing[axis] = size[i] / (kLongestSide - 1);
        }
    }
    const double finest = *std::ranges::min_element(own.grid.spacing);
    subject.spacings =
        spacings_within(subject, {8 * finest, 4 * finest, 2 * finest, finest}, mesh ? kMostMeshSamples : kMostSamples);
    if (bump && !own.texture) {
        subject.truth = cylinder_truth(own);
        subject.notes.push_back("The smooth shape is the cylinder of the scene's radius and width, with the force K d "
                                "along the normal above the probe, the depth read as the scene reads it.");
    } else {
        subject.truth = best_truth(*scene, subject.scale);
        subject.against = fmt::format("double precision of {}", shadings_of(*scene).back().name);
        subject.notes.push_back(fmt::format("No smooth shape of this scene is known: errors are told against {}, which "
                                            "is a law among others and no truth. They say how far apart ways and "
                                            "shadings are, not which of them is right.",
                                            subject.against));
    }
    complete(subject, {{scene, bump ? std::optional<double>(own.surface.facets) : std::nullopt}}, extents);
    for (Variant& variant : subject.variants)
        variant.lookups = variant.thorough = variant.prepared->one.scene.force.shading == own.force.shading;
    return subject;
}

} // namespace forceshade::study::error_time
