// The rows of analytic surfaces.
#include <cctype>
#include <cstdlib>

#include "host/output/height_image.h"
#include "tests/gpu/rows.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

using layout::uint;

std::string letters_of(std::string name) {
    for (char& letter : name)
        if (!std::isalnum(static_cast<unsigned char>(letter)))
            letter = '_';
    return name;
}

HeightMapSpec map_spec(MapFunction function) {
    HeightMapSpec map;
    map.function = function;
    map.width = 0.02;
    map.radius = function == MapFunction::gaussian ? 0.008 : 0.03;
    map.height = 0.003;
    if (function == MapFunction::file) {
        map.file = "waves";
        map.size = {0.03, 0.02};
    }
    return map;
}

std::shared_ptr<const HeightImage> waves() {
    auto image = std::make_shared<HeightImage>();
    image->columns = 31;
    image->rows = 17;
    for (std::size_t i = 0; i < image->columns * image->rows; ++i)
        image->samples.push_back(0.5 + 0.5 * std::sin(0.7 * static_cast<double>(i)));
    return image;
}

struct Surface {
    const char* name;
    Scene scene;
    SceneImages images{};
};

// One of every kind and shading.
std::vector<Surface> surfaces() {
    std::vector<Surface> all;
    all.push_back({"facets", bump(kRadii[0], 3)});
    all.push_back({"shaded_facets", bump(kRadii[0], 5, Shading::reference)});
    all.push_back({"many_facets", bump(kRadii[1], 100000, Shading::reference)});
    all.push_back({"normal_depth_radial", bump(kRadii[0], 4, Shading::reference)});
    all.back().scene.force.depth = DepthReading::normal;
    all.back().scene.force.reference = ReferenceDirection::radial;
    all.push_back({"cylinder", cylinder_bump(kRadii[1])});
    all.push_back({"dip", height_map(map_spec(MapFunction::dip))});
    all.push_back({"sine", height_map(map_spec(MapFunction::sine))});
    all.push_back({"textured_gaussian", height_map(map_spec(MapFunction::gaussian))});
    all.back().scene.texture = TextureSpec{30.0, map_spec(MapFunction::sine)};
    all.push_back({"textured_samples", height_map(map_spec(MapFunction::file)), {waves(), waves(), nullptr}});
    all.back().scene.texture = TextureSpec{30.0, map_spec(MapFunction::file)};
    all.push_back({"textured_facets", bump(kRadii[0], 3, Shading::reference)});
    all.back().scene.texture = TextureSpec{30.0, map_spec(MapFunction::gaussian)};
    return all;
}

// A grid that ends 10 mm below the plane and reaches beyond the surface at every side.
GridSpec grid_over(std::array<std::uint64_t, 3> size) {
    GridSpec grid;
    grid.size = size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        grid.spacing[axis] = 0.03 / static_cast<double>(size[axis]);
        grid.origin[axis] = axis == 2 ? -0.02 : -0.0137;
    }
    return grid;
}

MakeGround over(const Surface& surface) {
    return [surface] { return analytic(surface.scene, surface.images); };
}

MakeGround in_all_channels(Scene scene, const SceneImages& images = {}) {
    scene.output.channels = kAllChannels;
    return [=] { return analytic(scene, images); };
}

// A texture, and a force that depends on y where asked: kernels order their rows accordingly.
MakeGround textured(std::array<std::uint64_t, 3> size, bool varies_in_y, uint channels = kAllChannels) {
    Scene scene;
    scene.surface.facets = 5;
    scene.force.shading = Shading::reference;
    scene.output.channels = channels;
    scene.texture.emplace();
    scene.texture->stiffness = 100;
    scene.texture->map.function = varies_in_y ? MapFunction::gaussian : MapFunction::sine;
    scene.grid = grid_over(size);
    return [=] { return analytic(scene); };
}

MakeGround parsed(const std::string& text) {
    return [text] {
        Ground ground;
        ground.prepared.scene = text;
        ground.prepared.one = parse_scene(text, "a row of the table");
        return ground;
    };
}

