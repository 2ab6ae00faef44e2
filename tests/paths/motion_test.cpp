// Generated paths: speeds, extents and spreads as the scene says, and nothing of a path that depends on others; and
// warnings of paths that cannot be what a scene says at its rate.
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/paths/motions.h"
#include "tests/io/folder.h"
#include "tests/paths/explored.h"

namespace forceshade {
namespace {

using testing::says;

constexpr std::array kKinds{"strokes", "raster", "circle", "spiral", "taps", "random_walk", "minimum_jerk"};

template <typename T> Explored<T> paths_of(const std::string& keys, const reference::PathOptions& options = {}) {
    return explored<T>("[paths]\n" + keys, options);
}

double distance(const reference::Vector<double>& a, const reference::Vector<double>& b) {
    const reference::Vector<double> way = a - b;
    return std::sqrt(reference::dot(way, way));
}

double way_length(const Explored<double>& result) {
    double sum = 0;
    for (std::size_t i = 1; i < result.steps; ++i)
        sum += distance(result.place(i), result.place(i - 1));
    return sum;
}

TEST(Motion, SpeedIsTheScenes) {
    struct Row {
        const char* keys;
        double tolerance;
    };
    for (const Row& row : {Row{"kind = \"strokes\"\nlength = \"30 mm\"", 1e-5},
                           {"kind = \"circle\"\nlength = \"30 mm\"", 1e-4},
                           {"kind = \"raster\"\nlength = \"30 mm\"", 1e-3},
                           {"kind = \"taps\"\ndepth = \"2 mm\"\nlift = \"5 mm\"", 1e-3},
                           {"kind = \"spiral\"\nlength = \"30 mm\"\ninner = \"15 mm\"", 1e-4},
                           {"kind = \"minimum_jerk\"\nlength = \"30 mm\"", 0.03}})
        EXPECT_NEAR(
            way_length(paths_of<double>(fmt::format("count = 1\nsteps = 20001\nspeed = \"150 mm/s\"\n{}", row.keys))) /
                20,
            0.15, row.tolerance)
            << row.keys;
}

TEST(Motion, RandomWalkStaysInItsRegionAndHasItsSpeed) {
    const auto result = paths_of<double>("kind = \"random_walk\"\ncount = 200\nsteps = 4000\nlength = \"40 mm\"\n"
                                         "width = \"20 mm\"\nspeed = \"100 mm/s\"\n");
    double x = 0, y = 0, speed = 0, along = 0, across = 0;
    for (std::size_t step = 0; step + 1 < result.steps; ++step)
        for (std::size_t path = 0; path < result.paths; ++path) {
            const auto& here = result.place(step, path);
            x += here.x * here.x;
            y += here.y * here.y;
            along = std::max(along, std::abs(here.x));
            across = std::max(across, std::abs(here.y));
            speed += std::pow(1000 * distance(result.place(step + 1, path), here), 2);
        }
    const double samples = 3999 * 200;
    EXPECT_LE(along, 0.02);
    EXPECT_LE(across, 0.01);
    EXPECT_NEAR(along, 0.02, 1e-5) << "up to the edge";
    EXPECT_NEAR(across, 0.01, 1e-5);
    // Of a sum of 16 harmonics turned round at the edges, by simulation: 0.5499 of half a side.
    EXPECT_NEAR(std::sqrt(x / samples), 0.02 * 0.5499, 3e-4);
    EXPECT_NEAR(std::sqrt(y / samples), 0.01 * 0.5499, 3e-4);
    EXPECT_NEAR(std::sqrt(speed / samples), 0.1, 2e-3);
    const auto single = paths_of<float>("kind = \"random_walk\"\ncount = 200\nsteps = 4000\nlength = \"40 mm\"\n"
                                        "width = \"20 mm\"\nspeed = \"100 mm/s\"\n");
    for (const auto& place : single.position)
        ASSERT_TRUE(std::abs(place.x) <= 0.02f && std::abs(place.y) <= 0.01f) << place.x << ' ' << place.y;
}

TEST(Motion, StrokesBeginAtTheirEndAndGoThere) {
    const auto result = paths_of<double>("count = 1\nsteps = 601\nlength = \"30 mm\"\nheading = \"90 deg\"\n"
                                         "centre = [\"5 mm\", \"1 mm\"]\noffset = \"2 mm\"\ndepth = \"3 mm\"\n"
                                         "depth_back = \"-1 mm\"\nheight = \"10 mm\"\n");
    EXPECT_NEAR(distance(result.place(0), {0.003, -0.014, 0.007}), 0, 1e-15);
    EXPECT_NEAR(distance(result.place(150), {0.003, 0.001, 0.007}), 0, 3e-9);
    EXPECT_NEAR(distance(result.place(450), {0.003, 0.001, 0.011}), 0, 3e-9);
    EXPECT_NEAR(result.place(300).y, 0.016, 3e-9);
}

TEST(Motion, DefaultsFollowTheSurface) {
    EXPECT_NEAR(explored<double>("[paths]\ncount = 1\n").place(0).x, -0.6 * 0.0254, 1e-15);
    EXPECT_NEAR(explored<double>("[surface]\nwidth = \"10 mm\"\n[paths]\ncount = 1\n").place(0).x, -0.006, 1e-15);
    const auto above = explored<double>("[surface]\nfacets = 2\n[paths]\ncount = 1\nfollow = \"surface\"\n"
                                        "length = \"0 m\"\n");
    EXPECT_NEAR(above.place(0).z, 0.01524 - std::sqrt(0.01524 * 0.01524 - 0.0127 * 0.0127) - 0.001, 1e-9);
}

TEST(Motion, SpreadsAreTheScenes) {
    const PathsSpec spec = parse_scene("[paths]\nspeed = { mean = \"100 mm/s\", sd = \"80 mm/s\" }\n"
                                       "depth = { min = \"1 mm\", max = \"3 mm\" }\n",
                                       "scene")
                               .scene.paths.value();
    double sum = 0, square = 0, least = 1, depth = 0;
    constexpr int kPaths = 20000;
    for (int i = 0; i < kPaths; ++i) {
        const PathDraws draws(7, static_cast<std::uint64_t>(i));
        const double speed = draws.value(spec.speed, Draw::speed, true), deep = draws.value(spec.depth, Draw::depth);
        least = std::min(least, speed);
        sum += speed;
        square += speed * speed;
        depth += deep;
        EXPECT_TRUE(deep > 0.001 && deep < 0.003);
    }
    // A normal distribution without its part below 0.
    const double at = -0.1 / 0.08, density = std::exp(-at * at / 2) / std::sqrt(2 * std::numbers::pi);
    const double kept = 0.5 * std::erfc(at / std::sqrt(2.0)), shift = density / kept;
    const double mean = 0.1 + 0.08 * shift, sd = 0.08 * std::sqrt(1 + at * shift - shift * shift);
    EXPECT_GT(least, 0);
    EXPECT_NEAR(sum / kPaths, mean, 4 * sd / std::sqrt(kPaths));
    EXPECT_NEAR(std::sqrt(square / kPaths - std::pow(sum / kPaths, 2)), sd, 0.002);
    EXPECT_NEAR(depth / kPaths, 0.002, 2e-5);
}

TEST(Motion, TremorHasItsSize) {
    const auto still = paths_of<double>("count = 100\nsteps = 4000\nlength = \"0 m\"\n");
    const auto trembling = paths_of<double>("count = 100\nsteps = 4000\nlength = \"0 m\"\n"
                                            "tremor = { amplitude = \"0.2 mm\", frequency = \"9 Hz\" }\n");
    for (int axis = 0; axis < 3; ++axis) {
        double square = 0;
        for (std::size_t i = 0; i < still.position.size(); ++i)
            square += std::pow(trembling.position[i][axis] - still.position[i][axis], 2);
        EXPECT_NEAR(std::sqrt(square / static_cast<double>(still.position.size())), 2e-4, 1e-5);
    }
}

// Whatever the batch, the window or the number of threads.
TEST(Motion, PathsAreTheirOwn) {
    for (const char* kind : kKinds)
        for (const bool closed : {false, true}) {
            const std::string scene = fmt::format(
                "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n[paths]\nkind = \"{}\"\ncount = 70\n"
                "steps = 300\nloop = \"{}\"\nseed = 9\nspeed = {{ mean = \"100 mm/s\", sd = \"30 mm/s\" }}\n{}",
                kind, closed ? "closed" : "open",
                std::string_view(kind) == "random_walk" ? "" : "tremor.amplitude = \"0.1 mm\"\n");
            const auto whole = explored<float>(scene, {.threads = 1});
            for (const reference::PathOptions& options :
                 {reference::PathOptions{3, 20000, 16384}, reference::PathOptions{2, 1 << 20, 17},
                  reference::PathOptions{1, 1, 1}}) {
                const auto parts = explored<float>(scene, options);
                EXPECT_EQ(whole.position, parts.position) << kind;
                EXPECT_EQ(whole.force, parts.force) << kind;
            }
        }
}

TEST(Motion, SingleAndDoubleGoTheSameWay) {
    for (const char* kind : kKinds) {
        const std::string keys = fmt::format("kind = \"{}\"\ncount = 50\nsteps = 500\n", kind);
        const auto single = paths_of<float>(keys);
        const auto exact = paths_of<double>(keys);
        for (std::size_t i = 0; i < single.position.size(); ++i)
            EXPECT_LT(distance(reference::Vector<double>(single.position[i]), exact.position[i]), 1e-7) << kind;
    }
}

TEST(Motion, ExtremesAreNumbers) {
    for (const char* kind : kKinds)
        for (const char* length : {"0 m", "1e-40 m", "1 m"})
            for (const char* speed : {"1e-12 m/s", "25 m/s", "1e12 m/s"})
                for (const char* depth : {"1e-44 m", "0 m", "0.25 m"})
                    for (const int steps : {1, 50}) {
                        const bool taps = std::string_view(kind) == "taps";
                        const auto result = paths_of<float>(fmt::format(
                            "kind = \"{}\"\n{}speed = \"{}\"\ndepth = \"{}\"\nsteps = {}\ncount = 1\n", kind,
                            taps ? "" : fmt::format("length = \"{}\"\n", length), speed, depth, steps));
                        ASSERT_TRUE(result.finite()) << kind << length << speed << depth;
                    }
}

TEST(Motion, EqualPathsAreRemarkedOn) {
    const auto remarks = [](const std::string& keys) {
        const PreparedCase prepared = prepared_scene("[paths]\n" + keys);
        return ScenePaths<double>(prepared).warnings().size();
    };
    EXPECT_EQ(remarks(""), 1u);
    EXPECT_EQ(remarks("count = 1\n"), 0u);
    EXPECT_EQ(remarks("kind = \"random_walk\"\n"), 0u);
    EXPECT_EQ(remarks("tremor.amplitude = \"1 um\"\n"), 0u);
    EXPECT_EQ(remarks("tremor.amplitude = { min = \"0 m\", max = \"0 m\" }\n"), 1u);
    EXPECT_EQ(remarks("offset = { min = \"0 m\", max = \"1 m\" }\n"), 0u);
    EXPECT_EQ(remarks("speed = { mean = \"1 m/s\", sd = \"0 m/s\" }\n"), 1u);
}

TEST(Motion, MeanDistanceInARectangle) {
    EXPECT_NEAR(mean_distance(1, 1), 0.5214054331647207, 1e-14);
    EXPECT_NEAR(mean_distance(3, 0), 1, 1e-15);
    EXPECT_NEAR(mean_distance(2.0, 2.1e-4), mean_distance(2.0, 1.9e-4), 1e-6);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> x(0, 3), y(0, 0.5);
    double sum = 0;
    for (int i = 0; i < 400000; ++i)
        sum += std::hypot(x(random) - x(random), y(random) - y(random));
    EXPECT_NEAR(mean_distance(0.5, 3), sum / 400000, 5e-3);
    EXPECT_EQ(mean_distance(0, 0), 0);
}

TEST(Motion, PhasesOfTurns) {
    EXPECT_EQ(phase_of_turns(0.25), 1u << 30);
    EXPECT_EQ(phase_of_turns(7.5), 1u << 31);
    EXPECT_EQ(phase_of_turns(-0.25), 3u << 30);
    EXPECT_EQ(phase_of_turns(1 - 1e-12), 0u);
    // A round of so many samples is complete after so many.
    for (std::uint64_t samples = 2; samples <= 5000; ++samples) {
        const std::uint64_t turned = samples * phase_of_turns(1.0 / static_cast<double>(samples));
        EXPECT_TRUE(turned >= (std::uint64_t(1) << 32) && turned < (std::uint64_t(1) << 32) + samples) << samples;
    }
    EXPECT_EQ(phase_of_turns(HUGE_VAL), 0u);
}

std::vector<std::string> warnings(const std::string& keys) {
    const PreparedCase prepared = prepared_scene("[paths]\nlength = \"30 mm\"\n" + keys);
    return ScenePaths<double>(prepared).warnings();
}

// One warning, which says these words; none without words. Slow paths do not close a round, either: that is left out.
void expect_pace(const std::string& keys, const std::vector<std::string>& words = {}) {
    std::vector<std::string> found = warnings(keys);
    std::erase_if(found, [](const std::string& one) { return bool(says(one, "no round")); });
    ASSERT_EQ(found.size(), words.empty() ? 0u : 1u) << keys;
    if (!words.empty()) {
        EXPECT_TRUE(says(found[0], words)) << keys;
    }
}

TEST(Pace, HalfARoundASample) { // 30 m/s is half a round of 60 mm
    const std::string spread = "count = 300\nspeed = { min = \"10 m/s\", max = \"40 m/s\" }\n";
    expect_pace("count = 1\nspeed = \"29 m/s\"\n");
    expect_pace("count = 1\nspeed = \"31 m/s\"\n", {"a speed below 30 m/s, or a rate above 1.03e+03 Hz"});
    expect_pace(spread, {" of 300 paths half a round or more", "below 30 m/s"});
    expect_pace(spread + "rate = \"2 kHz\"\n");
    for (const std::string kind : {"circle", "spiral", "raster", "minimum_jerk", "random_walk"})
        expect_pace("count = 2\nspeed = { min = \"70 m/s\", max = \"90 m/s\" }\nkind = \"" + kind + "\"\n",
                    {"or a rate above"});
}

TEST(Pace, TooSlowForAPhase) {
    const std::string slow = "count = 1\nspeed = \"0.01 mm/s\"\n", nanometre = "count = 1\nspeed = \"1 nm/s\"\n";
    expect_pace(slow);
    expect_pace(nanometre, {"right is a speed above 1.4e-06 m/s"}); // 1.7e-11 rounds a sample
    expect_pace("count = 1\nspeed = \"0.01 nm/s\"\n", {"right is a speed above 1.4e-06 m/s"});
    expect_pace(nanometre + "rate = \"1 Hz\"\n", {"right is a speed above"});
    expect_pace(nanometre + "rate = \"0.1 Hz\"\n");
    for (const std::string kind : {"raster", "minimum_jerk"}) // whole samples, 3e7 for 30 mm, and no phase
        expect_pace("count = 1\nspeed = \"1 um/s\"\nkind = \"" + kind + "\"\n");
    expect_pace(slow + "kind = \"spiral\"\nlines = 2\n");
    // The way out and back takes 200 rounds.
    expect_pace(slow + "kind = \"spiral\"\nlines = 100\n", {"right is a speed above 0.000439 m/s"});
}

TEST(Pace, TremorOfHalfTheRate) {
    const std::string trembling = "count = 1\ntremor.amplitude = \"1 um\"\ntremor.frequency = ";
    expect_pace(trembling + "\"400 Hz\"\n");
    expect_pace(trembling + "\"420 Hz\"\n",
                {"tremor.frequency", "right is a frequency below 416.7 Hz, or a rate above 1008 Hz"});
    expect_pace("count = 1\ntremor.frequency = \"900 Hz\"\n"); // it does not tremble
}

TEST(Pace, OfARoundThatDoesNotClose) {
    // 60 mm there and back, at 100 mm/s and 1 kHz: 600 samples.
    EXPECT_EQ(warnings("count = 1\nsteps = 601\n").size(), 0u);
    const auto open = warnings("count = 1\nsteps = 500\n");
    ASSERT_EQ(open.size(), 1u);
    EXPECT_TRUE(says(open[0], "set steps = 601 or more"));
    EXPECT_EQ(warnings("count = 1\nsteps = 500\nkind = \"minimum_jerk\"\n").size(), 0u) << "it has no rounds";
    EXPECT_EQ(warnings("count = 300\nsteps = 500\nspeed = { min = \"50 mm/s\", max = \"200 mm/s\" }\n").size(), 0u)
        << "some close";
}

} // namespace
} // namespace forceshade
