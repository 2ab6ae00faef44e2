// Inside by winding number: the tree against the plain sum, against crossings of a ray, against pseudonormals, on open
// meshes, and the bound on its change.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/mesh_contact.h"
#include "tests/mesh/god_object_walks.h"
#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using reference::Vector;

struct Scene : shapes::MeshLaw<> {
    brute::MeshReferee referee{mesh, {}};
    using MeshLaw::MeshLaw;

    double winding(const glm::dvec3& world) const { return reference::winding_number(view, local(world)); }
    glm::dvec3 random_place(std::mt19937& random, double reach) const {
        return structure.centre + shapes::anywhere(random, reach * structure.scale);
    }
};

PolygonSoup bowl() {
    const PolygonSoup sphere = shapes::icosphere(4);
    return shapes::kept_facets(sphere,
                               [&](std::size_t facet) { return sphere.vertices[sphere.outline(facet)[0]].z < 0.6; });
}

TEST(Winding, TreeIsThePlainSumAsGoodAsItSays) {
    std::mt19937 random(5);
    double fine = 0, rough = 0;
    for (const PolygonSoup& polygons :
         {shapes::icosphere(5), shapes::spot(), bowl(), shapes::random_polyhedra(300, 8), shapes::sliver_box(300, 1e6),
          shapes::patch(shapes::Cells::quads, 40, [](double x, double y) { return 0.3 * x * y; })}) {
        const Scene scene(polygons);
        for (int i = 0; i < 100; ++i) {
            const glm::dvec3 world = scene.random_place(random, 1.5);
            const auto plain = double(scene.referee.winding_number(world));
            fine = std::max(fine, std::abs(scene.winding(world) - plain));
            const Vector<double> probe = scene.local(world);
            rough = std::max(rough,
                             std::abs(reference::winding_number(scene.view, probe, reference::kWindingRough) - plain));
        }
    }
    RecordProperty("fine", std::to_string(fine));
    RecordProperty("rough", std::to_string(rough));
    EXPECT_LT(fine, reference::kWindingFine.error);
    EXPECT_LT(rough, reference::kWindingRough.error / 5);
}

TEST(Winding, InsideIsWhatARayCrosses) {
    std::mt19937 random(6);
    for (const PolygonSoup& polygons : {shapes::cube(), shapes::icosphere(3), shapes::nested_shells(2, true),
                                        shapes::nested_shells(2, false), shapes::random_polyhedra(100, 4)}) {
        const Scene scene(polygons);
        for (int i = 0; i < 300; ++i) {
            const glm::dvec3 world = scene.random_place(random, 1.2);
            EXPECT_NEAR(scene.winding(world), scene.referee.crossings(world), 1e-4);
        }
    }
}

TEST(Winding, InsideBeginsAtOneHalf) {
    // A cube without its top: from within, the winding number falls to one half where the top was.
    const Scene scene(shapes::open_cube());
    int doubtful = 0;
    for (double z = -0.95; z < 1.6; z += 0.01)
        for (const double x : {0.0, 0.3, -0.7}) {
            if (std::abs(z - 1) < 1e-3)
                continue;
            const Vector<double> probe = scene.local({x, 0.2, z});
            EXPECT_EQ(reference::inside_by_winding(scene.view, probe), z < 1) << x << ' ' << z;
            doubtful += std::abs(scene.winding({x, 0.2, z}) - 0.5) < 0.15;
        }
    EXPECT_GT(doubtful, 100);
}

TEST(Winding, SingleTablesTellTheSame) {
    const Scene scene(shapes::spot());
    const MeshTables<float> tables = make_mesh_tables<float>(scene.structure, 1);
    std::mt19937 random(8);
    for (int i = 0; i < 200; ++i) {
        const Vector<double> probe = scene.local(scene.random_place(random, 1));
        if (reference::nearest(scene.view, probe).square > 1e-8) {
            EXPECT_NEAR(reference::winding_number(tables.view(), probe), reference::winding_number(scene.view, probe),
                        1e-4);
        }
    }
}

TEST(Winding, OfClosedMeshesDoesNotChangeInFreeSpace) {
    for (const PolygonSoup& polygons : {shapes::cube(), shapes::spot(), shapes::random_polyhedra(50, 1)}) {
        const Scene scene(polygons);
        EXPECT_TRUE(scene.structure.winding->rims.empty());
        EXPECT_EQ(reference::winding_change(scene.view, Vector<double>(3, 0, 0), 1.5), 0);
    }
}

TEST(Winding, ChangeIsBoundedOnOpenMeshes) {
    std::mt19937 random(9);
    int telling = 0;
    for (const PolygonSoup& polygons :
         {bowl(), shapes::single_triangle(),
          shapes::patch(shapes::Cells::quads, 8, [](double x, double y) { return x * y; })}) {
        const Scene scene(polygons);
        for (int i = 0; i < 300; ++i) {
            const Vector<double> probe = scene.local(scene.random_place(random, 1.5));
            const double free = std::sqrt(reference::nearest(scene.view, probe).square);
            const double radius = free * (0.1 + 0.8 * double(random()) / 4294967296.0);
            const double bound = reference::winding_change(scene.view, probe, radius, 10.0);
            const Vector<double> way = reference::normalised(Vector<double>(scene.random_place(random, 1)));
            const double change = std::abs(reference::winding_number(scene.view, Vector<double>(probe + radius * way)) -
                                           reference::winding_number(scene.view, probe));
            EXPECT_LE(change, bound + 2e-4);
            telling += bound < 0.5;
        }
    }
    EXPECT_GT(telling, 100);
    const Scene triangle(shapes::single_triangle());
    EXPECT_EQ(reference::winding_change(triangle.view, Vector<double>(0, 0, 0.1), 2.0),
              std::numeric_limits<double>::infinity());
}

constexpr double kReach = 3e-3;

TEST(ThinParts, AreWallsWedgesAndGapsNotWhatIsThickNorSheets) {
    const auto two_cubes = [](double x) {
        return shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), {1, 1, 1}, {x, 0, 0}));
    };
    for (const auto& [what, polygons, thin] : {std::tuple{"a wall of 1e-3", shapes::plate(1e-3), true},
                                               {"a wall of 1e-7", shapes::plate(1e-7), true},
                                               {"a wall of 1e-2", shapes::plate(1e-2), false},
                                               {"a narrow wedge", walks::wedge(1e-4), true},
                                               {"a wide wedge", walks::wedge(1.0), false},
                                               {"a narrow gap", two_cubes(2.001), true},
                                               {"a wide gap", two_cubes(2.1), false},
                                               {"a cube", shapes::cube(), false},
                                               {"a sphere", shapes::icosphere(3), false},
                                               {"a sheet", shapes::single_triangle(), false}})
        EXPECT_EQ(has_thin_parts(build_structure(shapes::mesh_of(polygons)), kReach), thin) << what;
}

} // namespace
} // namespace forceshade
