// Scenes with a mesh, with exploration paths and a hand: keys, defaults, spreads, refusals, sweeps.
#include <gtest/gtest.h>

#include "host/scene/study.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {
using test::expect_places;
using test::study_error;
using testing::says;

PathsSpec paths_of(const std::string& keys) {
    return parse_scene("[paths]\n" + keys, "f.toml").scene.paths.value();
}

TEST(PathScene, OnlyWithItsTable) {
    EXPECT_FALSE(parse_scene("", "f.toml").scene.paths);
    for (const char* table : {"paths", "hand"})
        EXPECT_FALSE(says(resolved_toml(parse_scene("", "f.toml")), table));
    EXPECT_EQ(paths_of(""), PathsSpec{});
    EXPECT_FALSE(paths_of("").closed());
}

TEST(PathScene, Keys) {
    const PathsSpec paths = paths_of(R"(kind = "raster"
count = 3
steps = 4
rate = "10 kHz"
seed = 0
speed = { mean = "100 mm/s", sd = "20 mm/s" }
press = "2 N"
heading = { min = "-90 deg", max = "90 deg" }
offset = "1 mm"
tremor = { amplitude = { mean = "0.1 mm", sd = "0.05 mm" }, frequency = "9 Hz" }
centre = ["1 mm", "2 mm"]
height = "3 mm"
length = "40 mm"
width = "20 mm"
lines = 5
start_depth = "1 mm"
bound = "1 m"
)");
    EXPECT_EQ(paths.kind, PathKind::raster);
    EXPECT_EQ(paths.seed, 0u);
    EXPECT_EQ(paths.rate, 10000);
    EXPECT_EQ(paths.speed, (Spread{Spread::Shape::normal, 0.1, 0.02, 0, 0}));
    EXPECT_EQ(paths.heading.shape, Spread::Shape::uniform);
    EXPECT_EQ(paths.heading.low, -paths.heading.high);
    EXPECT_EQ(paths.tremor_amplitude.sd, 5e-5);
    EXPECT_EQ(paths.tremor_frequency, 9);
    EXPECT_EQ(paths.press, 2);
    EXPECT_TRUE(paths.closed());
    EXPECT_EQ(*paths.centre, (std::array<double, 2>{0.001, 0.002}));
}

TEST(PathScene, ForcesCloseTheLoopAndReplaceTheDepth) {
    EXPECT_TRUE(paths_of("push = [\"1 N\", \"0 N\", \"-1 N\"]\n").closed());
    EXPECT_TRUE(paths_of("loop = \"closed\"\n").closed());
    EXPECT_EQ(study_error("[paths]\nspeed = \"1 m/s\"\nspeed.min = \"1 m/s\"\n").substr(0, 9), "f.toml:3:");
    expect_places({
        {"[paths]\npress = \"1 N\"\ndepth = \"1 mm\"\n", "3:1"},
        {"[paths]\nspeed = { mean = \"1 m/s\", max = \"1 m/s\" }\n", "2:27"},
        {"[paths]\nloop = \"open\"\npress = \"1 N\"\n", "3:9"},
        {"[paths]\nkind = \"taps\"\npress = \"1 N\"\n", "3:9"},
    });
}

TEST(PathScene, Refusals) {
    expect_places({
        {"[paths]\ncuont = 2\n", "2:1"},
        {"[hand]\nmas = \"1 kg\"\n", "2:1"},
        {"[paths]\nspeed = { men = \"1 m/s\", sd = \"0 m/s\" }\n", "2:11"},
        {"[paths]\nspeed = { mean = \"1 m/s\" }\n", "2:18"},
        {"[paths]\ndepth = { min = \"3 mm\", max = \"1 mm\" }\n", "2:17"},
        {"[paths]\nspeed = \"0 m/s\"\n", "2:9"},
        {"[paths]\nspeed = \"1 m\"\n", "2:9"},
        {"[paths]\nlines = 4\n", "2:1"},
        {"[paths]\nbound = \"1 m\"\n", "2:1"},
        {"[paths]\nkind = \"recorded\"\n", "2:8"},
        {"[paths]\ntremor = \"1 mm\"\n", "2:1"},
        {"[paths]\nspeed = {}\n", "2:1"},
        {"[paths]\npress = \"1 N\"\n[hand]\ndelay_samples = 2\n", "4:17"},
        {"[surface]\nkind = \"height_map\"\n[paths]\nfollow = \"surface\"\n", "4:10"},
        {"[paths]\nlength = \"1e16 m\"\n", "2:10"},
    });
}

TEST(PathScene, HandIsForClosedLoops) {
    const std::string hand = "[hand]\nmass = \"75 g\"\n";
    EXPECT_EQ(parse_scene(hand, "f.toml").scene.hand.mass, 0.075); // for a live loop
    EXPECT_EQ(parse_scene("[paths]\npress = \"1 N\"\n" + hand, "f.toml").scene.hand.mass, 0.075);
    const Study open = parse_study("[paths]\n" + hand, "f.toml");
    EXPECT_EQ(open.cases.front().scene.hand, HandSpec{});
    ASSERT_EQ(open.warnings.size(), 1u);
    EXPECT_EQ(open.warnings.front(),
              "f.toml:3:1: \"mass\" does not apply to an open loop; it applies to a closed loop");
}

