// What is given as a scene and is none.
#include "host/scene/scene_text.h"

#include <fstream>

#include <gtest/gtest.h>

#include "host/scene/study.h"
#include "tests/scene/errors.h"

namespace forceshade {
namespace {

using test::usage_error;

class SceneTextFile : public ::testing::Test {
protected:
    SceneTextFile() { std::filesystem::create_directories(folder_); }
    ~SceneTextFile() override { std::filesystem::remove_all(folder_); }

    // What reading a file of this name and content says, without the folder.
    std::string error_of(const std::string& name, const std::string& content) const {
        const std::filesystem::path file = folder_ / name;
        std::ofstream(file, std::ios::binary) << content;
        std::string error = usage_error([&] { read_study(file); });
        const std::string prefix = folder_.string() + "/";
        for (std::size_t at = 0; (at = error.find(prefix)) != error.npos;)
            error.erase(at, prefix.size());
        return error;
    }

    std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "scene_text_test";
};

TEST_F(SceneTextFile, AMeshAnImageAndATableSayHowTheyAreUsed) {
    EXPECT_EQ(error_of("bunny.obj", "v 0 0 0\n"),
              "bunny.obj is a mesh, not a scene; a scene of it: forceshade init mesh bunny.obj -o bunny.toml");
    EXPECT_EQ(error_of("x", "ply\nformat ascii 1.0\n").substr(0, 28), "x is a mesh, not a scene; a ");
    EXPECT_EQ(error_of("u.toml", "\x76\x2f\x31\x01...").substr(0, 41), "u.toml is an image or a volume, not a sce");
    EXPECT_NE(error_of("u.png", "").find("kind = \"height_map\" and file = \"u.png\""), std::string::npos);
    EXPECT_NE(error_of("felt.csv", "path,t,x,y,z\n").find("--paths felt.csv"), std::string::npos);
}

TEST_F(SceneTextFile, AnEmptySceneIsRefused) {
    for (const char* text : {"", "\n\n", "# only a comment", "\xEF\xBB\xBF\r\n  # and\r\n"})
        EXPECT_EQ(
            error_of("s.toml", text),
            "s.toml has no [surface], nor anything else; a scene to start from: forceshade init bump -o bump.toml");
    EXPECT_EQ(error_of("s.toml", "[surface]\n"), "(no error)");
}

TEST_F(SceneTextFile, AFolderNamesTheScenesInIt) {
    std::ofstream(folder_ / "b.toml") << "";
    std::ofstream(folder_ / "a.toml") << "";
    try {
        read_study(folder_);
        FAIL();
    } catch (const IoError& error) {
        EXPECT_TRUE(std::string(error.what()).ends_with("a TOML file is wanted; in it: a.toml, b.toml"))
            << error.what();
    }
}

} // namespace
} // namespace forceshade
