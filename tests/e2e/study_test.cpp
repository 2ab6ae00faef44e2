// Studies as a user runs them: what they leave, and what goes wrong.
#include <csignal>
#include <thread>

#include "tests/e2e/small_disk.h"
#include "tests/e2e/study_workplace.h"

namespace forceshade::testing {
namespace {

using Json = nlohmann::json;

class EveryStudy : public Study, public ::testing::WithParamInterface<const char*> {};

TEST_P(EveryStudy, IsWholeAndComputesNothingAgain) {
    const std::string name = GetParam(), folder = "out/" + name;
    Launch launch = this->launch({"study", name, "--quick", "--out", "out", "--json"});
    launch.timeout = kStudyPatience;
    const Outcome outcome = run(launch);
    ASSERT_EQ(outcome.code, 0) << outcome.error;
    expect_whole(folder, name);
    EXPECT_EQ(Json::parse(outcome.out), read_json(folder + "/study.json"));
    for (const Json& finding : read_json(folder + "/study.json")["findings"])
        EXPECT_TRUE(says(outcome.error, finding["text"].get<std::string>())) << "told on the way";

    const Tree before = tree_of(path(folder));
    expect_study(quick(name, "out"));
    EXPECT_EQ(differences(before, tree_of(path(folder))), std::set<std::string>{}) << "the same run is there already";
}

TEST_P(EveryStudy, TakesAScene) {
    const std::string name = GetParam(), folder = "out/" + name;
    write("scene.toml", kOneCase);
    expect_study({"study", name, "scene.toml", "--quick", "--out", "out", "--quiet"});
    expect_whole(folder, name);
    EXPECT_TRUE(says(read_json(folder + "/study.json")["scene"].get<std::string>(), "facets = 3"));
}

INSTANTIATE_TEST_SUITE_P(All, EveryStudy,
                         ::testing::Values("error-time", "stability", "energy", "omission", "perception"),
                         [](const auto& study) {
                             std::string name = study.param;
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

// A scene of the user's own, small enough to be run often.
class SceneStudy : public Study {
protected:
    SceneStudy() { write("scene.toml", kOneCase); }
    static std::vector<std::string> on_scene(const std::string& out) {
        return {"study", "omission", "scene.toml", "--quick", "--out", out, "--quiet"};
    }
};

TEST_F(SceneStudy, SwitchesTheFeaturesOfThatScene) {
    expect_study(on_scene("out"));
    expect_whole("out/omission", "omission");
    const Json data = read_json("out/omission/study.json");
    EXPECT_TRUE(says(data["scene"].get<std::string>(), "facets = 3"));
    for (const Json& scene : column_of(data["tables"][0], 1))
        EXPECT_EQ(scene, "scene");
    expect_success(with(on_scene("cpu"), {"--engine", "cpu"}));
    expect_whole("cpu/omission", "omission");
}

TEST_F(SceneStudy, SaysWhatItTakesThePlaceOf) {
    expect_study(on_scene("out"));
    const std::vector<std::string> loud{"study", "omission", "scene.toml", "--quick", "--out", "out"};
    EXPECT_FALSE(says(expect_success(loud).error, "holds a full run"));
    Json data = read_json("out/omission/study.json");
    data["run"]["quick"] = false;
    data["run"]["fingerprint"] = "another";
    write("out/omission/study.json", data.dump());
    expect_failure(2, loud, {"omission holds tables and figures of a full run", "--overwrite", "--no-clobber"});
    const Json kept = read_json("out/omission/study.json");
    expect_success(with(loud, {"--no-clobber"}));
    EXPECT_EQ(read_json("out/omission/study.json"), kept);
    expect_success(with(loud, {"--overwrite"}));
    data = read_json("out/omission/study.json");
    data["scene"] = "";
    data["run"]["fingerprint"] = "another";
    write("out/omission/study.json", data.dump());
    expect_failure(2, loud, {"omission holds tables and figures of this study of another scene", "--overwrite"});
}

TEST_F(SceneStudy, LeavesNothingHalfAfterAnInterrupt) {
    Process process(launch(on_scene("out")));
    while (process.running() && !std::filesystem::exists(path("out/omission")))
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.error;
    EXPECT_EQ(tree_of(path("out")).size(), 0u);
    expect_study(on_scene("out"));
    expect_whole("out/omission", "omission");
}

TEST_F(SceneStudy, IsComputedAnewIfAFileWasChangedOrOnRequest) {
    expect_study(on_scene("out"));
    const auto seconds = [&] { return read_json("out/omission/study.json")["run"]["seconds"].get<double>(); };
    const double first = seconds();
    expect_study(on_scene("out"));
    EXPECT_EQ(seconds(), first) << "the same run is there already";
    write("out/omission/omitted.csv", "damaged");
    expect_study(on_scene("out"));
    const double second = seconds();
    EXPECT_NE(second, first);
    expect_whole("out/omission", "omission");
    expect_study(with(on_scene("out"), {"--fresh"}));
    EXPECT_NE(seconds(), second);
}

// Times are another run's; what is no time is the same.
TEST_F(SceneStudy, IsTheSameFromEveryRunButForTimes) {
    expect_study(on_scene("one"));
    expect_study(on_scene("two"));
    EXPECT_EQ(read_text(path("one/omission/omitted.csv")), read_text(path("two/omission/omitted.csv")));
    const Json one = read_json("one/omission/study.json"), two = read_json("two/omission/study.json");
    const Json &a = one["tables"][0], &b = two["tables"][0];
    for (std::size_t column = 0; column < a["columns"].size(); ++column) {
        const std::string name = a["columns"][column]["name"];
        if (name.starts_with("kernel_") || name.starts_with("whole_"))
            continue;
        EXPECT_EQ(column_of(a, column), column_of(b, column)) << name;
    }
}

// Maps of a scene's curl are named after its features, and those of the program's own studies after theirs.
TEST_F(SceneStudy, OfAnotherSceneInTheSameFolderLeavesNothingOfTheFirst) {
    expect_study({"study", "energy", "scene.toml", "--quick", "--out", "out", "--quiet"});
    write("out/energy/mine.csv", "kept");
    const Tree first = tree_of(path("out/energy"));
    expect_study(with(quick("energy", "out"), {"--overwrite"}));
    EXPECT_EQ(read_text(path("out/energy/mine.csv")), "kept");
    std::filesystem::remove(path("out/energy/mine.csv"));
    expect_whole("out/energy", "energy");
    std::size_t gone = 0;
    for (const auto& [name, content] : first)
        gone += !std::filesystem::exists(path("out/energy") / name);
    EXPECT_GE(gone, 3u) << "the scene's figures and volumes";
    EXPECT_EQ(forceshade({"report", "out", "--quiet"}).code, 0);
    write("out/energy/closed_strokes.csv", read_text(path("out/energy/closed_strokes.csv")) + "one more\n");
    expect_failure(4, {"report", "out"}, {"energy/closed_strokes.csv", "bytes where"});
}

TEST_F(SceneStudy, OnAFullDiskIsAnIoError) {
    const SmallDisk disk(path("disk"), "size=64k");
    if (disk.bad())
        GTEST_SKIP() << "mounting is not permitted here";
    write("scene.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n[grid]\nsize = [64, 8, 32]\norigin = "
                        "[\"-14 mm\", \"-1 mm\", \"-4 mm\"]\nspacing = [\"0.45 mm\", \"0.25 mm\", \"0.15 mm\"]\n");
    const Outcome outcome = run_study(on_scene("disk/out"));
    EXPECT_EQ(outcome.code, 4) << outcome.error;
    EXPECT_TRUE(says(outcome.error, "No space left on device"));
    EXPECT_EQ(temporaries_in(path("disk/out")), std::vector<std::string>{});
    const auto left = [&](const char* name) { return std::filesystem::exists(path("disk/out/omission") / name); };
    EXPECT_EQ(left("features.csv"), left("study.json")) << "all, where only the page did not fit, or none";
    ASSERT_TRUE(disk.change(0, "size=64m"));
    expect_study(on_scene("disk/out"));
    expect_whole("disk/out/omission", "omission");
}

TEST_F(SceneStudy, IntoNoFolderIsAnError) {
    expect_failure(2, {"study", "omission"}, {"--out"});
    expect_failure(2, {"study", "omission", "--out", ""}, {"--out is empty"});
    expect_failure(2, {"study", "--out", "out"}, {"needs STUDY"});
    write("file", "kept");
    expect_failure(4, {"study", "omission", "--out", "file"}, {"file", "Not a directory"});
    std::filesystem::create_directories(path("taken"));
    write("taken/omission", "kept");
    expect_failure(4, {"study", "omission", "--out", "taken"}, {"taken/omission", "Not a directory"});
    EXPECT_EQ(read_text(path("file")), "kept");
    EXPECT_EQ(read_text(path("taken/omission")), "kept");
    Launch foreign = launch(on_scene("out"));
    if (is_root())
        foreign.user = kNobody;
    else
        std::filesystem::permissions(folder_.path(), std::filesystem::perms(0555));
    expect_failure(4, foreign, {"out", "Permission denied"});
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
}

TEST_F(SceneStudy, ThatIsNoneOrOnNoDeviceLeavesNothing) {
    expect_failure(2, {"study", "omision", "--out", "out"}, {"no study \"omision\"", "did you mean omission?"});
    for (const char* precision : {"f32", "f64"})
        expect_failure(2, {"study", "energy", "scene.toml", "--out", "out", "--precision", precision},
                       {"--precision has no effect in the study energy", "double precision", "leave it out"});
    expect_failure(2, {"study", "astrology", "--out", "out"}, {"error-time, stability, energy, omission"});
    expect_failure(3, {"study", "omission", "--out", "out", "--gpu", "no such device"}, {"no such device"});
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"scene.toml"});
}

TEST_F(SceneStudy, OfASceneThatIsWrongLeavesNothing) {
    write("broken.toml", "[surface]\nfacets = \"two\"\n");
    write("misspelt.toml", "[surface]\nfacetts = 2\n");
    write("axis.toml", "[surface]\nfacets = [2, 3]\n");
    write("recorded.toml", "[paths]\nkind = \"recorded\"\nfile = \"stroke.csv\"\n");
    write("stroke.csv", "path,t,x,y,z\n0,0,0,0,0\n");
    const std::vector<std::string> before = folder_.names();
    for (const std::string name : {"error-time", "stability", "energy", "omission"}) {
        expect_failure(2, {"study", name, "broken.toml", "--out", "out"}, {"broken.toml:2:10: ", "facets"});
        expect_failure(2, {"study", name, "misspelt.toml", "--out", "out"}, {"misspelt.toml:2:1: ", "facets"});
        expect_failure(2, {"study", name, "axis.toml", "--out", "out"}, {"axis.toml:2:"});
        expect_failure(4, {"study", name, "missing.toml", "--out", "out"}, {"missing.toml", "No such file"});
    }
    EXPECT_EQ(folder_.names(), before);
    expect_failure(2, {"study", "omission", "recorded.toml", "--out", "out"}, {"recorded paths alone"});
}

} // namespace
} // namespace forceshade::testing
