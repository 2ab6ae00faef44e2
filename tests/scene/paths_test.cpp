// Scenes with exploration paths and a hand: keys, defaults, spreads, refusals, sweeps.
#include <gtest/gtest.h>

#include "host/scene/study.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {

using test::study_error;

PathsSpec paths_of(const std::string& keys) {
    return parse_scene("[paths]\n" + keys, "f.toml").scene.paths.value();
}

TEST(PathScene, OnlyWithItsTable) {
    EXPECT_FALSE(parse_scene("", "f.toml").scene.paths);
    EXPECT_EQ(resolved_toml(parse_scene("", "f.toml")).find("paths"), std::string::npos);
    EXPECT_EQ(resolved_toml(parse_scene("", "f.toml")).find("hand"), std::string::npos);
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
    EXPECT_EQ(study_error("[paths]\npress = \"1 N\"\ndepth = \"1 mm\"\n"),
              "f.toml:3:1: give \"depth\" or \"press\", not both");
    EXPECT_EQ(study_error("[paths]\nspeed = \"1 m/s\"\nspeed.min = \"1 m/s\"\n").substr(0, 9), "f.toml:3:");
    EXPECT_EQ(study_error("[paths]\nspeed = { mean = \"1 m/s\", max = \"1 m/s\" }\n"),
              "f.toml:2:27: give \"speed.mean\" or \"speed.max\", not both");
    EXPECT_EQ(study_error("[paths]\nloop = \"open\"\npress = \"1 N\"\n").substr(0, 12), "f.toml:3:9: ");
    EXPECT_EQ(study_error("[paths]\nkind = \"taps\"\npress = \"1 N\"\n"),
              "f.toml:3:9: taps go down to a depth: give depth instead of press");
}

TEST(PathScene, Refusals) {
    EXPECT_EQ(study_error("[paths]\ncuont = 2\n"),
              "f.toml:2:1: unknown key \"cuont\" in [paths]; did you mean \"count\"?");
    EXPECT_EQ(study_error("[hand]\nmas = \"1 kg\"\n"),
              "f.toml:2:1: unknown key \"mas\" in [hand]; did you mean \"mass\"?");
    EXPECT_EQ(study_error("[paths]\nspeed = { men = \"1 m/s\", sd = \"0 m/s\" }\n"),
              "f.toml:2:11: unknown key \"speed.men\" in [paths]; did you mean \"speed.mean\"?");
    EXPECT_EQ(study_error("[paths]\nspeed = { mean = \"1 m/s\" }\n"),
              "f.toml:2:18: speed = { mean, sd } needs both; sd is missing");
    EXPECT_EQ(study_error("[paths]\ndepth = { min = \"3 mm\", max = \"1 mm\" }\n"),
              "f.toml:2:17: depth: min 3 mm is more than max 1 mm");
    EXPECT_EQ(study_error("[paths]\nspeed = \"0 m/s\"\n"), "f.toml:2:9: speed must be positive, got 0 m/s");
    EXPECT_EQ(study_error("[paths]\nspeed = \"1 m\"\n"),
              "f.toml:2:9: \"m\" is a length, not a speed; write for example \"100 mm/s\"");
    EXPECT_EQ(study_error("[paths]\nlines = 4\n"),
              "f.toml:2:1: \"lines\" does not apply to kind \"strokes\"; it applies to kind raster or spiral");
    EXPECT_EQ(study_error("[paths]\nbound = \"1 m\"\n"),
              "f.toml:2:1: \"bound\" does not apply to an open loop; it applies to a closed loop");
    EXPECT_EQ(study_error("[paths]\nkind = \"recorded\"\n"),
              "f.toml:2:8: kind \"recorded\" needs a file: file = \"NAME.csv\" in [paths]");
    EXPECT_EQ(study_error("[paths]\ntremor = \"1 mm\"\n").substr(0, 12), "f.toml:2:1: ");
    EXPECT_EQ(study_error("[paths]\nspeed = {}\n"), "f.toml:2:1: speed is a table without a key");
    EXPECT_EQ(study_error("[paths]\npress = \"1 N\"\n[hand]\ndelay_samples = 2\n"),
              "f.toml:4:17: delay_samples must be from 0 to 1, got 2");
    EXPECT_EQ(study_error("[surface]\nkind = \"height_map\"\n[paths]\nfollow = \"surface\"\n").substr(0, 12),
              "f.toml:4:10:");
    EXPECT_EQ(study_error("[paths]\nlength = \"1e16 m\"\n"),
              "f.toml:2:10: paths.length must be at most 1e+15 m in f32; got 1e16 m");
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

} // namespace
} // namespace forceshade
