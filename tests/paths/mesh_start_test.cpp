// How paths on a mesh begin: outside, inside, on an edge; and paths far beyond the object.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/mesh_file.h"
#include "host/paths/recorded.h"
#include "host/referee/referee.h"
#include "tests/io/folder.h"
#include "tests/paths/explored.h"
#include "tests/places.h"

namespace forceshade {
namespace {

constexpr double kStartStiffness = 1000; // N/m

// A cube of 2 cm whose top is z = 0.
class MeshStart : public ::testing::Test {
protected:
    MeshStart() { folder_.write("cube.obj", kCubeObj); }
    std::string scene(const std::string& keys) const {
        return "[surface]\nkind = \"mesh\"\nfile = \"cube.obj\"\nunit = \"cm\"\n[paths]\n" + keys;
    }
    template <typename T>
    Explored<T> explore(const std::string& keys, const reference::PathOptions& options = {}) const {
        const PreparedCase prepared = prepared_scene(scene(keys), folder_.path());
        ScenePaths<T> source(prepared);
        return explored(source, options);
    }
    std::uint64_t inside(const std::string& keys) const {
        const PreparedCase prepared = prepared_scene(scene(keys), folder_.path());
        ScenePaths<double> source(prepared);
        source.batch(0, 1000);
        source.batch(0, 1000); // counted once
        return source.begins_inside();
    }

