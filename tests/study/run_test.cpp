// Steps of a study: what was finished stays, what does not belong to the run is computed anew.
#include <csignal>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "host/program.h"
#include "host/study/run/study_run.h"
#include "tests/io/folder.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

void write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

class Run : public ::testing::Test {
protected:
    Run() {
        options_.folder = folder_ / "out/energy";
        options_.quiet = true;
        options_.engine.cpu = true;
    }

    // Three steps that count how often they were computed.
    std::vector<Step> steps() {
        std::vector<Step> made;
        for (const char* name : {"a", "b.1", "c-2"})
            made.push_back({name, [this, name] {
                                return Json{{"name", name}, {"value", 0.1}, {"turn", ++computed_}};
                            }});
        return made;
    }
    std::vector<Json> run(const std::string& study = "energy") { return StudyRun(study, options_).run(steps()); }
    std::filesystem::path step(const std::string& name) const { return options_.folder / "steps.d" / (name + ".json"); }

    // How many of the steps a run computes.
    int computed_by_run(const std::string& study = "energy") {
        const int before = computed_;
        run(study);
        return computed_ - before;
    }

    testing::Folder folder_;
    StudyOptions options_;
    int computed_ = 0;
};

TEST_F(Run, IsNotComputedAgain) {
    const std::vector<Json> first = run();
    ASSERT_EQ(first.size(), 3u);
    EXPECT_EQ(first[1]["name"], "b.1");
    EXPECT_EQ(run(), first) << "from the files";
    EXPECT_EQ(computed_, 3);
    const Json kept = Json::parse(read(step("b.1")));
    EXPECT_EQ(kept["result"], first[1]);
    EXPECT_GE(kept["seconds"].get<double>(), 0);
}

TEST_F(Run, ComputesOnlyWhatIsMissing) {
    run();
    std::filesystem::remove(step("b.1"));
    EXPECT_EQ(computed_by_run(), 1);
    std::filesystem::remove_all(options_.folder / "steps.d");
    EXPECT_EQ(computed_by_run(), 3);
    options_.fresh = true;
    EXPECT_EQ(computed_by_run(), 3);
}

TEST_F(Run, OfAnotherStudySceneOrFormIsComputedAnew) {
    run();
    EXPECT_EQ(computed_by_run("stability"), 3);
    EXPECT_EQ(computed_by_run(), 3);
    options_.quick = true;
    EXPECT_EQ(computed_by_run(), 3);
    options_.quick = false;
    EXPECT_EQ(computed_by_run(), 0) << "a quick run takes nothing away from a full one";
    options_.scene = parse_scene("[surface]\nfacets = 2\n", "test");
    EXPECT_EQ(computed_by_run(), 3);
    EXPECT_EQ(computed_by_run(), 0);
    options_.scene = parse_scene("[surface]\nfacets = 3\n", "test");
    EXPECT_EQ(computed_by_run(), 3);
}

TEST_F(Run, ComputesDamagedStepsAnew) {
    run();
    const std::string sound = read(step("b.1"));
    Json changed = Json::parse(sound);
    changed["result"]["value"] = 0.2;
    Json stranger = Json::parse(sound);
    stranger["fingerprint"] = 3;
    Json nameless = Json::parse(sound);
    nameless.erase("fingerprint");
    Json timeless = Json::parse(sound);
    timeless["seconds"] = "long";
    for (const std::string& damaged :
         {std::string(), std::string("{"), std::string("[]"), std::string("null"), sound.substr(0, sound.size() / 2),
          std::string("{}"), std::string("\0\xff", 2), changed.dump(), stranger.dump(), nameless.dump(),
          timeless.dump(), sound + sound}) {
        write(step("b.1"), damaged);
        EXPECT_EQ(computed_by_run(), 1) << damaged;
        EXPECT_EQ(computed_by_run(), 0) << "put right: " << damaged;
    }
}

TEST_F(Run, KeepsWhatStoodBeforeAStepThatFails) {
    std::vector<Step> failing = steps();
    failing[2].compute = []() -> Json { throw UsageError("the step fails"); };
    EXPECT_THROW(StudyRun("energy", options_).run(failing), UsageError);
    EXPECT_EQ(computed_, 2);
    EXPECT_FALSE(std::filesystem::exists(step("c-2")));
    EXPECT_EQ(computed_by_run(), 1) << "the one that failed";
}

// A number that is none is nothing, in the first run as in the next.
TEST_F(Run, GivesTheSameAtFirstAsFromFiles) {
    const std::vector<Step> odd{{"odd", [] {
                                     return Json{{"none", std::numeric_limits<double>::quiet_NaN()},
                                                 {"third", 1.0 / 3},
                                                 {"tiny", 5e-324},
                                                 {"minus", -0.0},
                                                 {"word", "\u00b5\n\""}};
                                 }}};
    const Json first = StudyRun("energy", options_).run(odd)[0], second = StudyRun("energy", options_).run(odd)[0];
    EXPECT_TRUE(first["none"].is_null());
    EXPECT_EQ(first.dump(), second.dump());
    EXPECT_EQ(second["third"].get<double>(), 1.0 / 3);
    EXPECT_TRUE(std::signbit(second["minus"].get<double>()));
}

TEST_F(Run, ClearsWhatAKilledOneLeft) {
    run();
    for (const char* stale :
         {"out/energy/steps.d/.a.json.fs0123456789abcdef.tmp", "out/energy/.x.exr.fs0123456789abcdef.tmp"})
        write(folder_ / stale, "half");
    EXPECT_EQ(computed_by_run(), 0);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/energy/steps.d/.a.json.fs0123456789abcdef.tmp"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/energy/.x.exr.fs0123456789abcdef.tmp"));
}

TEST_F(Run, WithoutAFolderToWriteIsAnIoError) {
    write(folder_ / "file", "");
    options_.folder = folder_ / "file/energy";
    EXPECT_THROW(run(), IoError);
    std::filesystem::create_directories(folder_ / "out/energy");
    write(folder_ / "out/energy/steps.d", "");
    options_.folder = folder_ / "out/energy";
    EXPECT_THROW(run(), IoError);
}

TEST_F(Run, DescribesItself) {
    options_.quick = true;
    StudyRun study("energy", options_);
    study.run({{"slow", [] { return Json(1); }}});
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
        std::vector<Step> interrupted = steps();
        interrupted[1].compute = [] {
            std::raise(SIGINT);
            return Json{{"name", "b.1"}};
        };
        bool thrown = false;
        try {
            StudyRun("energy", options_).run(interrupted);
        } catch (const Interrupted&) {
            thrown = true;
        }
        const bool kept = std::filesystem::exists(step("a")) && std::filesystem::exists(step("b.1"));
        std::_Exit(thrown && kept && !std::filesystem::exists(step("c-2")) ? 42 : 1);
    };
    EXPECT_EXIT(interrupted_run(), ::testing::ExitedWithCode(42), "");
}

} // namespace
} // namespace forceshade::study