// Facets begin exactly on samples: 0.5 mm apart, every fourth a vertex.
Row on_samples(const char* name, const char* shading, const char* surface) {
    const std::string text = fmt::format(R"(surface = {{{}}}
force = {{stiffness = "1 N/mm", shading = "{}"}}
grid = {{size = [81, 3, 33], origin = ["-20 mm", "0.3 mm", "-10 mm"], spacing = "0.5 mm"}}
output = {{channels = ["force", "depth", "facet", "proxy", "unshaded"]}}
)",
                                         surface, shading);
    return {.name = name, .ground = parsed(text), .ways = {{}, {.packed = false}}, .referee = true};
}

MakeGround scene_paths(const std::string& kind, const std::string& tremor, const std::string& drive) {
    return parsed(fmt::format(R"(surface = {{kind = "bump", facets = 3}}
force = {{stiffness = "500 N/m", shading = "reference"}}
output = {{channels = ["force", "depth", "facet", "proxy"]}}
[paths]
count = 100
steps = 400
kind = "{}"
{}
{}
)",
                              kind, tremor, drive));
}

PathShape shape_of(uint motion, uint loop) {
    PathShape shape;
    shape.features.motion = motion;
    shape.features.loop = loop;
    shape.features.channels = kAllPathChannels;
    return shape;
}

} // namespace

std::vector<Row> field_rows() {
    std::vector<Row> rows;
    // The paper's study, every voxel; every third case in double precision, too. Chunks that stay in the caches are
    // compared faster.
    const Way cached{.chunk_bytes = std::size_t(4) << 20};
    const Way unpacked{.chunk_bytes = std::size_t(4) << 20, .packed = false};
    const Study study = default_study();
    for (std::size_t i = 0; i < study.cases.size(); ++i)
        rows.push_back({.name = "study_" + letters_of(study.cases[i].name),
                        .ground = in_all_channels(study.cases[i].scene),
                        .ways = i % 5 == 0 ? std::vector{cached, unpacked} : std::vector{cached},
                        .f64 = i % 3 == 0});
    for (Surface& surface : surfaces()) {
        surface.scene.grid = grid_over({37, 9, 23});
        rows.push_back({.name = surface.name,
                        .ground = in_all_channels(surface.scene, surface.images),
                        .ways = {{}, {.chunk_bytes = 20000, .packed = false, .staged = true}},
                        .referee = surface.scene.surface.facets <= 1000}); // the closed forms loop over them
    }
    rows.push_back(on_samples("facets_on_samples", "reference",
                              "kind = 'bump', width = '32 mm', radius = '20 mm', facets = 16, "
                              "facet_spacing = 'equal_x'"));
    rows.push_back(
        on_samples("cylinder_on_samples", "none", "kind = 'cylinder_bump', width = '32 mm', radius = '20 mm'"));
    rows.push_back(on_samples("gaussian_on_samples", "height_map",
                              "kind = 'height_map', function = 'gaussian', radius = '10 mm', height = '5 mm'"));
    for (const bool varies : {false, true}) {
        const char* const order = varies ? "_along_z" : "";
        // Odd shapes, the large before the small: what those left must still be there.
        using Size = std::array<std::uint64_t, 3>;
        for (const Size& size : {Size{320, 9, 120},
                                 {300, 9, 39},
                                 {65, 64, 3},
                                 {64, 16, 17},
                                 {37, 2, 129},
                                 {301, 3, 5},
                                 {3, 300, 7},
                                 {63, 7, 17},
                                 {64, 1, 16},
                                 {1031, 1, 2},
                                 {257, 2, 1},
                                 {9, 5, 3},
                                 {1, 1, 33},
                                 {1, 9, 1},
                                 {7, 1, 1},
                                 {1, 1, 1}})
            rows.push_back({.name = fmt::format("grid_{}{}", fmt::join(size, "_"), order),
                            .ground = textured(size, varies),
                            .ways = {{}, {.packed = false}}});
        // From one row a dispatch to all in one.
        std::vector<Way> chunks, stores;
        for (const std::size_t bytes : {1u, 5000u, 20000u, 77777u, 300000u, 32u << 20})
            chunks.push_back({.chunk_bytes = bytes, .staged = bytes == 20000u});
        for (const bool packed : {false, true})
            for (const bool staged : {false, true})
                for (const std::uint32_t of_rows : {1u, 3u, 1000u})
                    stores.push_back({.chunk_bytes = 60000, .rows = of_rows, .packed = packed, .staged = staged});
        rows.push_back(
            {.name = fmt::format("chunks{}", order), .ground = textured({37, 9, 23}, varies), .ways = chunks});
        rows.push_back(
            {.name = fmt::format("stores{}", order), .ground = textured({45, 11, 13}, varies), .ways = stores});
    }
    // Each set of channels binds other buffers.
    for (uint channels = 1; channels <= kAllChannels; channels += 2)
        rows.push_back({.name = fmt::format("channels_{}", channels),
                        .ground = textured({21, 6, 9}, false, channels),
                        .ways = {{.chunk_bytes = 100000, .packed = false}, {.chunk_bytes = 100000, .staged = true}},
                        .f64 = false});
    return rows;
}

