// The library for programs of one's own: why there is a force or none, meshes from arrays, poses, batches, states of
// probes, errors, the critical stiffness.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/paths/sampled_plants.h"

// After what has names of the library's own, which would be ambiguous below it.
#include "host/library/forceshade.hpp"

namespace {

using forceshade::testing::kPlants;
using forceshade::testing::Plant;
using forceshade::testing::says;

using namespace forceshade::v0; // not the library's own names, which shapes.h has
namespace shapes = forceshade::shapes;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Mesh arrays_of(const forceshade::PolygonSoup& soup) {
    Mesh mesh;
    for (const glm::dvec3& vertex : soup.vertices)
        mesh.vertices.push_back({vertex.x, vertex.y, vertex.z});
    for (std::size_t facet = 0; facet < soup.facets(); ++facet) {
        mesh.corners.insert(mesh.corners.end(), soup.outline(facet).begin(), soup.outline(facet).end());
        mesh.corner_counts.push_back(static_cast<int>(soup.corners_of(facet)));
    }
    return mesh;
}

const char* const kMesh = "[surface]\nkind = \"mesh\"\nunit = \"cm\"\n[force]\nshading = \"mean_value\"\n";

/// About a sphere of 1 cm, some of them in it.
Vector place_near_sphere(int i) {
    return {0.012 * std::sin(i), 0.012 * std::sin(1.7 * i), 0.012 * std::cos(2.3 * i)};
}

template <typename Make> std::string refusal(const Make& make, fs_error code = FS_SCENE) {
    try {
        make();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        return error.what();
    }
    return "";
}

std::string refusal(const Mesh& mesh, const std::string& text = kMesh) {
    return refusal([&] { Scene::parse(text, mesh); });
}

void expect_same(const Touch& one, const Touch& other) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(one.force[i], other.force[i]);
        EXPECT_EQ(one.proxy[i], other.proxy[i]);
    }
    EXPECT_EQ(one.depth, other.depth);
    EXPECT_EQ(one.facet, other.facet);
    EXPECT_EQ(one.status, other.status);
}

TEST(Library, HasTheVersionOfItsHeader) {
    EXPECT_EQ(fs_version(),
              FORCESHADE_VERSION_MAJOR * 10000 + FORCESHADE_VERSION_MINOR * 100 + FORCESHADE_VERSION_PATCH);
}

TEST(Library, TellsWhyThereIsNoForce) {
    for (const std::string precision : {"f32", "f64"}) {
        const Scene scene = Scene::parse(kMesh, arrays_of(shapes::icosphere(1)), "run.precision = " + precision);
        Probe probe(scene);
        for (const auto& [place, status] : {std::pair<Vector, fs_status>({0.05, 0, 0}, FS_FREE),
                                            {{0.009, 0, 0}, FS_TOUCHING},
                                            {{1e300, 0, 0}, FS_OUT_OF_RANGE},
                                            {{0, kNan, 0}, FS_NOT_A_NUMBER},
                                            {{0, 0, -kInfinity}, FS_NOT_A_NUMBER}}) {
            EXPECT_EQ(scene.at(place).status, status) << place[0];
            EXPECT_EQ(probe.step(place).status, status) << place[0];
            EXPECT_EQ(scene.at(place).facet >= 0, status == FS_TOUCHING);
        }
    }
}

TEST(Library, ForcesDoNotDependOnHowVerticesAreGiven) {
    const Mesh sphere = arrays_of(shapes::icosphere(1));
    Mesh triangles = sphere;
    triangles.corner_counts.clear();
    const Scene joined = Scene::parse(kMesh, sphere),
                given_apart = Scene::parse(kMesh, arrays_of(shapes::split(shapes::icosphere(1)))),
                without_counts = Scene::parse(kMesh, triangles);
    int touched = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vector place = place_near_sphere(i);
        expect_same(joined.at(place), given_apart.at(place));
        expect_same(joined.at(place), without_counts.at(place));
        touched += joined.at(place).status == FS_TOUCHING;
    }
    EXPECT_GT(touched, 50);
}

