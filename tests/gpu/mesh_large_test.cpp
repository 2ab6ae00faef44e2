// Fields of meshes with many triangles or corners, 128 samples a side, and what a scene may add to a mesh: texture,
// relief; against the oracle at every voxel, bit for bit.
#include <gtest/gtest.h>

#include "host/mesh/block_plan.h"
#include "host/mesh/mesh_file.h"
#include "tests/gpu/mesh_case.h"

namespace forceshade {
namespace {

using test::MeshCase;
using test::MeshGrid;

template <typename T>
test::BitComparison held(compute::Device& device, const MeshCase<T>& mesh_case,
                         compute::MeshKernelOptions options = {}) {
    compute::MeshKernel kernel(device, options);
    const layout::FieldInput<T> input = mesh_case.input();
    const BlockPlanner<T> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside);
    BlockPlan plan;
    return test::hold_against_oracle<T>(kernel, input, [&](std::size_t z_first, std::size_t z_count) {
        plan = planner.plan(z_first, z_count);
        return plan.view();
    });
}

class MeshLarge : public test::SoftwareDeviceTest {
protected:
    static constexpr MeshGrid kGrid{{128, 128, 128}, glm::dvec3(-1.05), glm::dvec3(1.05)};

    static void hold(const PolygonSoup& polygons, const MeshGrid& grid, layout::uint shading) {
        const MeshStructure structure = build_structure(shapes::mesh_of(polygons));
        EXPECT_TRUE(is_equal(held(device(), MeshCase<float>(structure, grid, shading))));
        EXPECT_TRUE(is_equal(held(device(), MeshCase<double>(structure, grid, shading))));
    }
};

TEST_F(MeshLarge, SpotAt128) {
    hold(read_polygons(FORCESHADE_DATA "/spot.obj").polygons, kGrid, layout::kShadingBarycentric);
}

TEST_F(MeshLarge, IcosphereOf20480At128) {
    hold(shapes::icosphere(5), kGrid, layout::kShadingMeanValue);
}

TEST_F(MeshLarge, RandomPolyhedraAt128) {
    hold(shapes::random_polyhedra(200, 1996), kGrid, layout::kShadingMorgenbesser);
}

// Every triangle is about as near to the centre as any other: more than a list may hold.
TEST_F(MeshLarge, CentreOfASphere) {
    hold(shapes::icosphere(5), {{24, 23, 22}, glm::dvec3(-0.02), glm::dvec3(0.02)}, layout::kShadingNone);
    hold(shapes::icosphere(4), {{3, 3, 3}, glm::dvec3(-1e-12), glm::dvec3(1e-12)}, layout::kShadingNone);
}

// Far outside, where single precision hardly tells one triangle from another, and where squares overflow.
TEST_F(MeshLarge, FarAway) {
    for (const double reach : {1e3, 1e6, 1e12, 1e18})
        hold(shapes::icosphere(2), {{9, 9, 9}, glm::dvec3(-reach), glm::dvec3(reach)}, layout::kShadingNone);
}

TEST_F(MeshLarge, FacetOf65537Corners) {
    const PolygonSoup prism = shapes::many_gon_prism(65537);
    const MeshGrid grid{{6, 5, 4}, glm::dvec3(-0.9), glm::dvec3(0.9)};
    for (const layout::uint shading :
         {layout::kShadingMorgenbesser, layout::kShadingMeanValue, layout::kShadingTwoPass})
        hold(prism, grid, shading);
}

TEST_F(MeshLarge, RefusesFacetsWithTooManyCorners) {
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::cube(false)));
    MeshCase<float> mesh_case(structure, {{4, 4, 4}}, layout::kShadingMeanValue);
    layout::FieldInput<float> input = mesh_case.input();
    const std::vector<layout::uint> begins{0, 4, 200004};
    input.law.mesh.facet_begins = begins;
    compute::MeshKernel kernel(device());
    try {
        kernel.evaluate<float>(input, [](const layout::FieldChunk<float>&) {});
        FAIL();
    } catch (const compute::DeviceError& error) {
        EXPECT_EQ(error.kind(), compute::DeviceError::Kind::unsupported);
        EXPECT_NE(std::string(error.what()).find("200000"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("--engine cpu"), std::string::npos) << error.what();
    }
}

