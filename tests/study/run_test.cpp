// Parts of a study, and what a run says of itself.
#include <csignal>

#include <gtest/gtest.h>

#include "host/output/files.h"
#include "host/program.h"
#include "host/study/study_run.h"
#include "tests/io/folder.h"

namespace forceshade::study {
namespace {

class Run : public ::testing::Test {
protected:
    Run() {
        options_.folder = folder_ / "out/energy";
        options_.engine.cpu = true;
    }
    std::string fingerprint(const std::string& study = "energy") const {
        return StudyRun(study, options_).fingerprint();
    }

    testing::Folder folder_;
    StudyOptions options_;
};

TEST_F(Run, TakesItsPartsInTheirOrder) {
    std::string done;
    std::vector<Part> parts{{"a", [&] { done += "a"; }}, {"b", [&] { done += "b"; }}};
    StudyRun("energy", options_).run(parts);
    EXPECT_EQ(done, "ab");
    parts[0].compute = [] { throw UsageError("the part fails"); };
    EXPECT_THROW(StudyRun("energy", options_).run(parts), UsageError);
    EXPECT_EQ(done, "ab") << "none after the one that failed";
}

TEST_F(Run, OfAnotherStudySceneOrFormIsAnother) {
    const std::string own = fingerprint();
    EXPECT_EQ(fingerprint(), own);
    EXPECT_NE(fingerprint("stability"), own);
    options_.quick = true;
    EXPECT_NE(fingerprint(), own);
    options_.quick = false;
    options_.scene = parse_scene("[surface]\nfacets = 2\n", "test");
    const std::string two = fingerprint();
    EXPECT_NE(two, own);
    options_.scene = parse_scene("[surface]\nfacets = 3\n", "test");
    EXPECT_NE(fingerprint(), two);
}

TEST_F(Run, ClearsWhatAKilledOneLeft) {
    std::filesystem::create_directories(folder_ / "out/energy");
    const std::filesystem::path stale = TemporaryFile(folder_ / "out/energy/x.exr").temporary_path();
    testing::write_text(stale, "half");
    fingerprint();
    EXPECT_FALSE(std::filesystem::exists(stale));
}

TEST_F(Run, WithoutAFolderToWriteIsAnIoError) {
    folder_.write("file", "");
    options_.folder = folder_ / "file/energy";
    EXPECT_THROW(fingerprint(), IoError);
}

TEST_F(Run, DescribesItself) {
    options_.quick = true;
    StudyRun study("energy", options_);
    study.run({{"slow", [] {}}});
    const StudyData data = study.data();
    EXPECT_EQ(data.study, "energy");
    EXPECT_EQ(data.engine, "cpu");
    EXPECT_EQ(data.program, version());
    EXPECT_TRUE(data.quick);
    EXPECT_TRUE(data.scene.empty());
    EXPECT_GE(data.seconds, 0);
    EXPECT_GT(data.cores, 0u);
}

// The flag of an interrupt stays raised: in a process of its own.
TEST_F(Run, EndsBetweenStepsWhenInterrupted) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto interrupted_run = [this] {
        catch_interrupts();
        bool went_on = false, thrown = false;
        try {
            StudyRun("energy", options_).run({{"raise", [] { std::raise(SIGINT); }}, {"go on", [&] {
                                                                                          went_on = true;
                                                                                      }}});
        } catch (const Interrupted&) {
            thrown = true;
        }
        std::_Exit(thrown && !went_on ? 42 : 1);
    };
    EXPECT_EXIT(interrupted_run(), ::testing::ExitedWithCode(42), "");
}

} // namespace
} // namespace forceshade::study
