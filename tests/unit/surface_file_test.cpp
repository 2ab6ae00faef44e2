// The surface with the forces on it, read by hand and held against closed forms and against the law.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/cases/case_files.h"
#include "host/field/case_law.h"
#include "host/field/comparison.h"
#include "host/output/files.h"
#include "host/picture/picture.h"
#include "host/touch/force_errors.h"
#include "tests/io/folder.h"
#include "tests/io/vtk_bytes.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"
#include "tests/places.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

using forceshade::testing::says;

constexpr double kDegreesOfRadian = 180 / std::numbers::pi;

using Point = glm::dvec3;

// A file's arrays, numbers as double.
struct ReadSurface {
    std::string text;
    std::vector<Point> points, force, unshaded;
    std::vector<double> turn;                    /* deg */
    std::vector<std::vector<std::size_t>> cells; /* points of each corner */
    std::vector<int> facet;
    double raw_bytes = 0; /* of all arrays */

    std::size_t cell_of(std::size_t point) const {
        for (std::size_t cell = 0; cell < cells.size(); ++cell)
            for (const std::size_t corner : cells[cell])
                if (corner == point)
                    return cell;
        ADD_FAILURE() << "no cell has point " << point;
        return 0;
    }
};

template <typename Real> std::vector<Point> vectors_in(const std::string& text, const char* name) {
    const std::vector<Real> numbers = testing::vtk_numbers<Real>(text, name, 3);
    std::vector<Point> vectors;
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
        vectors.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return vectors;
}

template <typename Real> ReadSurface read_surface(const std::filesystem::path& file) {
    ReadSurface surface{read_file(file), {}, {}, {}, {}, {}, {}};
    const std::string& text = surface.text;
    surface.points = vectors_in<double>(text, "Points");
    surface.force = vectors_in<Real>(text, "force");
    surface.unshaded = vectors_in<Real>(text, "unshaded");
    for (const Real turn : testing::vtk_numbers<Real>(text, "turn"))
        surface.turn.push_back(double(turn));
    surface.facet = testing::vtk_numbers<std::int32_t>(text, "facet");
    const auto corners = testing::vtk_numbers<std::int64_t>(text, "connectivity");
    std::int64_t begin = 0;
    for (const std::int64_t end : testing::vtk_numbers<std::int64_t>(text, "offsets")) {
        surface.cells.emplace_back(corners.begin() + begin, corners.begin() + end);
        begin = end;
    }
    EXPECT_EQ(std::size_t(begin), corners.size());
    EXPECT_EQ(surface.cells.size(), surface.facet.size());
    EXPECT_EQ(surface.points.size(), surface.force.size());
    EXPECT_EQ(surface.points.size(), surface.turn.size());
    surface.raw_bytes =
        double(surface.points.size() * (24 + 7 * sizeof(Real)) + corners.size() * 8 + surface.facet.size() * 12);
    return surface;
}