template <typename T> void add_maps(MeshCase<T>& mesh_case, layout::uint map, layout::uint texture) {
    mesh_case.features.map = map;
    mesh_case.features.texture = texture;
    const T side = mesh_case.tables.params.scale;
    layout::MapParams<T> params{};
    params.half_width = params.half_length = T(0.7) * side;
    params.radius = side;
    params.slope = T(0.6);
    params.inverse_length = T(4) / side;
    params.columns = 5;
    params.rows = 4;
    params.nodes_per_x = T(4) / (params.half_width + params.half_width);
    params.nodes_per_y = T(3) / (params.half_length + params.half_length);
    mesh_case.params.map = mesh_case.params.texture = params;
    mesh_case.params.texture_stiffness = T(300);
    for (int i = 0; i < 40; ++i) {
        mesh_case.map_gradients.push_back(T(i * 7 % 11) / T(11) - T(0.5));
        mesh_case.texture_gradients.push_back(T(i * 5 % 13) / T(13) - T(0.5));
    }
}

TEST_F(MeshLarge, TextureAndRelief) {
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::icosphere(3)));
    const MeshGrid grid{{33, 34, 35}, glm::dvec3(-1.05), glm::dvec3(1.05)};
    const layout::uint maps[] = {layout::kMapNone, layout::kMapCylinder, layout::kMapDip,
                                 layout::kMapSine, layout::kMapGaussian, layout::kMapSamples};
    for (std::size_t i = 0; i < std::size(maps); ++i)
        for (const layout::uint shading : {layout::kShadingNone, layout::kShadingMeanValue, layout::kShadingTwoPass}) {
            MeshCase<float> single(structure, grid, shading);
            add_maps(single, maps[i], maps[(i + 1) % std::size(maps)]);
            EXPECT_TRUE(is_equal(held(device(), single))) << "map " << maps[i] << ", shading " << shading;
            MeshCase<double> twice(structure, grid, shading);
            add_maps(twice, maps[i], maps[(i + 2) % std::size(maps)]);
            EXPECT_TRUE(is_equal(held(device(), twice))) << "map " << maps[i] << ", shading " << shading;
        }
}

// Chunks of single rows of blocks, slabs of single layers, and results that travel through staging buffers.
TEST_F(MeshLarge, ChunksSlabsAndStaging) {
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::random_polyhedra(40, 3)));
    const MeshCase<float> mesh_case(structure, {{37, 35, 33}, glm::dvec3(-1.05), glm::dvec3(1.05)},
                                    layout::kShadingMeanValue);
    for (const std::size_t chunk_bytes : {std::size_t(1), std::size_t(40000), std::size_t(500000)})
        for (const bool staging : {false, true}) {
            compute::MeshKernelOptions options;
            options.chunk_bytes = chunk_bytes;
            options.slab_voxels = 5000;
            options.force_staging = staging;
            EXPECT_TRUE(is_equal(held(device(), mesh_case, options))) << chunk_bytes;
        }
}

// A list beyond what the driver's loops allow must not go unseen; what the planner makes never is so long.
TEST_F(MeshLarge, LoopLimitIsNoticed) {
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::icosphere(2)));
    const MeshCase<float> mesh_case(structure, {{2, 2, 2}, glm::dvec3(-0.1), glm::dvec3(0.1)});
    layout::FieldInput<float> input = mesh_case.input();
    std::vector<layout::uint> candidates;
    for (layout::uint i = 0; i < 100000; ++i)
        candidates.push_back(i % 320);
    const std::vector<layout::MeshBlock> blocks{{0, 0, 0, 0, static_cast<layout::uint>(candidates.size())}};
    input.plan = {blocks, candidates, {}};
    compute::MeshKernel kernel(device());
    try {
        kernel.evaluate<float>(input, [](const layout::FieldChunk<float>&) {});
        FAIL() << "the driver no longer ends loops: this test needs another shape";
    } catch (const compute::DeviceError& error) {
        EXPECT_EQ(error.kind(), compute::DeviceError::Kind::unfinished) << error.what();
    }
    // The same kernel object serves on.
    candidates.resize(320);
    const std::vector<layout::MeshBlock> shorter{{0, 0, 0, 0, 320}};
    input.plan = {shorter, candidates, {}};
    EXPECT_TRUE(is_equal(test::hold_against_oracle<float>(kernel, input)));
}

} // namespace
} // namespace forceshade
