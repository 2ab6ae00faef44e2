// Paths that cannot be what a scene says at its rate are told of, and what would be right; others are not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/paths/explored.h"

namespace forceshade {
namespace {

std::vector<std::string> warnings(const std::string& keys) {
    const PreparedCase prepared = prepared_scene("[paths]\nlength = \"30 mm\"\n" + keys);
    return ScenePaths<double>(prepared).warnings();
}

// Slow paths do not close a round, either.
std::vector<std::string> pace_warnings_of(const std::string& keys) {
    std::vector<std::string> found = warnings(keys);
    std::erase_if(found, [](const std::string& one) { return one.find("no round") != one.npos; });
    return found;
}

const char* const kSpread = "speed = { min = \"10 m/s\", max = \"40 m/s\" }\n"; // 30 m/s is half a round of 60 mm

TEST(Pace, HalfARoundASample) {
    EXPECT_EQ(pace_warnings_of("count = 1\nspeed = \"29 m/s\"\n").size(), 0u);
    const auto fast = pace_warnings_of("count = 1\nspeed = \"31 m/s\"\n");
    ASSERT_EQ(fast.size(), 1u);
    EXPECT_EQ(fast[0], "[paths]: speed: on the path half a round or more lies between two samples, so that the motion "
                       "seems slower, or to go back; right is a speed below 30 m/s, or a rate above 1.03e+03 Hz");
    const auto some = pace_warnings_of(std::string("count = 300\n") + kSpread);
    ASSERT_EQ(some.size(), 1u);
    EXPECT_NE(some[0].find(" of 300 paths half a round or more"), std::string::npos);
    EXPECT_NE(some[0].find("below 30 m/s"), std::string::npos);
    EXPECT_EQ(pace_warnings_of(std::string("count = 300\nrate = \"2 kHz\"\n") + kSpread).size(), 0u);
    for (const char* kind : {"circle", "spiral", "raster", "minimum_jerk", "random_walk"})
        EXPECT_EQ(pace_warnings_of(
                      fmt::format("count = 2\nspeed = {{ min = \"70 m/s\", max = \"90 m/s\" }}\nkind = \"{}\"\n", kind))
                      .size(),
                  1u)
            << kind;
}

TEST(Pace, TooSlowForAPhase) {
    EXPECT_EQ(pace_warnings_of("count = 1\nspeed = \"0.01 mm/s\"\n").size(), 0u);
    for (const char* speed : {"1 nm/s", "0.01 nm/s"}) { // 1 nm/s is 1.7e-11 rounds a sample
        const auto slow = pace_warnings_of(fmt::format("count = 1\nspeed = \"{}\"\n", speed));
        ASSERT_EQ(slow.size(), 1u) << speed;
        EXPECT_NE(slow[0].find("right is a speed above 1.4e-06 m/s"), std::string::npos) << slow[0];
    }
    EXPECT_EQ(pace_warnings_of("count = 1\nspeed = \"1 nm/s\"\nrate = \"1 Hz\"\n").size(), 1u);
    for (const char* kind : {"raster", "minimum_jerk"}) // whole samples, 3e7 for 30 mm, and no phase
        EXPECT_EQ(pace_warnings_of(fmt::format("count = 1\nspeed = \"1 um/s\"\nkind = \"{}\"\n", kind)).size(), 0u)
            << kind;
    EXPECT_EQ(pace_warnings_of("count = 1\nspeed = \"0.01 mm/s\"\nkind = \"spiral\"\nlines = 2\n").size(), 0u);
    const auto out = pace_warnings_of("count = 1\nspeed = \"0.01 mm/s\"\nkind = \"spiral\"\nlines = 100\n");
    ASSERT_EQ(out.size(), 1u) << "the way out and back takes 200 rounds";
    EXPECT_NE(out[0].find("right is a speed above 0.000439 m/s"), std::string::npos) << out[0];
    EXPECT_EQ(pace_warnings_of("count = 1\nspeed = \"1 nm/s\"\nrate = \"0.1 Hz\"\n").size(), 0u);
}

TEST(Pace, TremorOfHalfTheRate) {
    const auto tremor = [](const char* frequency) {
        return pace_warnings_of(
            fmt::format("count = 1\ntremor = {{ amplitude = \"1 um\", frequency = \"{}\" }}\n", frequency));
    };
    EXPECT_EQ(tremor("400 Hz").size(), 0u);
    const auto fast = tremor("420 Hz");
    ASSERT_EQ(fast.size(), 1u);
    EXPECT_NE(fast[0].find("tremor.frequency"), std::string::npos);
    EXPECT_NE(fast[0].find("right is a frequency below 416.7 Hz, or a rate above 1008 Hz"), std::string::npos)
        << fast[0];
    EXPECT_EQ(pace_warnings_of("count = 1\ntremor.frequency = \"900 Hz\"\n").size(), 0u) << "it does not tremble";
}

TEST(Pace, OfARoundThatDoesNotClose) {
    // 60 mm there and back, at 100 mm/s and 1 kHz: 600 samples.
    EXPECT_EQ(warnings("count = 1\nsteps = 601\n").size(), 0u);
    const auto open = warnings("count = 1\nsteps = 500\n");
    ASSERT_EQ(open.size(), 1u);
    EXPECT_EQ(open[0], "[paths]: steps: a round takes 0.6 s at 0.1 m/s, and the paths end after 0.5 s: no round is "
                       "complete, and none is reported; set steps = 601 or more, or a higher speed");
    EXPECT_EQ(warnings("count = 1\nsteps = 601\n").size(), 0u);
    EXPECT_EQ(warnings("count = 1\nsteps = 500\nkind = \"minimum_jerk\"\n").size(), 0u) << "it has no rounds";
    EXPECT_EQ(warnings("count = 300\nsteps = 500\nspeed = { min = \"50 mm/s\", max = \"200 mm/s\" }\n").size(), 0u)
        << "some close";
}

} // namespace
} // namespace forceshade
