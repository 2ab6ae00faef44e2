#include "host/study/stability/loop_place.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::study {
namespace {

constexpr double kMil = 25.4e-6;    // m
constexpr double kGrip = 200;       // N/m: holds the probe beside, where a slope would let it go
constexpr double kBumpDepth = 2e-3; // m

HandSpec bare_hand() {
    HandSpec hand;
    hand.mass = 0.1;
    hand.damping = 1;
    hand.grip_stiffness = 0;
    hand.grip_damping = 0;
    return hand;
}

LoopPlace place_on(std::string name, std::string title, const Scene& scene) {
    LoopPlace place;
    place.name = std::move(name);
    place.title = std::move(title);
    place.prepared.one.scene = scene;
    place.prepared.one.scene.force.stiffness = 1;
    place.hand = bare_hand();
    return place;
}

LoopPlace plane_place() {
    LoopPlace place = place_on("plane", "plane", Scene{});
    place.rest = {0, 0, -place.depth};
    place.flat = true;
    feel_around(place, {0, 0, 1});
    return place;
}

// In the middle of a facet: there the smooth cylinder's normal is the facet's, and only its turning tells them apart.
LoopPlace bump_place(bool shaded) {
    Scene scene;
    scene.surface.width = 1000 * kMil;
    scene.surface.radius = 600 * kMil;
    scene.surface.facets = 2;
    scene.force.shading = shaded ? Shading::reference : Shading::none;
    LoopPlace place =
        shaded ? place_on("bump-shaded", "bump, shaded", scene) : place_on("bump", "bump, not shaded", scene);
    place.hand.grip_stiffness = kGrip;
    place.depth = kBumpDepth;
    const double half = scene.surface.width / 2, radius = scene.surface.radius;
    const double x = radius * std::sin(std::asin(half / radius) / 2);
    const double top = radius - std::sqrt((radius - half) * (radius + half)); // of the two facets' ridge
    place.rest = {x, 0, top * (1 - x / half) - place.depth};
    feel_around(place, {0, 0, 1});
    return place;
}

// Where the laws tell of flutter: a slope of 50 degrees, pressed to 0.131 of the radius.
LoopPlace dip_place() {
    Scene scene;
    scene.surface.kind = SurfaceKind::height_map;
    scene.surface.map.function = MapFunction::dip;
    scene.surface.map.radius = 0.025;
    scene.surface.map.width = 1.9 * scene.surface.map.radius;
    scene.force.shading = Shading::height_map;
    LoopPlace place = place_on("dip-shaded", "concave dip, shaded", scene);
    place.depth = 0.131 * scene.surface.map.radius;
    place.rest = {scene.surface.map.radius * std::sin(50 * std::numbers::pi / 180), 0, -place.depth};
    feel_around(place, {0, 0, 1});
    return place;
}

constexpr double kCapRadius = 0.02, kCapHalf = 0.01; // m: a square patch of a sphere
constexpr std::uint32_t kCapCells = 4;               // a side, two triangles each

PolygonSoup cap() {
    PolygonSoup soup;
    const auto coordinate = [](std::uint32_t i) { return kCapHalf * (2.0 * i / kCapCells - 1); };
    for (std::uint32_t j = 0; j <= kCapCells; ++j)
        for (std::uint32_t i = 0; i <= kCapCells; ++i) {
            const double x = coordinate(i), y = coordinate(j);
            soup.vertices.push_back({x, y, std::sqrt(kCapRadius * kCapRadius - x * x - y * y) - kCapRadius});
        }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        soup.corners.insert(soup.corners.end(), {a, b, c});
        soup.begins.push_back(static_cast<std::uint32_t>(soup.corners.size()));
    };
    for (std::uint32_t j = 0; j < kCapCells; ++j)
        for (std::uint32_t i = 0; i < kCapCells; ++i) {
            const std::uint32_t a = j * (kCapCells + 1) + i, d = a + kCapCells + 1;
            add(a, a + 1, d + 1);
            add(a, d + 1, d);
        }
    return soup;
}