TEST(Library, TheLawOfAMeshIsThatOfTheScenesKeys) {
    const Mesh sphere = arrays_of(shapes::icosphere(1));
    EXPECT_STREQ(Scene(sphere).toml(),
                 Scene::parse("[surface]\nkind = \"mesh\"\n", sphere, "force.stiffness = 1000 N/m").toml());
    Law law;
    law.stiffness = 123.456;
    law.shading = FS_SHADING_TWO_PASS;
    law.precision = FS_F64;
    law.weld = 1e-6;
    law.orientation = FS_ORIENT_OUTWARD;
    EXPECT_STREQ(Scene(sphere, law).toml(),
                 Scene::parse("[surface]\nkind = \"mesh\"\nweld = \"1e-06 m\"\norient = \"outward\"\n[force]\n"
                              "stiffness = \"123.456 N/m\"\nshading = \"two_pass\"\n[run]\nprecision = \"f64\"\n",
                              sphere)
                     .toml());
}

TEST(Library, ManyPlacesAtOnceMeetWhatEachMeets) {
    const Scene scene = Scene::parse(kMesh, arrays_of(shapes::icosphere(2)));
    std::vector<Vector> places;
    for (int i = 0; i < 1000; ++i)
        places.push_back(place_near_sphere(i));
    places[17][1] = kNan;
    for (const unsigned threads : {0u, 1u, 3u}) {
        const std::vector<Touch> touches = scene.at(places, threads);
        for (std::size_t i = 0; i < places.size(); ++i)
            if (i != 17)
                expect_same(touches[i], scene.at(places[i]));
        EXPECT_EQ(touches[17].status, FS_NOT_A_NUMBER);
    }
    EXPECT_TRUE(scene.at(std::vector<Vector>()).empty());
}

// A quarter turn about z is exact, and so are these sums.
TEST(Library, APoseCarriesTheObject) {
    const Scene still = Scene::parse(kMesh, arrays_of(shapes::icosphere(1)), "run.precision = f64");
    Scene turned = still;
    turned.pose({0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0});
    Probe here(still), there(turned);
    int touched = 0;
    for (int i = 0; i < 200; ++i) {
        const Vector place = place_near_sphere(i), world{-place[1], place[0], place[2]};
        for (const auto& [plain, posed] :
             {std::pair(still.at(place), turned.at(world)), {here.step(place), there.step(world)}}) {
            EXPECT_EQ(posed.status, plain.status);
            EXPECT_EQ(posed.force[0], -plain.force[1]);
            EXPECT_EQ(posed.force[1], plain.force[0]);
            EXPECT_EQ(posed.force[2], plain.force[2]);
            EXPECT_EQ(posed.proxy[0], -plain.proxy[1]);
            EXPECT_EQ(posed.proxy[1], plain.proxy[0]);
            EXPECT_EQ(posed.depth, plain.depth);
            EXPECT_EQ(posed.facet, plain.facet);
            touched += plain.status == FS_TOUCHING;
        }
    }
    EXPECT_GT(touched, 20);
    fs_scene_pose(turned.get(), nullptr, nullptr); // and back
    expect_same(turned.at({0.009, 0, 0}), still.at({0.009, 0, 0}));
}

// The plate is thinner than it moves: without a history the probe would be in front of the other side.
TEST(Library, AnObjectThatMovesTakesItsProbesAlong) {
    Mesh plate;
    plate.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    plate.corners = {0, 1, 2, 3};
    plate.corner_counts = {4};
    Scene scene = Scene::parse(kMesh, plate, "run.precision = f64");
    Probe probe(scene);
    for (int step = 0; step <= 10; ++step) {
        const double height = 0.001 * step - 0.005; // m
        scene.pose({1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.3, 0, height});
        const Touch touch = probe.step({0.3, 0, 0.0001});
        EXPECT_NEAR(touch.force[2], 1000 * std::max(0.0, height - 0.0001), 1e-4) << step;
    }
}

TEST(Library, RefusesAPoseThatIsNone) {
    Scene scene = Scene::parse(kMesh, arrays_of(shapes::icosphere(1)));
    const Touch before = scene.at({0.009, 0, 0});
    const auto pose = [&](const std::array<double, 9>& rotation, const Vector& translation) {
        return refusal([&] { scene.pose(rotation, translation); }, FS_ARGUMENT);
    };
    EXPECT_TRUE(says(pose({1, 0, 0, 0, 1.1, 0, 0, 0, 1}, {}), "orthonormal"));
    EXPECT_TRUE(says(pose({1, 0, 0, 0, 1, 0, 0, 0, kNan}, {}), "orthonormal"));
    EXPECT_TRUE(says(pose({1, 0, 0, 0, 1, 0, 0, 0, -1}, {}), "mirror"));
    EXPECT_TRUE(says(pose({1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, kInfinity, 0}), "finite"));
    expect_same(scene.at({0.009, 0, 0}), before);
}

