// The rows of meshes.
#include <numbers>

#include "tests/gpu/rows.h"
#include "tests/mesh/damage.h"
#include "tests/places.h"

namespace forceshade::test {
namespace {

using layout::uint;

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
    std::vector<glm::dvec3> rim;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        rim.push_back(0.01 * glm::dvec3(std::cos(angle), std::sin(angle), 0.02 * std::cos(2 * angle)));
    }
    return shapes::polygon(std::move(rim));
}

PolygonSoup sheet() {
    return shapes::polygon({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
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

} // namespace

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
    const std::size_t side = std::getenv("FORCESHADE_LONG") ? 128 : 64;
    const MeshGrid fine{{side, side, side}};
    rows.push_back({"spot_fine", on_mesh(shapes::spot, Shading::barycentric), {}, fine});
    rows.push_back({"icosphere_of_20480_fine", on_mesh(sphere<5>, Shading::mean_value), {}, fine});
    rows.push_back({"polyhedra_fine",
                    on_mesh([] { return shapes::random_polyhedra(200, 1996); }, Shading::morgenbesser),
                    {},
                    fine});
    // Every triangle is about as near to the centre as any other: more than a list may hold.
    rows.push_back({"centre", on_mesh(sphere<5>), {}, {{24, 23, 22}, glm::dvec3(-0.02), glm::dvec3(0.02)}});
    rows.push_back({"very_centre", on_mesh(sphere<4>), {}, {{3, 3, 3}, glm::dvec3(-1e-12), glm::dvec3(1e-12)}});
    // Where single precision hardly tells one triangle from another, and where squares overflow: there a solid has more
    // sides than the planner takes it to have.
    for (const int power : {3, 6, 12, 18}) {
        const glm::dvec3 reach(std::pow(10.0, power));
        rows.push_back({fmt::format("far_off_{}", power),
                        on_mesh(sphere<2>, Shading::none, {.known_solid = power <= 6}),
                        {},
                        {{9, 9, 9}, -reach, reach}});
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
            shape.coupled = motion % 2 == 0;
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
    for (const auto& terrains : {walks::solids(), walks::meshes({in_source("tests/data/spot.obj")})})
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
                    .ground = on_mesh(shapes::spot),
                    .shape = through,
                    .least = {.host_updates = 400, .most_host_updates = 400 * 150 / 2}});
    // What takes more loops than an invocation may run goes to the host, on the way to edges too.
    rows.push_back({.name = "few_loops_on_spot",
                    .ground = on_mesh(shapes::spot),
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
                            .ground = on_mesh(shapes::spot, shading.is, maps ? both : none),
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
                    .ground = on_mesh(shapes::spot, Shading::barycentric),
                    .shape = wandering(1000, 500),
                    .least = {.touching = 10000},
                    .slices = 2});
    return rows;
}

} // namespace forceshade::test
