// The switched features, and their scenes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/random.h"
#include "host/study/omission/omission.h"

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
            ring.end_facet();
        }
    return ring;
}

PreparedCase ring_case(bool quick) {
    constexpr double kRadius = 0.01, kThickness = 0.005; /* m */
    PreparedCase made;
    // The winding number is one of the features of a mesh that is switched.
    made.images.mesh = made_mesh(torus(quick ? 24 : 48, quick ? 12 : 24, kRadius, kThickness), true);
    Scene& scene = made.one.scene;
    scene.surface.kind = SurfaceKind::mesh;
    scene.force.shading = Shading::mean_value;
    // Twice as wide as the ring and three times as high.
    const std::uint64_t side = quick ? 40 : 80, layers = quick ? 20 : 40;
    const double spacing = 4 * (kRadius + kThickness) / static_cast<double>(side - 1);
    scene.grid.size = {side, side, layers};
    scene.grid.spacing = {spacing, spacing, 6 * kThickness / static_cast<double>(layers - 1)};
    scene.grid.origin = {-2 * (kRadius + kThickness), -2 * (kRadius + kThickness), -3 * kThickness};
    return made;
}

// About the vertical, and tilted a little, its middle staying where it is.
Turned turned(const SceneMesh& mesh) {
    constexpr std::size_t kMostTriangles = 20000;
    constexpr unsigned kTurns = 8;
    constexpr double kTilt = 5 * std::numbers::pi / 180; // rad
    Turned all;
    Random random(0, "orientations of the study of omissions");
    const MeshBox box = bounding_box(mesh.mesh.polygons);
    const glm::dvec3 middle = 0.5 * (box.low + box.high);
    PolygonSoup about_middle = mesh.mesh.polygons;
    for (glm::dvec3& vertex : about_middle.vertices)
        vertex -= middle;
    for (unsigned i = 0; i < kTurns && mesh.structure.triangles() <= kMostTriangles; ++i) {
        const auto symmetric = [&](double most) { return (2 * random.uniform() - 1) * most; };
        const std::array<double, 3> angles{symmetric(kTilt), symmetric(kTilt), symmetric(std::numbers::pi)};
        const std::shared_ptr<SceneMesh> one =
            made_mesh(about_middle, true, {.rotate = angles, .translate = {middle.x, middle.y, middle.z}});
        one->inside = mesh.inside;
        all.push_back(one);
    }
    return all;
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

constexpr std::uint32_t kDepth = layout::kChannelDepth, kFacet = layout::kChannelFacet;
constexpr std::uint32_t kProxy = layout::kChannelProxy, kUnshaded = layout::kChannelUnshaded;
constexpr std::uint32_t kOptional = kDepth | kFacet | kProxy | kUnshaded;

Scene& scene_of(Setup& setup) {
    return setup.prepared.one.scene;
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
         ring, true, false, turned(*ring.images.mesh)});
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
    base.paths = scene.paths && scene.paths->kind != PathKind::recorded;
    if (!base.field && !base.paths)
        throw UsageError("the study of omissions switches the features of fields and of generated paths, and this "
                         "scene has recorded paths alone: add a [grid], or paths of another kind");
    scene.grid = thinned(scene.grid, quick ? kQuickVoxels : kVoxels);
    if (base.paths) {
        scene.paths->count = std::min(scene.paths->count, quick ? kQuickPaths : kPaths);
        scene.paths->steps = std::min(scene.paths->steps, quick ? kQuickSteps : kSteps);
    }
    if (const auto& mesh = base.prepared.images.mesh; mesh && !mesh->structure.winding) {
        const auto with_winding = std::make_shared<SceneMesh>(*mesh);
        with_winding->structure.winding = make_winding(with_winding->structure);
        base.prepared.images.mesh = with_winding;
    }
    if (base.prepared.images.mesh)
        base.turned = turned(*base.prepared.images.mesh);
    return base;
}

