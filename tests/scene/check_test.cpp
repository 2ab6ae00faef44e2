// Extremes: accepted, warned of, or refused with the place and the numbers.
#include "host/scene/study.h"

#include "tests/scene/errors.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace forceshade {
namespace {

using test::study_error;

std::vector<std::string> warnings(std::string_view text) {
    return parse_study(text, "f.toml").warnings;
}

TEST(Check, RadiusAndWidth) {
    EXPECT_EQ(study_error("[surface]\nradius = \"500 mil\"\n"), "(no error)");
    EXPECT_EQ(study_error("[surface]\nradius = \"499.9999999999 mil\"\n"),
              "f.toml:2:10: radius must be at least half of width: 499.9999999999 mil is less than half of 1000 mil");
    EXPECT_EQ(
        study_error("[surface]\nwidth = \"2 m\"\n"),
        "f.toml:2:9: radius must be at least half of width: 600 mil is less than half of 2 m, which is 39370.1 mil");
    EXPECT_EQ(study_error("[surface]\nradius = \"5e8 in\"\n"), "(no error)"); // R/a = 1e9
    EXPECT_EQ(study_error("[texture]\nfunction = \"dip\"\nradius = \"0.5 mm\"\n").substr(0, 12), "f.toml:3:10:");
}

TEST(Check, LengthsWhoseSquaresAreNormal) {
    EXPECT_EQ(study_error("[surface]\nwidth = \"1e-16 m\"\n"),
              "f.toml:2:9: surface.width must be from 1e-15 m to 1e+15 m in f32, so that its square is a normal "
              "number; got 1e-16 m");
    EXPECT_EQ(study_error("[surface]\nradius = \"1e16 m\"\n").substr(0, 12), "f.toml:2:10:");
    EXPECT_EQ(study_error("[surface]\nradius = \"1e16 m\"\n[run]\nprecision = \"f64\"\n"), "(no error)");
    EXPECT_EQ(study_error("[texture]\nheight = \"1e15 km\"\n").substr(0, 12), "f.toml:2:10:");
    EXPECT_EQ(study_error("[texture]\nheight = \"1 m\"\nwidth = \"1e-15 m\"\n"), "(no error)");
    EXPECT_EQ(study_error("[texture]\nheight = \"-2 m\"\nwidth = \"1e-15 m\"\n").substr(0, 12), "f.toml:2:10:");
}

TEST(Check, Stiffness) {
    for (const char* text : {"1e-9 N/m", "1e12 N/m"})
        EXPECT_EQ(study_error(fmt::format("[force]\nstiffness = \"{}\"\n", text)), "(no error)");
    EXPECT_EQ(study_error("[force]\nstiffness = \"1e21 N/m\"\n"),
              "f.toml:2:13: force.stiffness must be from 1e-20 N/m to 1e+20 N/m in f32; got 1e21 N/m");
    EXPECT_EQ(study_error("[texture]\nstiffness = \"0 N/m\"\n"), "(no error)");
    EXPECT_EQ(study_error("[texture]\nstiffness = \"-1 N/m\"\n"),
              "f.toml:2:13: stiffness must not be negative, got -1 N/m");
}

TEST(Check, ShadingFitsTheSurface) {
    EXPECT_EQ(study_error("[surface]\nkind = \"cylinder_bump\"\n[force]\nshading = \"reference\"\n"),
              "f.toml:4:11: shading \"reference\" does not fit kind \"cylinder_bump\", whose shading is none");
    EXPECT_EQ(study_error("[force]\nshading = [\"none\",\n\"height_map\"]\n"),
              "f.toml:3:1: shading \"height_map\" does not fit kind \"bump\", whose shading is none or reference");
    EXPECT_EQ(
        study_error("[surface]\nkind = \"height_map\"\n[force]\nshading = \"reference\"\n"),
        "f.toml:4:11: shading \"reference\" does not fit kind \"height_map\", whose shading is none or height_map");
}

TEST(Check, GridLimits) {
    EXPECT_EQ(study_error("[grid]\nsize = [1, 1, 1]\n"), "(no error)");
    EXPECT_EQ(study_error("[grid]\nsize = [1, 65536, 32768]\n"),
              "f.toml:2:12: size has 2147483648 rows, y times z; an EXR holds up to 1073741822");
    EXPECT_EQ(study_error("[grid]\nsize = [2147483648, 1, 1]\n"),
              "f.toml:2:9: size must be from 1 to 1073741822, got 2147483648");
    EXPECT_EQ(study_error("[grid]\nsize = [5592406, 1, 1]\n"),
              "f.toml:2:9: size has 5592406 samples along x; an EXR holds up to 5592405");
    EXPECT_EQ(study_error("[grid]\nsize = [5592405, 32768, 32767]\nspacing = \"1 um\"\n"),
              "f.toml:2:9: size has 6004615893319680 voxels; the limit is 281474976710656, 2^48");
    EXPECT_EQ(study_error("[grid]\norigin = [\"0 m\", \"1e16 m\", \"0 m\"]\n"),
              "f.toml:2:18: the grid reaches 1e+16 m along y; f32 allows 1e+15 m");
    EXPECT_NE(study_error("[grid]\nspacing = \"1e308 m\"\n"), "(no error)");
}

TEST(Check, WarnsOfVoxelsThatCoincide) {
    const std::string far = "[grid]\norigin = [\"1 km\", \"0 m\", \"0 m\"]\nspacing = \"1 nm\"\n";
    ASSERT_EQ(warnings(far).size(), 1u);
    EXPECT_EQ(warnings(far)[0],
              "f.toml:3:11: spacing 1 nm is below the f32 step 6.1e-05 m at 1 km: neighbouring voxels sample the same "
              "point; use precision f64 or move the grid");
    EXPECT_TRUE(warnings(far + "[run]\nprecision = \"f64\"\n").empty());
    EXPECT_TRUE(warnings("[grid]\nspacing = \"1 nm\"\norigin = [\"0 m\", \"0 m\", \"0 m\"]\n").empty());
    EXPECT_TRUE(
        warnings("[grid]\nspacing = \"1e-45 m\"\norigin = [\"0 m\", \"0 m\", \"0 m\"]\nsize = [2, 2, 2]\n").size() ==
        1);
    EXPECT_TRUE(warnings(far + "size = [1, 2, 2]\n").empty()); // one sample along x has no neighbour
    EXPECT_EQ(warnings("[surface]\nfacets = [1000000, 100000000]\n").size(), 1u);
}

} // namespace
} // namespace forceshade
