#include "host/study/energy/scene_loops.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/paths/motions.h"
#include "host/prepare/prepared_case.h"
#include "host/reference/elementary.h"
#include "host/study/energy/scene_section.h"
#include "host/study/energy/scenes.h"

namespace forceshade::study {
namespace {

constexpr double kDeep = 0.02;  /* of the region's length */
constexpr double kUsed = 0.998; /* of the region's length, so that no loop ends on an edge */
constexpr int kSceneMeshSteps = 1024;

struct Scheme {
    std::string name;
    ForceSpec force;
};

bool all_triangles(const SceneMesh& mesh) {
    const auto& begins = mesh.mesh.polygons.begins;
    for (std::size_t facet = 0; facet + 1 < begins.size(); ++facet)
        if (begins[facet + 1] - begins[facet] != 3)
            return false;
    return true;
}

std::vector<Scheme> bump_schemes(ForceSpec force) {
    std::vector<Scheme> schemes;
    for (const DepthReading depth : {DepthReading::vertical, DepthReading::normal}) {
        const char* suffix = depth == DepthReading::normal ? ", normal depth" : "";
        force.depth = depth;
        force.shading = Shading::none;
        schemes.push_back({fmt::format("facets{}", suffix), force});
        force.shading = Shading::reference;
        force.reference = ReferenceDirection::normal;
        schemes.push_back({fmt::format("shaded{}", suffix), force});
        force.reference = ReferenceDirection::radial;
        schemes.push_back({fmt::format("shaded, radial{}", suffix), force});
        force.reference = ReferenceDirection::normal;
    }
    return schemes;
}

std::vector<Scheme> schemes_of(const PreparedCase& scene) {
    ForceSpec force = scene.one.scene.force;
    switch (scene.one.scene.surface.kind) {
    case SurfaceKind::bump:
        return bump_schemes(force);
    case SurfaceKind::cylinder_bump:
        return {{"superposed", force}};
    case SurfaceKind::height_map: {
        ForceSpec plain = force, shaded = force;
        plain.shading = Shading::none;
        shaded.shading = Shading::height_map;
        return {{"plane", plain}, {"height map on the plane", shaded}};
    }
    case SurfaceKind::mesh:
        break;
    }
    std::vector<Scheme> schemes;
    const std::pair<const char*, Shading> shadings[] = {{"none", Shading::none},
                                                        {"morgenbesser", Shading::morgenbesser},
                                                        {"barycentric", Shading::barycentric},
                                                        {"mean_value", Shading::mean_value},
                                                        {"two_pass", Shading::two_pass}};
    for (const auto& [name, shading] : shadings)
        if (shading != Shading::barycentric || all_triangles(*scene.images.mesh)) {
            force.shading = shading;
            schemes.push_back({name, force});
        }
    return schemes;
}

PreparedCase with_force(const PreparedCase& scene, const Scheme& scheme) {
    PreparedCase prepared = scene;
    prepared.one.scene.force = scheme.force;
    prepared.one.scene.paths.reset();
    prepared.scene = fmt::format("# [force] here: {}\n{}", scheme.name, scene.scene);
    return prepared;
}

/// The region of the scene's paths, as of open strokes.
struct Room {
    PathRegion region;
    double out, back; /* m */
};

Room room_of(const PreparedCase& scene) {
    const PathsSpec given = scene.one.scene.paths.value_or(PathsSpec{});
    PathsSpec strokes;
    strokes.centre = given.centre;
    strokes.length = given.length;
    if (scene.one.scene.surface.kind == SurfaceKind::mesh)
        strokes.drive = PathDrive::press; // not over the mesh's rim
    const PathRegion region = path_region(strokes, scene);
    if (!(region.length > 0))
        throw UsageError("paths.length leaves no room for a loop: it must be above 0");
    const auto depth_of = [](const Spread& spread) {
        return spread.shape == Spread::Shape::uniform ? (spread.low + spread.high) / 2 : spread.value;
    };
    const bool told = scene.one.scene.paths && given.drive == PathDrive::depth && depth_of(given.depth) > 0;
    const double out = told ? depth_of(given.depth) : kDeep * region.length;
    return {region, out, given.depth_back ? depth_of(*given.depth_back) : out / 2};
}

std::string surface_word(SurfaceKind kind) {
    return kind == SurfaceKind::bump            ? "bump"
           : kind == SurfaceKind::cylinder_bump ? "cylinder bump"
           : kind == SurfaceKind::height_map    ? "height map"
                                                : "mesh";
}

std::function<Vector(double, double)> normals_of(const Scene& scene) {
    const double radius = scene.surface.radius, half_width = scene.surface.width / 2;
    if (scene.surface.kind != SurfaceKind::bump && scene.surface.kind != SurfaceKind::cylinder_bump)
        return {};
    return [=](double x, double) {
        return std::abs(x) < half_width ? Vector(x, 0, reference::circle_rise(radius, x)) : Vector(0, 0, 1);
    };
}

/// R in mil, without the digits that units leave; 0: the surface has none.
double radius_mil(const SurfaceSpec& surface) {
    const bool round = surface.kind == SurfaceKind::bump || surface.kind == SurfaceKind::cylinder_bump;
    const bool map = surface.kind == SurfaceKind::height_map &&
                     (surface.map.function == MapFunction::cylinder || surface.map.function == MapFunction::dip);
    constexpr double kSteps = 1e6; /* of a mil */
    return std::round(kSteps * (round ? surface.radius : map ? surface.map.radius : 0) / kMil) / kSteps;
}

/// Where a loop from the middle ends: inside the bump, where its last facet slopes, for over the rim on the plane the
/// breaks of unequal slopes add up to nothing.
double half_end(const Scene& scene, double middle, double end) {
    const bool bump = scene.surface.kind == SurfaceKind::bump || scene.surface.kind == SurfaceKind::cylinder_bump;
    const double rim = kLoopEnd * scene.surface.width / 2;
    return bump && middle < rim ? std::min(end, rim) : end;
}

} // namespace

std::vector<LoopCase> scene_loops(const PreparedCase& scene) {
    const Room room = room_of(scene);
    const double x = room.region.centre[0], y = room.region.centre[1], half = kUsed * room.region.length / 2;
    const SurfaceKind surface = scene.one.scene.surface.kind;
    const bool mesh = surface == SurfaceKind::mesh;
    const std::pair<const char*, Section> parts[] = {
        {"half", scene_section(scene, x, half_end(scene.one.scene, x, x + half), y)},
        {"whole", scene_section(scene, x - half, x + half, y)}};
    std::vector<LoopCase> loops;
    for (const auto& [part, section] : parts)
        for (const Scheme& scheme : schemes_of(scene))
            for (const bool god_object : {false, true}) {
                if (god_object && !mesh)
                    continue;
                LoopCase one;
                one.surface = surface_word(surface);
                one.loop = part;
                one.scheme = scheme.name + (god_object ? ", god-object" : "");
                one.prepared = with_force(scene, scheme);
                one.radius_mil = radius_mil(scene.one.scene.surface);
                one.sections = {section};
                one.out = room.out;
                one.back = room.back;
                one.smooth = normals_of(scene.one.scene);
                one.god_object = god_object;
                one.pieces = {8};
                one.steps = mesh ? kSceneMeshSteps : one.steps;
                if (surface == SurfaceKind::bump)
                    one.facets = scene.one.scene.surface.facets;
                const bool plain = !scene.one.scene.texture && scheme.force.shading == Shading::none;
                if (plain && !god_object && (mesh || surface == SurfaceKind::cylinder_bump))
                    one.closed_form = 0; // a mesh's is the gradient of K/2 d^2
                loops.push_back(std::move(one));
            }
    return loops;
}

std::vector<CurlMap> scene_curl_maps(const PreparedCase& scene, std::uint64_t columns) {
    const Room room = room_of(scene);
    const double x = room.region.centre[0], y = room.region.centre[1], half = room.region.length / 2;
    const Section section = scene_section(scene, x - half, x + half, y);
    double low = section.height(section.breaks.front()), high = low;
    for (const double at : section.breaks) {
        low = std::min(low, section.height(at));
        high = std::max(high, section.height(at));
    }
    const double beyond = 1.5 * room.out;
    std::vector<CurlMap> maps;
    for (const Scheme& scheme : schemes_of(scene)) {
        PreparedCase prepared = with_force(scene, scheme);
        set_section(prepared, {{x - half, low - beyond}, {x + half, high + 0.25 * beyond}, y, columns, columns / 2});
        std::string name = "scene-" + scheme.name;
        std::erase(name, ',');
        std::ranges::replace(name, ' ', '-');
        maps.push_back({name, scheme.name, scheme.name, std::move(prepared), {}});
    }
    return maps;
}

} // namespace forceshade::study
