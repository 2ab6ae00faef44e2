#include "host/study/omission/base_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::study {
namespace {

constexpr std::uint64_t kVoxels = std::uint64_t(1) << 18, kQuickVoxels = std::uint64_t(1) << 15;
constexpr std::uint64_t kPaths = 512, kQuickPaths = 128, kSteps = 500, kQuickSteps = 200;

PreparedCase prepared(const std::string& toml) {
    return CasePreparation().prepare(parse_scene(toml, "the study's scene"));
}

std::string grid(std::array<int, 3> size, const char* depth) {
    const auto spacing = [&](std::size_t axis, double extent) { return extent / (size[axis] - 1); }; /* mm */
    return fmt::format("[grid]\nsize = [{}, {}, {}]\norigin = [\"-25 mm\", \"-6 mm\", \"{}\"]\nspacing = [\"{:.6f} "
                       "mm\", \"{:.6f} mm\", \"{:.6f} mm\"]\n",
                       size[0], size[1], size[2], depth, spacing(0, 50), spacing(1, 12), spacing(2, 12));
}

// A ring of quads about the z axis.
PolygonSoup torus(std::uint32_t around, std::uint32_t across, double radius, double thickness) {
    PolygonSoup ring;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double along = 2 * std::numbers::pi * i / around, about = 2 * std::numbers::pi * j / across;
            const double out = radius + thickness * std::cos(about);
            ring.vertices.push_back({out * std::cos(along), out * std::sin(along), thickness * std::sin(about)});
        }
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const std::uint32_t next = (i + 1) % around * across, here = i * across, up = (j + 1) % across;
            for (const std::uint32_t corner : {here + j, next + j, next + up, here + up})
                ring.corners.push_back(corner);
            ring.begins.push_back(static_cast<std::uint32_t>(ring.corners.size()));
        }
    return ring;
}

PreparedCase ring_case(bool quick) {
    constexpr double kRadius = 0.01, kThickness = 0.005; /* m */
    auto mesh = std::make_shared<SceneMesh>();
    PolygonSoup polygons = torus(quick ? 24 : 48, quick ? 12 : 24, kRadius, kThickness);
    mesh->findings = inspect(polygons);
    mesh->mesh = prepare_mesh(std::move(polygons), {}, VertexNormals::plain);
    StructureOptions options;
    options.winding = true; // one of the features
    options.solid = is_solid(mesh->findings);
    mesh->structure = build_structure(mesh->mesh, options);
    PreparedCase made;
    Scene& scene = made.one.scene;
    scene.surface.kind = SurfaceKind::mesh;
    scene.force.shading = Shading::mean_value;
    // Twice as wide as the ring and three times as high.
    const std::uint64_t side = quick ? 40 : 80, layers = quick ? 20 : 40;
    const double spacing = 4 * (kRadius + kThickness) / static_cast<double>(side - 1);
    scene.grid.size = {side, side, layers};
    scene.grid.spacing = {spacing, spacing, 6 * kThickness / static_cast<double>(layers - 1)};
    scene.grid.origin = {-2 * (kRadius + kThickness), -2 * (kRadius + kThickness), -3 * kThickness};
    made.images.mesh = mesh;
    return made;
}

// The same box with fewer samples.
GridSpec thinned(GridSpec grid, std::uint64_t most) {
    while (grid.size[0] * grid.size[1] * grid.size[2] > most) {
        const auto largest = static_cast<std::size_t>(std::ranges::max_element(grid.size) - grid.size.begin());
        const std::uint64_t fewer = (grid.size[largest] + 1) / 2;
        grid.spacing[largest] *= static_cast<double>(grid.size[largest] - 1) / static_cast<double>(fewer - 1);
        grid.size[largest] = fewer;
    }
    return grid;
}

// The winding number is one of the features of a mesh that is switched.
void add_winding(PreparedCase& one) {
    if (!one.images.mesh || one.images.mesh->structure.winding)
        return;
    auto mesh = std::make_shared<SceneMesh>(*one.images.mesh);
    StructureOptions options;
    options.winding = true;
    options.solid = is_solid(mesh->findings);
    mesh->structure = build_structure(mesh->mesh, options);
    one.images.mesh = std::move(mesh);
}

} // namespace

std::vector<BaseScene> own_scenes(bool quick) {
    const std::string shaded_bump = "[surface]\nkind = \"bump\"\nfacets = 3\nradius = \"600 mil\"\n[force]\nshading = "
                                    "\"reference\"\n";
    std::vector<BaseScene> scenes;
    scenes.push_back({"bump", "a bump of three facets and 600 mil radius, shaded, which does not depend on y",
                      prepared(shaded_bump + grid(quick ? std::array{192, 8, 96} : std::array{384, 8, 192}, "-5 mm"))});
    scenes.push_back({"height_map", "a Gaussian bump as a height map, which depends on x and y",
                      prepared("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"5 mm\"\nheight "
                               "= \"1 mm\"\n[force]\nshading = \"height_map\"\n" +
                               grid(quick ? std::array{64, 16, 32} : std::array{128, 32, 64}, "-8 mm"))});
    const PreparedCase ring = ring_case(quick);
    scenes.push_back(
        {"mesh",
         fmt::format("a ring of {} quads, shaded by mean values, in a box twice as wide and three times as high",
                     ring.images.mesh->mesh.polygons.facets()),
         ring});
    scenes.push_back({"strokes", "strokes over the shaded bump, in open loop",
                      prepared(shaded_bump + fmt::format("[paths]\ncount = {}\nsteps = {}\nspeed = {{ mean = \"100 "
                                                         "mm/s\", sd = \"20 mm/s\" }}\n",
                                                         quick ? kQuickPaths : kPaths, quick ? kQuickSteps : kSteps)),
                      false, true});
    return scenes;
}

BaseScene user_scene(const PreparedCase& prepared, bool quick) {
    BaseScene base{"scene", "the scene that was given", prepared};
    Scene& scene = base.prepared.one.scene;
    base.field = scene.field;
    base.given = true;
    base.paths = scene.paths && scene.paths->kind != PathKind::recorded;
    if (!base.field && !base.paths)
        throw UsageError("the study of omissions switches the features of fields and of generated paths, and this "
                         "scene has recorded paths alone: add a [grid], or paths of another kind");
    scene.grid = thinned(scene.grid, quick ? kQuickVoxels : kVoxels);
    if (base.paths) {
        scene.paths->count = std::min(scene.paths->count, quick ? kQuickPaths : kPaths);
        scene.paths->steps = std::min(scene.paths->steps, quick ? kQuickSteps : kSteps);
    }
    add_winding(base.prepared);
    return base;
}

} // namespace forceshade::study