std::shared_ptr<const SceneMesh> cap_mesh() {
    auto mesh = std::make_shared<SceneMesh>();
    mesh->findings = inspect(cap());
    mesh->mesh = prepare_mesh(cap(), MeshPlacement{}, VertexNormals::plain);
    mesh->structure = build_structure(mesh->mesh);
    return mesh;
}

// Below the middle of a triangle halfway down the cap.
LoopPlace mesh_place(const std::shared_ptr<const SceneMesh>& mesh, bool shaded) {
    Scene scene;
    scene.surface.kind = SurfaceKind::mesh;
    scene.surface.mesh.file = "cap";
    scene.force.shading = shaded ? Shading::mean_value : Shading::none;
    LoopPlace place =
        shaded ? place_on("mesh-shaded", "mesh, shaded", scene) : place_on("mesh", "mesh, not shaded", scene);
    place.prepared.images.mesh = mesh;
    place.hand.grip_stiffness = kGrip;
    constexpr std::size_t kTriangle = 2 * (kCapCells + 2); // of the cell beside the middle, towards +x and +y
    glm::dvec3 middle(0);
    for (const std::uint32_t corner : mesh->mesh.triangles.corners[kTriangle])
        middle += mesh->mesh.polygons.vertices[corner] / 3.0;
    const glm::dvec3 normal = mesh->mesh.triangles.normals[kTriangle];
    place.rest = middle - place.depth * normal;
    feel_around(place, normal);
    return place;
}

} // namespace

glm::dvec3 force_at(const PreparedCase& prepared, const glm::dvec3& outside, const glm::dvec3& probe) {
    const auto law = make_path_law<double>(prepared);
    law->at(0, outside);
    return glm::dvec3(law->at(0, probe).contact.force);
}

void feel_around(LoopPlace& place, const glm::dvec3& outward) {
    constexpr double kShare = 1e-3; // of the depth
    const auto law = make_path_law<double>(place.prepared);
    std::size_t path = 0;
    const auto force = [&](const glm::dvec3& probe) {
        law->at(path, probe + 2 * place.depth * outward);
        return glm::dvec3(law->at(path++, probe).contact.force);
    };
    place.force = force(place.rest);
    if (!(glm::dot(place.force, place.force) > 0))
        throw UsageError(
            fmt::format("no force holds a probe at ({:.4g}, {:.4g}, {:.4g}) m, so that no hand can be in a loop "
                        "there",
                        place.rest.x, place.rest.y, place.rest.z));
    const double step = kShare * place.depth;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 more = place.rest, less = place.rest;
        more[axis] += step;
        less[axis] -= step;
        place.slope[axis] = (force(less) - force(more)) / (more[axis] - less[axis]);
    }
}

LinearLoop linear_loop(const LoopPlace& place, const HandSpec& hand, double rate) {
    LinearLoop loop;
    loop.lateral = {hand.mass, hand.damping + hand.grip_damping, hand.grip_stiffness};
    loop.vertical = loop.lateral;
    if (!place.held)
        loop.vertical.stiffness = 0;
    loop.period = 1 / rate;
    loop.delay = static_cast<int>(hand.delay_samples);
    loop.slope = place.slope;
    return loop;
}

nlohmann::ordered_json pressed(const LoopPlace& place) {
    return {{"depth", place.depth},
            {"rest", {place.rest.x, place.rest.y, place.rest.z}},
            {"grip", place.hand.grip_stiffness},
            {"held", place.held}};
}

std::vector<LoopPlace> own_places() {
    const auto mesh = cap_mesh();
    return {plane_place(), bump_place(false),       bump_place(true),
            dip_place(),   mesh_place(mesh, false), mesh_place(mesh, true)};
}

} // namespace forceshade::study
