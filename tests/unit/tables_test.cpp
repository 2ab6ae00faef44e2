// What a scene switches on, and what it leaves out.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "host/field/prepared_case.h"
#include "host/scene/study.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

bool mentions(const std::vector<std::string>& omitted, const std::string& what) {
    return std::any_of(omitted.begin(), omitted.end(),
                       [&](const std::string& phrase) { return phrase.find(what) != std::string::npos; });
}

TEST(Tables, AFieldThatDoesNotDependOnYIsEvaluatedOnce) {
    Scene scene = bump(kRadii[0], 2);
    scene.grid.size = {8, 6, 4};
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 1u);
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::everything).y.size(), 6u);
    scene.output.channels = layout::kChannelForce | layout::kChannelProxy;
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 6u) << "a proxy has the probe's y";
    scene.output.channels = layout::kChannelForce;
    scene.texture = TextureSpec{100, {}};
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 1u) << "a cylinder does not depend on y";
    scene.texture->map.function = MapFunction::gaussian;
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 6u);
}

TEST(Tables, OnlyMapsInUseThatVaryAlongYMakeAFieldDependOnIt) {
    Scene scene = height_map({});
    scene.surface.map.function = MapFunction::gaussian;
    EXPECT_TRUE(depends_on_y(features_of(scene)));
    scene.force.shading = Shading::none;
    EXPECT_FALSE(depends_on_y(features_of(scene))) << "the map is not in use";
    scene.texture = TextureSpec{100, {}};
    scene.texture->map.function = MapFunction::sine;
    EXPECT_FALSE(depends_on_y(features_of(scene)));
    scene.texture->map.function = MapFunction::file;
    EXPECT_TRUE(depends_on_y(features_of(scene)));
    scene.texture->stiffness = 0;
    EXPECT_FALSE(depends_on_y(features_of(scene)));
}

TEST(Tables, AxesAreRoundedOnce) {
    Scene scene = bump(kRadii[0], 2);
    scene.grid.size = {1000, 1, 1};
    scene.grid.origin = {1000, 0, 0};
    scene.grid.spacing = {1e-4, 1e-4, 1e-4};
    const auto tables = make_tables<float>(scene, {}, Extent::everything);
    for (std::size_t i = 0; i < 1000; ++i)
        EXPECT_EQ(tables.x[i], static_cast<float>(1000 + 1e-4 * static_cast<double>(i)));
}

TEST(Tables, OnlyWhatTheSceneUsesIsSwitchedOn) {
    Scene scene = bump(kRadii[0], 2);
    scene.grid.size = {8, 6, 4};
    EXPECT_TRUE(mentions(omissions(scene), "shading"));
    EXPECT_TRUE(mentions(omissions(scene), "texture"));
    EXPECT_TRUE(mentions(omissions(scene), "5 of 6 y samples"));
    scene.field = false;
    EXPECT_FALSE(mentions(omissions(scene), "y samples")) << "paths alone have no samples of a grid";
    scene.field = true;
    scene.force.shading = Shading::reference;
    scene.texture = TextureSpec{100, {}};
    EXPECT_FALSE(mentions(omissions(scene), "shading"));
    EXPECT_FALSE(mentions(omissions(scene), "texture"));
    scene.texture->stiffness = 0;
    EXPECT_TRUE(mentions(omissions(scene), "texture")) << "a texture without stiffness is none";
    scene.force.reference = ReferenceDirection::radial;
    EXPECT_EQ(features_of(scene).reference, layout::kReferenceRadial);
    scene.force.shading = Shading::none;
    EXPECT_EQ(features_of(scene).reference, layout::kReferenceNormal) << "without shading no direction is borrowed";
    EXPECT_TRUE(make_tables<float>(height_map({}), {}, Extent::everything).facet_vertices.empty());
}

std::vector<std::string> scene_warnings(const std::string& toml) {
    return CasePreparation().prepare(parse_scene(toml, "scene")).warnings;
}

TEST(Warnings, OfAFinerGridThatLeavesOutAPartOfTheBump) {
    EXPECT_TRUE(scene_warnings("[surface]\nkind = \"bump\"\n").empty());
    EXPECT_TRUE(scene_warnings("[grid]\nspacing = \"0.1 mm\"\norigin = [\"0 mm\", \"0 mm\", \"0 mm\"]\n").empty());
    const auto found = scene_warnings("[grid]\nspacing = \"0.1 mm\"\n");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(mentions(found, "the grid ends at x = 0.5 mm, the bump at 12.7 mm")) << found.front();
}

TEST(Warnings, OfAMeshThatNoHandSpans) {
    const std::string file = testing::TempDir() + "forceshade_tetrahedron.obj";
    std::ofstream(file) << "v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 40\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    const std::string scene = "[surface]\nkind = \"mesh\"\nfile = \"" + file + "\"\n";
    EXPECT_TRUE(scene_warnings(scene + "unit = \"mm\"\n[grid]\nsamples = 4\n").empty());
    EXPECT_TRUE(mentions(scene_warnings(scene + "[grid]\nsamples = 4\n"), "is 40 m across"));
    std::filesystem::remove(file);
}

} // namespace
} // namespace forceshade::test
