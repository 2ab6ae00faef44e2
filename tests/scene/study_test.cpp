// Axes, variants, cases that come twice, and the names of cases: what they list, safe and unique as file names.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "host/scene/study.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {

using test::expect_places;
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
    expect_places({
        {"[surface]\nkind = \"height_map\"\nfile = [\"u.png\", \"v.png\"]\nsha256 = \"" + a + "\"\n", "4:1"},
        {"[surface]\nsha256 = \"" + a + "\"\n", "2:1"},
        {"[surface]\nkind = \"height_map\"\nfile = [\"a/u.png\", \"b/u.png\"]\n", "3:20"},
    });
}

TEST(Study, OneSceneRefusesASweep) {
    const auto error = [](std::string_view text) { return usage_error([&] { parse_scene(text, "f.toml"); }); };
    EXPECT_EQ(error("[surface]\nradius = [\"600 mil\", \"1 in\"]\n"),
              "f.toml:2:1: \"surface.radius\" is a sweep axis of 2 values; this takes one scene: leave one value, "
              "or use sweep");
    EXPECT_EQ(error("[[variant]]\n[[variant]]\n"),
              "f.toml:2:1: a second [[variant]]; this takes one scene: leave one, or use sweep");
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
    expect_places({{axes + stiffness + "]\n", "6:1"}});
}

std::vector<Case> cases(std::string_view text) {
    return parse_study(text, "f.toml").cases;
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    return text;
}

void expect_unique(const std::vector<Case>& all) {
    std::set<std::string> names;
    for (const Case& one : all) {
        EXPECT_TRUE(names.insert(lower_case(one.name)).second) << one.name;
        EXPECT_LE(one.name.size(), 150u);
        EXPECT_EQ(one.name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._+-"),
                  std::string::npos)
            << one.name;
    }
}

TEST(CaseName, UniqueInTheDefaultStudy) {
    expect_unique(default_study().cases);
}

TEST(CaseName, OnlyTheKindIfNothingVaries) {
    EXPECT_EQ(names("[surface]\nfacets = [7]\n"), Names{"bump"});
}

TEST(CaseName, FollowsTheFile) {
    EXPECT_EQ(names("[force]\nshading = [\"none\", \"reference\"]\n[surface]\nfacets = [1, 2]\n"
                    "radius = [\"1 in\", \"2 in\"]\n")[0],
              "bump_shading-none_facets-1_radius-1in");
}

TEST(CaseName, NamesTheTableWhereAKeyIsAmbiguous) {
    const auto both =
        cases("[force]\nstiffness = [\"1 N/mm\", \"2 N/mm\"]\n[texture]\nstiffness = [\"0 N/m\", \"1 N/m\"]\n");
    EXPECT_EQ(both.at(1).name, "bump_stiffness-1N-mm_texture.stiffness-1N-m");
    EXPECT_EQ(both.at(1).varied.at(2), (std::pair<std::string, std::string>{"texture.stiffness", "1 N/m"}));
    EXPECT_EQ(cases("[texture]\nstiffness = [\"0 N/m\", \"1 N/m\"]\n").at(0).name, "bump_texture.stiffness-0N-m");
}

TEST(CaseName, NamesBothTablesWhereNeitherIsATexture) {
    EXPECT_EQ(
        names("[surface]\nkind = \"height_map\"\nfile = \"u.png\"\nsize = [[\"1 m\", \"2 m\"], [\"2 m\", \"1 m\"]]\n"
              "[grid]\nsize = [[1, 2, 3], [4, 5, 6]]\n")[0],
        "height_map_surface.size-1mx2m_grid.size-1x2x3");
}

TEST(CaseName, SaysWhetherThereIsATexture) {
    EXPECT_EQ(names("[[variant]]\n[[variant]]\n[variant.texture]\nfunction = \"dip\"\n"),
              (Names{"bump", "bump_texture.function-dip"}));
}

TEST(CaseName, SafeEverywhere) {
    EXPECT_EQ(names("[grid]\nspacing = [[\"100 \u00b5m\"], [\"1 mm\", \"2 mm\", \"3 mm\"]]\n"),
              (Names{"bump_spacing-100um", "bump_spacing-1mmx2mmx3mm"}));
    EXPECT_EQ(names("[surface]\nkind = \"height_map\"\nfile = [\"/a/b c?.png\", \"x/d\u00e9.\", \"..e\"]\n"),
              (Names{"height_map_file-bc_.png", "height_map_file-d___", "height_map_file-..e"}));
    expect_unique(cases("[surface]\nkind = \"height_map\"\nfile = [\"a b\", \"ab\", \"a?\", \"a!\", \"AB\"]\n"));
    expect_unique(cases("[force]\nstiffness = [\"1 mN/m\", \"1 MN/m\", \"2 MN/m\"]\n"));
}

TEST(CaseName, LongNamesEndInAHash) {
    const std::string first(200, 'a');
    const auto long_names =
        cases("[surface]\nkind = \"height_map\"\nfile = [\"" + first + "1\", \"" + first + "2\", \"b\"]\n");
    expect_unique(long_names);
    EXPECT_EQ(long_names.at(0).name.size(), 150u);
    EXPECT_EQ(long_names.at(2).name, "height_map_file-b");
}

} // namespace
} // namespace forceshade
