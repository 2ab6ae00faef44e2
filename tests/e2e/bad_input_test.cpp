// Input that is missing, unreadable or wrong: one clear message, the exit code that belongs to it, and no file.
#include <thread>
#include <tuple>

#include <fmt/format.h>
#include <sys/stat.h>

#include "host/output/files.h"
#include "tests/e2e/workplace.h"
#include "tests/io/picture.h"
#include "tests/places.h"

namespace forceshade::testing {
namespace {

class BadInput : public Workplace {
protected:
    /// The scene is refused by every command that reads one, and nothing is written.
    void expect_refused_by_all(const std::string& scene, const std::vector<std::string>& words) const {
        SCOPED_TRACE(scene);
        write("scene.toml", scene);
        expect_refused({"field", "scene.toml", "--out", "field.exr"}, words);
        expect_refused({"sweep", "scene.toml", "--out", "out"}, words);
        expect_refused({"validate", "scene.toml"}, words);
    }
};

TEST_F(BadInput, AMissingOrUnreadableSceneIsAnIoErrorWithItsName) {
    std::filesystem::create_directory(path("folder"));
    write("file", "");
    for (const auto& [scene, why] : {std::pair<std::string, std::string>("missing.toml", "No such file"),
                                     {"folder", "it is a folder"},
                                     {"file/scene.toml", "Not a directory"},
                                     {"no/such/scene.toml", "No such file"},
                                     {".", "it is a folder"}})
        for (const std::string command : {"field", "sweep", "validate"}) {
            std::vector<std::string> arguments{command, scene};
            if (command != "validate")
                arguments.insert(arguments.end(), {"--out", "result.exr"});
            expect_refused(arguments, {scene, why}, 4);
        }
}

TEST_F(BadInput, ASceneWithoutPermissionIsAnIoError) {
    write("scene.toml", kOneCase);
    std::filesystem::permissions(path("scene.toml"), std::filesystem::perms::none);
    Launch launch = this->launch({"validate", "scene.toml"});
    if (is_root())
        launch.user = kNobody;
    expect_failure(4, launch, {"scene.toml", "Permission denied"});
}

TEST_F(BadInput, AMisspeltFileGetsTheNearestName) {
    write("bump.toml", "[surface]\nfacets = 2\n");
    write("one.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    write("mesh.toml", "[surface]\nkind = \"mesh\"\nfile = \"oen.obj\"\n[grid]\nsamples = 8\n");
    expect_failure(4, {"field", "bmup.toml", "--out", "x.exr"}, {"did you mean \"bump.toml\"?"});
    expect_failure(4, {"mesh", "oen.obj"}, {"did you mean \"one.obj\"?"});
    expect_failure(4, {"mesh", "plane.obj"}, {"check the name"});
    expect_failure(4, {"field", "mesh.toml", "--out", "x.exr"}, {"mesh.toml:3:8: ", "did you mean \"one.obj\"?"});
    expect_failure(4, {"field", "no/bump.toml", "--out", "x.exr"}, {"there is no folder no"});
    write("ball.toml", "[surface]\nkind = \"sphere\"\n");
    expect_failure(2, {"field", "ball.toml", "--out", "x.exr"}, {"ball.toml:2:8: ", "forceshade init mesh FILE"});
    const std::string scene = expect_success({"init", "mesh", "one.obj"}).out;
    EXPECT_TRUE(says(scene, "unit = \"mm\"")) << "100 mm is what a hand can hold";
}

TEST_F(BadInput, AMissingOrBrokenHeightMapIsAnErrorWithItsName) {
    const std::string scene = "[surface]\nkind = \"height_map\"\nfile = \"map.{}\"\nsize = [\"2 mm\", \"2 mm\"]\n"
                              "height = \"1 mm\"\n";
    for (const std::string kind : {"png", "exr", "bmp"}) {
        write("scene.toml", fmt::format(fmt::runtime(scene), kind));
        if (kind != "bmp") { // a kind that is none is the scene's mistake
            expect_failure(4, {"field", "scene.toml", "--out", "field.exr"}, {"map." + kind, "No such file"});
        }
        write("map." + kind, "this is no picture, whatever its name says");
        const Outcome outcome = forceshade({"field", "scene.toml", "--out", "field.exr"});
        EXPECT_TRUE(outcome.code == 2 || outcome.code == 4) << outcome.code;
        EXPECT_TRUE(says(outcome.error, "map." + kind));
    }
    EXPECT_FALSE(std::filesystem::exists(path("field.exr")));
    write("study.toml", "[force]\nstiffness = [\"1 N/mm\", \"2 N/mm\"]\n" + fmt::format(fmt::runtime(scene), "exr"));
    std::filesystem::remove(path("map.exr"));
    expect_refused({"sweep", "study.toml", "--out", "out"}, {"map.exr", "No such file"}, 4);
    write("digest.toml", fmt::format(fmt::runtime(scene), "png") + "sha256 = \"" + std::string(64, '0') + "\"\n");
    EXPECT_NE(forceshade({"field", "digest.toml", "--out", "field.exr"}).code, 0);
}

// What is wrong with each is for tests/scene.
TEST_F(BadInput, ASceneThatIsWrongIsRefusedWithItsPlaceByEveryCommand) {
    expect_refused_by_all("[surface]\nradius = 600\n", {"scene.toml:2:10", "unit", "600"});
    expect_refused_by_all("[[variant]]\nsurface.facet = 2\n", {"scene.toml:2:", "facets"});
    expect_refused_by_all("[output]\nchannels = []\n", {"scene.toml:2:12", "empty"});
    // 2^64 voxels, whose number wraps to 0.
    expect_refused_by_all("[grid]\nsize = [1073741824, 536870912, 32]\n", {"scene.toml:2:", "size"});
    expect_refused_by_all(std::string("\x7f"
                                      "ELF\x02\x01\x01\x00\xff\xfe",
                                      10),
                          {"scene.toml:1:"});
    write("axis.toml", "[surface]\nradius = [\"600 mil\", \"499 mil\"]\n");
    expect_failure(2, {"sweep", "axis.toml", "--out", "out"}, {"axis.toml:2:22", "radius"});
}

TEST_F(BadInput, AFieldTakesNoSweepAxis) {
    write("axis.toml", kThreeCases);
    expect_refused({"field", "axis.toml", "--out", "field.exr"}, {"axis.toml:2:", "surface.radius", "sweep"});
    write("variants.toml", "[[variant]]\nsurface.facets = 2\n[[variant]]\nsurface.facets = 3\n");
    expect_refused({"field", "variants.toml", "--out", "field.exr"}, {"variants.toml", "sweep"});
}

TEST_F(BadInput, AForceThatHalfCannotHoldIsRefusedAndTheLargestIsNamed) {
    std::string scene = kOneCase;
    scene.replace(scene.find("shading"), 0, "stiffness = \"1e8 N/m\"\n");
    write("float.toml", scene);
    write("half.toml", scene + "[output]\npixel = \"half\"\n");
    const auto at = json_of({"field", "float.toml", "--out", "float.exr", "--json", "--quiet"})["largest_force_voxel"];
    expect_refused({"field", "half.toml", "--out", "half.exr"},
                   {"half", "65504", "half.exr",
                    fmt::format("voxel ({}, {}, {})", at[0].get<int>(), at[1].get<int>(), at[2].get<int>()), "float"});
}

TEST_F(BadInput, ACaseThatFailsDoesNotStopTheOthers) {
    std::string study = kThreeCases;
    study.replace(study.find("shading"), 0, "stiffness = [\"1 N/mm\", \"1e8 N/m\"]\n");
    write("study.toml", study + "[output]\npixel = \"half\"\n");
    for (int repeat = 0; repeat < 2; ++repeat) {
        const Outcome outcome = forceshade({"sweep", "study.toml", "--out", "out", "--json"});
        EXPECT_EQ(outcome.code, 2);
        EXPECT_TRUE(says(outcome.error, "65504"));
        const nlohmann::json said = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(said["failures"].size(), 3u);
        EXPECT_EQ(said["computed"], repeat == 0 ? 3 : 0);
        EXPECT_EQ(said["kept"], repeat == 0 ? 0 : 3);
        EXPECT_EQ(temporaries_in(path("out")), std::vector<std::string>{});
    }
    EXPECT_EQ(read_json("out/manifest.json")["cases"].size(), 3u);
}

TEST_F(BadInput, ASceneMayComeFromAPipeButNotWithoutEnd) {
    ASSERT_EQ(::mkfifo(path("pipe.toml").c_str(), 0600), 0);
    const std::jthread writer([&] { write("pipe.toml", kOneCase); });
    expect_success({"field", "pipe.toml", "--out", "field.exr", "--quiet"});
    const Outcome outcome = forceshade({"validate", "/dev/zero"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_TRUE(says(outcome.error, "/dev/zero: it is no scene or study"));
    EXPECT_LT(outcome.peak_memory, std::uint64_t{256} << 20);
}

TEST_F(BadInput, AHeightMapThatNeedsMoreMemoryThanAllowedIsRefused) {
    write_exr(path("map.exr"), {{"Y", {Imf::FLOAT, [](int, int) { return 0.5; }}}},
              {.display = {{0, 0}, {16383, 16383}}, .data = {{0, 0}, {0, 0}}});
    write("scene.toml", "[surface]\nkind = \"height_map\"\nfile = \"map.exr\"\nsize = [\"9 mm\", \"9 mm\"]\n"
                        "[force]\nshading = \"height_map\"\n[grid]\nsize = [4, 4, 4]\n");
    const Outcome outcome = forceshade({"field", "scene.toml", "--out", "field.exr"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_TRUE(says(outcome.error,
                     "map.exr: a height map of 16384 x 16384 samples needs about 8.0 GiB of memory, more than "
                     "the 4.0 GiB that are allowed: make it smaller, or say --max-memory \"8.0 GiB\""));
    EXPECT_LT(outcome.peak_memory, std::uint64_t{256} << 20);
    write_exr(path("map.exr"), {{"Y", {Imf::FLOAT, [](int, int) { return 0.5; }}}});
    expect_failure(2, {"field", "scene.toml", "--out", "field.exr", "--max-memory", "100 kilo"},
                   {"--max-memory 100 kilo"});
    expect_success({"field", "scene.toml", "--out", "field.exr", "--max-memory", "1 MB"});
    expect_failure(2, {"field", "scene.toml", "--out", "field.exr", "--max-memory", "100 B"}, {"--max-memory 100 B"});
}

// libpng would allocate what a text says it is, and only then find that the file has ended.
TEST_F(BadInput, AHeightMapWithAChunkLongerThanTheFileTakesNoMemory) {
    write_png(path("map.png"), 2, {{9, 51}});
    std::string bytes = read_text(path("map.png"));
    bytes.insert(33, std::string("\x40\0\0\0tEXt", 8)); // behind the header: 1 GiB
    write("map.png", bytes);
    write("scene.toml", "[surface]\nkind = \"height_map\"\nfile = \"map.png\"\nsize = [\"9 mm\", \"9 mm\"]\n"
                        "[force]\nshading = \"height_map\"\n[grid]\nsize = [4, 4, 4]\n");
    const Outcome outcome = forceshade({"field", "scene.toml", "--out", "field.exr"});
    EXPECT_EQ(outcome.code, 4);
    EXPECT_LT(outcome.peak_memory, std::uint64_t{256} << 20);
}

TEST_F(BadInput, NothingIsWrittenThroughALinkInTheResults) {
    std::filesystem::create_directories(path("others"));
    write("others/" + TemporaryFile(path("others/a")).temporary_path().filename().string(),
          "as if left by a run that was killed");
    write("others/study.json", "{}");
    const Tree before = tree_of(path("others"));
    write("scene.toml", kOneCase);
    std::filesystem::create_directory(path("out"));
    std::filesystem::create_directory_symlink(path("others"), path("out/manifest.d"));
    std::filesystem::create_directory_symlink(path("others"), path("out/omission"));
    expect_failure(4, {"sweep", "scene.toml", "--out", "out"}, {"manifest.d", "symbolic link"});
    expect_failure(4, {"study", "omission", "scene.toml", "--out", "out", "--quick"}, {"omission", "symbolic link"});
    EXPECT_EQ(tree_of(path("others")), before);
    // Links of files are replaced, not followed.
    std::filesystem::remove(path("out/manifest.d"));
    for (const char* name : {"manifest.json", "summary.csv", "study.toml", "report.html"})
        std::filesystem::create_symlink(path("others/study.json"), path("out") / name);
    expect_success({"sweep", "scene.toml", "--out", "out"});
    EXPECT_EQ(tree_of(path("others")), before);
}

class SceneFile : public Workplace {
protected:
    // A shell's line, in which $0 is the program.
    Outcome shell(const std::string& line) const {
        Launch launch = this->launch({"-c", line, in_build("forceshade")});
        launch.program = "/bin/sh";
        return run(launch);
    }
};

TEST_F(SceneFile, EveryOneThatInitWritesWorksAsItStands) {
    write("spot.obj", read_text(in_source("tests/data/spot.obj")));
    std::filesystem::create_directory(path("scenes"));
    for (const std::string kind : {"bump", "paths", "live", "experiment"})
        expect_success({"init", kind, "-o", "scenes/" + kind + ".toml"});
    expect_success({"init", "mesh", "spot.obj", "-o", "scenes/mesh.toml"});
    for (const auto& arguments : std::vector<std::vector<std::string>>{
             {"field", "scenes/bump.toml", "--out", "bump.exr"},
             {"field", "scenes/mesh.toml", "--out", "mesh.exr"},
             {"explore", "scenes/paths.toml", "--out", "paths.exr"},
             {"live", "scenes/live.toml", "--device", "sim", "--duration", "1 s", "--fast", "--log", "felt.csv"},
             {"experiment", "plan", "scenes/experiment.toml"}}) {
        const Outcome outcome = expect_success(arguments);
        EXPECT_FALSE(says(outcome.error, "warning"));
        EXPECT_FALSE(says(outcome.error, " 0 in contact")); // of the live loop
    }
}

TEST_F(SceneFile, InitSaysWhatItCannotWriteAndReplacesNoFile) {
    write("scene.toml", "mine");
    expect_refused({"init", "bump", "-o", "scene.toml"}, {"scene.toml is there already"});
    expect_failure(2, {"init", "bmup"}, {"did you mean bump?"});
    expect_failure(4, {"init", "mesh", "no.obj"}, {"no.obj", "No such file"});
    expect_failure(2, {"init", "bump", "scene.toml"}, {"init bump takes no file"});
    EXPECT_TRUE(says(expect_success({"init", "mesh"}).out, "file = \"mesh.obj\""));
}

TEST_F(SceneFile, ADashIsStandardInput) {
    EXPECT_EQ(shell("\"$0\" init bump | \"$0\" field - --out piped.exr --quiet").code, 0);
    EXPECT_TRUE(std::filesystem::exists(path("piped.exr")));
    for (const std::string command : {"field - --out x.exr", "sweep - --out x", "validate -", "explore - --out x.csv",
                                      "live - --device sim", "experiment plan -", "study stability - --out x"}) {
        const Outcome refused = shell("printf '[surface]\\nradius = 600\\n[gird]\\n' | \"$0\" " + command);
        EXPECT_EQ(refused.code, 2) << command;
        EXPECT_TRUE(says(refused.error, "<stdin>:2:10: radius needs a unit", "error: <stdin>:3:2: unknown table [gird]",
                         "2 errors in <stdin>"));
    }
    write("spot.obj", read_text(in_source("tests/data/spot.obj"))); // of the current folder
    EXPECT_EQ(shell("\"$0\" init mesh spot.obj | \"$0\" field - --out mesh.exr --quiet").code, 0);
    EXPECT_EQ(shell("\"$0\" init live | \"$0\" live - --device sim --duration 0.1s --fast --quiet").code, 0);
    EXPECT_TRUE(says(shell("\"$0\" live - --watch --device sim </dev/null").error, "--watch"));
    EXPECT_TRUE(says(shell("\"$0\" field - --out x.exr </dev/null").error, "<stdin> has no [surface]"));
}

TEST_F(SceneFile, ErrorsOfAnExperimentAreToldWithThoseOfItsStimuli) {
    write("e.toml", "[experiment]\ntrails = 3\nblocks = 0\n[surface]\nradius = 600\n"
                    "[[experiment.answer]]\nlabel = 1\n[[experiment.answer]]\nname = \"A B\"\n");
    expect_failure(2, {"experiment", "plan", "e.toml"},
                   {"e.toml:2:1: unknown key \"trails\"", "e.toml:3:10: blocks", "e.toml:5:10: radius", "e.toml:7:9",
                    "e.toml:9:8", "5 errors in e.toml"});
    expect_success({"init", "experiment", "--out", "whole.toml"});
    expect_failure(2, {"experiment", "plan", "whole.toml", "--compare", "one"}, {"--compare wants two conditions"});
}

TEST_F(SceneFile, AMeshGivenAsASceneIsToldHowToBecomeOne) {
    write("bunny.obj", "v 0 0 0\n");
    for (const std::string command : {"field", "sweep", "explore"})
        expect_refused({command, "bunny.obj", "--out", "x.exr"}, {"forceshade init mesh bunny.obj -o bunny.toml"});
}

} // namespace
} // namespace forceshade::testing
