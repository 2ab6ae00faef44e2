// A scene from its start: written by init, explained by schema, read from a file or standard input, all its errors
// told.
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

class SceneFile : public Workplace {
protected:
    // A shell's line, in which $0 is the program.
    Outcome shell(const std::string& line) const {
        Launch launch = this->launch({"-c", line, FORCESHADE_PROGRAM});
        launch.program = "/bin/sh";
        return run(launch);
    }
};

TEST_F(SceneFile, every_one_that_init_writes_works_as_it_stands) {
    write("spot.obj", read_text(FORCESHADE_SOURCE "/tests/data/spot.obj"));
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
        EXPECT_EQ(outcome.error.find("warning"), std::string::npos) << outcome.error;
        EXPECT_EQ(outcome.error.find(" 0 in contact"), std::string::npos) << outcome.error; // of the live loop
    }
}

TEST_F(SceneFile, init_says_what_it_cannot_write_and_replaces_no_file) {
    write("scene.toml", "mine");
    expect_failure(2, {"init", "bump", "-o", "scene.toml"}, {"scene.toml is there already"});
    EXPECT_EQ(read_text(path("scene.toml")), "mine");
    expect_failure(2, {"init", "bmup"}, {"did you mean bump?"});
    expect_failure(4, {"init", "mesh", "no.obj"}, {"no.obj", "No such file"});
    expect_failure(2, {"init", "bump", "scene.toml"}, {"init bump takes no file"});
    EXPECT_NE(expect_success({"init", "mesh"}).out.find("file = \"mesh.obj\""), std::string::npos);
}

TEST_F(SceneFile, schema_explains_one_key_or_table) {
    const std::string radius = expect_success({"schema", "surface.radius"}).out;
    for (const char* part : {"surface.radius\n", "R of the cylinder", "length, positive", "\"600 mil\"", "kind bump",
                             "[surface]\n", "radius = \"600 mil\""})
        EXPECT_NE(radius.find(part), std::string::npos) << part << radius;
    EXPECT_EQ(radius.find("surface.width"), std::string::npos);
    EXPECT_NE(expect_success({"schema", "radius"}).out.find("texture.radius"), std::string::npos);
    EXPECT_NE(expect_success({"schema", "hand"}).out.find("hand.max_force"), std::string::npos);
    EXPECT_NE(expect_success({"schema", "experiment.trials"}).out.find("1 to 10000"), std::string::npos);
    const auto json = nlohmann::json::parse(expect_success({"schema", "surface.radius", "--json"}).out);
    ASSERT_EQ(json["keys"].size(), 1u);
    expect_failure(2, {"schema", "surface.raduis"}, {"did you mean surface.radius?"});
}

TEST_F(SceneFile, a_dash_is_standard_input) {
    EXPECT_EQ(shell("\"$0\" init bump | \"$0\" field - --out piped.exr --quiet").code, 0);
    EXPECT_TRUE(std::filesystem::exists(path("piped.exr")));
    for (const std::string command : {"field - --out x.exr", "sweep - --out x", "validate -", "explore - --out x.csv",
                                      "live - --device sim", "experiment plan -", "study stability - --out x"}) {
        const Outcome refused = shell("printf '[surface]\\nradius = 600\\n[gird]\\n' | \"$0\" " + command);
        EXPECT_EQ(refused.code, 2) << command;
        EXPECT_NE(refused.error.find("<stdin>:2:10: radius needs a unit"), std::string::npos) << refused.error;
        EXPECT_NE(refused.error.find("error: <stdin>:3:2: unknown table [gird]"), std::string::npos) << refused.error;
        EXPECT_NE(refused.error.find("2 errors in <stdin>"), std::string::npos) << refused.error;
    }
    write("spot.obj", read_text(FORCESHADE_SOURCE "/tests/data/spot.obj")); // of the current folder
    EXPECT_EQ(shell("\"$0\" init mesh spot.obj | \"$0\" field - --out mesh.exr --quiet").code, 0);
    EXPECT_EQ(shell("\"$0\" init live | \"$0\" live - --device sim --duration 0.1s --fast --quiet").code, 0);
    EXPECT_NE(shell("\"$0\" live - --watch --device sim </dev/null").error.find("--watch"), std::string::npos);
    EXPECT_NE(shell("\"$0\" field - --out x.exr </dev/null").error.find("<stdin> has no [surface]"), std::string::npos);
}

TEST_F(SceneFile, errors_of_an_experiment_are_told_with_those_of_its_stimuli) {
    write("e.toml", "[experiment]\ntrails = 3\nblocks = 0\n[surface]\nradius = 600\n"
                    "[[experiment.answer]]\nlabel = 1\n[[experiment.answer]]\nname = \"A B\"\n");
    expect_failure(2, {"experiment", "plan", "e.toml"},
                   {"e.toml:2:1: unknown key \"trails\"", "e.toml:3:10: blocks", "e.toml:5:10: radius", "e.toml:7:9",
                    "e.toml:9:8", "5 errors in e.toml"});
}

TEST_F(SceneFile, a_mesh_given_as_a_scene_is_told_how_to_become_one) {
    write("bunny.obj", "v 0 0 0\n");
    for (const std::string command : {"field", "sweep", "explore"})
        expect_failure(2, {command, "bunny.obj", "--out", "x.exr"}, {"forceshade init mesh bunny.obj -o bunny.toml"});
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"bunny.obj"});
}

} // namespace
} // namespace forceshade::testing
