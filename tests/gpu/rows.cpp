#include "tests/gpu/rows.h"

#include <cctype>
#include <cstdlib>
#include <numbers>

#include "host/mesh/mesh_file.h"
#include "host/output/height_image.h"
#include "host/paths/scene_paths.h"
#include "host/reference/mesh_field.h"
#include "tests/mesh/damage.h"
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

// Analytic surfaces.

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

constexpr uint kLoops[] = {layout::kLoopOpen, layout::kLoopClosed};
constexpr const char* kLoopNames[] = {"open", "closed"};
constexpr const char* kMotionNames[] = {"strokes", "raster",      "circle",       "spiral",
                                        "taps",    "random_walk", "minimum_jerk", "recorded"};

std::string name_of(uint motion, uint loop) {
    return fmt::format("{}_{}", kMotionNames[motion], kLoopNames[loop]);
}

// Meshes.

using MakeSoup = std::function<PolygonSoup()>;

MakeSoup shared(const PolygonSoup& polygons) {
    return [kept = std::make_shared<const PolygonSoup>(polygons)] { return *kept; };
}

MakeGround on_mesh(const MakeSoup& soup, Shading shading = Shading::none, const Maps& maps = {}) {
    return [=] { return mesh_of(soup(), shading, maps); };
}

struct Shape {
    const char* name;
    MakeSoup soup;
    bool triangles = true;
};

template <unsigned levels> PolygonSoup sphere() {
    return shapes::icosphere(levels);
}

std::vector<Shape> shapes_of_all_kinds() {
    std::mt19937 random(3);
    PolygonSoup open = shapes::icosphere(2);
    open.begins.resize(open.begins.size() - 100);
    open.corners.resize(open.begins.back());
    const PolygonSoup damaged =
        shapes::damaged(shapes::icosphere(2), {.caps = 60, .needles = 20, .repeats = 20, .strays = 3}, random);
    return {{"icosphere", sphere<2>},
            {"cube_of_quads", [] { return shapes::cube(false); }, false},
            {"random_polyhedra", [] { return shapes::random_polyhedra(30, 5); }},
            {"single_triangle", shapes::single_triangle},
            {"needle_fan", [] { return shapes::needle_fan(200, 0.5); }, false},
            {"sliver_box", [] { return shapes::sliver_box(30, 1e6); }},
            {"plate", [] { return shapes::plate(1e-5); }},
            {"shells", [] { return shapes::nested_shells(2, false); }},
            {"cavity", [] { return shapes::nested_shells(2, true); }},
            {"hexagons",
             [] { return shapes::patch(shapes::Cells::hexagons, 8, [](double x, double y) { return x * x - y * y; }); },
             false},
            {"open_sphere", shared(open)},
            {"wall_between_cubes",
             [] {
                 return shapes::merged(shapes::cube(true), shapes::moved(shapes::cube(true), glm::dvec3(1), {2, 0, 0}));
             }},
            {"damaged", shared(damaged)}};
}

struct MeshShading {
    const char* name;
    Shading is;
};
constexpr MeshShading kMeshShadings[] = {{"unshaded", Shading::none},
                                         {"morgenbesser", Shading::morgenbesser},
                                         {"barycentric", Shading::barycentric},
                                         {"mean_value", Shading::mean_value},
                                         {"two_pass", Shading::two_pass}};

PolygonSoup spot() {
    return read_polygons(FORCESHADE_DATA "/spot.obj").polygons;
}

// A sphere of 25 mm whose top is the origin.
template <unsigned levels> PolygonSoup ball() {
    return shapes::moved(shapes::icosphere(levels), glm::dvec3(0.025), glm::dvec3(0, 0, -0.025));
}

PolygonSoup far_away(unsigned levels, double radius) {
    return shapes::moved(shapes::icosphere(levels), glm::dvec3(radius), glm::dvec3(566321.25, -5933204.5, 12.25));
}

// A dented sphere for edges, tetrahedra twice for ties (turned over, or they would count once), on samples that are not
// symmetric to them.
PolygonSoup dented_and_twice() {
    const PolygonSoup some = shapes::random_polyhedra(20, 7);
    PolygonSoup over = some;
    std::reverse(over.corners.begin(), over.corners.end());
    return shapes::merged(shapes::nested_shells(1, true), shapes::merged(some, over));
}

