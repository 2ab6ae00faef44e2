// Fields of meshes: the kernel and the CPU engine, told by the planner, against the oracle at every voxel, bit for bit.
#include <gtest/gtest.h>

#include "host/mesh/block_plan.h"
#include "host/mesh/mesh_file.h"
#include "host/reference/mesh_field.h"
#include "tests/gpu/mesh_case.h"
#include "tests/mesh/damage.h"

namespace forceshade {
namespace {

using test::MeshCase;
using test::MeshGrid;

// Grids about the mesh's frame: odd, cutting it, inside it, beside it, of single samples.
const std::vector<MeshGrid> kGrids{{},
                                   {{17, 5, 31}, {-0.3, -0.2, -1.3}, {0.9, 0.1, 0.4}},
                                   {{9, 8, 7}, {-0.1, -0.12, -0.09}, {0.11, 0.1, 0.1}},
                                   {{12, 11, 10}, {2, 2, 2}, {4, 5, 6}},
                                   {{1, 1, 1}, {0.01, 0.02, -0.03}, {0.01, 0.02, -0.03}},
                                   {{1, 40, 1}, {0.01, -1.1, 0.2}, {0.01, 1.1, 0.2}},
                                   {{70, 1, 3}, {-1.1, 0.1, 0.2}, {1.1, 0.1, 0.3}}};

class MeshField : public test::SoftwareDeviceTest {
protected:
    /// One for all tests, so that each kernel is compiled once.
    static compute::MeshKernel& kernel() {
        static compute::MeshKernel made(device());
        return made;
    }

    template <typename T>
    static void hold(const MeshCase<T>& mesh_case, const std::string& what, FreeSpace free = FreeSpace::skipped) {
        const layout::FieldInput<T> input = mesh_case.input();
        const BlockPlanner<T> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 0, free);
        BlockPlan plan;
        const auto layers = [&](std::size_t z_first, std::size_t z_count) {
            plan = planner.plan(z_first, z_count);
            return plan.view();
        };
        const auto comparison = test::hold_against_oracle<T>(kernel(), input, layers);
        EXPECT_TRUE(is_equal(comparison)) << what;
        EXPECT_EQ(comparison.voxels, input.x.size() * input.y.size() * input.z.size());
        // On the CPU in chunks of many layers, or of few rows of one.
        test::BitComparer<T> comparer(input);
        const std::size_t chunk_bytes = std::size_t(1) << (sizeof(T) == sizeof(float) ? 25 : 13);
        reference::evaluate_mesh_field<T>(input, {.threads = 2, .chunk_bytes = chunk_bytes}, layers,
                                          [&](const layout::FieldChunk<T>& chunk) { comparer.add(chunk); });
        EXPECT_TRUE(is_equal(comparer.result())) << what << " on the CPU";
    }

    static void hold_both(const PolygonSoup& polygons, const MeshGrid& grid, layout::uint shading,
                          const std::string& what, layout::uint inside = layout::kInsidePseudonormal) {
        StructureOptions options;
        options.winding = inside == layout::kInsideWinding;
        const MeshStructure structure = build_structure(shapes::mesh_of(polygons), options);
        MeshCase<float> single(structure, grid, shading);
        single.features.inside = inside;
        hold(single, what + ", f32");
        MeshCase<double> twice(structure, grid, shading);
        twice.features.inside = inside;
        hold(twice, what + ", f64");
    }

    /// Bytes of the tables alone: no block is planned.
    template <typename T>
    static std::uint64_t uploaded(const MeshStructure& structure, layout::uint shading, layout::uint inside,
                                  layout::uint texture = layout::kMapNone) {
        MeshCase<T> mesh_case(structure, {{4, 4, 4}}, shading);
        mesh_case.features.inside = inside;
        mesh_case.features.texture = texture;
        return kernel().evaluate<T>(mesh_case.input(), [](const layout::FieldChunk<T>&) {}).uploaded;
    }

