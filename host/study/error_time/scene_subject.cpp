// A user's scene: its own law, and those that its surface has beside.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/prepare/prepared_case.h"
#include "host/study/error_time/law_at.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kTries = 64;         // places drawn for each that is kept
constexpr std::size_t kStroke = 256;       // probes of a stroke
constexpr std::size_t kMeshPlaces = 2048;  // from which strokes over a mesh are chosen
constexpr std::size_t kOthers = 32;        // places of which a stroke goes to the nearest
constexpr std::size_t kFewShallow = 64;    // fewer are not enough
constexpr double kShallow = 0.05;          // of the grid's longest side
constexpr std::uint64_t kLongestSide = 64; // voxels of a kernel's grid
constexpr double kMostSamples = 6e6;       // of a volume
constexpr double kMostMeshSamples = 1e6;   // likewise of a mesh, whose samples take longer

struct NamedShading {
    Shading shading;
    const char* name;
};

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
    std::vector<NamedShading> shadings{{Shading::none, "none"},
                                       {Shading::morgenbesser, "morgenbesser"},
                                       {Shading::mean_value, "mean_value"},
                                       {Shading::two_pass, "two_pass"}};
    const auto& begins = scene.images.mesh->mesh.polygons.begins;
    const auto is_triangle = [&](std::size_t i) { return begins[i + 1] - begins[i] == 3; };
    bool triangles = true;
    for (std::size_t i = 0; i + 1 < begins.size(); ++i)
        triangles = triangles && is_triangle(i);
    if (triangles)
        shadings.push_back({Shading::barycentric, "barycentric"});
    return shadings;
}

// The shading that comes closest to what the facets stand for.
NamedShading best_shading(const PreparedCase& scene) {
    switch (scene.one.scene.surface.kind) {
    case SurfaceKind::bump:
        return {Shading::reference, "reference"};
    case SurfaceKind::cylinder_bump:
        return {Shading::none, "none"};
    case SurfaceKind::height_map:
        return {Shading::height_map, "height_map"};
    case SurfaceKind::mesh:
        break;
    }
    return {Shading::mean_value, "mean_value"};
}

SmoothLaw best_law(const PreparedCase& scene) {
    const auto prepared = std::make_shared<PreparedCase>(scene);
    prepared->one.scene.force.shading = best_shading(scene).shading;
    const auto law = std::make_shared<DirectLaw<double>>(*prepared);
    return [prepared, law](const glm::dvec3& at) {
        return law->at(places_of<double>(*prepared, std::span(&at, 1))[0]).force;
    };
}

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

GridSpec coarser(GridSpec grid) {
    const glm::dvec3 low = low_of(grid), high = high_of(grid);
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        if (grid.size[axis] <= kLongestSide)
            continue;
        grid.size[axis] = kLongestSide;
        grid.spacing[axis] = (high[i] - low[i]) / static_cast<double>(kLongestSide - 1);
    }
    grid.samples = 0;
    return grid;
}

// Places in the grid's box that the scene's own law has in contact, no deeper than `deepest`, m, if there are enough.
std::vector<glm::dvec3> touching_places(const PreparedCase& scene, std::size_t count, double deepest) {
    const glm::dvec3 low = low_of(scene.one.scene.grid), high = high_of(scene.one.scene.grid);
    DirectLaw<double> law(scene);
    Draw draw(3);
    std::vector<glm::dvec3> shallow, all;
    for (std::size_t tries = 0; shallow.size() < count && tries < kTries * count; ++tries) {
        const double x = draw(low.x, high.x), y = draw(low.y, high.y);
        const glm::dvec3 at(x, y, draw(low.z, high.z));
        const auto contact = law.at(places_of<double>(scene, std::span(&at, 1))[0]);
        if (contact.facet == layout::kNoFacet)
            continue;
        all.push_back(at);
        if (contact.depth <= deepest)
            shallow.push_back(at);
    }
    if (all.empty())
        throw UsageError("nothing in the scene's [grid] is in contact: there is no force whose error could be told");
    if (shallow.size() >= kFewShallow)
        return shallow;
    all.resize(std::min(all.size(), count));
    return all;
}

// From a place to the nearest of a few others, so that strokes go along the surface rather than through the mesh.
std::vector<glm::dvec3> strokes_between(const std::vector<glm::dvec3>& places, std::size_t count) {
    Draw draw(5);
    const auto any = [&] { return places[static_cast<std::size_t>(draw(0, static_cast<double>(places.size())))]; };
    std::vector<glm::dvec3> probes;
    while (probes.size() < count) {
        const glm::dvec3 from = any();
        glm::dvec3 way = any() - from;
        for (std::size_t i = 1; i < kOthers; ++i) {
            const glm::dvec3 other = any() - from;
            const double square = reference::dot(other, other);
            if (square > 0 && square < reference::dot(way, way))
                way = other;
        }
        for (std::size_t i = 0; i < kStroke; ++i)
            probes.push_back(from + static_cast<double>(i) / (kStroke - 1) * way);
    }
    return probes;
}

