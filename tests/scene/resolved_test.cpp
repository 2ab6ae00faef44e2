// Resolved TOML is complete and canonical: reading it gives the same scenes.
#include "host/scene/study.h"

#include "host/error.h"
#include "tests/scene/errors.h"
#include "tests/scene/random_study.h"

#include <gtest/gtest.h>

namespace forceshade {
namespace {

using testing::says;

TEST(Resolved, CaseListsEveryKeyThatApplies) {
    const Case one =
        parse_scene("[surface]\nradius = \"+600   mil\"\nfacets = 2\n[force]\nshading = \"reference\"\n", "f.toml");
    EXPECT_EQ(resolved_toml(one), R"([surface]
kind = "bump"
width = "1000 mil"
radius = "+600   mil"
facets = 2
facet_spacing = "equal_arc"

[force]
stiffness = "1 N/mm"
shading = "reference"
depth = "vertical"
reference = "normal"

[grid]
size = [256, 64, 128]
origin = ["-25 mm", "-6 mm", "-10 mm"]
spacing = "0.2 mm"

[output]
channels = ["force"]
compression = "zip"
pixel = "float"

[run]
precision = "f32"
)");
}

TEST(Resolved, FilesByBaseNameAndDigest) {
    const std::string text = "[surface]\nkind = \"height_map\"\nfile = [\"/secret/place/u.png\", \"v.png\"]\n";
    Study study = parse_study(text, "f.toml", "/home/user");
    EXPECT_FALSE(says(resolved_toml(study), "sha256"));
    study.cases[0].scene.surface.map.sha256 = std::string(64, 'a');
    EXPECT_FALSE(says(resolved_toml(study), "sha256")); // one of two would be no list of both
    study.cases[1].scene.surface.map.sha256 = std::string(64, 'b');
    const std::string one = resolved_toml(study.cases[0]);
    EXPECT_TRUE(says(one, "file = \"u.png\"\nsha256 = \"" + std::string(64, 'a') + "\"\n"));
    const std::string all = resolved_toml(study);
    EXPECT_TRUE(says(all, "file = [\"u.png\", \"v.png\"]\nsha256 = [\"aaa"));
    for (const std::string& resolved : {one, all}) {
        EXPECT_FALSE(says(resolved, "secret"));
        EXPECT_FALSE(says(resolved, "/home"));
    }
    const Study again = parse_study(all, "f.toml", "/home/user");
    EXPECT_EQ(again.cases.at(1).scene, study.cases[1].scene);
}

TEST(Resolved, OverridesAreInIt) {
    const std::vector<Override> overrides{{"run.precision", "f64"}, {"surface.facets", "[5, 6]"}};
    const Study study = default_study(overrides);
    const std::string text = resolved_toml(study);
    EXPECT_TRUE(says(text, "precision = \"f64\""));
    const Study again = parse_study(text, "f.toml");
    ASSERT_EQ(again.cases.size(), study.cases.size());
    for (std::size_t i = 0; i < study.cases.size(); ++i) {
        EXPECT_EQ(again.cases[i].name, study.cases[i].name);
        EXPECT_EQ(again.cases[i].scene, study.cases[i].scene);
    }
}

TEST(Resolved, VibrationAloneHasNoHeightMap) {
    const Case alone =
        parse_scene("[texture]\nvibration = \"m.xml\"\nvibration_mass = \"20 g\"\n", "f.toml", "/folder");
    EXPECT_FALSE(alone.scene.texture);
    ASSERT_TRUE(alone.scene.vibration);
    EXPECT_EQ(alone.scene.vibration->path, "/folder/m.xml");
    EXPECT_EQ(alone.scene.vibration->mass, 0.02);
    EXPECT_EQ(resolved_toml(alone).find("function"), std::string::npos);
    EXPECT_EQ(parse_scene(resolved_toml(alone), "again.toml", "/folder").scene, alone.scene);

    Case both = parse_scene("[texture]\nstiffness = \"1 N/mm\"\nvibration = \"m.xml\"\n", "f.toml", "/folder");
    ASSERT_TRUE(both.scene.texture);
    EXPECT_EQ(both.scene.texture->map.function, MapFunction::sine);
    EXPECT_EQ(both.scene.vibration->mass, 0.05);
    both.scene.vibration->sha256 = std::string(64, 'a');
    const std::string text = resolved_toml(both);
    EXPECT_NE(text.find("vibration_sha256 = \"" + std::string(64, 'a')), std::string::npos) << text;
    EXPECT_EQ(parse_scene(text, "again.toml", "/folder").scene, both.scene);

    EXPECT_FALSE(parse_scene("[texture]\n", "f.toml").scene.vibration);
    EXPECT_FALSE(parse_scene("", "f.toml").scene.friction);
    EXPECT_EQ(parse_scene("[friction]\n", "f.toml").scene.friction, FrictionSpec{});
    EXPECT_TRUE(test::study_error("[texture]\nvibration_mass = \"1 g\"\n").starts_with("f.toml:2:1: "));
    EXPECT_TRUE(test::study_error("[texture]\nvibration_sha256 = \"" + std::string(64, 'a') + "\"\n")
                    .starts_with("f.toml:2:1: \"vibration_sha256\" needs a \"vibration\""));
}

void expect_same(const Study& first, const Study& second) {
    RC_ASSERT(first.cases.size() == second.cases.size());
    for (std::size_t i = 0; i < first.cases.size(); ++i) {
        RC_ASSERT(first.cases[i].name == second.cases[i].name);
        RC_ASSERT(first.cases[i].scene == second.cases[i].scene);
        RC_ASSERT(resolved_toml(first.cases[i]) == resolved_toml(second.cases[i]));
        RC_ASSERT(first.cases[i].varied == second.cases[i].varied);
    }
}

TEST(Resolved, ReadsBackAsTheSame) {
    int valid = 0;
    EXPECT_TRUE(rc::check([&valid] {
        const std::string text = test::random_study();
        const std::vector<Override> overrides = test::random_overrides();
        Study study;
        try {
            study = parse_study(text, "random.toml", "/folder", overrides);
        } catch (const UsageError&) {
            return;
        }
        ++valid;
        const std::string resolved = resolved_toml(study);
        RC_LOG() << text << "-----\n" << resolved;
        const Study again = parse_study(resolved, "resolved.toml", "/folder");
        expect_same(study, again);
        RC_ASSERT(resolved_toml(again) == resolved);
        for (const Case& one : study.cases) {
            const Case back = parse_scene(resolved_toml(one), "case.toml", "/folder");
            RC_ASSERT(back.scene == one.scene);
            RC_ASSERT(resolved_toml(back) == resolved_toml(one));
        }
    }));
    EXPECT_GT(valid, 15); // the generator must not drown in what is refused
}

} // namespace
} // namespace forceshade