TEST(PathScene, SweepsOverPathsAndHand) {
    const Study study = parse_study("[paths]\nspeed = [\"10 mm/s\", \"1 cm/s\", \"20 mm/s\"]\npress = \"1 N\"\n"
                                    "heading = { mean = \"0 deg\", sd = [\"1 deg\", \"2 deg\"] }\nwidth = \"1 mm\"\n"
                                    "kind = [\"raster\", \"random_walk\"]\n"
                                    "[hand]\ndelay_samples = [0, 1]\n",
                                    "f.toml");
    // 10 mm/s is 1 cm/s, and a random walk has no heading.
    EXPECT_EQ(study.cases.size(), 2u * 2u * (2u + 1u));
    EXPECT_EQ(study.cases.front().name, "bump_speed-10mm-s_heading.sd-1deg_paths.kind-raster_delay_samples-0");
    const Study again = parse_study(resolved_toml(study), "f.toml");
    ASSERT_EQ(again.cases.size(), study.cases.size());
    for (std::size_t i = 0; i < study.cases.size(); ++i) {
        EXPECT_EQ(again.cases[i].name, study.cases[i].name);
        EXPECT_EQ(again.cases[i].scene, study.cases[i].scene);
        EXPECT_EQ(parse_scene(resolved_toml(study.cases[i]), "f.toml").scene, study.cases[i].scene);
    }
}

TEST(PathScene, VariantsMayDriveOtherwise) {
    const Study study = parse_study("[paths]\ndepth = { min = \"1 mm\", max = \"2 mm\" }\n[[variant]]\n[[variant]]\n"
                                    "paths.press = \"1 N\"\n[[variant]]\npaths.depth = \"1 mm\"\n",
                                    "f.toml");
    ASSERT_EQ(study.cases.size(), 3u);
    EXPECT_EQ(study.cases[0].scene.paths->depth.high, 0.002);
    EXPECT_EQ(study.cases[1].scene.paths->drive, PathDrive::press);
    EXPECT_EQ(study.cases[2].scene.paths->depth, fixed_spread(0.001));
    const Study again = parse_study(resolved_toml(study), "f.toml");
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(again.cases[i].scene, study.cases[i].scene);
    const std::vector<Override> overrides{{"paths.depth", "3 mm"}};
    for (const Case& one : parse_study("[paths]\npress = \"1 N\"\n", "f.toml", {}, overrides).cases)
        EXPECT_EQ(one.scene.paths->depth, fixed_spread(0.003));
}

constexpr const char* kScene = R"([surface]
kind = "mesh"
file = "spot.obj"
unit = "mm"
normals = "angle"
inside = "winding"
transform = { scale = 0.05, rotate = ["90 deg", "0 deg", "0 deg"], translate = ["1 mm", "0 m", "0 m"] }
[force]
shading = "mean_value"
)";

const std::string kGrid = "[grid]\nsize = [4, 5, 6]\norigin = [\"0 m\", \"0 m\", \"0 m\"]\nspacing = \"1 mm\"\n";

TEST(MeshScene, Keys) {
    const Case one = parse_scene(kScene, "f.toml", "/folder");
    const MeshSpec& mesh = one.scene.surface.mesh;
    EXPECT_EQ(one.scene.surface.kind, SurfaceKind::mesh);
    EXPECT_EQ(mesh.file, "spot.obj");
    EXPECT_EQ(mesh.path, "/folder/spot.obj");
    EXPECT_EQ(mesh.unit, 0.001);
    EXPECT_EQ(mesh.normals, NormalWeights::angle);
    EXPECT_EQ(mesh.inside, InsideTest::winding);
    EXPECT_EQ(mesh.scale, 0.05);
    EXPECT_NEAR(mesh.rotate[0], 1.5707963267948966, 1e-15);
    EXPECT_EQ(mesh.translate[0], 0.001);
    EXPECT_EQ(one.scene.force.shading, Shading::mean_value);
    EXPECT_TRUE(parse_scene(resolved_toml(one), "f.toml", "/folder").scene == one.scene);
}

TEST(MeshScene, GridFollowsFromTheMeshUnlessItIsGiven) {
    EXPECT_EQ(parse_scene(kScene, "f.toml").scene.grid.samples, 128u);
    EXPECT_EQ(parse_scene(std::string(kScene) + "[grid]\nsamples = 9\n", "f.toml").scene.grid.samples, 9u);
    const Case given = parse_scene(std::string(kScene) + kGrid, "f.toml");
    EXPECT_EQ(given.scene.grid.samples, 0u);
    EXPECT_EQ(given.scene.grid.size[1], 5u);
    EXPECT_EQ(parse_scene("", "f.toml").scene.grid.samples, 0u);
    const Case later = parse_scene(std::string(kScene) + kGrid + "[[variant]]\ngrid.samples = 7\n", "f.toml");
    EXPECT_EQ(later.scene.grid.samples, 7u);
}

TEST(MeshScene, Refusals) {
    const std::string start = "[surface]\nkind = \"mesh\"\n";
    expect_places({{start, "2:8"}});
    const std::string mesh = start + "file = \"a.obj\"\n";
    expect_places({
        {mesh + "unit = \"kg\"\n", "4:8"},
        {mesh + "unit = 1\n", "4:8"},
        {mesh + "transform = { scale = \"2\" }\n", "4:23"},
        {mesh + "transform = { scale = -1 }\n", "4:23"},
        {mesh + "transform = { turn = 1 }\n", "4:15"},
        {mesh + "[force]\nshading = \"reference\"\n", "5:11"},
        {"[texture]\neffect = \"normal\"\n", "2:10"},
        {mesh + "transform = 3\n", "4:1"},
        {mesh + "[grid]\nsize = [1, 2, 3]\n", "5:9"},
        {mesh + kGrid + "samples = 3\n", "5:1"},
        {"[surface]\nunit = \"mm\"\n", "2:1"},
    });
}

} // namespace
} // namespace forceshade
