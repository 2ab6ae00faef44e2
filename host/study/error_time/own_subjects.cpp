// The study's own surfaces: the paper's bump, and meshes of its cylinder.
#include <cmath>

#include <fmt/format.h>

#include "host/mesh/mesh.h"
#include "host/prepare/prepared_case.h"
#include "host/reference/elementary.h"
#include "host/study/error_time/lookup_errors.h"
#include "host/study/error_time/patch.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kMil = 25.4e-6;         // m
constexpr double kRadius = 600 * kMil;   // m
constexpr double kHalf = 500 * kMil;     // m
constexpr double kStiffness = 1000;      // N/m
constexpr double kShallowest = 0.25e-3;  // m: of the probes
constexpr double kDeepest = 2e-3;        // m
constexpr std::size_t kStroke = 256;     // probes
constexpr double kReach = 0.85;          // of the bump's half width: no stencil of a look-up reaches its rim
constexpr double kMeshReachAlong = 0.75; // of the mesh's half angle
constexpr double kMeshReachAcross = 0.6; // of its half length
constexpr unsigned kThorough = 64;       // facets of the bump that everything is done with
constexpr unsigned kThoroughCells = 16;  // likewise of the mesh; volumes are of the finest, too, as reading them costs
                                         // the same whatever they are of
constexpr double kStiffHand = 1;         // N: what closed loops press with

const double kCentreDepth = std::sqrt((kRadius - kHalf) * (kRadius + kHalf)); // m
const double kHalfAngle = std::asin(kHalf / kRadius);                         // rad

Scene own_scene() {
    Scene scene;
    scene.surface.radius = kRadius;
    scene.surface.width = 2 * kHalf;
    scene.force.stiffness = kStiffness;
    scene.paths.emplace();
    scene.paths->count = 64;
    scene.paths->steps = 500;
    scene.paths->drive = PathDrive::press;
    scene.paths->press = kStiffHand;
    scene.paths->speed = fixed_spread(0.06);
    return scene;
}

GridSpec grid_over(const glm::dvec3& low, const glm::dvec3& high, const std::array<std::uint64_t, 3>& size) {
    GridSpec grid;
    grid.size = size;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        grid.origin[axis] = low[i];
        grid.spacing[axis] = (high[i] - low[i]) / static_cast<double>(size[axis] - 1);
    }
    return grid;
}

Variant bump_variant(unsigned facets, bool shaded) {
    auto prepared = std::make_shared<PreparedCase>();
    prepared->one.scene = own_scene();
    prepared->one.scene.surface.facets = facets;
    prepared->one.scene.force.shading = shaded ? Shading::reference : Shading::none;
    Variant variant;
    variant.name = fmt::format("{} facet{}, {}", facets, facets == 1 ? "" : "s", shaded ? "shaded" : "flat");
    variant.shading = shaded ? "reference" : "none";
    variant.facets = facets;
    variant.half = facets == 4 || facets == kThorough || facets == 512 || facets == 4096;
    variant.kernels = variant.half || facets == 1;
    variant.thorough = facets == kThorough;
    variant.prepared = std::move(prepared);
    return variant;
}

// The cylinder's patch as triangles between equal arcs.
std::shared_ptr<const SceneMesh> cylinder_mesh(unsigned cells) {
    PolygonSoup polygons = patch(Cells::triangles, cells, [](double, double) { return 0.0; });
    for (glm::dvec3& vertex : polygons.vertices) {
        const double angle = 2 * kHalfAngle * vertex.x;
        vertex = {kRadius * std::sin(angle), 2 * kHalf * vertex.y, kRadius * std::cos(angle) - kCentreDepth};
    }
    auto mesh = std::make_shared<SceneMesh>();
    mesh->mesh = prepare_mesh(std::move(polygons), MeshPlacement{}, VertexNormals::plain);
    mesh->structure = build_structure(mesh->mesh);
    return mesh;
}

struct NamedShading {
    Shading shading;
    const char* name;
};
constexpr NamedShading kMeshShadings[] = {{Shading::none, "none"},
                                          {Shading::morgenbesser, "morgenbesser"},
                                          {Shading::barycentric, "barycentric"},
                                          {Shading::mean_value, "mean_value"},
                                          {Shading::two_pass, "two_pass"}};

Variant mesh_variant(const std::shared_ptr<const SceneMesh>& mesh, unsigned cells, const NamedShading& shading) {
    auto prepared = std::make_shared<PreparedCase>();
    Scene& scene = prepared->one.scene;
    scene = own_scene();
    scene.surface.kind = SurfaceKind::mesh;
    scene.force.shading = shading.shading;
    prepared->images.mesh = mesh;
    const bool often = shading.shading == Shading::none || shading.shading == Shading::mean_value;
    Variant variant;
    variant.name = fmt::format("{0} x {0} cells, {1}", cells, shading.name);
    variant.shading = shading.name;
    variant.cells = cells;
    variant.half = cells == kThoroughCells && often;
    variant.kernels = often && cells >= 8;
    variant.proxies = often || shading.shading == Shading::morgenbesser;
    variant.thorough = cells == kThoroughCells && often;
    variant.prepared = std::move(prepared);
    return variant;
}

glm::dvec3 on_cylinder(double angle, double y, double depth) {
    const double r = kRadius - depth;
    return {r * std::sin(angle), y, r * std::cos(angle) - kCentreDepth};
}

