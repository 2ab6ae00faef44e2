// A study's folder holds what its study.json names, and nothing that an earlier run left.
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/study/study_data.h"
#include "tests/io/folder.h"

namespace forceshade::study {
namespace {

using Names = std::vector<std::string>;

StudyData data_with(const Names& tables, const std::string& study = "energy") {
    StudyData data;
    data.study = study;
    for (const std::string& name : tables)
        data.tables.push_back({name, name, {{"x_m", "m", "where"}}, {{cell(0.25)}}});
    return data;
}

class StudyFolder : public ::testing::Test {
protected:
    // A run with volumes, whose contents are their names; returns what stayed changed.
    Names run(const Names& tables, const Names& pictures, const Names& volumes = {},
              const std::string& study = "energy") {
        StudyData data = data_with(tables, study);
        std::vector<TextFile> texts;
        for (const std::string& name : pictures)
            texts.push_back({name, "<svg/>"});
        for (const std::string& name : volumes) {
            folder_.write(name, name);
            data.volumes.push_back({name, sha256_of(name), name.size()});
        }
        return write_data(folder_.path(), data, texts);
    }

    testing::Folder folder_;
};

TEST_F(StudyFolder, IsNamedFileByFile) {
    run({"loops"}, {"loops.svg"}, {"curl.exr"});
    const StudyData data = read_data(folder_.path());
    ASSERT_EQ(data.files.size(), 2u);
    EXPECT_EQ(data.files[0].name, "loops.csv");
    EXPECT_EQ(data.files[1].name, "loops.svg");
    for (const FileRecord& file : data.files) {
        const std::string text = folder_.read(file.name);
        EXPECT_FALSE(text.empty()) << file.name;
        EXPECT_EQ(file.sha256, sha256_of(text)) << file.name;
        EXPECT_EQ(file.bytes, text.size()) << file.name;
    }
}

TEST_F(StudyFolder, HoldsNothingOfARunBefore) {
    run({"loops", "curl"}, {"loops.svg", "bump.svg"}, {"bump.exr", "bump.curl.exr"});
    folder_.write("mine.csv", "kept");
    folder_.write("mine.exr", "kept");
    EXPECT_EQ(run({"curl", "front"}, {"mesh.svg"}, {"mesh.exr"}), Names{});
    EXPECT_EQ(folder_.names(),
              (Names{"curl.csv", "front.csv", "mesh.exr", "mesh.svg", "mine.csv", "mine.exr", "study.json"}));
    EXPECT_EQ(run({"curl", "front"}, {"mesh.svg"}, {"mesh.exr"}), Names{}) << "the same once more";
    EXPECT_EQ(folder_.names().size(), 7u);
}

TEST_F(StudyFolder, KeepsWhatWasChangedSince) {
    run({"loops", "curl"}, {"loops.svg"}, {"bump.exr"});
    folder_.write("loops.csv", "x_m\n7\n");
    folder_.write("bump.exr", "another's");
    EXPECT_EQ(run({"front"}, {}), (Names{"loops.csv", "bump.exr"}));
    EXPECT_EQ(folder_.read("loops.csv"), "x_m\n7\n");
    EXPECT_EQ(folder_.names(), (Names{"bump.exr", "front.csv", "loops.csv", "study.json"}));
}

TEST_F(StudyFolder, KeepsWhatAnotherStudyOrNoAccountNames) {
    run({"loops"}, {});
    EXPECT_EQ(run({"points"}, {}, {}, "error-time"), Names{});
    EXPECT_TRUE(std::filesystem::exists(folder_ / "loops.csv")) << "the other study's";
    for (const char* account : {"", "{", "[]", "{\"study\": 3}", "{\"study\": \"energy\", \"files\": 3}",
                                "{\"study\": \"energy\", \"files\": [{\"name\": \"loops.csv\"}]}"}) {
        folder_.write("study.json", account);
        EXPECT_EQ(run({"front"}, {}), Names{}) << account;
        EXPECT_TRUE(std::filesystem::exists(folder_ / "loops.csv")) << account;
    }
}

TEST_F(StudyFolder, FollowsNoNameOutOfIt) {
    const std::filesystem::path own = folder_ / "energy";
    std::filesystem::create_directories(own / "steps.d");
    folder_.write("outside.csv", "text");
    folder_.write("energy/steps.d/a.json", "text");
    std::filesystem::create_symlink(folder_ / "outside.csv", own / "linked.csv");
    StudyData data = data_with({});
    for (const char* name : {"../outside.csv", "steps.d/a.json", "linked.csv", "steps.d", ""})
        data.volumes.push_back({name, sha256_of("text"), 4});
    write_data(own, data, {});
    StudyData next = data_with({"front"});
    EXPECT_EQ(write_data(own, next, {}), Names{});
    EXPECT_EQ(folder_.read("outside.csv"), "text");
    EXPECT_EQ(folder_.read("energy/steps.d/a.json"), "text");
    EXPECT_TRUE(std::filesystem::is_symlink(own / "linked.csv"));
}

// Whatever ends a run before its account stands: the one before still names its own files, for the next run.
TEST_F(StudyFolder, IsClearedByTheNextRunAfterOneThatFailed) {
    run({"loops"}, {});
    std::filesystem::create_directory(folder_ / "broken.svg");
    EXPECT_THROW(run({"points"}, {"broken.svg"}), IoError);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "loops.csv"));
    EXPECT_EQ(read_data(folder_.path()).tables[0].name, "loops");
    run({"points"}, {"whole.svg"});
    EXPECT_EQ(folder_.names(), (Names{"broken.svg", "points.csv", "study.json", "whole.svg"}));
}

} // namespace
} // namespace forceshade::study