PolygonSoup wavy_disc(std::uint32_t corners) {
    PolygonSoup disc;
    disc.begins = {0, corners};
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        disc.vertices.push_back(0.01 * glm::dvec3(std::cos(angle), std::sin(angle), 0.02 * std::cos(2 * angle)));
        disc.corners.push_back(i);
    }
    return disc;
}

PolygonSoup sheet() {
    PolygonSoup sheet;
    sheet.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    sheet.corners = {0, 1, 2};
    sheet.begins = {0, 3};
    return sheet;
}

template <typename T> layout::MapParams<T> mesh_map(T side) {
    layout::MapParams<T> params{};
    params.half_width = params.half_length = T(0.7) * side;
    params.radius = side;
    params.slope = T(0.6);
    params.inverse_length = T(4) / side;
    params.columns = 5;
    params.rows = 4;
    params.nodes_per_x = T(4) / (params.half_width + params.half_width);
    params.nodes_per_y = T(3) / (params.half_length + params.half_length);
    return params;
}

template <typename T> void add_maps(FieldTables<T>& tables, const Maps& maps) {
    tables.features.map = maps.map;
    tables.features.texture = maps.texture;
    MeshTables<T> mesh = *tables.mesh;
    if (maps.map_x)
        mesh.params.map_x = T(*maps.map_x);
    tables.params.map = tables.params.texture = mesh_map(mesh.params.scale);
    tables.params.texture_stiffness = T(300);
    for (int i = 0; i < 40; ++i) {
        tables.map_gradients.push_back(T(i * 7 % 11) / T(11) - T(0.5));
        tables.texture_gradients.push_back(T(i * 5 % 13) / T(13) - T(0.5));
    }
    tables.mesh = std::make_shared<const MeshTables<T>>(std::move(mesh));
}

PathShape mesh_shape(uint motion, uint loop, std::size_t paths = 64, std::size_t steps = 200) {
    PathShape shape = shape_of(motion, loop);
    shape.features.harmonics = motion == layout::kMotionRandomWalk ? 6 : 1;
    shape.paths = paths;
    shape.steps = steps;
    return shape;
}

PathShape wandering(std::size_t paths, std::size_t steps, std::optional<glm::dvec3> focus = {}) {
    PathShape shape = mesh_shape(layout::kMotionRecorded, layout::kLoopOpen, paths, steps);
    shape.probes = Probes::wandering;
    shape.focus = focus;
    return shape;
}

// Runs of a kernel.

// Becomes what a kernel takes.
struct AnyOptions {
    Way way;
    template <typename Options> operator Options() const;
};

template <typename Options> AnyOptions::operator Options() const {
    Options options;
    const auto set = [](auto& option, auto value) {
        if (value)
            option = value;
    };
    set(options.chunk_bytes, way.chunk_bytes);
    if constexpr (requires { options.software_chunk_bytes; })
        set(options.software_chunk_bytes, way.chunk_bytes);
    if constexpr (requires { options.rows; })
        set(options.rows, way.rows);
    if constexpr (requires { options.steps; })
        set(options.steps, way.rows);
    if constexpr (requires { options.packed_stores; })
        options.packed_stores = way.packed;
    if constexpr (requires { options.force_staging; })
        options.force_staging = way.staged;
    if constexpr (requires { options.slab_voxels; })
        set(options.slab_voxels, way.batch);
    if constexpr (requires { options.batch_paths; })
        set(options.batch_paths, way.batch);
    if constexpr (requires { options.limit; }) {
        set(options.pause, way.pause);
        set(options.limit, way.limit);
    }
    return options;
}

} // namespace

Ground analytic(const Scene& scene, const SceneImages& images) {
    Ground ground;
    ground.prepared.one.scene = scene;
    ground.prepared.images = images;
    return ground;
}

