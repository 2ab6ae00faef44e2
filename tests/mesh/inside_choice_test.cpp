// surface.inside = "auto": what suits the mesh, recorded; and what orient and weld make of a scene's mesh.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/mesh/places.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

using testing::says;

class InsideChoice : public ::testing::Test {
protected:
    PreparedCase prepared(const PolygonSoup& polygons, const std::string& more = "") {
        folder_.write("mesh.obj", testing::as_obj(polygons));
        return CasePreparation().prepare(
            parse_scene("[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\n" + more, "scene", folder_.path()));
    }

    static bool is_inside(const PreparedCase& one, const glm::dvec3& place) {
        const auto tables = make_tables<double>(one.one.scene, one.images, Extent::nothing);
        const glm::dvec3 local = to_mesh_frame(one.images.mesh->structure, place);
        return reference::is_inside(tables.law(), reference::nearest(tables.law().mesh, local), local);
    }

    static bool is_recorded(const PreparedCase& one, const std::string& line) {
        return one.scene.find(line + "\n") != std::string::npos;
    }

    testing::Folder folder_;
};

TEST_F(InsideChoice, IsTheWindingNumberWhereASolidStandsInAnother) {
    const PolygonSoup small = shapes::moved(shapes::cube(), glm::dvec3(0.5), {});
    const PreparedCase one = prepared(shapes::merged(shapes::cube(), small));
    EXPECT_EQ(one.images.mesh->inside, InsideTest::winding);
    for (const double x : {0.2, 0.55, 0.7, 0.95}) // in both, just outside of the inner one, and in the outer one
        EXPECT_TRUE(is_inside(one, {x, 0, 0})) << x;
    EXPECT_FALSE(is_inside(one, {1.05, 0, 0}));
    EXPECT_TRUE(std::ranges::any_of(one.warnings, [](const std::string& text) {
        return text.find("faces outward within another piece") != std::string::npos;
    }));
}

TEST_F(InsideChoice, IsThePseudonormalForSolidsAndSheets) {
    const PolygonSoup apart = shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {5, 0, 0}));
    const PolygonSoup sheet = shapes::patch(shapes::Cells::triangles, 10, [](double x, double y) { return x * y; });
    for (const PolygonSoup& polygons : {shapes::cube(), apart, sheet, shapes::nested_shells(1, true)}) {
        const PreparedCase one = prepared(polygons);
        EXPECT_EQ(one.images.mesh->inside, InsideTest::pseudonormal);
        EXPECT_TRUE(is_recorded(one, "inside = \"pseudonormal\""));
    }
}

TEST_F(InsideChoice, IsTheWindingNumberForCrossingPiecesAndShapesWithHoles) {
    const PolygonSoup crossing =
        shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {0.9, 0.8, 0.7}));
    const PreparedCase one = prepared(crossing);
    EXPECT_EQ(one.images.mesh->inside, InsideTest::winding);
    EXPECT_TRUE(is_recorded(one, "inside = \"winding\""));
    const PreparedCase other = prepared(crossing, "inside = \"pseudonormal\"\n");
    int missing = 0;
    for (double x = -0.95; x < 1.9; x += 0.1)
        for (double y = -0.95; y < 1.8; y += 0.1)
            for (double z = -0.95; z < 1.7; z += 0.1) {
                const auto within = [&](double a, double b, double c) {
                    return std::abs(x - a) < 1 && std::abs(y - b) < 1 && std::abs(z - c) < 1;
                };
                const bool expected = within(0, 0, 0) || within(0.9, 0.8, 0.7);
                EXPECT_EQ(is_inside(one, {x, y, z}), expected) << x << ' ' << y << ' ' << z;
                missing += expected && !is_inside(other, {x, y, z});
            }
    EXPECT_GT(missing, 100);
    const PolygonSoup holed = shapes::kept_facets(shapes::icosphere(3), [](std::size_t facet) { return facet > 0; });
    EXPECT_EQ(prepared(holed).images.mesh->inside, InsideTest::winding);
    EXPECT_EQ(prepared(holed, "inside = \"pseudonormal\"\n").images.mesh->inside, InsideTest::pseudonormal);
}

// Where the tree shows that triangles keep apart, the file's own are not looked at.
TEST_F(InsideChoice, CrossingsAreThoseOfTheFileWhereverItStands) {
    const PolygonSoup touching =
        shapes::merged(shapes::cube(true), shapes::moved(shapes::cube(true), glm::dvec3(0.25), {1.25, 0, 0}));
    for (PolygonSoup polygons :
         {shapes::icosphere(3), shapes::merged(shapes::icosphere(2), shapes::icosphere(1)), touching,
          shapes::random_polyhedra(40, 3), shapes::needle_fan(257, 1), shapes::cube(), shapes::plate(1e-12)}) {
        join_vertices(polygons); // as files are read
        const MeshFindings expected = inspect(polygons);
        for (const char* transform :
             {"scale = 1", "scale = 1e-5", "translate = [\"5 m\", \"0 m\", \"-7 m\"]",
              "rotate = [\"20 deg\", \"-50 deg\", \"7 deg\"]",
              "translate = [\"1e12 m\", \"0 m\", \"1e12 m\"], rotate = [\"33 deg\", \"5 deg\", \"0 deg\"]"}) {
            const MeshFindings found =
                prepared(polygons, std::string("transform = {") + transform + "}\n").images.mesh->findings;
            EXPECT_EQ(found.self_intersections, expected.self_intersections) << polygons.facets() << transform;
            EXPECT_EQ(static_cast<const ConnectivityCounts&>(found), expected) << polygons.facets() << transform;
        }
    }
}

TEST_F(InsideChoice, OrientAndWeldMakeASolid) {
    const PolygonSoup apart =
        shapes::merged(shapes::cube(), shapes::moved(shapes::reversed(shapes::cube()), glm::dvec3(1), {5, 0, 0}));
    EXPECT_FALSE(is_inside(prepared(apart), {5, 0, 0.5}));
    const PreparedCase turned = prepared(apart, "orient = \"outward\"\n");
    EXPECT_TRUE(is_inside(turned, {5, 0, 0.5}));
    EXPECT_FALSE(is_inside(turned, {5, 0, 1.5}));
    ASSERT_EQ(turned.images.mesh->changes.size(), 1u);

    PolygonSoup crack = shapes::cube();
    crack.vertices.push_back(crack.vertices[crack.corners[0]] + glm::dvec3(1e-6, 0, 0));
    crack.corners[0] = 8;
    EXPECT_FALSE(prepared(crack).images.mesh->findings.closed);
    EXPECT_TRUE(prepared(crack, "weld = \"2 um\"\n").images.mesh->findings.closed);
    EXPECT_FALSE(prepared(crack, "weld = \"0.5 um\"\n").images.mesh->findings.closed);
    EXPECT_TRUE(says(testing::message_of<UsageError>([&] { prepared(crack, "weld = \"10 m\"\n"); }), "smaller than"));
    for (const char* bad : {"weld = \"-1 um\"\n", "weld = \"nan um\"\n", "weld = \"inf um\"\n", "weld = 1\n",
                            "orient = \"inward\"\n", "normals = \"crease\"\n", "normals = \"crease:-1 deg\"\n",
                            "normals = \"crease:30\"\n", "normals = \"crease:200 deg\"\n", "normals = \"groups\"\n"})
        EXPECT_THROW(prepared(crack, bad), UsageError) << bad;
    EXPECT_NO_THROW(prepared(crack, "normals = \"crease:30 deg\"\n"));
}

} // namespace
} // namespace forceshade