double longest_side(const GridSpec& grid) {
    const glm::dvec3 size = high_of(grid) - low_of(grid);
    return std::max({size.x, size.y, size.z});
}

Variant variant_of(const PreparedCase& scene, const NamedShading& shading, std::uint32_t facets) {
    auto prepared = std::make_shared<PreparedCase>(scene);
    Scene& own = prepared->one.scene;
    own.force.shading = shading.shading;
    own.surface.facets = facets;
    if (!own.paths || own.paths->kind == PathKind::recorded)
        own.paths.emplace();
    own.paths->count = 64;
    own.paths->steps = 500;
    own.paths->drive =
        own.paths->closed() && own.paths->drive != PathDrive::depth ? own.paths->drive : PathDrive::press;
    own.paths->loop.reset();
    const bool bump = own.surface.kind == SurfaceKind::bump, mesh = own.surface.kind == SurfaceKind::mesh;
    const bool is_own = shading.shading == scene.one.scene.force.shading && facets == scene.one.scene.surface.facets;
    Variant variant;
    variant.name = bump ? fmt::format("{} facet{}, {}", facets, facets == 1 ? "" : "s", shading.name) : shading.name;
    variant.shading = shading.name;
    if (bump)
        variant.facets = facets;
    variant.half = variant.kernels = variant.lookups = variant.thorough = is_own;
    variant.proxies = mesh;
    variant.prepared = std::move(prepared);
    return variant;
}

std::vector<double> spacings_of(const GridSpec& grid, double most) {
    const glm::dvec3 size = high_of(grid) - low_of(grid);
    const double finest = *std::min_element(grid.spacing.begin(), grid.spacing.end());
    std::vector<double> spacings;
    for (const double times : {8.0, 4.0, 2.0, 1.0}) {
        const double h = times * finest;
        if ((size.x / h + 5) * (size.y / h + 5) * (size.z / h + 5) <= most)
            spacings.push_back(h);
    }
    return spacings;
}

} // namespace

Subject scene_subject(const PreparedCase& given, const Extents& extents) {
    PreparedCase scene = given;
    const Scene& own = scene.one.scene;
    if (!own.field && own.surface.kind == SurfaceKind::mesh) // of paths alone: no grid was given
        scene.one.scene.grid = fitted_grid(kLongestSide, scene.images.mesh->mesh);
    Subject subject;
    subject.name = "scene";
    const bool bump = own.surface.kind == SurfaceKind::bump, mesh = own.surface.kind == SurfaceKind::mesh;
    std::vector<unsigned> facets = bump ? extents.facets : std::vector<unsigned>{own.surface.facets};
    if (std::find(facets.begin(), facets.end(), own.surface.facets) == facets.end())
        facets.push_back(own.surface.facets);
    std::sort(facets.begin(), facets.end());
    for (const unsigned n : facets)
        for (const NamedShading& shading : shadings_of(scene))
            subject.variants.push_back(variant_of(scene, shading, n));
    subject.grid = coarser(own.grid);
    subject.low = low_of(own.grid);
    subject.high = high_of(own.grid);
    if (mesh) {
        const auto places = touching_places(scene, kMeshPlaces, kShallow * longest_side(own.grid));
        subject.probes = strokes_between(places, extents.probes);
        subject.stroke = kStroke;
        subject.best = std::make_shared<PreparedCase>(scene);
        subject.best->one.scene.force.shading = best_shading(scene).shading;
    } else {
        subject.probes = touching_places(scene, extents.probes, INFINITY);
    }
    subject.spacings = spacings_of(own.grid, mesh ? kMostMeshSamples : kMostSamples);
    if (bump && !own.texture) {
        subject.smooth = cylinder_law(own);
        subject.notes.push_back(
            "The smooth shape is the cylinder of the scene's radius and width, with the force K d along the normal "
            "above the probe, the depth read as the scene reads it.");
    } else {
        subject.smooth = best_law(scene);
        const NamedShading best = best_shading(scene);
        subject.against = best.shading == Shading::none ? std::string("double without shading")
                                                        : fmt::format("double of {}", best.name);
        subject.notes.push_back(fmt::format(
            "No smooth shape of this scene is known: errors are told against reference<double> {}, which is a law "
            "among "
            "others and no truth. They say how far apart ways and shadings are, not which of them is right; so nothing "
            "is named the cheapest here.",
            best.shading == Shading::none ? std::string("without shading") : fmt::format("of {}", best.name)));
    }
    subject.notes.push_back(mesh ? "Probes go along short straight strokes between places inside the mesh, no deeper "
                                   "than 5 % of the grid's longest side "
                                   "where there are enough of these, god-object and static field alike; a god-object "
                                   "is held against the god-object "
                                   "with the best shading, which keeps the side that it is on as it does."
                                 : "Probes are random places in the scene's grid that are in contact.");
    return subject;
}

} // namespace forceshade::study::error_time