    template <typename T> static void expect_least_uploads(const PolygonSoup& polygons) {
        const MeshStructure structure = build_structure(shapes::mesh_of(polygons));
        const MeshTables<T> tables = make_mesh_tables<T>(structure, 1000);
        const layout::MeshView<T> mesh = tables.view();
        constexpr std::size_t kVector = 4 * sizeof(T);
        const std::size_t vertices = mesh.vertices.size() / 3, facets = mesh.facet_normals.size() / 3;
        const std::size_t edges = mesh.edge_pseudonormals.size() / 3, triangles = mesh.triangle_facets.size();
        ASSERT_GT(edges, 0u);
        const std::uint64_t plain = uploaded<T>(structure, layout::kShadingNone, layout::kInsidePseudonormal);
        const std::uint64_t winding = uploaded<T>(structure, layout::kShadingNone, layout::kInsideWinding);
        const std::uint64_t shaded = uploaded<T>(structure, layout::kShadingMeanValue, layout::kInsidePseudonormal);
        const std::size_t words = sizeof(layout::uint) * (8 * triangles - (triangles + 3) / 4 * 4);
        EXPECT_EQ(plain - winding, (vertices + edges) * kVector + words) << "pseudonormals, and what is around";
        EXPECT_EQ(shaded - plain, (2 * vertices + facets) * kVector +
                                      sizeof(layout::uint) * (mesh.facet_begins.size() + mesh.facet_corners.size()))
            << "places and normals of vertices, normals and corners of facets";
        EXPECT_EQ(shaded - uploaded<T>(structure, layout::kShadingMeanValue, layout::kInsideWinding), plain - winding);
        EXPECT_EQ(uploaded<T>(structure, layout::kShadingNone, layout::kInsidePseudonormal, layout::kMapSine) - plain,
                  facets * kVector);
        EXPECT_EQ(uploaded<T>(structure, layout::kShadingMeanValue, layout::kInsidePseudonormal, layout::kMapSine),
                  shaded);
    }
};

struct Shape {
    const char* name;
    PolygonSoup polygons;
    bool triangles = true;
};

std::vector<Shape> shapes_of_all_kinds() {
    std::mt19937 random(3);
    PolygonSoup open = shapes::icosphere(2);
    open.begins.resize(open.begins.size() - 100);
    open.corners.resize(open.begins.back());
    return {{"icosphere", shapes::icosphere(2)},
            {"cube of quads", shapes::cube(false), false},
            {"random polyhedra", shapes::random_polyhedra(30, 5)},
            {"single triangle", shapes::single_triangle()},
            {"needle fan", shapes::needle_fan(200, 0.5), false},
            {"sliver box", shapes::sliver_box(30, 1e6)},
            {"plate", shapes::plate(1e-5)},
            {"shells", shapes::nested_shells(2, false)},
            {"cavity", shapes::nested_shells(2, true)},
            {"hexagons", shapes::patch(shapes::Cells::hexagons, 8, [](double x, double y) { return x * x - y * y; }),
             false},
            {"open sphere", open},
            {"wall between cubes",
             shapes::merged(shapes::cube(true), shapes::moved(shapes::cube(true), glm::dvec3(1), {2, 0, 0}))},
            {"damaged",
             shapes::damaged(shapes::icosphere(2), {.caps = 60, .needles = 20, .repeats = 20, .strays = 3}, random)}};
}

TEST_F(MeshField, IsTheSameWhereFreeSpaceIsVisited) {
    for (const layout::uint inside : {layout::kInsidePseudonormal, layout::kInsideWinding}) {
        StructureOptions options;
        options.winding = true;
        const MeshStructure structure = build_structure(shapes::mesh_of(shapes::icosphere(2)), options);
        MeshCase<float> sphere(structure, {{21, 22, 23}, glm::dvec3(-1.6), glm::dvec3(1.6)}, layout::kShadingMeanValue);
        sphere.features.inside = inside;
        hold(sphere, "every block", FreeSpace::visited);
    }
}

TEST_F(MeshField, EqualsTheOracleOnEveryGrid) {
    for (const Shape& shape : shapes_of_all_kinds())
        for (std::size_t g = 0; g < kGrids.size(); ++g)
            hold_both(shape.polygons, kGrids[g], layout::kShadingNone, fmt::format("{}, grid {}", shape.name, g));
}

TEST_F(MeshField, EqualsTheOracleWithEveryShading) {
    for (const Shape& shape : shapes_of_all_kinds())
        for (const layout::uint shading : {layout::kShadingMorgenbesser, layout::kShadingBarycentric,
                                           layout::kShadingMeanValue, layout::kShadingTwoPass})
            if (shape.triangles || shading != layout::kShadingBarycentric)
                hold_both(shape.polygons, kGrids[0], shading, fmt::format("{}, shading {}", shape.name, shading));
}

TEST_F(MeshField, EqualsTheOracleInsideByWinding) {
    for (const Shape& shape : shapes_of_all_kinds())
        for (const layout::uint shading : {layout::kShadingNone, layout::kShadingMeanValue})
            hold_both(shape.polygons, kGrids[0], shading, shape.name, layout::kInsideWinding);
}

TEST_F(MeshField, IsInsideWhereTheWindingNumberIsAboveOneHalf) {
    // Within a cube without its top that is so up to where the top was, and nowhere else.
    StructureOptions options;
    options.winding = true;
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::open_cube()), options);
    MeshCase<float> cube(structure, {{50, 51, 52}, glm::dvec3(-1.3), glm::dvec3(1.3)});
    cube.features.inside = layout::kInsideWinding;
    hold(cube, "cube without top");
    const layout::FieldInput<float> input = cube.input();
    const BlockPlanner<float> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 0);
    BlockPlan plan;
    const auto planned = [&](std::size_t z_first, std::size_t z_count) {
        plan = planner.plan(z_first, z_count);
        return plan.view();
    };
    const auto expect_cube = [&](const layout::FieldChunk<float>& chunk) {
        for (std::size_t z = 0; z < chunk.z_count; ++z)
            for (std::size_t y = 0; y < chunk.y_count; ++y)
                for (std::size_t x = 0; x < chunk.x_count; ++x) {
                    const float at[3] = {input.x[x], input.y[chunk.y_first + y], input.z[chunk.z_first + z]};
                    const bool inside = std::abs(at[0]) < 1 && std::abs(at[1]) < 1 && std::abs(at[2]) < 1;
                    ASSERT_EQ(chunk.facet[(z * chunk.y_count + y) * chunk.x_pitch + x] != layout::kNoFacet, inside)
                        << at[0] << ' ' << at[1] << ' ' << at[2];
                }
    };
    kernel().evaluate<float>(input, expect_cube, planned);
    reference::evaluate_field<float>(input, {}, expect_cube);
}

TEST_F(MeshField, UploadsWhatTheLawReadsAlone) {
    const PolygonSoup wall =
        shapes::merged(shapes::cube(true), shapes::moved(shapes::cube(true), glm::dvec3(1), {2, 0, 0}));
    expect_least_uploads<float>(wall);
    expect_least_uploads<double>(wall);
}

// Places are measured from the scene's origin, height maps are read in the world.
TEST_F(MeshField, FarFromTheWorldsOrigin) {
    const MeshStructure structure = build_structure(
        shapes::mesh_of(shapes::moved(shapes::icosphere(2), glm::dvec3(1), glm::dvec3(566321.25, -5933204.5, 12.25))));
    MeshCase<float> far(structure, kGrids[1], layout::kShadingMeanValue);
    EXPECT_LT(std::abs(far.tables.params.centre_y), 1);
    EXPECT_EQ(far.tables.params.map_y, -5933204.5F);
    far.tables.params.map_x = 0.37F;
    far.features.texture = layout::kMapSine;
    far.params.texture.slope = 0.2F;
    far.params.texture.inverse_length = 3;
    far.params.texture_stiffness = 100;
    hold(far, "far");
}

} // namespace
} // namespace forceshade
