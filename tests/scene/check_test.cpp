// Extremes: accepted, warned of, or refused with the place and the numbers.
#include "host/scene/study.h"

#include "tests/scene/errors.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace forceshade {
namespace {
using test::expect_places;
using test::study_error;

std::vector<std::string> warnings(std::string_view text) {
    return parse_study(text, "f.toml").warnings;
}

TEST(Check, RadiusAndWidth) {
    expect_places({
        {"[surface]\nradius = \"500 mil\"\n", ""},
        {"[surface]\nradius = \"499.9999999999 mil\"\n", "2:10"},
        {"[surface]\nwidth = \"2 m\"\n", "2:9"},
        {"[surface]\nradius = \"5e8 in\"\n", ""},
        {"[texture]\nfunction = \"dip\"\nradius = \"0.5 mm\"\n", "3:10"},
    });
}

TEST(Check, StiffnessAndLengthsWhoseSquaresAreNormal) {
    for (const char* text : {"1e-9 N/m", "1e12 N/m"})
        EXPECT_EQ(study_error(fmt::format("[force]\nstiffness = \"{}\"\n", text)), "(no error)");
    expect_places({
        {"[surface]\nwidth = \"1e-16 m\"\n", "2:9"},
        {"[surface]\nradius = \"1e16 m\"\n", "2:10"},
        {"[surface]\nradius = \"1e16 m\"\n[run]\nprecision = \"f64\"\n", ""},
        {"[texture]\nheight = \"1e15 km\"\n", "2:10"},
        {"[texture]\nheight = \"1 m\"\nwidth = \"1e-15 m\"\n", ""},
        {"[texture]\nheight = \"-2 m\"\nwidth = \"1e-15 m\"\n", "2:10"},
        {"[force]\nstiffness = \"1e21 N/m\"\n", "2:13"},
        {"[texture]\nstiffness = \"0 N/m\"\n", ""},
        {"[texture]\nstiffness = \"-1 N/m\"\n", "2:13"},
    });
}

TEST(Check, ShadingFitsTheSurface) {
    expect_places({
        {"[surface]\nkind = \"cylinder_bump\"\n[force]\nshading = \"reference\"\n", "4:11"},
        {"[force]\nshading = [\"none\",\n\"height_map\"]\n", "3:1"},
        {"[surface]\nkind = \"height_map\"\n[force]\nshading = \"reference\"\n", "4:11"},
    });
}

TEST(Check, GridLimits) {
    expect_places({
        {"[grid]\nsize = [1, 1, 1]\n", ""},
        {"[grid]\nsize = [1, 65536, 32768]\n", "2:12"},
        {"[grid]\nsize = [2147483648, 1, 1]\n", "2:9"},
        {"[grid]\nsize = [5592406, 1, 1]\n", "2:9"},
        {"[grid]\nsize = [5592405, 32768, 32767]\nspacing = \"1 um\"\n", "2:9"},
        {"[grid]\norigin = [\"0 m\", \"1e16 m\", \"0 m\"]\n", "2:18"},
    });
    EXPECT_NE(study_error("[grid]\nspacing = \"1e308 m\"\n"), "(no error)");
}

TEST(Check, Friction) {
    expect_places({
        {"[friction]\n", ""},
        {"[friction]\ncoefficient = 0.3\nstatic_coefficient = 0.3\n", ""},
        {"[friction]\ncoefficient = 0.5\nstatic_coefficient = 0.4\n", "3:22"},
        {"[friction]\nstatic_coefficient = 0.2\n", "2:22"},
        {"[friction]\nstatic_coefficient = 0.2\n[texture]\nvibration = \"m.xml\"\n", ""}, // the file may have less
        {"[friction]\ncoefficient = -0.1\n", "2:15"},
        {"[friction]\ncoefficient = 1e6\n", "2:15"},
        {"[friction]\nstatic_coefficient = 1e6\n", "2:22"},
        {"[friction]\nstiffness = \"0 N/m\"\n", "2:13"},
        {"[friction]\nstiffness = \"1e21 N/m\"\n", "2:13"},
        {"[friction]\nstribeck_speed = \"0 m/s\"\n", "2:18"},
        {"[friction]\nstribeck_speed = \"1e-16 m/s\"\n", "2:18"},
        {"[friction]\ndamping = \"1e16 N s/m\"\n", "2:11"},
        {"[friction]\nmu = 0.3\n", "2:1"},
    });
    EXPECT_NE(study_error("[friction]\nmu = 0.3\n").find("did you mean \"coefficient\"?"), std::string::npos);
}

TEST(Check, WarnsOfVoxelsThatCoincide) {
    const std::string far = "[grid]\norigin = [\"1 km\", \"0 m\", \"0 m\"]\nspacing = \"1 nm\"\n";
    ASSERT_EQ(warnings(far).size(), 1u);
    EXPECT_EQ(warnings(far)[0], "f.toml:3:11: spacing 1 nm is below the f32 step 6.1e-05 m at 1 km: neighbouring "
                                "voxels sample the same point; use precision f64 or move the grid");
    EXPECT_TRUE(warnings(far + "[run]\nprecision = \"f64\"\n").empty());
    EXPECT_TRUE(warnings("[grid]\nspacing = \"1 nm\"\norigin = [\"0 m\", \"0 m\", \"0 m\"]\n").empty());
    EXPECT_TRUE(
        warnings("[grid]\nspacing = \"1e-45 m\"\norigin = [\"0 m\", \"0 m\", \"0 m\"]\nsize = [2, 2, 2]\n").size() ==
        1);
    EXPECT_TRUE(warnings(far + "size = [1, 2, 2]\n").empty()); // one sample along x has no neighbour
    EXPECT_EQ(warnings("[surface]\nfacets = [1000000, 100000000]\n").size(), 1u);
}

TEST(Check, WarnsOfAForceWithoutABound) {
    const std::string mesh = "[surface]\nkind = \"mesh\"\nfile = \"a.obj\"\n[grid]\nsamples = 9\n[force]\n";
    ASSERT_EQ(warnings(mesh + "shading = [\"mean_value\", \"two_pass\"]\n").size(), 1u);
    EXPECT_TRUE(warnings(mesh + "shading = [\"mean_value\", \"none\"]\n").empty());
}

} // namespace
} // namespace forceshade
