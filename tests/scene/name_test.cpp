// Case names: what they list, and that they are safe and unique as file names.
#include "host/scene/study.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace forceshade {
namespace {

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
    EXPECT_EQ(cases("[surface]\nfacets = [7]\n").at(0).name, "bump");
}

TEST(CaseName, FollowsTheFile) {
    EXPECT_EQ(
        cases(
            "[force]\nshading = [\"none\", \"reference\"]\n[surface]\nfacets = [1, 2]\nradius = [\"1 in\", \"2 in\"]\n")
            .at(0)
            .name,
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
    const auto both =
        cases("[surface]\nkind = \"height_map\"\nfile = \"u.png\"\nsize = [[\"1 m\", \"2 m\"], [\"2 m\", \"1 m\"]]\n"
              "[grid]\nsize = [[1, 2, 3], [4, 5, 6]]\n");
    EXPECT_EQ(both.at(0).name, "height_map_surface.size-1mx2m_grid.size-1x2x3");
}

TEST(CaseName, SaysWhetherThereIsATexture) {
    const auto two = cases("[[variant]]\n[[variant]]\n[variant.texture]\nfunction = \"dip\"\n");
    EXPECT_EQ(two.at(0).name, "bump");
    EXPECT_EQ(two.at(1).name, "bump_texture.function-dip");
}

TEST(CaseName, SafeEverywhere) {
    const auto micro = cases("[grid]\nspacing = [[\"100 \u00b5m\"], [\"1 mm\", \"2 mm\", \"3 mm\"]]\n");
    EXPECT_EQ(micro.at(0).name, "bump_spacing-100um");
    EXPECT_EQ(micro.at(1).name, "bump_spacing-1mmx2mmx3mm");
    const auto files = cases("[surface]\nkind = \"height_map\"\nfile = [\"/a/b c?.png\", \"x/d\u00e9.\", \"..e\"]\n");
    EXPECT_EQ(files.at(0).name, "height_map_file-bc_.png");
    EXPECT_EQ(files.at(1).name, "height_map_file-d___");
    EXPECT_EQ(files.at(2).name, "height_map_file-..e");
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