bool agrees_with_manifest(const Comparison& comparison) {
    const auto is_listed = [&](const Setup& setup) {
        const std::vector<std::string> omitted = omissions(setup.prepared.one.scene);
        return std::ranges::find(omitted, comparison.omitted) != omitted.end();
    };
    if (comparison.omitted.empty())
        return true;
    return is_listed(comparison.without) && (comparison.always || !is_listed(comparison.with));
}

std::vector<Comparison> comparisons_of(const BaseScene& base, bool gpu) {
    const Scene& scene = base.prepared.one.scene;
    std::vector<Comparison> all;
    bool paths = false;
    // Both sides are the scene as it stands, until one is changed.
    const auto add = [&](const std::string& feature, const char* with, const char* without, std::uint32_t channels,
                         const std::string& omitted = {}) -> Comparison& {
        Comparison& one = all.emplace_back(Comparison{.feature = feature,
                                                      .scene = base.name,
                                                      .with = {base.prepared, with},
                                                      .without = {base.prepared, without},
                                                      .channels = channels,
                                                      .omitted = omitted,
                                                      .paths = paths});
        one.with.turned = one.without.turned = base.turned;
        scene_of(one.with).field = scene_of(one.without).field = !paths;
        return one;
    };
    const auto add_channel = [&](const std::string& name, std::uint32_t channel) {
        const std::string feature = name + " channel";
        Comparison& one = add(feature, "written", "not written", scene.output.channels & ~channel & kOptional, feature);
        scene_of(one.with).output.channels |= channel;
        scene_of(one.without).output.channels &= ~channel;
    };
    // Features of both fields and paths.
    const auto add_common = [&] {
        add(kControl, "the scene", "the scene", scene.output.channels);
        if (!scene.texture) {
            Comparison& one =
                add("texture of height 0", "a sine of height 0", "none", kDepth | kFacet | kProxy, "texture");
            TextureSpec& texture = scene_of(one.with).texture.emplace();
            texture.stiffness = scene.force.stiffness / 5;
            texture.map.function = MapFunction::sine;
            texture.map.width = 1e-3;
            texture.map.height = 0;
            one.same = Same::values;
        }
        add_channel("depth", kDepth);
        add_channel("facet", kFacet);
        add_channel("proxy", kProxy);
    };
    if (base.field) {
        add_common();
        add_channel("unshaded", kUnshaded);
        layout::Features features = features_of(scene);
        features.channels &= ~kProxy;
        if (const std::uint64_t samples = scene.grid.size[1]; samples > 1 && !depends_on_y(features)) {
            Comparison& one = add("every y", "all y samples", "one for all", kDepth | kFacet | kUnshaded,
                                  fmt::format("{} of {} y samples, alike", samples - 1, samples));
            for (Setup* setup : {&one.with, &one.without})
                scene_of(*setup).output.channels &= ~kProxy;
            one.with.extent = Extent::everything;
            one.always = true;
        }
        const bool mesh = scene.surface.kind == SurfaceKind::mesh;
        // For a mesh that is not a solid the winding number defines another inside: another law.
        if (mesh && is_solid(base.prepared.images.mesh->findings)) {
            Comparison& one = add("winding number", "winding", "pseudonormal", kOptional, "winding number");
            scene_of(one.with).surface.mesh.inside = InsideTest::winding;
            scene_of(one.without).surface.mesh.inside = InsideTest::pseudonormal;
        }
        if (mesh && gpu) {
            Comparison& one = add("free space", "every block visited", "skipped", kOptional, kFreeSpace);
            one.with.free = FreeSpace::visited;
            one.always = true;
        }
    }
    paths = true;
    if (base.paths) {
        Comparison& samples = add(base.field ? "path samples" : "samples", "written", "metrics alone", 0);
        samples.without.samples = false;
        samples.same = Same::metrics;
        if (!base.field)
            add_common();
    }
    // A proxy depends on y: so that it is switched alone, both sides are evaluated at every y.
    const auto varies = [](Setup& setup) { return depends_on_y(features_of(scene_of(setup))); };
    for (Comparison& one : all)
        if (!one.always && varies(one.with) != varies(one.without))
            one.with.extent = one.without.extent = Extent::everything;
    return all;
}

} // namespace forceshade::study