TEST(Library, AProbeGoesOnFromItsState) {
    for (const std::string precision : {"f32", "f64"}) {
        const Scene scene = Scene::parse(kMesh, arrays_of(shapes::icosphere(2)), "run.precision = " + precision);
        Probe probe(scene), other(scene);
        EXPECT_EQ(probe.state().begun, 0u);
        int touched = 0;
        for (int i = 0; i < 300; ++i) {
            const double angle = 0.05 * i, radius = 0.0105 - 0.002 * std::abs(std::sin(0.3 * i));
            const Vector place{radius * std::cos(angle), radius * std::sin(angle), 0.001 * std::sin(1.3 * angle)};
            other.step(place_near_sphere(i)); // another history
            other.set_state(probe.state());
            const Touch touch = probe.step(place);
            expect_same(touch, other.step(place));
            touched += touch.status == FS_TOUCHING;
        }
        EXPECT_GT(touched, 100);
    }
}

TEST(Library, RefusesAStateThatNoProbeHas) {
    const Scene scene = Scene::parse(kMesh, arrays_of(shapes::icosphere(1)), "run.precision = f64"),
                another = Scene::parse(kMesh, arrays_of(shapes::cube()));
    Probe probe(scene);
    probe.step({0.02, 0, 0});
    probe.step({0.009, 0, 0});
    const ProbeState good = probe.state();
    EXPECT_EQ(good.begun, 1u);
    EXPECT_GE(good.count, 1u);
    EXPECT_TRUE(says(refusal([&] { Probe(another).set_state(good); }, FS_ARGUMENT), "another scene"));
    for (const auto& spoil : std::initializer_list<void (*)(ProbeState&)>{
             [](ProbeState& state) { state.triangles[0] = 80; }, [](ProbeState& state) { state.count = 4; },
             [](ProbeState& state) { state.proxy[2] = kNan; }, [](ProbeState& state) { state.proxy[0] = 1e20; },
             [](ProbeState& state) { state.begun = 2; }, [](ProbeState& state) { state.cornered = 7; }}) {
        ProbeState bad = good;
        spoil(bad);
        EXPECT_NE(refusal([&] { probe.set_state(bad); }, FS_ARGUMENT), "");
    }
    Probe other(scene);
    other.set_state(good);
    expect_same(other.step({0.008, 0.001, 0}), probe.step({0.008, 0.001, 0}));
    probe.reset();
    EXPECT_EQ(probe.state().begun, 0u);
}

TEST(Library, SaysWhatIsWrongWithAMesh) {
    EXPECT_STREQ(Scene::parse(kMesh, arrays_of(shapes::cube())).warnings(), "");
    const std::string open = Scene::parse(kMesh, arrays_of(shapes::open_cube())).warnings();
    EXPECT_TRUE(says(("\n" + open), "\nmesh: 4 boundary edges along 1 hole or rim"));
    Mesh short_faces = arrays_of(shapes::cube());
    short_faces.corners.insert(short_faces.corners.end(), {0, 1});
    short_faces.corner_counts.push_back(2);
    EXPECT_STREQ(Scene::parse(kMesh, short_faces).warnings(), "mesh: 1 face of two corners: skipped (at facet 6)");
    Mesh turned;
    turned.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    turned.corners = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    const std::string warnings = Scene::parse(kMesh, turned).warnings();
    EXPECT_EQ(std::ranges::count(warnings, '\n'), 1); // and that the winding number is taken
    EXPECT_EQ(Scene::parse(kMesh, turned, "surface.orient = outward").at({0.001, 0.001, 0.001}).status, FS_TOUCHING);
}

TEST(Library, RefusesWhatIsNoMesh) {
    Mesh cube = arrays_of(shapes::cube());
    cube.corners[9] = 8;
    EXPECT_TRUE(says(refusal(cube), "mesh: facet 2 has the vertex 8"));
    cube.corners[9] = -1;
    EXPECT_TRUE(says(refusal(cube), "the vertex -1"));
    cube = arrays_of(shapes::cube());
    cube.vertices[3][1] = kNan;
    EXPECT_TRUE(says(refusal(cube), "vertex 4 of 8"));
    for (const char* kind : {"bump", "height_map"})
        EXPECT_NE(refusal(arrays_of(shapes::cube()), "[surface]\nkind = \"" + std::string(kind) + "\"\n"), "") << kind;
    EXPECT_TRUE(says(refusal(Mesh()), "no facets"));
    EXPECT_TRUE(says(refusal(arrays_of(shapes::cube()), "[surface]\nkind = \"mesh\"\nnormals = \"file\"\n"),
                     "has no vertex normals"));
    cube = arrays_of(shapes::cube());
    cube.corner_counts.back() = 5;
    EXPECT_THROW(Scene{cube}, std::invalid_argument);
}