std::vector<Row> path_rows() {
    std::vector<Row> rows;
    const Surface shaded = surfaces()[1];
    for (uint motion = layout::kMotionStrokes; motion <= layout::kMotionRecorded; ++motion)
        for (const uint loop : kLoops) {
            PathShape shape = shape_of(motion, loop);
            shape.features.harmonics = motion == layout::kMotionRecorded ? 0 : motion % 3;
            rows.push_back(
                {.name = name_of(motion, loop), .ground = over(shaded), .shape = shape, .least = {.touching = 1}});
        }
    // As many as a path keeps, and more.
    for (const uint harmonics : {1u, 16u, 17u, 40u}) {
        PathShape shape = shape_of(layout::kMotionRandomWalk, layout::kLoopOpen);
        shape.features.harmonics = harmonics;
        rows.push_back({fmt::format("harmonics_{}", harmonics), over(shaded), shape});
    }
    for (const Surface& surface : surfaces())
        for (const uint loop : kLoops)
            for (const uint follow : {layout::kFollowPlane, layout::kFollowSurface}) {
                PathShape shape = shape_of(layout::kMotionStrokes, loop);
                shape.features.follow = follow;
                rows.push_back(
                    {.name = fmt::format("{}_{}{}", surface.name, kLoopNames[loop], follow ? "_followed" : ""),
                     .ground = over(surface),
                     .shape = shape,
                     .least = {.touching = 1, .rounds = 1}});
            }
    for (unsigned bits = 0; bits < 64; ++bits) {
        PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopClosed);
        shape.seed = bits + 1;
        shape.coulomb = bits & 1 ? 0.1 : 0;
        shape.quantum = bits & 2 ? 3e-5 : 0;
        shape.delay = bits & 4 ? 1 : 0;
        shape.max_force = bits & 8 ? 0.3 : 8.5;
        shape.own_hands = bits & 16;
        shape.coupled = bits & 32;
        rows.push_back({fmt::format("hand_{}", bits), over(shaded), shape});
    }
    // A wall far too stiff for the sampling throws the probe off; it is held where it left its bound.
    for (const double bound : {0.005, 0.1}) {
        Surface stiff = shaded;
        stiff.scene.force.stiffness = 1e6;
        PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopClosed);
        shape.bound = bound;
        shape.max_force = 1e30;
        shape.own_hands = true;
        shape.depth = 3e-3;
        rows.push_back({.name = bound < 0.05 ? "unstable_soon" : "unstable",
                        .ground = over(stiff),
                        .shape = shape,
                        .least = {.unstable = 1}});
    }
    for (const std::size_t paths : {257u, 33u, 31u, 1u})
        for (const std::size_t steps : {67u, 2u, 1u})
            for (const uint motion : {layout::kMotionStrokes, layout::kMotionRecorded})
                for (const uint loop : kLoops) {
                    PathShape shape = shape_of(motion, loop);
                    shape.paths = paths;
                    shape.steps = steps;
                    rows.push_back({.name = fmt::format("{}_{}_by_{}", name_of(motion, loop), paths, steps),
                                    .ground = over(shaded),
                                    .shape = shape,
                                    .f64 = false});
                }
    // Windows and batches of any size give the same paths, through a staging buffer or not.
    std::vector<Way> windows;
    for (const bool staged : {false, true})
        for (const std::uint32_t steps : {0u, 1u, 7u, 60u})
            windows.push_back(
                {.chunk_bytes = 64 << 10, .rows = steps, .staged = staged, .batch = steps == 7 ? 64u : 40u});
    for (const uint motion : {layout::kMotionStrokes, layout::kMotionRecorded})
        for (const uint channels : {kAllPathChannels, layout::kChannelForce, 0u}) {
            PathShape shape = shape_of(motion, layout::kLoopClosed);
            shape.features.channels = channels;
            shape.features.harmonics = motion == layout::kMotionRecorded ? 0 : 2;
            shape.paths = 150;
            shape.steps = 60;
            shape.own_hands = true;
            rows.push_back({.name = fmt::format("windows_{}_{}", kMotionNames[motion], channels),
                            .ground = over(shaded),
                            .shape = shape,
                            .ways = windows,
                            .f64 = false});
        }
    // Long enough to tell what breaks.
    for (const uint loop : kLoops) {
        PathShape shape = shape_of(layout::kMotionStrokes, loop);
        shape.steps = 1000;
        shape.coulomb = 0.1;
        rows.push_back({fmt::format("friction_{}", kLoopNames[loop]), over(surfaces()[0]), shape});
    }
    // A facet's vertex, then its middle: a vertex belongs to the facet at its right, also for a probe from the left.
    PathShape walk = shape_of(layout::kMotionRecorded, layout::kLoopOpen);
    walk.features.channels = layout::kChannelFacet;
    const FieldTables<double> facets = make_tables<double>(surfaces()[0].scene, {}, Extent::what_varies);
    for (std::size_t i = 0; i < 4; ++i) {
        const double here = facets.facet_vertices[i], next = i < 3 ? facets.facet_vertices[i + 1] : 2 - here;
        walk.places.insert(walk.places.end(), {{here, 0, -1e-3}, {(here + next) / 2, 0, -1e-3}});
    }
    rows.push_back({"vertices", over(surfaces()[0]), walk});
    // Those that scenes describe, of every kind.
    for (const std::string kind : {"strokes", "raster", "circle", "spiral", "taps", "random_walk", "minimum_jerk"}) {
        const std::string tremor = kind == "random_walk" ? "" : "tremor = {amplitude = '0.05 mm', frequency = '8 Hz'}";
        for (const uint loop : kLoops)
            rows.push_back(
                {.name = fmt::format("scene_{}_{}", kind, kLoopNames[loop]),
                 .ground = scene_paths(kind, tremor, fmt::format("depth = '1 mm'\nloop = '{}'", kLoopNames[loop])),
                 .least = {.touching = 1},
                 .f64 = false});
    }
    rows.push_back({.name = "scene_press",
                    .ground = scene_paths("strokes", "", "press = '1 N'"),
                    .least = {.touching = 1},
                    .f32 = false});
    return rows;
}

std::vector<Row> long_path_rows() {
    std::vector<Row> rows;
    const std::vector<Surface> all = surfaces();
    for (const std::size_t s : {1u, 4u, 6u, 7u, 8u})
        for (const uint loop : kLoops)
            for (const bool single : {true, false}) {
                PathShape shape = shape_of(layout::kMotionStrokes, loop);
                shape.paths = 1000; // held in memory at once
                shape.steps = single ? 1000 : 300;
                shape.own_hands = true;
                shape.coulomb = 0.05;
                shape.quantum = 3e-5;
                shape.delay = 1;
                rows.push_back({.name = fmt::format("{}_{}_f{}", all[s].name, kLoopNames[loop], single ? 32 : 64),
                                .ground = over(all[s]),
                                .shape = shape,
                                .least = {.touching = shape.paths * shape.steps / 10},
                                .f32 = single,
                                .f64 = !single,
                                .slices = std::getenv("FORCESHADE_LONG") ? 10u : 2u});
            }
    return rows;
}

} // namespace forceshade::test