Ground mesh_of(const PolygonSoup& polygons, Shading shading, const Maps& maps) {
    StructureOptions options;
    options.winding = maps.inside == InsideTest::winding;
    auto mesh = std::make_shared<SceneMesh>();
    mesh->mesh = shapes::mesh_of(polygons);
    mesh->structure = build_structure(mesh->mesh, options);
    mesh->inside = maps.inside;
    Ground ground;
    ground.maps = maps;
    ground.prepared.images.mesh = mesh;
    Scene& scene = ground.prepared.one.scene;
    scene.surface.kind = SurfaceKind::mesh;
    scene.surface.mesh.inside = maps.inside;
    scene.force.shading = shading;
    scene.output.channels = kAllChannels;
    scene.field = false;
    return ground;
}

template <typename T> FieldTables<T> tables_of(const Ground& ground, const MeshGrid& grid) {
    const Extent extent = ground.prepared.images.mesh ? Extent::nothing : Extent::everything; // the row gives a mesh's
    FieldTables<T> tables = make_tables<T>(ground.prepared.one.scene, ground.prepared.images, extent);
    if (!tables.mesh)
        return tables;
    std::vector<T>* const axes[] = {&tables.x, &tables.y, &tables.z};
    for (int i = 0; i < 3; ++i) {
        const std::size_t count = grid.size[static_cast<std::size_t>(i)];
        const double step = count > 1 ? (grid.to[i] - grid.from[i]) / static_cast<double>(count - 1) : 0;
        axes[i]->clear();
        for (std::size_t k = 0; k < count; ++k)
            axes[i]->push_back(static_cast<T>(grid.from[i] + step * static_cast<double>(k)));
    }
    if (ground.maps.map != layout::kMapNone || ground.maps.texture != layout::kMapNone)
        add_maps(tables, ground.maps);
    return tables;
}
template FieldTables<float> tables_of<float>(const Ground&, const MeshGrid&);
template FieldTables<double> tables_of<double>(const Ground&, const MeshGrid&);

// The channels of paths on meshes stand one behind the other in a buffer.
template <typename Kernel>
Kernels::Kept<Kernel>::Kept(compute::Device& device, const Way& way)
    : kernel(device, AnyOptions{way}), sentinels(std::is_same_v<Kernel, compute::MeshPathKernel>) {}

template <typename Kernel> Kernels::Kept<Kernel>& Kernels::kept(const Way& way) {
    auto& all = std::get<std::map<Way, Kept<Kernel>>>(kept_);
    if (const auto found = all.find(way); found != all.end())
        return found->second;
    return all.try_emplace(way, device_, way).first->second;
}

template <typename T> Held Kernels::field(const Way& way, const FieldTables<T>& tables) {
    auto& [kernel, sentinels] = kept<compute::FieldKernel>(way);
    const layout::FieldInput<T> input = tables.input();
    HeldField<T> held(input, &sentinels);
    kernel.template evaluate<T>(input, [&](const layout::FieldChunk<T>& chunk) { held.add(chunk); });
    return held.result();
}

// The kernel and the CPU engine, told by the planner.
template <typename T> Held Kernels::mesh_field(const Way& way, const FieldTables<T>& tables, FreeSpace free) {
    auto& [kernel, sentinels] = kept<compute::MeshKernel>(way);
    const layout::FieldInput<T> input = tables.input();
    const BlockPlanner<T> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 0, free);
    BlockPlan plan;
    const auto layers = [&](std::size_t z_first, std::size_t z_count) {
        plan = planner.plan(z_first, z_count);
        return plan.view();
    };
    HeldField<T> held(input, &sentinels);
    kernel.template evaluate<T>(
        input, [&](const layout::FieldChunk<T>& chunk) { held.add(chunk); }, layers);
    // On the CPU in chunks of many layers, or of few rows of one.
    HeldField<T> on_cpu(input);
    const std::size_t chunk_bytes = std::size_t(1) << (sizeof(T) == sizeof(float) ? 25 : 13);
    if (way == Way{})
        reference::evaluate_mesh_field<T>(input, {.threads = 2, .chunk_bytes = chunk_bytes}, layers,
                                          [&](const layout::FieldChunk<T>& chunk) { on_cpu.add(chunk); });
    EXPECT_TRUE(way != Way{} || is_equal(on_cpu.result())) << "on the CPU";
    return held.result();
}

