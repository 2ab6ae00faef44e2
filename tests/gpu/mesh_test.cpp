// Of meshes, what the table's rows do not say: that kernels get what the law reads and no more.
#include <gtest/gtest.h>

#include "host/mesh/block_plan.h"
#include "tests/gpu/software_device.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using test::Ground;

class MeshField : public test::SoftwareDeviceTest {
protected:
    /// Bytes of the tables alone: no block is planned.
    template <typename T>
    static std::uint64_t uploaded(const PolygonSoup& polygons, Shading shading, InsideTest inside,
                                  layout::uint texture = layout::kMapNone) {
        const Ground ground = test::mesh_of(polygons, shading, {.inside = inside});
        FieldTables<T> tables = test::tables_of<T>(ground, {{4, 4, 4}});
        tables.features.texture = texture;
        compute::MeshKernel kernel(device());
        return kernel.evaluate<T>(tables.input(), [](const layout::FieldChunk<T>&) {}).uploaded;
    }

    template <typename T> static void expect_least_uploads(const PolygonSoup& polygons) {
        const FieldTables<T> tables = test::tables_of<T>(test::mesh_of(polygons));
        const layout::MeshView<T> mesh = tables.mesh->view();
        constexpr std::size_t kVector = 4 * sizeof(T);
        const std::size_t vertices = mesh.vertices.size() / 3, facets = mesh.facet_normals.size() / 3;
        const std::size_t edges = mesh.edge_pseudonormals.size() / 3, triangles = mesh.triangle_facets.size();
        ASSERT_GT(edges, 0u);
        const std::uint64_t plain = uploaded<T>(polygons, Shading::none, InsideTest::pseudonormal);
        const std::uint64_t winding = uploaded<T>(polygons, Shading::none, InsideTest::winding);
        const std::uint64_t shaded = uploaded<T>(polygons, Shading::mean_value, InsideTest::pseudonormal);
        const std::size_t words = sizeof(layout::uint) * (8 * triangles - (triangles + 3) / 4 * 4);
        EXPECT_EQ(plain - winding, (vertices + edges) * kVector + words) << "pseudonormals, and what is around";
        EXPECT_EQ(shaded - plain, (2 * vertices + facets) * kVector +
                                      sizeof(layout::uint) * (mesh.facet_begins.size() + mesh.facet_corners.size()))
            << "places and normals of vertices, normals and corners of facets";
        EXPECT_EQ(shaded - uploaded<T>(polygons, Shading::mean_value, InsideTest::winding), plain - winding);
        EXPECT_EQ(uploaded<T>(polygons, Shading::none, InsideTest::pseudonormal, layout::kMapSine) - plain,
                  facets * kVector);
        EXPECT_EQ(uploaded<T>(polygons, Shading::mean_value, InsideTest::pseudonormal, layout::kMapSine), shaded);
    }
};

TEST_F(MeshField, UploadsWhatTheLawReadsAlone) {
    const PolygonSoup wall =
        shapes::merged(shapes::cube(true), shapes::moved(shapes::cube(true), glm::dvec3(1), {2, 0, 0}));
    expect_least_uploads<float>(wall);
    expect_least_uploads<double>(wall);
}

class MeshPaths : public test::SoftwareDeviceTest {
protected:
    static std::uint64_t uploaded(const PolygonSoup& polygons, Shading shading, const test::PathShape& shape,
                                  bool pseudonormals = true) {
        const Ground ground = test::mesh_of(polygons, shading);
        const FieldTables<float> tables = test::tables_of<float>(ground);
        test::PathCase<float> one(tables, ground.mesh(), shape);
        layout::PathInput<float> input = one.input();
        EXPECT_FALSE(pseudonormals && polygons.begins.size() == 4 && input.law.mesh.edge_pseudonormals.empty());
        if (!pseudonormals)
            input.law.mesh.edge_pseudonormals = {};
        compute::MeshPathKernel kernel(device());
        const compute::FinishUpdates<float> finish = [&](std::span<layout::MeshUpdate<float>> updates) {
            reference::finish_updates(input.law.mesh, updates, 2);
        };
        return kernel
            .explore<float>(
                input, finish, [](const layout::PathChunk<float>&) {},
                [](std::size_t, std::span<const layout::PathMetrics<float>>) {})
            .uploaded;
    }
};

// What the law does not read stays with the host.
TEST_F(MeshPaths, UploadWhatIsReadAlone) {
    test::PathShape shape;
    shape.features.motion = layout::kMotionRecorded;
    shape.features.channels = test::kAllPathChannels;
    shape.paths = 8;
    shape.steps = 5;
    shape.probes = test::Probes::wandering;
    test::PathShape twice = shape;
    twice.paths = 16;
    const PolygonSoup ball = shapes::icosphere(1);
    const FieldTables<float> tables = test::tables_of<float>(test::mesh_of(ball));
    const layout::MeshView<float> mesh = tables.mesh->view();
    constexpr std::size_t kVector = 4 * sizeof(float);
    const std::size_t vertices = mesh.vertices.size() / 3, facets = mesh.facet_normals.size() / 3;
    const std::size_t corners = sizeof(layout::uint) * (mesh.facet_begins.size() + mesh.facet_corners.size());
    const std::uint64_t least = uploaded(ball, Shading::none, shape);
    EXPECT_EQ(uploaded(ball, Shading::mean_value, shape) - least, (2 * vertices + facets) * kVector + corners);
    EXPECT_EQ(uploaded(ball, Shading::none, twice) - least, 8 * 5 * 3 * sizeof(float))
        << "recorded paths have places and no motions";
    // Pseudonormals are for the host alone. Three sheets meet at an edge; the path stays far off.
    const PolygonSoup sheets =
        shapes::soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
    test::PathShape far_off = shape;
    far_off.probes = test::Probes::lines;
    far_off.places = {{30, 0, 0}, {30, 0, 0}};
    EXPECT_EQ(uploaded(sheets, Shading::none, far_off, true), uploaded(sheets, Shading::none, far_off, false));
}

} // namespace
} // namespace forceshade
