#include "host/scene/schema.h"
#include "host/scene/schema_json.h"

#include "host/scene/scene.h"
#include "host/scene/starter.h"
#include "host/scene/study.h"
#include "host/scene/value.h"

#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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
        const Study study = parse_study(starter_scene(what, "a.obj", "s.toml"), "starter");
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

} // namespace
} // namespace forceshade