template <typename T, typename Length>
Held Kernels::paths(const Way& way, const layout::PathInput<T>& input, const Length& length) {
    const auto hold = [&](Sentinels& sentinels, const auto& explore) {
        HeldPaths<T> held(input, sentinels);
        explore([&](const layout::PathChunk<T>& chunk) { held.add(chunk, length); },
                [&](std::size_t first, std::span<const layout::PathMetrics<T>> some) { held.add(first, some); });
        return held.result();
    };
    if (input.law.features.surface != layout::kSurfaceMesh) {
        auto& [kernel, sentinels] = kept<compute::PathKernel>(way);
        return hold(sentinels, [&, &on = kernel](const auto& take, const auto& metrics) {
            on.template explore<T>(input, take, metrics);
        });
    }
    auto& [kernel, sentinels] = kept<compute::MeshPathKernel>(way);
    std::uint64_t updates = 0;
    const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> some) {
        updates += some.size();
        reference::finish_updates(input.law.mesh, some, 2);
    };
    Held held = hold(sentinels, [&, &on = kernel](const auto& take, const auto& metrics) {
        on.template explore<T>(input, finish, take, metrics);
    });
    held.host_updates = updates;
    return held;
}

template <typename T> std::vector<Held> Kernels::hold(const Row& row) {
    const Ground ground = row.ground();
    const FieldTables<T> tables = tables_of<T>(ground, row.grid);
    std::vector<Held> all;
    for (const Way& way : row.ways) {
        if (ground.prepared.one.scene.paths) {
            ScenePaths<T> paths(ground.prepared);
            const layout::PathInput<T> input = paths.input();
            all.push_back(this->paths(way, input, [&](std::size_t) { return input.steps; }));
        } else if (row.shape) {
            PathShape shape = *row.shape;
            for (std::uint64_t slice = 0; slice < row.slices; ++slice, ++shape.seed) {
                PathCase<T> one(tables, ground.mesh(), shape);
                all.push_back(paths(way, one.input(), [&](std::size_t path) { return one.length(path); }));
            }
        } else {
            all.push_back(ground.mesh() ? mesh_field(way, tables, row.free) : field(way, tables));
        }
    }
    return all;
}
template std::vector<Held> Kernels::hold<float>(const Row&);
template std::vector<Held> Kernels::hold<double>(const Row&);

// The table.