// Straight in angle and y, each stroke at a depth that changes evenly.
std::vector<glm::dvec3> strokes(std::size_t count) {
    Draw draw(2);
    const double along = kMeshReachAlong * kHalfAngle, across = kMeshReachAcross * kHalf;
    std::vector<glm::dvec3> probes;
    while (probes.size() < count) {
        const glm::dvec3 from(draw(-along, along), draw(-across, across), draw(kShallowest, kDeepest));
        const glm::dvec3 to(draw(-along, along), draw(-across, across), draw(kShallowest, kDeepest));
        for (std::size_t i = 0; i < kStroke; ++i) {
            const double share = static_cast<double>(i) / (kStroke - 1);
            const glm::dvec3 at = from + share * (to - from);
            probes.push_back(on_cylinder(at.x, at.y, at.z));
        }
    }
    return probes;
}

} // namespace

std::vector<LookupCase> lookup_cases() {
    constexpr double kAcross = 3e-3, kDeep = 4e-3; // m
    const glm::dvec3 low(-0.8 * kHalf, -kAcross, -kDeep), high(0.8 * kHalf, kAcross, kRadius - kCentreDepth);
    const auto mesh = cylinder_mesh(4);
    const glm::dvec3 left(-0.45 * kHalf, low.y, low.z), right(0.45 * kHalf, high.y, high.z); // of the mesh's border
    return {
        {"bump of 4 facets, shaded", "bump-4-shaded", bump_variant(4, true).prepared, low, high, kDeep, 0.8e-3, 1,
         false},
        {"bump of 4 facets, flat", "bump-4-flat", bump_variant(4, false).prepared, low, high, kDeep, 0.8e-3, 0, true},
        {"mesh of 4 x 4 cells, mean_value", "mesh-4-mean_value", mesh_variant(mesh, 4, kMeshShadings[3]).prepared, left,
         right, kDeep, 0.4e-3, std::nullopt, false}};
}

Subject bump_subject(const Extents& extents) {
    Subject subject;
    subject.name = "bump";
    for (const unsigned facets : extents.facets)
        for (const bool shaded : {false, true}) {
            subject.variants.push_back(bump_variant(facets, shaded));
            subject.variants.back().lookups = shaded && (facets == kThorough || facets == extents.facets.back());
        }
    subject.smooth = cylinder_law(own_scene());
    const glm::dvec3 low(-kReach * kHalf, -kHalf / 4, -kDeepest), high(kReach * kHalf, kHalf / 4, -kShallowest);
    Draw draw(1);
    for (std::size_t i = 0; i < extents.probes; ++i) {
        const double x = draw(low.x, high.x), y = draw(low.y, high.y);
        subject.probes.push_back({x, y, draw(low.z, high.z)});
    }
    subject.grid = grid_over(low, high, {256, 16, 64});
    subject.low = low;
    subject.high = {high.x, high.y, kRadius - kCentreDepth};
    subject.spacings = extents.spacings;
    subject.notes = {fmt::format(
        "The bump is the paper's: R = 600 mil, W = 1000 mil, K = {} N/m. Its smooth shape is the cylinder, with the "
        "force K (U(x) - z) along the normal N(x) above the probe: the depth is read vertically, as that of "
        "the facets is. Probes lie at random {} to {} mm below the nominal plane, where every number of "
        "facets is in contact, over {:.0f} % of the bump's width: across its rim, where the smooth shape itself has an "
        "edge, a look-up would err by that jump.",
        kStiffness, kShallowest * 1e3, kDeepest * 1e3, 100 * kReach)};
    return subject;
}

Subject mesh_subject(const Extents& extents) {
    Subject subject;
    subject.name = "mesh";
    for (const unsigned cells : extents.cells) {
        const auto mesh = cylinder_mesh(cells);
        for (const NamedShading& shading : kMeshShadings) {
            subject.variants.push_back(mesh_variant(mesh, cells, shading));
            subject.variants.back().lookups =
                shading.shading == Shading::mean_value && (cells == kThoroughCells || cells == extents.cells.back());
        }
    }
    subject.smooth = [](const glm::dvec3& at) {
        const glm::dvec3 from_axis(at.x, 0, at.z + kCentreDepth);
        const double r = reference::length(from_axis);
        return r < kRadius ? kStiffness * (kRadius - r) / r * from_axis : glm::dvec3(0);
    };
    subject.probes = strokes(extents.probes);
    subject.stroke = kStroke;
    subject.grid = grid_over({-7e-3, -6e-3, 2.9e-3}, {7e-3, 6e-3, 4.8e-3}, {48, 24, 16});
    subject.low = {-kHalf, -kMeshReachAcross * kHalf, -kDeepest};
    subject.high = {kHalf, kMeshReachAcross * kHalf, kRadius - kCentreDepth};
    subject.spacings = extents.spacings;
    subject.spacings.pop_back(); // the finest takes as long as all others
    subject.notes = {fmt::format("The meshes are patches of the same cylinder, cut into triangles between equal arcs. "
                                 "Their smooth shape has the force "
                                 "K (R - r) along the radius: the depth is that of the nearest point, as the meshes' "
                                 "is. Probes go along strokes of {} "
                                 "places, {} to {} mm deep, in every direction; god-object and static field meet the "
                                 "same places. A bump's errors and a mesh's are "
                                 "therefore against two readings of the same cylinder.",
                                 kStroke, kShallowest * 1e3, kDeepest * 1e3)};
    return subject;
}

} // namespace forceshade::study::error_time
