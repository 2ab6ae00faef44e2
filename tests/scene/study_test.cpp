// Axes, variants, and cases that come twice.
#include "host/scene/study.h"

#include "tests/scene/errors.h"

#include <gtest/gtest.h>

namespace forceshade {
namespace {

using test::study_error;
using test::usage_error;

std::vector<std::string> names(std::string_view text) {
    std::vector<std::string> result;
    for (const Case& one : parse_study(text, "f.toml").cases)
        result.push_back(one.name);
    return result;
}

using Names = std::vector<std::string>;

TEST(Study, AxesCrossTheLastFastest) {
    EXPECT_EQ(names("[surface]\nradius = [\"600 mil\", \"1 in\"]\nfacets = [2, 3]\n"),
              (Names{"bump_radius-600mil_facets-2", "bump_radius-600mil_facets-3", "bump_radius-1in_facets-2",
                     "bump_radius-1in_facets-3"}));
}

TEST(Study, TheDefaultIsThePapers) {
    const Study study = default_study();
    ASSERT_EQ(study.cases.size(), 51u);
    EXPECT_TRUE(study.warnings.empty());
    EXPECT_EQ(study.cases[0].name, "cylinder_bump_radius-600mil");
    EXPECT_EQ(study.cases[3].name, "bump_radius-600mil_facets-1_shading-none");
    EXPECT_EQ(study.cases[50].name, "bump_radius-1400mil_facets-64_shading-reference");
    EXPECT_EQ(study.cases[50].scene.surface.radius, 0.03556);
    EXPECT_EQ(study.cases[50].scene.grid, GridSpec{});
    const std::vector<Override> f64{{"run.precision", "f64"}};
    EXPECT_EQ(default_study(f64).cases[7].scene.precision, Precision::f64);
    EXPECT_EQ(default_study(f64).cases[7].name, study.cases[7].name);
}

TEST(Study, ACaseThatComesTwiceRunsOnce) {
    EXPECT_EQ(names("[surface]\nwidth = [\"1000 mil\", \"25.4 mm\", \"1 in\"]\n"), (Names{"bump"}));
    // An axis that does not apply multiplies nothing, however long.
    EXPECT_EQ(names("[surface]\nfacets = [1, 2, 3]\n[force]\ndepth = [\"vertical\", \"normal\"]\n[[variant]]\n"
                    "surface.kind = \"cylinder_bump\"\n"),
              (Names{"cylinder_bump"}));
    EXPECT_EQ(names("[surface]\nkind = [\"bump\", \"cylinder_bump\"]\nfacets = [1, 2]\n"),
              (Names{"bump_facets-1", "bump_facets-2", "cylinder_bump"}));
    EXPECT_EQ(names("[surface]\nfacets = 2\n[force]\nshading = [\"none\", \"reference\"]\nreference = [\"normal\", "
                    "\"radial\"]\n"),
              (Names{"bump_shading-none", "bump_shading-reference_reference-normal",
                     "bump_shading-reference_reference-radial"}));
    EXPECT_EQ(names("[output]\nchannels = [[\"force\", \"depth\"], [\"depth\", \"force\"], [\"depth\"]]\n"),
              (Names{"bump"}));
    EXPECT_EQ(names("[grid]\nspacing = [[\"1 mm\"], [\"1 mm\", \"1 mm\", \"1 mm\"]]\n"), (Names{"bump"}));
    EXPECT_EQ(names("[[variant]]\nsurface.facets = [1, 2]\n[[variant]]\nsurface.facets = [2, 3]\n").size(), 3u);
}

TEST(Study, VectorsAreNoAxes) {
    EXPECT_EQ(names("[grid]\nspacing = [\"1 mm\", \"2 mm\", \"3 mm\"]\n"), (Names{"bump"}));
    EXPECT_EQ(names("[grid]\nsize = [[2, 3, 4], [5, 6, 7]]\n"), (Names{"bump_size-2x3x4", "bump_size-5x6x7"}));
}

TEST(Study, VariantsOverrideAndDrop) {
    const Study study = parse_study(R"(
[surface]
kind = "height_map"
file = "u.png"
sha256 = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"
[force]
shading = "height_map"
[[variant]]
[[variant]]
surface.function = "dip"
[[variant]]
surface.kind = "bump"
force.shading = "reference"
[[variant]]
surface.file = "v.png"
[variant.texture]
)",
                                    "f.toml", "/folder");
    ASSERT_EQ(study.cases.size(), 4u);
    EXPECT_EQ(study.cases[0].name, "height_map_file-u.png_shading-height_map");
    EXPECT_EQ(study.cases[0].scene.surface.map.path, "/folder/u.png");
    EXPECT_EQ(study.cases[0].scene.surface.map.sha256.size(), 64u);
    EXPECT_EQ(study.cases[1].name, "height_map_function-dip_shading-height_map");
    EXPECT_EQ(study.cases[1].scene.surface.map.path, "");
    EXPECT_EQ(study.cases[2].name, "bump_shading-reference");
    EXPECT_EQ(study.cases[3].name, "height_map_file-v.png_shading-height_map_texture.function-sine");
    EXPECT_EQ(study.cases[3].scene.surface.map.sha256, ""); // the digest was the other file's
    ASSERT_TRUE(study.cases[3].scene.texture);
    EXPECT_EQ(study.cases[3].scene.texture->stiffness, 200.0);
}

TEST(Study, DigestsStandBesideTheirFiles) {
    const std::string a(64, 'a');
    const std::string b(64, 'b');
    const Study study = parse_study("[surface]\nkind = \"height_map\"\nfile = [\"u.png\", \"v.png\"]\nsha256 = [\"" +
                                        a + "\", \"" + b + "\"]\n",
                                    "f.toml");
    ASSERT_EQ(study.cases.size(), 2u);
    EXPECT_EQ(study.cases[1].scene.surface.map.sha256, b);
    EXPECT_EQ(study_error("[surface]\nkind = \"height_map\"\nfile = [\"u.png\", \"v.png\"]\nsha256 = \"" + a + "\"\n"),
              "f.toml:4:1: \"sha256\" needs one digest for each file: 1 for 2");
    EXPECT_EQ(study_error("[surface]\nsha256 = \"" + a + "\"\n"), "f.toml:2:1: \"sha256\" needs \"file\" beside it");
    EXPECT_EQ(study_error("[surface]\nkind = \"height_map\"\nfile = [\"a/u.png\", \"b/u.png\"]\n"),
              "f.toml:3:20: two files are named \"u.png\"; results name files without their folders, so rename one");
}

TEST(Study, OneSceneRefusesASweep) {
    const auto error = [](std::string_view text) { return usage_error([&] { parse_scene(text, "f.toml"); }); };
    EXPECT_EQ(error("[surface]\nradius = [\"600 mil\", \"1 in\"]\n"),
              "f.toml:2:1: \"surface.radius\" is a sweep axis of 2 values; one scene is wanted here: leave one value, "
              "or use sweep");
    EXPECT_EQ(error("[[variant]]\n[[variant]]\n"),
              "f.toml:2:1: a second [[variant]]; one scene is wanted here: leave one, or use sweep");
    EXPECT_EQ(error("[surface]\nradius = [\"600 mil\"]\n[[variant]]\nsurface.facets = 2\n"), "(no error)");
    const std::vector<Override> radius{{"surface.radius", "1 in"}};
    EXPECT_EQ(parse_scene("[surface]\nradius = [\"600 mil\", \"1 in\"]\n", "f.toml", {}, radius).scene.surface.radius,
              0.0254);
}

TEST(Study, TooManyCases) {
    std::string list = "1";
    for (int i = 2; i <= 1000; ++i)
        list += ", " + std::to_string(i);
    const std::string axes =
        "[surface]\nfacets = [" + list + "]\n[grid]\nsize = [[1, 1, 1], [2, 1, 1]]\n[force]\nstiffness = [";
    std::string stiffness = "\"1 N/m\"";
    for (int i = 2; i <= 51; ++i)
        stiffness += ", \"" + std::to_string(i) + " N/m\"";
    EXPECT_EQ(study_error(axes + stiffness + "]\n"),
              "f.toml:6:1: the axes cross to more than 100000 cases; split the study");
}

} // namespace
} // namespace forceshade
