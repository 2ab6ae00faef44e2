// The library for programs of one's own: why there is a force or none, meshes from arrays, and what is said of them.
#include "host/library/forceshade.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"

namespace forceshade::oracle {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Mesh arrays_of(const PolygonSoup& soup) {
    Mesh mesh;
    for (const glm::dvec3& vertex : soup.vertices)
        mesh.vertices.push_back({vertex.x, vertex.y, vertex.z});
    for (std::size_t facet = 0; facet < soup.facets(); ++facet)
        mesh.facets.emplace_back(soup.outline(facet).begin(), soup.outline(facet).end());
    return mesh;
}

/// A vertex for each corner.
Mesh split(const Mesh& mesh) {
    Mesh result;
    for (const std::vector<int>& facet : mesh.facets) {
        result.facets.emplace_back();
        for (const int corner : facet) {
            result.facets.back().push_back(static_cast<int>(result.vertices.size()));
            result.vertices.push_back(mesh.vertices[static_cast<std::size_t>(corner)]);
        }
    }
    return result;
}

const char* const kMesh = "[surface]\nkind = \"mesh\"\nunit = \"cm\"\n[force]\nshading = \"mean_value\"\n";

std::string refusal(const Mesh& mesh, const std::string& text = kMesh) {
    try {
        Scene::parse(text, mesh);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "";
}

TEST(Library, TellsWhyThereIsNoForce) {
    for (const char* precision : {"f32", "f64"}) {
        const Scene scene = Scene::parse(kMesh, arrays_of(shapes::icosphere(1)), {{"run.precision", precision}});
        Probe probe(scene);
        for (const auto& [place, status] : {std::pair<Place, Status>({0.05, 0, 0}, Status::free),
                                            {{0.009, 0, 0}, Status::touching},
                                            {{1e300, 0, 0}, Status::out_of_range},
                                            {{0, kNan, 0}, Status::not_a_number},
                                            {{0, 0, -kInfinity}, Status::not_a_number}}) {
            EXPECT_EQ(scene.at(place).status, status) << place[0];
            EXPECT_EQ(probe.step(place).status, status) << place[0];
            EXPECT_EQ(scene.at(place).facet >= 0, status == Status::touching);
        }
    }
}

TEST(Library, ForcesDoNotDependOnHowVerticesAreGiven) {
    const Mesh sphere = arrays_of(shapes::icosphere(1));
    const Scene joined = Scene::parse(kMesh, sphere), given_apart = Scene::parse(kMesh, split(sphere));
    int touched = 0;
    for (int i = 0; i < 1000; ++i) {
        const Place place{0.012 * std::sin(i), 0.012 * std::sin(1.7 * i), 0.012 * std::cos(2.3 * i)};
        EXPECT_EQ(joined.at(place).force, given_apart.at(place).force);
        touched += joined.at(place).status == Status::touching;
    }
    EXPECT_GT(touched, 50);
}

TEST(Library, SaysWhatIsWrongWithAMesh) {
    EXPECT_TRUE(Scene::parse(kMesh, arrays_of(shapes::cube())).warnings().empty());
    const std::vector<std::string> open = Scene::parse(kMesh, arrays_of(shapes::open_cube())).warnings();
    EXPECT_TRUE(std::ranges::any_of(
        open, [](const std::string& text) { return text.starts_with("mesh: 4 boundary edges along 1 hole or rim"); }));
    Mesh short_faces = arrays_of(shapes::cube());
    short_faces.facets.push_back({0, 1});
    EXPECT_EQ(Scene::parse(kMesh, short_faces).warnings(),
              std::vector<std::string>{"mesh: 1 face of two corners: skipped (at facet 6)"});
    const Mesh turned{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
    EXPECT_EQ(Scene::parse(kMesh, turned).warnings().size(), 2u); // and that the winding number is taken
    EXPECT_EQ(Scene::parse(kMesh, turned, {{"surface.orient", "outward"}}).at({0.001, 0.001, 0.001}).status,
              Status::touching);
}

TEST(Library, RefusesWhatIsNoMesh) {
    Mesh cube = arrays_of(shapes::cube());
    cube.facets[2][1] = 8;
    EXPECT_NE(refusal(cube).find("mesh: facet 2 has the vertex 8"), std::string::npos) << refusal(cube);
    cube.facets[2][1] = -1;
    EXPECT_NE(refusal(cube).find("the vertex -1"), std::string::npos);
    cube = arrays_of(shapes::cube());
    cube.vertices[3][1] = kNan;
    EXPECT_NE(refusal(cube).find("vertex 4 of 8"), std::string::npos) << refusal(cube);
    for (const char* kind : {"bump", "height_map"})
        EXPECT_NE(refusal(arrays_of(shapes::cube()), "[surface]\nkind = \"" + std::string(kind) + "\"\n"), "") << kind;
    EXPECT_NE(refusal({}).find("no facets"), std::string::npos) << refusal({});
    EXPECT_NE(refusal(arrays_of(shapes::cube()), "[surface]\nkind = \"mesh\"\nnormals = \"file\"\n")
                  .find("has no vertex normals"),
              std::string::npos);
}

} // namespace
} // namespace forceshade::oracle