std::vector<Row> field_rows() {
    std::vector<Row> rows;
    // The paper's study, every voxel. Chunks that stay in the caches are compared faster.
    const Way cached{.chunk_bytes = std::size_t(4) << 20};
    const Way unpacked{.chunk_bytes = std::size_t(4) << 20, .packed = false};
    const Study study = default_study();
    for (std::size_t i = 0; i < study.cases.size(); ++i)
        rows.push_back({.name = "study_" + letters_of(study.cases[i].name),
                        .ground = in_all_channels(study.cases[i].scene),
                        .ways = i % 5 == 0 ? std::vector{cached, unpacked} : std::vector{cached}});
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

std::vector<Row> mesh_field_rows() {
    std::vector<Row> rows;
    // Grids about the mesh's frame: odd, cutting it, inside it, beside it, of single samples.
    const MeshGrid grids[] = {{},
                              {{17, 5, 31}, {-0.3, -0.2, -1.3}, {0.9, 0.1, 0.4}},
                              {{9, 8, 7}, {-0.1, -0.12, -0.09}, {0.11, 0.1, 0.1}},
                              {{12, 11, 10}, {2, 2, 2}, {4, 5, 6}},
                              {{1, 1, 1}, {0.01, 0.02, -0.03}, {0.01, 0.02, -0.03}},
                              {{1, 40, 1}, {0.01, -1.1, 0.2}, {0.01, 1.1, 0.2}},
                              {{70, 1, 3}, {-1.1, 0.1, 0.2}, {1.1, 0.1, 0.3}}};
    for (const Shape& shape : shapes_of_all_kinds()) {
        for (std::size_t g = 0; g < std::size(grids); ++g)
            rows.push_back({fmt::format("{}_grid_{}", shape.name, g), on_mesh(shape.soup), {}, grids[g]});
        for (const MeshShading& shading : kMeshShadings)
            if (shape.triangles || shading.is != Shading::barycentric)
                rows.push_back({fmt::format("{}_{}", shape.name, shading.name), on_mesh(shape.soup, shading.is)});
        for (const MeshShading& shading : {kMeshShadings[0], kMeshShadings[3]})
            rows.push_back({fmt::format("{}_{}_winding", shape.name, shading.name),
                            on_mesh(shape.soup, shading.is, {.inside = InsideTest::winding})});
    }
    for (const InsideTest inside : {InsideTest::pseudonormal, InsideTest::winding})
        rows.push_back({.name = inside == InsideTest::winding ? "free_space_winding" : "free_space",
                        .ground = on_mesh(sphere<2>, Shading::mean_value, {.inside = inside}),
                        .grid = {{21, 22, 23}, glm::dvec3(-1.6), glm::dvec3(1.6)},
                        .f64 = false,
                        .free = FreeSpace::visited});
    // Places are measured from the scene's origin, height maps are read in the world.
    rows.push_back({.name = "far",
                    .ground = on_mesh([] { return far_away(2, 1); }, Shading::mean_value,
                                      {.texture = layout::kMapSine, .map_x = 0.37}),
                    .grid = grids[1]});
    const uint maps[] = {layout::kMapNone, layout::kMapCylinder, layout::kMapDip,
                         layout::kMapSine, layout::kMapGaussian, layout::kMapSamples};
    for (std::size_t m = 0; m < std::size(maps); ++m)
        for (const std::size_t s : {0u, 3u, 4u})
            rows.push_back({fmt::format("relief_{}_{}", m, kMeshShadings[s].name),
                            on_mesh(sphere<3>, kMeshShadings[s].is,
                                    {.map = maps[m], .texture = maps[(m + 1 + s % 2) % std::size(maps)]})});
    // Chunks of single rows of blocks, slabs of single layers, and results that travel through staging buffers.
    std::vector<Way> chunks{{}};
    for (const std::size_t bytes : {1u, 40000u, 500000u})
        for (const bool staged : {false, true})
            chunks.push_back({.chunk_bytes = bytes, .staged = staged, .batch = 5000});
    rows.push_back({.name = "chunks",
                    .ground = on_mesh([] { return shapes::random_polyhedra(40, 3); }, Shading::mean_value),
                    .grid = {{37, 35, 33}},
                    .ways = chunks,
                    .f64 = false});
    const MeshGrid fine{{128, 128, 128}};
    rows.push_back({"spot_at_128", on_mesh(spot, Shading::barycentric), {}, fine});
    rows.push_back({"icosphere_of_20480_at_128", on_mesh(sphere<5>, Shading::mean_value), {}, fine});
    rows.push_back({"polyhedra_at_128",
                    on_mesh([] { return shapes::random_polyhedra(200, 1996); }, Shading::morgenbesser),
                    {},
                    fine});
    // Every triangle is about as near to the centre as any other: more than a list may hold.
    rows.push_back({"centre", on_mesh(sphere<5>), {}, {{24, 23, 22}, glm::dvec3(-0.02), glm::dvec3(0.02)}});
    rows.push_back({"very_centre", on_mesh(sphere<4>), {}, {{3, 3, 3}, glm::dvec3(-1e-12), glm::dvec3(1e-12)}});
    // Where single precision hardly tells one triangle from another, and where squares overflow.
    for (const int power : {3, 6, 12, 18}) {
        const glm::dvec3 reach(std::pow(10.0, power));
        rows.push_back({fmt::format("far_off_{}", power), on_mesh(sphere<2>), {}, {{9, 9, 9}, -reach, reach}});
    }
    for (const std::size_t s : {1u, 3u, 4u})
        rows.push_back({fmt::format("corners_65537_{}", kMeshShadings[s].name),
                        on_mesh([] { return shapes::many_gon_prism(65537); }, kMeshShadings[s].is),
                        {},
                        {{6, 5, 4}, glm::dvec3(-0.9), glm::dvec3(0.9)}});
    rows.push_back({"ties",
                    on_mesh(dented_and_twice, Shading::mean_value),
                    {},
                    {{33, 34, 35}, glm::dvec3(-1.03), glm::dvec3(1.05)}});
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
    for (unsigned bits = 0; bits < 32; ++bits) {
        PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopClosed);
        shape.seed = bits + 1;
        shape.coulomb = bits & 1 ? 0.1 : 0;
        shape.quantum = bits & 2 ? 3e-5 : 0;
        shape.delay = bits & 4 ? 1 : 0;
        shape.max_force = bits & 8 ? 0.3 : 8.5;
        shape.own_hands = bits & 16;
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
        for (const std::uint32_t steps : {0u, 1u, 7u, 200u})
            windows.push_back(
                {.chunk_bytes = 64 << 10, .rows = steps, .staged = staged, .batch = steps == 7 ? 64u : 40u});
    for (const uint motion : {layout::kMotionStrokes, layout::kMotionRecorded})
        for (const uint channels : {kAllPathChannels, layout::kChannelForce, 0u}) {
            PathShape shape = shape_of(motion, layout::kLoopClosed);
            shape.features.channels = channels;
            shape.features.harmonics = motion == layout::kMotionRecorded ? 0 : 2;
            shape.paths = 150;
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

std::vector<Row> mesh_path_rows() {
    std::vector<Row> rows;
    for (uint motion = layout::kMotionStrokes; motion <= layout::kMotionRecorded; ++motion)
        for (const uint loop : kLoops) {
            PathShape shape = mesh_shape(motion, loop, 40, 150);
            shape.seed = motion + 1;
            shape.reach = 0.004;
            shape.delay = motion % 2;
            shape.own_hands = motion % 3 == 0;
            shape.coulomb = motion % 2 ? 0.01 : 0;
            shape.quantum = motion % 4 ? 0 : 1e-5;
            rows.push_back({.name = name_of(motion, loop),
                            .ground = on_mesh(ball<4>),
                            .shape = shape,
                            .least = {.touching = 1},
                            .f64 = motion == layout::kMotionCircle && loop == layout::kLoopClosed});
        }
    // Over every terrain; in pits a triangle left too early leads elsewhere.
    for (const auto& terrains : {walks::terrains(), walks::pits()})
        for (const walks::Terrain& terrain : terrains)
            rows.push_back({"wandering_" + letters_of(terrain.name),
                            on_mesh(shared(terrain.polygons), Shading::barycentric),
                            wandering(24, 100, terrain.focus)});
    constexpr std::size_t kSlice = 5000; // paths held in memory at once
    PathShape aimed = mesh_shape(layout::kMotionRecorded, layout::kLoopOpen, kSlice, walks::Aimer::kSteps);
    aimed.probes = Probes::aimed;
    for (const auto& terrains : {walks::solids(), walks::meshes({FORCESHADE_DATA "/spot.obj"})})
        for (const walks::Terrain& terrain : terrains)
            rows.push_back({.name = "aimed_" + letters_of(terrain.name),
                            .ground = on_mesh(shared(terrain.polygons)),
                            .shape = aimed,
                            .least = {.touching = kSlice / 4},
                            .slices = (std::getenv("FORCESHADE_LONG") ? 1000000 : 10000) / kSlice});
    // Through a model of edges that fold either way: the host finishes many updates, and the kernel goes on from them.
    PathShape through = mesh_shape(layout::kMotionStrokes, layout::kLoopOpen, 400, 150);
    through.reach = 0.4;
    through.depth = 0.3;
    through.seed = 3;
    rows.push_back({.name = "through_spot",
                    .ground = on_mesh(spot),
                    .shape = through,
                    .least = {.host_updates = 400, .most_host_updates = 400 * 150 / 2}});
    // What takes more loops than an invocation may run goes to the host, on the way to edges too.
    rows.push_back({.name = "few_loops_on_spot",
                    .ground = on_mesh(spot),
                    .shape = wandering(24, 200),
                    .ways = {{.limit = 300}},
                    .least = {.host_updates = 10}});
    rows.push_back({.name = "few_loops_in_folds",
                    .ground = on_mesh([] { return walks::pit(24, 0.3); }),
                    .shape = wandering(24, 200, glm::dvec3(0, 0, -0.3)),
                    .ways = {{.limit = 300}},
                    .least = {.host_updates = 10}});
    rows.push_back({.name = "fewest_loops",
                    .ground = on_mesh(ball<4>),
                    .shape = wandering(24, 60),
                    .ways = {{.limit = 6}},
                    .least = {.host_updates = 200},
                    .f64 = false});
    const Maps none{}, both{.map = layout::kMapSine, .texture = layout::kMapGaussian};
    for (const MeshShading& shading : kMeshShadings)
        for (const bool maps : {false, true})
            rows.push_back({.name = fmt::format("{}{}", shading.name, maps ? "_with_maps" : ""),
                            .ground = on_mesh(spot, shading.is, maps ? both : none),
                            .shape = wandering(48, 80),
                            .least = {.touching = 400},
                            .f64 = false});
    // Places are measured from the scene's origin, height maps are read in the world.
    rows.push_back({.name = "far",
                    .ground = on_mesh([] { return far_away(3, 0.025); }, Shading::none,
                                      {.map = layout::kMapGaussian, .texture = layout::kMapSine, .map_x = 0.0123}),
                    .shape = wandering(48, 80),
                    .least = {.touching = 400}});
    for (const PathShape& shape : {wandering(40, 50), mesh_shape(layout::kMotionStrokes, layout::kLoopOpen, 40, 50)})
        rows.push_back({.name = fmt::format("pieces_{}", kMotionNames[shape.features.motion]),
                        .ground = on_mesh(ball<3>),
                        .shape = shape,
                        .ways = {{.chunk_bytes = 17 * 60 * 7, .batch = 17, .pause = 20}},
                        .f64 = false});
    PathShape small = mesh_shape(layout::kMotionStrokes, layout::kLoopOpen, 8, 20);
    small.reach = 0.004;
    for (const MeshShading& shading : {kMeshShadings[3], kMeshShadings[4]})
        rows.push_back({.name = fmt::format("corners_70000_{}", shading.name),
                        .ground = on_mesh([] { return wavy_disc(70000); }, shading.is),
                        .shape = small,
                        .least = {.touching = 100},
                        .f64 = false});
    PathShape alone = mesh_shape(layout::kMotionStrokes, layout::kLoopClosed);
    alone.features.channels = 0;
    rows.push_back({.name = "metrics_alone", .ground = on_mesh(ball<3>), .shape = alone, .f64 = false});
    // Round the rim of an open sheet, which it presses from behind.
    PathShape round = mesh_shape(layout::kMotionRecorded, layout::kLoopOpen);
    round.places = {{3, 0, 1}, {3, 0, -1}, {0, 0, -0.5}, {0.1, 0, 0.25}};
    rows.push_back({.name = "from_behind", .ground = on_mesh(sheet), .shape = round, .least = {.touching = 1}});
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
                                .slices = 10});
            }
    return rows;
}

// Over a mesh of 81 920 triangles, and wandering over another with edges and folds.
std::vector<Row> long_mesh_path_rows() {
    std::vector<Row> rows;
    const uint motions[] = {layout::kMotionStrokes, layout::kMotionCircle, layout::kMotionRandomWalk};
    for (std::size_t slice = 0; slice < 10; ++slice) {
        PathShape shape = mesh_shape(motions[slice % 3], kLoops[slice % 2], 1000, 1000);
        shape.seed = slice + 1;
        shape.reach = 0.004;
        shape.own_hands = true;
        shape.coulomb = 0.01;
        shape.delay = 1;
        rows.push_back({fmt::format("sphere_{}", slice), on_mesh(ball<6>, Shading::barycentric), shape});
    }
    rows.push_back({.name = "spot",
                    .ground = on_mesh(spot, Shading::barycentric),
                    .shape = wandering(1000, 500),
                    .least = {.touching = 10000},
                    .slices = 2});
    return rows;
}

} // namespace forceshade::test
