// The schema of scenes, scenes to start from, and what is given as a scene and is none.
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/scene/scene.h"
#include "host/scene/schema.h"
#include "host/scene/schema_json.h"
#include "host/scene/study.h"
#include "host/scene/value.h"
#include "host/spelling.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {

TEST(Schema, TextParsesAsTheDefaultScene) {
    const Study study = parse_study(schema_text(), "schema");
    ASSERT_EQ(study.cases.size(), 1u);
    EXPECT_EQ(study.cases.front().scene, Scene{});
    EXPECT_TRUE(study.warnings.empty());
}

TEST(Schema, DefaultsAreThoseOfTheStructs) {
    EXPECT_EQ(parse_study("", "empty").cases.front().scene, Scene{});
}

TEST(Schema, KeysAreUniqueAndDocumented) {
    std::set<std::string> paths;
    for (const Key& key : schema_keys()) {
        EXPECT_TRUE(paths.insert(key.path()).second) << key.path();
        EXPECT_FALSE(key.doc.empty()) << key.path();
        EXPECT_EQ(&schema_keys()[static_cast<std::size_t>(find_key(key.path()))], &key);
        // What a quantity may be as a table is told in its own place.
        EXPECT_EQ(schema_text().find(std::string(key.name) + " = ") == std::string::npos, key.spread_part)
            << key.path();
    }
    EXPECT_EQ(find_key("surface"), -1);
    EXPECT_EQ(find_key("surface.radius.x"), -1);
}

TEST(Schema, JsonHasEveryKey) {
    const auto json = schema_json();
    ASSERT_EQ(json["keys"].size(), schema_keys().size());
    EXPECT_EQ(json["keys"][2]["key"], "surface.radius");
    EXPECT_EQ(json["keys"][2]["unit"], "m");
}

// A key that is left out of a scene to start from, or misspelt in it, would be its user's first error.
TEST(Starter, EachIsAStudyWithoutWarnings) {
    for (const std::string_view what : kStarters) {
        const Study study = parse_study(starter_scene(what, "a.obj", "mm", "s.toml"), "starter");
        EXPECT_TRUE(study.warnings.empty()) << what;
        EXPECT_EQ(study.cases.size(), what == "experiment" ? 14u : 1u) << what;
        EXPECT_EQ(study.cases.front().scene.paths.has_value(), what == "paths" || what == "live");
    }
}

TEST(Nearest, FindsWhatWasMeant) {
    EXPECT_EQ(edit_distance("stifness", "stiffness"), 1u);
    EXPECT_EQ(edit_distance("raduis", "radius"), 1u);
    EXPECT_EQ(edit_distance("", "abc"), 3u);
    const std::vector<std::string> words{"mm", "radius", "width"};
    EXPECT_EQ(nearest("MM", words), "mm");
    EXPECT_EQ(nearest("raidus", words), "radius");
    EXPECT_EQ(nearest("facets", words), "");
    EXPECT_EQ(nearest(std::string(100000, 'r'), words), "");
}

using test::usage_error;
using testing::says;

class SceneTextFile : public ::testing::Test {
protected:
    // What reading a file of this name and content says, without the folder.
    std::string error_of(const std::string& name, const std::string& content) const {
        std::string error = usage_error([&] { read_study(folder_.write(name, content)); });
        const std::string prefix = folder_.path().string() + "/";
        for (std::size_t at = 0; (at = error.find(prefix)) != error.npos;)
            error.erase(at, prefix.size());
        return error;
    }

    const testing::Folder folder_;
};

TEST_F(SceneTextFile, AMeshAnImageAndATableSayHowTheyAreUsed) {
    EXPECT_EQ(error_of("bunny.obj", "v 0 0 0\n"),
              "bunny.obj is a mesh, not a scene; a scene of it: forceshade init mesh bunny.obj -o bunny.toml");
    EXPECT_EQ(error_of("x", "ply\nformat ascii 1.0\n").substr(0, 28), "x is a mesh, not a scene; a ");
    EXPECT_EQ(error_of("u.toml", "\x76\x2f\x31\x01...").substr(0, 41), "u.toml is an image or a volume, not a sce");
    EXPECT_TRUE(says(error_of("u.png", ""), "kind = \"height_map\" and file = \"u.png\""));
    EXPECT_TRUE(says(error_of("felt.csv", "path,t,x,y,z\n"), "--paths felt.csv"));
}

TEST_F(SceneTextFile, AnEmptySceneIsRefused) {
    for (const char* text : {"", "\n\n", "# only a comment", "\xEF\xBB\xBF\r\n  # and\r\n"})
        EXPECT_EQ(
            error_of("s.toml", text),
            "s.toml has no [surface], nor anything else; a scene to start from: forceshade init bump -o bump.toml");
    EXPECT_EQ(error_of("s.toml", "[surface]\n"), "(no error)");
}

TEST_F(SceneTextFile, AFolderNamesTheScenesInIt) {
    folder_.write("b.toml", "");
    folder_.write("a.toml", "");
    const std::string error = testing::message_of<IoError>([&] { read_study(folder_.path()); });
    EXPECT_TRUE(error.ends_with("not a TOML file; in it: a.toml, b.toml")) << error;
}

} // namespace
} // namespace forceshade