TEST(Library, RefusesArgumentsThatAreNone) {
    EXPECT_EQ(fs_scene_from_toml(nullptr, nullptr, nullptr), nullptr);
    EXPECT_EQ(fs_last_error_code(), FS_ARGUMENT);
    EXPECT_STREQ(fs_last_error(), "text is NULL");
    EXPECT_EQ(fs_scene_from_mesh(nullptr, 3, nullptr, nullptr, 1, nullptr), nullptr);
    EXPECT_STREQ(fs_last_error(), "vertices is NULL");
    const double vertices[9]{};
    const int counts[] = {-3};
    EXPECT_EQ(fs_scene_from_mesh(vertices, 3, counts, counts, 1, nullptr), nullptr);
    EXPECT_STREQ(fs_last_error(), "facet 0 has -3 corners");
    EXPECT_EQ(fs_probe_new(nullptr), nullptr);
    EXPECT_EQ(fs_scene_copy(nullptr), nullptr);
    fs_scene_free(nullptr);
    fs_probe_free(nullptr);
    const Mesh cube = arrays_of(shapes::cube());
    Law law;
    law.shading = static_cast<fs_shading>(5);
    EXPECT_NE(refusal([&] { Scene(cube, law); }, FS_ARGUMENT), "");
    law = Law();
    law.stiffness = kNan;
    EXPECT_NE(refusal([&] { Scene(cube, law); }, FS_ARGUMENT), "");
    law.stiffness = -1;
    EXPECT_TRUE(says(refusal([&] { Scene(cube, law); }), "stiffness"));
    law = Law();
    law.shading = FS_SHADING_BARYCENTRIC;
    EXPECT_TRUE(says(refusal([&] { Scene(cube, law); }), "mean_value"));
    EXPECT_TRUE(says(refusal([&] { Scene::parse(kMesh, cube, "run.precision"); }, FS_ARGUMENT), "a key and a value"));
    EXPECT_TRUE(says(refusal([] { Scene("no such.toml"); }, FS_FILE), "no such.toml"));
}

TEST(Library, CriticalStiffnessIsThatOfTheClosedForms) {
    for (const Plant& plant : kPlants) {
        EXPECT_NEAR(critical_stiffness(plant.mass, plant.damping, plant.period), plant.limit, 0.006);
        EXPECT_NEAR(critical_stiffness(plant.mass, plant.damping, plant.period, 1), plant.limit_late, 0.006);
    }
    EXPECT_NEAR(critical_stiffness(0.1, 1e-6, 1e-3), 2e-3, 1e-10); // 2 b / T
    EXPECT_TRUE(std::isnan(critical_stiffness(0, 1, 1e-3)));
    EXPECT_TRUE(std::isnan(critical_stiffness(0.1, 0, 1e-3)));
    EXPECT_TRUE(std::isnan(critical_stiffness(0.1, 1, -1e-3)));
    EXPECT_TRUE(std::isnan(critical_stiffness(kNan, 1, 1e-3)));
    EXPECT_TRUE(std::isnan(critical_stiffness(0.1, 1, 1e-3, 1000001)));
}

// The loop itself, stepped: it dies out below and grows above.
TEST(Library, AWallIsStableUpToTheCriticalStiffness) {
    const double mass = 0.1, damping = 2, period = 1e-3;
    const double e = damping * period / mass, decay = std::exp(-e);
    const double q = mass / damping * (1 - decay), p = (period - q) / damping, r = (1 - decay) / damping;
    for (const unsigned delay : {0u, 1u, 2u, 5u, 20u})
        for (const double share : {0.99, 1.01}) {
            const double stiffness = share * critical_stiffness(mass, damping, period, delay);
            std::vector<double> forces(delay, 0);
            double place = 1e-6, speed = 0, early = 0, late = 0; // m, m/s
            for (int step = 0; step < 40000; ++step) {
                forces.push_back(-stiffness * place);
                const double force = forces.front();
                forces.erase(forces.begin());
                place += q * speed + p * force;
                speed = decay * speed + r * force;
                (step < 20000 ? early : late) = std::max(step < 20000 ? early : late, std::abs(place));
            }
            EXPECT_EQ(late < early, share < 1) << delay << " " << share;
        }
}

} // namespace