    forceshade::testing::Folder folder_;
};

TEST_F(MeshStart, RegionIsTheBoxs) {
    const auto result = explore<double>("count = 1\n");
    EXPECT_NEAR(result.place(0).x, -0.012, 1e-15); // 1.2 times the box, from its middle
    EXPECT_NEAR(result.place(0).z, -0.001, 1e-15); // below its top
}

TEST_F(MeshStart, InsideIsCountedAndFeltFromTheNearestPlace) {
    EXPECT_EQ(inside("count = 1000\n"), 0u); // strokes begin beside the cube
    EXPECT_EQ(inside("count = 1000\nlength = \"1 cm\"\n"), 1000u);
    EXPECT_EQ(inside("count = 1000\nlength = \"1 cm\"\ndepth = \"-1 mm\"\n"), 0u);
    EXPECT_EQ(inside("count = 1000\nlength = \"1 cm\"\ndepth = \"-1 mm\"\nloop = \"closed\"\nstart_depth = \"3 mm\"\n"),
              1000u);
    const auto result = explore<double>("count = 1\nsteps = 2\nlength = \"1 cm\"\ndepth = \"2 mm\"\n");
    EXPECT_NEAR(result.force[0].z, kStartStiffness * 0.002, 1e-6);
    const auto beside = explore<double>("count = 1\nsteps = 2\nlength = \"19 mm\"\ndepth = \"2 mm\"\n");
    EXPECT_NEAR(beside.force[0].x, -kStartStiffness * 0.0005, 1e-6); // the side is nearer
    EXPECT_NEAR(beside.force[0].z, 0, 1e-6);
}

// Half of a uniform spread of depths about the top begins below it.
TEST_F(MeshStart, EachPathByItsOwnPlace) {
    const auto count = inside("count = 1000\nlength = \"1 cm\"\ndepth = { min = \"-1 mm\", max = \"1 mm\" }\n");
    EXPECT_NEAR(static_cast<double>(count), 500, 60);
    const std::string pressed = "count = 100\nsteps = 100\nlength = \"1 cm\"\npress = \"1 N\"\n"
                                "heading = { min = \"0 deg\", max = \"90 deg\" }\n";
    const auto whole = explore<float>(pressed);
    const auto parts = explore<float>(pressed, {.threads = 3, .chunk_bytes = 1000, .batch_paths = 7});
    EXPECT_EQ(whole.position, parts.position);
    EXPECT_EQ(whole.force, parts.force);
}

TEST_F(MeshStart, OnAnEdgeACornerOrTheTop) {
    for (const char* where :
         {"[\"1 cm\", \"0 m\"]", "[\"1 cm\", \"1 cm\"]", "[\"-1 cm\", \"1 cm\"]", "[\"0 m\", \"0 m\"]"})
        for (const char* loop : {"open", "closed"}) {
            const auto result = explore<float>(
                fmt::format("count = 1\nsteps = 200\nlength = \"0 m\"\ndepth = \"0 m\"\ncentre = {}\nloop = \"{}\"\n",
                            where, loop));
            for (const auto& force : result.force)
                EXPECT_LT(std::sqrt(reference::dot(force, force)), 1e-4f) << where << loop;
        }
}

// Where facets face away from each other, in front of one is behind another.
template <typename T> void expect_start_outside(const PreparedCase& prepared) {
    ScenePaths<T> source(prepared, read_recorded<T>(prepared, prepared.one.scene.paths->path));
    const brute::MeshReferee referee(prepared.images.mesh->mesh, {});
    const MeshStructure& structure = prepared.images.mesh->structure;
    const auto batch = source.batch(0, source.input().paths);
    for (std::size_t path = 0; path < batch.count; ++path) {
        const auto& start = batch.proxies[path];
        const glm::dvec3 place = structure.centre + structure.scale * glm::dvec3(start.x, start.y, start.z);
        EXPECT_NEAR(double(referee.winding_number(place)), 0, 1e-6) << path;
    }
}

TEST_F(MeshStart, OutsideOfEveryCornerAndEdgeOfAStar) {
    const PolygonSoup star = read_polygons(in_source("tests/mutation/scenes/star.obj")).polygons;
    std::string rows = "path,t,x,y,z\n";
    std::size_t path = 0;
    const auto begin = [&](const glm::dvec3& at) {
        rows += fmt::format("{},0,{:.9g},{:.9g},{:.9g}\n", path++, 1e-3 * at.x, 1e-3 * at.y, 1e-3 * at.z);
    };
    for (const glm::dvec3& at : star.vertices)
        begin(at);
    for (std::size_t facet = 0; facet < star.facets(); ++facet)
        for (int i = 0; i < 3; ++i)
            begin(0.5 *
                  (star.vertices[star.corners[3 * facet + i]] + star.vertices[star.corners[3 * facet + (i + 1) % 3]]));
    folder_.write("in.csv", rows);
    const PreparedCase prepared =
        prepared_scene("[surface]\nkind = \"mesh\"\nfile = \"" + in_source("tests/mutation/scenes/star.obj") +
                           "\"\nunit = \"mm\"\n[paths]\nkind = \"recorded\"\nfile = \"in.csv\"\n",
                       folder_.path());
    expect_start_outside<double>(prepared);
    expect_start_outside<float>(prepared);
}

TEST_F(MeshStart, DepthsAndSpeedsBeyondReason) {
    for (const char* depth : {"1e-44 m", "1e-300 m", "1 um", "2 cm", "20 cm", "1 km"})
        for (const char* speed : {"1 mm/s", "30 m/s", "1e9 m/s"})
            for (const char* loop : {"open", "closed"}) {
                const std::string keys =
                    fmt::format("count = 8\nsteps = 200\ndepth = \"{}\"\nspeed = \"{}\"\nloop = \"{}\"\n"
                                "heading = {{ min = \"0 deg\", max = \"360 deg\" }}\n",
                                depth, speed, loop);
                EXPECT_TRUE(explore<float>(keys).finite()) << keys;
                EXPECT_TRUE(explore<double>(keys).finite()) << keys;
            }
}

TEST_F(MeshStart, FurtherThanAFloatCanFollow) {
    EXPECT_THROW(explore<float>("depth = \"100 km\"\n"), UsageError);
    EXPECT_THROW(explore<float>("press = \"1 N\"\nbound = \"100 km\"\n"), UsageError);
    EXPECT_NO_THROW(explore<double>("count = 1\nsteps = 1\ndepth = \"100 km\"\n"));
}

// The cube stands on a corner, so that its surface is three slopes.
template <typename T> void expect_followed(const PreparedCase& prepared, double height) {
    ScenePaths<T> source(prepared);
    const MeshStructure& mesh = prepared.images.mesh->structure;
    const Explored<T> result = explored(source);
    std::size_t followed = 0;
    for (std::size_t i = 0; i < result.position.size(); ++i) {
        const reference::Vector<T>& place = result.position[i];
        const std::optional<double> top = height_at(mesh, double(place.x), double(place.y));
        ASSERT_NEAR(double(place.z), top.value_or(height) - 0.002, 1e-7) << i;
        followed += top.has_value();
    }
    EXPECT_GT(followed, result.position.size() / 2);
    // A batch at a time, and whatever the steps that are asked for at once.
    const Explored<T> again = explored(source, {.threads = 1, .chunk_bytes = 4096});
    EXPECT_EQ(again.position, result.position);
    EXPECT_EQ(again.force, result.force);
}

TEST_F(MeshStart, PathsFollowTheSurfaceAtTheirDepth) {
    const std::string turned = "transform.rotate = [\"45 deg\", \"35.26 deg\", \"0 deg\"]\n[paths]\nfollow = "
                               "\"surface\"\ndepth = \"2 mm\"\ncount = 7\nsteps = 400\n";
    for (const std::string& keys :
         {std::string("heading = { mean = \"90 deg\", sd = \"50 deg\" }\n"), std::string("length = \"60 mm\"\n"),
          std::string("kind = \"circle\"\nlength = \"5 mm\"\n"), std::string("kind = \"random_walk\"\n")}) {
        std::string text = scene(keys);
        text.replace(text.find("[paths]\n"), 8, turned);
        const PreparedCase prepared = prepared_scene(text, folder_.path());
        const double height = path_region(*prepared.one.scene.paths, prepared).height;
        expect_followed<double>(prepared, height);
        expect_followed<float>(prepared, height);
    }
}

} // namespace
} // namespace forceshade