double distance(const Point& a, const Point& b) {
    return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

class SurfaceFile : public ::testing::Test {
protected:
    PreparedCase prepare(const std::string& scene) const {
        return CasePreparation().prepare(parse_scene(scene, "scene", folder_.path()));
    }
    ReadSurface written(const PreparedCase& prepared) const {
        const std::filesystem::path file = folder_ / "a.vtp";
        const VolumeResult result = write_surface(file, prepared);
        EXPECT_EQ(result.bytes, std::filesystem::file_size(file));
        const Scene& scene = prepared.one.scene;
        const ReadSurface surface =
            scene.precision == Precision::f32 ? read_surface<float>(file) : read_surface<double>(file);
        if (!prepared.images.mesh) {
            EXPECT_LE(surface.raw_bytes, most_surface_bytes(scene));
        }
        return surface;
    }
    ReadSurface written(const std::string& scene) const { return written(prepare(scene)); }
    std::string mesh(const std::string& file, const std::string& more) const {
        return fmt::format("[surface]\nkind = \"mesh\"\nfile = \"{}\"\nunit = \"cm\"\n{}", (folder_ / file).string(),
                           more);
    }
    testing::Folder folder_;
};

// A house: five walls of a pentagonal prism with a roof's angle, two gables of five corners; K = 2 N/mm.
constexpr const char* kHouse = "OFF\n10 7 0\n-1 -1 0\n1 -1 0\n1 -1 1\n0 -1 2\n-1 -1 1\n-1 1 0\n1 1 0\n1 1 1\n0 1 2\n"
                               "-1 1 1\n5 0 1 2 3 4\n5 9 8 7 6 5\n4 0 5 6 1\n4 1 6 7 2\n4 2 7 8 3\n4 3 8 9 4\n"
                               "4 4 9 5 0\n";
constexpr double kSlope = std::numbers::sqrt2 / 2;
const std::vector<Point> kHouseNormals{{0, -1, 0},           {0, 1, 0}, {0, 0, -1}, {1, 0, 0}, {kSlope, 0, kSlope},
                                       {-kSlope, 0, kSlope}, {-1, 0, 0}};

TEST_F(SurfaceFile, OfAMeshHasItsFacetsAsTheyAreAndTheForceAlongTheirNormals) {
    folder_.write("house.off", kHouse);
    for (const char* precision : {"f32", "f64"}) {
        PreparedCase prepared = prepare(mesh("house.off", "[force]\nstiffness = \"2 N/mm\"\n"));
        prepared.one.scene.precision = precision == std::string("f32") ? Precision::f32 : Precision::f64;
        const ReadSurface surface = written(prepared);
        const PolygonSoup& polygons = prepared.images.mesh->mesh.polygons;
        ASSERT_EQ(surface.cells.size(), 7u);
        for (std::size_t facet = 0; facet < 7; ++facet) {
            EXPECT_EQ(surface.facet[facet], int(facet));
            ASSERT_EQ(surface.cells[facet].size(), facet < 2 ? 5u : 4u);
            for (std::size_t corner = 0; corner < surface.cells[facet].size(); ++corner) {
                const std::size_t point = surface.cells[facet][corner];
                EXPECT_EQ(surface.points[point], polygons.vertices[polygons.outline(std::uint32_t(facet))[corner]]);
                EXPECT_LT(distance(surface.force[point], 2.0 * kHouseNormals[facet]), 1e-6) << "2 N/mm times 1 mm";
                EXPECT_EQ(surface.force[point], surface.unshaded[point]);
                EXPECT_EQ(surface.turn[point], 0);
            }
        }
        EXPECT_EQ(surface.points[surface.cells[0][3]], Point(0, -0.01, 0.02)) << "in metres";
        EXPECT_TRUE(says(surface.text, "Name=\"pressed_m\" NumberOfTuples=\"1\" format=\"ascii\">0.001<",
                         "<PointData Vectors=\"force\" Scalars=\"turn\">", "NumberOfPolys=\"7\">"));
    }
}

TEST_F(SurfaceFile, OfAShadedMeshTurnsFromVertexToVertex) {
    // An octahedron: barycentric normals at its vertices are the axes, 54.7 degrees from each facet's normal.
    folder_.write("octahedron.off",
                  "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 2 4\n3 2 1 4\n3 1 3 4\n"
                  "3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n");
    const ReadSurface surface = written(mesh("octahedron.off", "[force]\nshading = \"barycentric\"\n"));
    const double turn = std::acos(1 / std::sqrt(3.0)) * kDegreesOfRadian;
    ASSERT_EQ(surface.cells.size(), 8u);
    for (const std::vector<std::size_t>& cell : surface.cells)
        for (const std::size_t point : cell) {
            const Point expected = surface.points[point] * 100.0; // at 1 cm, of length 1: 1 N/mm times 1 mm
            EXPECT_LT(distance(surface.force[point], expected), 1e-6);
            EXPECT_LT(distance(surface.unshaded[point], surface.unshaded[cell[0]]), 1e-12) << "one for a facet";
            EXPECT_NEAR(surface.turn[point], turn, 1e-4);
        }
}

TEST_F(SurfaceFile, OfAMeshHoldsWhatAProbeFeelsOnEachFacet) {
    for (const char* shading : {"none", "mean_value"}) {
        const PreparedCase prepared =
            prepare(fmt::format("[surface]\nkind = \"mesh\"\nfile = \"{}/spot.obj\"\n"
                                "transform = {{ scale = 0.05, rotate = [\"90 deg\", \"0 deg\", \"0 deg\"] }}\n"
                                "[force]\nshading = \"{}\"\n[run]\nprecision = \"f64\"\n",
                                in_source("tests/data"), shading));
        const ReadSurface surface = written(prepared);
        const std::unique_ptr<ProbeLaw> law = make_probe_law(prepared);
        ASSERT_EQ(surface.cells.size(), 5856u);
        std::size_t own = 0;
        for (std::size_t facet = 0; facet < surface.cells.size(); ++facet) {
            Point middle(0), force(0);
            for (const std::size_t point : surface.cells[facet]) {
                const Point &shaded = surface.force[point], &unshaded = surface.unshaded[point];
                middle += surface.points[point] / 3.0;
                force += shaded;
                EXPECT_NEAR(distance(shaded, Point(0)), 1, 1e-9) << "1 N/mm times 1 mm";
                EXPECT_LT(distance(unshaded, surface.unshaded[surface.cells[facet][0]]), 1e-12) << "one for a facet";
                EXPECT_NEAR(surface.turn[point], angle_between(shaded, unshaded) * kDegreesOfRadian, 1e-5);
            }
            // From just above the middle to 1 mm below it.
            const Point& normal = prepared.images.mesh->mesh.facet_normals[facet];
            law->begin_path();
            law->at(middle + 1e-6 * normal);
            const ProbeContact felt = law->at(middle - 1e-3 * normal);
            EXPECT_EQ(surface.facet[facet], int(facet));
            if (felt.facet != facet)
                continue; // under a fold
            EXPECT_LT(distance(felt.force, force / distance(force, Point(0))), 1e-8);
            ++own;
        }
        EXPECT_GT(double(own), 0.97 * double(surface.cells.size()));
        EXPECT_EQ(std::ranges::max(surface.turn) > 10, shading != std::string("none"));
    }
}

// On a cube's face vertex normals are (x, y, 1), linear in the place, which mean value coordinates reproduce.
TEST_F(SurfaceFile, TurnsOfACubeAreThoseOfItsNormalsAllOverAFace) {
    folder_.write("cube.off", "OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
                              "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
    const PreparedCase plain = prepare(mesh("cube.off", ""));
    const Mesh& cube = plain.images.mesh->mesh;
    const picture::TurnedMesh turned = mesh_turns(plain, Shading::mean_value), flat = mesh_turns(plain, Shading::none);
    EXPECT_EQ(turned.parts, 48u);
    ASSERT_EQ(turned.turns.size(), 12u * 48 * 48);
    EXPECT_EQ(std::ranges::count(flat.turns, 0.0f), std::ssize(turned.turns));
    auto turn = turned.turns.begin();
    for (const auto& [a, b, c] : cube.triangles.corners)
        picture::for_each_part(turned.parts, [&](const auto& shares) {
            glm::dvec3 place(0);
            for (const auto& [v, w] : shares)
                place += ((1 - v - w) * cube.polygons.vertices[a] + v * cube.polygons.vertices[b] +
                          w * cube.polygons.vertices[c]) /
                         3.0;
            const glm::dvec3 across =
                glm::abs(place) / std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
            const double tangent = std::sqrt(std::max(0.0, glm::dot(across, across) - 1));
            EXPECT_NEAR(*turn++, std::atan(tangent) * kDegreesOfRadian, 1e-4);
        });
}

TEST_F(SurfaceFile, TurnsOfAFacetOfManyCornersStandForTheirNeighbours) {
    constexpr int kCorners = 1000;
    folder_.write("prism.off", testing::as_off(shapes::many_gon_prism(kCorners)));
    const picture::TurnedMesh turned = mesh_turns(prepare(mesh("prism.off", "")), Shading::mean_value);
    ASSERT_EQ(turned.turns.size(), 4u * (kCorners - 1) * turned.parts * turned.parts);
    EXPECT_GT(std::ranges::max(turned.turns), 10);
    EXPECT_TRUE(std::ranges::all_of(turned.turns, [](float turn) { return turn >= 0 && turn < 64; }));
}

// Facets this fine are the cylinder: nothing is left between them, however depth is read.
TEST(Comparison, OfABumpWithItsOwnSmoothShapeReadsDepthAsTheSceneDoes) {
    for (const std::string depth : {"vertical", "normal"}) {
        const PreparedCase prepared =
            CasePreparation().prepare(parse_scene("[surface]\nfacets = 20000\n[force]\ndepth = \"" + depth +
                                                      "\"\n[compare]\nsurface = {kind = \"cylinder\"}\n",
                                                  "scene"));
        const CaseLaw<double> law(prepared);
        const ShapeComparison comparison(prepared);
        layout::uint hint = 0;
        for (const glm::dvec3 place :
             {glm::dvec3(0, 0, 1e-3), glm::dvec3(8e-3, 0, 1e-3), glm::dvec3(-0.02, 0, -1e-3)}) {
            const glm::dvec3 force(law.at(place).force);
            EXPECT_GT(std::hypot(force.x, force.z), 0.5);
            EXPECT_NEAR(comparison.at(place, force, hint).magnitude_error, 0, 1e-4) << depth << ' ' << place.x;
        }
        EXPECT_NE(comparison.text().find(depth == "normal" ? "along that normal" : "straight down"), std::string::npos);
    }
}

// On the plane around it there is no error to be made; and the depth itself counts, however its force was rounded.
TEST(Comparison, OfABumpWithItsOwnSmoothShapeCountsOverTheBump) {
    const PreparedCase prepared = CasePreparation().prepare(
        parse_scene("[surface]\nfacets = 2\n[compare]\nsurface = {kind = \"cylinder\"}\n", "scene"));
    const ShapeComparison comparison(prepared);
    const auto counts = [&](double x, double depth) {
        layout::uint hint = 0;
        const double force = prepared.one.scene.force.stiffness * depth;
        return comparison.at({x, 0, -1e-3}, {0, 0, force}, hint).counts;
    };
    EXPECT_TRUE(counts(0.0126, 1e-3));
    EXPECT_FALSE(counts(0.0128, 1e-3));
    EXPECT_TRUE(counts(0, 2e-3 * (1 + 1e-7)));
    EXPECT_FALSE(counts(0, 2.001e-3));
}

// Two facets of the paper's most curved bump, by other code: touched places under points anywhere over it.
TEST(TouchedError, HasRangesThatHoldTheNumbersOfAllPlaces) {
    const auto error_of = [](const char* shading) {
        return touched_error(CasePreparation().prepare(parse_scene(
            fmt::format("[surface]\nradius = \"600 mil\"\nfacets = 2\n[force]\nshading = \"{}\"\n", shading),
            "scene")));
    };
    constexpr double kHalf = 500 * kMil, kRadius = 600 * kMil;
    const double low = std::sqrt(kRadius * kRadius - kHalf * kHalf), top = kRadius - low; // m: centre, crest
    double squares = 0, missed = 0, touched = 0;
    for (int i = 0; i < 400; ++i)
        for (int j = 0; j < 400; ++j) { // middles of equal parts of x and of the depth's logarithm
            const double x = kHalf * ((i + 0.5) / 200 - 1), depth = 2e-5 * std::pow(100, (j + 0.5) / 400);
            const double px = x * (1 - depth / kRadius);
            const double pz = std::sqrt(kRadius * kRadius - x * x) * (1 - depth / kRadius) - low;
            if (top * (1 - std::abs(px) / kHalf) <= pz) {
                ++missed;
                continue;
            }
            const double facet = std::copysign(std::atan2(top, kHalf), px), circle = std::asin(px / kRadius);
            squares += (facet - circle) * (facet - circle);
            ++touched;
        }
    const double direction = std::sqrt(squares / touched) * 180 / std::numbers::pi;
    const auto plain = error_of("none"), shaded = error_of("reference");
    ASSERT_TRUE(plain && shaded);
    EXPECT_EQ(plain->against, kSmoothShape);
    EXPECT_EQ(plain->places, 125 * plain->draws);
    const auto holds = [](const DrawnNumber& one, double number) { return one.low <= number && number <= one.high; };
    EXPECT_TRUE(holds(plain->direction, direction)) << direction;
    EXPECT_NEAR(plain->direction.value, direction, 0.05 * direction);
    EXPECT_TRUE(holds(plain->missed, missed / (missed + touched))) << missed / (missed + touched);
    EXPECT_LT(shaded->direction.high, 1e-6) << "the normal above the probe is the shaded law's own";
    EXPECT_EQ(shaded->missed.value, plain->missed.value);
}

TEST_F(SurfaceFile, OfAMeshHasNoForceWhereNoProbeTouchesIt) {
    // The first facet once more, and one whose corners lie on a line: cells 7 and 8.
    std::string house = kHouse;
    house.replace(house.find("10 7 0"), 6, "11 9 0");
    house.insert(house.find("5 0 1 2"), "0 -1 0\n");
    folder_.write("house.off", house + "5 0 1 2 3 4\n3 0 10 1\n");
    const ReadSurface surface = written(mesh("house.off", "[force]\nshading = \"mean_value\"\n"));
    ASSERT_EQ(surface.cells.size(), 9u);
    for (std::size_t facet = 0; facet < 9; ++facet)
        for (const std::size_t point : surface.cells[facet]) {
            EXPECT_NEAR(distance(surface.force[point], Point(0)), facet < 7 ? 1 : 0, 1e-6) << facet;
            EXPECT_EQ(surface.turn[point] > 0, facet < 7) << facet;
        }
}

constexpr const char* kSurfaceGrid = "[grid]\nsize = [20, 5, 4]\norigin = [\"-20 mm\", \"-3 mm\", \"0 mm\"]\n"
                                     "spacing = \"2 mm\"\n"; // x from -20 to 18 mm, y from -3 to 5 mm

TEST_F(SurfaceFile, OfAnUnshadedBumpHasOneForceAFacetWithJumpsBetween) {
    const ReadSurface surface = written(std::string("[surface]\nfacets = 3\n") + kSurfaceGrid);
    EXPECT_EQ(surface.facet, (std::vector<int>{3, 0, 1, 2, 3}));
    Scene scene = bump(600 * kMil, 3);
    const OwnedLaw<double> law(scene);
    const std::vector<double> ends{-20e-3,     -kHalfWidth, law.tables.facet_vertices[1], law.tables.facet_vertices[2],
                                   kHalfWidth, 18e-3};
    std::set<double> forces;
    for (std::size_t cell = 0; cell < 5; ++cell) {
        const std::vector<std::size_t>& corners = surface.cells[cell];
        ASSERT_EQ(corners.size(), 4u);
        const double middle = (ends[cell] + ends[cell + 1]) / 2;
        for (std::size_t i = 0; i < 4; ++i) {
            const Point& at = surface.points[corners[i]];
            EXPECT_NEAR(at.x, ends[cell + (i == 1 || i == 2)], 1e-8);
            EXPECT_NEAR(at.y, i < 2 ? -3e-3 : 5e-3, 1e-9) << "counterclockwise seen from above";
            EXPECT_NEAR(law(middle, 0, -1).proxy.z - at.z,
                        (surface.points[corners[1]].z - surface.points[corners[0]].z) * (middle - at.x) /
                            (ends[cell + 1] - ends[cell]),
                        1e-8);
            const Point expected = law(middle, 0, law(middle, 0, -1).proxy.z - 1e-3).force;
            EXPECT_LT(distance(surface.force[corners[i]], expected), 2e-6) << cell;
            EXPECT_EQ(surface.turn[corners[i]], 0);
        }
        forces.insert(std::round(1e4 * surface.force[corners[0]].x));
    }
    EXPECT_EQ(forces.size(), 3u) << "left, none, right";
}

// The paper's bump of one facet: flat, and nothing but the force's direction tells of the cylinder.
TEST_F(SurfaceFile, OfAShadedBumpTurnsWithinItsFacets) {
    for (const int facets : {1, 2}) {
        const ReadSurface surface =
            written(fmt::format("[surface]\nfacets = {}\nradius = \"600 mil\"\n[force]\nshading = \"reference\"\n{}",
                                facets, kSurfaceGrid));
        EXPECT_GT(surface.cells.size(), 15u);
        double largest = 0;
        for (std::size_t point = 0; point < surface.points.size(); ++point) {
            const double x = surface.points[point].x;
            const bool beside = std::size_t(surface.facet[surface.cell_of(point)]) == std::size_t(facets);
            const double sine = beside ? 0 : x / (600 * kMil), cosine = std::sqrt(1 - sine * sine);
            EXPECT_LT(distance(surface.force[point], Point(sine, 0, cosine)), 3e-6) << x;
            const double slope = std::atan2(surface.unshaded[point].x, surface.unshaded[point].z);
            EXPECT_NEAR(surface.turn[point], std::abs(std::asin(sine) - slope) * kDegreesOfRadian, 1e-3) << x;
            largest = std::max(largest, surface.turn[point]);
        }
        const double edge = std::asin(500.0 / 600);
        EXPECT_NEAR(largest, (facets == 1 ? edge : edge / 2) * kDegreesOfRadian, 0.01);
    }
}

TEST_F(SurfaceFile, OfManyFacetsIsKeptSmall) {
    const ReadSurface surface =
        written(std::string("[surface]\nfacets = 1000000\n[force]\nshading = \"reference\"\n") + kSurfaceGrid);
    EXPECT_EQ(surface.cells.size(), 1024u + 4 + 3) << "strips of facets, and the plane cut as the grid is";
    for (std::size_t point = 0; point < surface.points.size(); ++point)
        EXPECT_LT(surface.turn[point], 0.1) << "so many facets are as good as the cylinder";
    std::set<int> facets(surface.facet.begin(), surface.facet.end());
    EXPECT_EQ(facets.size(), 1025u);
    EXPECT_EQ(*facets.rbegin(), 1000000) << "the plane";
}

TEST_F(SurfaceFile, OfACylinderFollowsItAndIsSampledAsTheGridIs) {
    const ReadSurface surface =
        written(std::string("[surface]\nkind = \"cylinder_bump\"\nradius = \"600 mil\"\n") + kSurfaceGrid);
    const OwnedLaw<double> law(cylinder_bump(600 * kMil));
    const double centre = std::sqrt(600.0 * 600 - 500.0 * 500) * kMil;
    EXPECT_GE(surface.cells.size(), 19u);
    std::size_t on_top = 0;
    for (std::size_t point = 0; point < surface.points.size(); ++point) {
        const Point& at = surface.points[point];
        const bool beside = surface.facet[surface.cell_of(point)] == 1;
        EXPECT_NEAR(at.z, beside ? 0 : std::sqrt(std::pow(600 * kMil, 2) - at.x * at.x) - centre, 1e-8);
        EXPECT_LT(distance(surface.force[point], law(at.x, at.y, at.z - 1e-3).force), 1e-4);
        on_top += at.z > 6e-3;
    }
    EXPECT_GT(on_top, 4u);
}

TEST_F(SurfaceFile, OfAHeightMapIsThePlaneSampledAsTheGridIs) {
    const std::string map = "[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"5 mm\"\n"
                            "height = \"1 mm\"\n[force]\nshading = \"height_map\"\n";
    const ReadSurface surface = written(map + kSurfaceGrid);
    ASSERT_EQ(surface.points.size(), 20u * 5);
    ASSERT_EQ(surface.cells.size(), 19u * 4);
    for (std::size_t point = 0; point < surface.points.size(); ++point) {
        const Point& at = surface.points[point];
        EXPECT_NEAR(at.x, -20e-3 + 2e-3 * double(point % 20), 1e-8);
        EXPECT_NEAR(at.y, -3e-3 + 2e-3 * double(point / 20), 1e-8);
        EXPECT_EQ(at.z, 0);
        const double steep = 2e-3 * std::exp(-(at.x * at.x + at.y * at.y) / 25e-6) / 25e-6; // -dU/dx / x
        const Point normal(steep * at.x, steep * at.y, 1);
        EXPECT_LT(distance(surface.force[point], normal / distance(normal, Point(0))), 1e-5);
        EXPECT_EQ(surface.unshaded[point], Point(0, 0, 1));
    }
    const ReadSurface large = written(map + "[grid]\nsize = [2000, 700, 2]\nspacing = \"0.01 mm\"\n");
    EXPECT_EQ(large.points.size(), 513u * 513);
    const ReadSurface lone = written(map + "[grid]\nsize = [1, 1, 1]\norigin = [\"1 mm\", \"2 mm\", \"0 mm\"]\n"
                                           "spacing = \"1 mm\"\n");
    ASSERT_EQ(lone.cells.size(), 1u);
    EXPECT_NEAR(distance(lone.points[0], Point(0.5e-3, 1.5e-3, 0)), 0, 1e-9) << "a cell of the grid";
}

TEST_F(SurfaceFile, IsCutAlongYWhereATextureIs) {
    const ReadSurface surface =
        written(std::string("[surface]\nfacets = 1\n[texture]\nstiffness = \"1 N/mm\"\nfunction = \"gaussian\"\n"
                            "radius = \"5 mm\"\nheight = \"1 mm\"\n") +
                kSurfaceGrid);
    std::set<double> rows;
    for (const Point& at : surface.points)
        rows.insert(at.y);
    EXPECT_EQ(rows.size(), 5u);
    bool pulls = false;
    for (const Point& force : surface.force)
        pulls = pulls || std::abs(force.y) > 0.1;
    EXPECT_TRUE(pulls);
}

// A grid of 100 x 100 squares as a scanner's program would write it.
TEST_F(SurfaceFile, OfAMeshIsForecastFromItsFile) {
    std::string text = "OFF\n10201 10000 0\n";
    for (int i = 0; i < 10201; ++i)
        text += fmt::format("{:.6f} {:.6f} {:.6f}\n", i % 101 * 0.1, i / 101 * 0.1, std::sin(i * 0.1) * 0.01);
    for (int i = 0; i < 100; ++i)
        for (int j = 0; j < 100; ++j)
            text += fmt::format("4 {} {} {} {}\n", 101 * i + j, 101 * i + j + 1, 101 * i + j + 102, 101 * i + j + 101);
    folder_.write("grid.off", text);
    const PreparedCase prepared = prepare(mesh("grid.off", ""));
    const double guess = most_surface_bytes(prepared.one.scene);
    const ReadSurface surface = written(prepared);
    EXPECT_LE(surface.raw_bytes, guess);
    EXPECT_GE(surface.raw_bytes, guess / 10);
}

TEST_F(SurfaceFile, OfANarrowBumpOrAThinMeshIsPressedLess) {
    PreparedCase prepared;
    prepared.one.scene = bump(60 * kMil, 1);
    EXPECT_EQ(pressed_depth(prepared), 1e-3);
    prepared.one.scene.surface.width = 1e-4;
    EXPECT_EQ(pressed_depth(prepared), 5e-6);
    folder_.write("plate.off", "OFF\n4 4 0\n-1 -1 0\n1 -1 0\n0 1 0\n0 0 0.06\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    EXPECT_NEAR(pressed_depth(prepare(mesh("plate.off", ""))), 3e-5, 1e-12) << "0.6 mm thick";
}

} // namespace
} // namespace forceshade::test
