// The command line as it meets a user: help, versions, streams, exit codes, places, devices that are not there.
#include <csignal>
#include <cstdlib>
#include <iterator>
#include <regex>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "tests/e2e/volume.h"
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class CommandLine : public Workplace {
protected:
    CommandLine() {
        write("scene.toml", kOneCase);
        write("three.toml", kThreeCases);
        write("triangle.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        write("paths.csv", "path,t,x,y,z\n0,0,0,0,-0.001\n");
    }

    // Every command, with arguments that let it succeed.
    const std::vector<std::vector<std::string>> commands_{
        {"sweep", "three.toml", "--out", "out"},
        {"field", "scene.toml", "--out", "field.exr"},
        {"validate", "three.toml"},
        {"explore", "scene.toml", "--paths", "paths.csv", "--out", "felt.csv", "--engine", "cpu"},
        {"mesh", "triangle.off"},
        {"gpus"},
        {"devices"},
        {"doctor"},
        {"schema"}};
};

TEST_F(CommandLine, TellsReleaseAndCommit) {
    const Outcome outcome = expect_success({"--version"});
    EXPECT_TRUE(std::regex_match(
        outcome.out, std::regex("forceshade \\d+\\.\\d+\\.\\d+(\\+[0-9a-f]{12})?(\\.sources-[0-9a-f]{12})?\n")))
        << outcome.out;
}

// What is wrong with the line itself is told in grammar_test.
TEST_F(CommandLine, RefusesValuesThatAreNoneAndOptionsThatDoNotGoTogether) {
    const std::string field = "field scene.toml --out a.exr ", drawn = field + "--also png ";
    for (const std::string& line : std::vector<std::string>{
             "sweep three.toml scene.toml --out out", "sweep three.toml --out out --also bmp",
             "sweep three.toml --out=", "field scene.toml --out=", "field scene.toml --out .exr",
             "validate three.toml --only nosuch*", "gpus --engine tpu", field + "--also bmp", field + "--title picture",
             field + "--precision f16", field + "--gpu 0 --engine cpu", field + "--gpu=", drawn + "--size 12",
             drawn + "--quantity force", drawn + "--quantity turn", drawn + "--slice y=1km", drawn + "--slice u"}) {
        std::istringstream words(line);
        const Outcome outcome = forceshade({std::istream_iterator<std::string>(words), {}});
        EXPECT_EQ(outcome.code, 2) << line;
        EXPECT_EQ(outcome.out, "");
        EXPECT_NE(outcome.error, "");
    }
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"paths.csv", "scene.toml", "three.toml", "triangle.off"}));
}

TEST_F(CommandLine, PrintsJsonAndNothingElseIfAsked) {
    for (const auto& command : commands_) {
        const Outcome outcome = expect_success(with(command, {"--json"}));
        EXPECT_TRUE(json::accept(outcome.out)) << command[0] << ": " << outcome.out;
    }
    const json validation = json_of({"validate", "three.toml", "--json"});
    EXPECT_EQ(validation["voxels"], 3 * 2 * 512);
    EXPECT_EQ(validation["differing"], 0);
    EXPECT_EQ(validation["passed"], true);
    EXPECT_EQ(validation["cases"].size(), 6u);
    const json devices = json_of({"validate", "three.toml", "--gpu", "all", "--json"})["devices"];
    ASSERT_GE(devices.size(), 1u);
    for (const json& device : devices)
        EXPECT_EQ(device["passed"], true) << device["engine"]["device"];
    expect_failure(2, {"schema", "--default-study", "--json"}, {"--json"});
}

TEST_F(CommandLine, IsQuietIfAskedAndTellsHowItWentIfNot) {
    for (const auto& command : commands_)
        EXPECT_EQ(expect_success(with(command, {"--quiet"})).error, "") << command[0];
    for (const auto& command : commands_) {
        if (command[0] == "sweep" || command[0] == "field") {
            const Outcome outcome = expect_success(command);
            EXPECT_EQ(outcome.out, "") << "data only goes to stdout";
            EXPECT_NE(outcome.error, "");
        }
    }
    // Quiet means no remarks; errors stay.
    expect_failure(4, {"validate", "nosuch.toml", "--quiet"}, {"nosuch.toml"});
}

TEST_F(CommandLine, DrawsNothingWhereThereIsNoTerminal) {
    const Outcome outcome = expect_success(commands_[0]);
    EXPECT_TRUE(says(outcome.error, "3 cases: 3 computed", "engine: cpu (", "out/report.html"));
    EXPECT_FALSE(says(outcome.error, "\r"));
    EXPECT_FALSE(says(outcome.error, "\033"));
}

TEST_F(CommandLine, TellsOfDevicesAndRefusesThoseThatAreNotThere) {
    const json devices = json_of({"gpus", "--json"});
    ASSERT_GE(devices.size(), 1u);
    const std::string name = devices[0]["name"];
    const auto field_on = [&](const std::string& gpu) {
        return std::vector<std::string>{"field", "scene.toml", "--out", "field.exr", "--gpu", gpu};
    };
    for (const char* gpu : {"nosuch", "99", "-1", "00000000000000000000000000000000", "llvmpipes"})
        for (const char* command : {"field", "sweep", "validate"}) {
            std::vector<std::string> arguments{command, "scene.toml", "--gpu", gpu};
            if (std::string(command) != "validate")
                arguments.insert(arguments.end(), {"--out", "new.exr"});
            expect_failure(3, arguments, {gpu, name});
        }
    EXPECT_FALSE(std::filesystem::exists(path("new.exr/manifest.json")));
    for (const std::string& gpu :
         {std::string("0"), devices[0]["uuid"].get<std::string>(), name, name.substr(0, 4), std::string("LLVM")}) {
        if (devices.size() == 1) {
            expect_success(field_on(gpu));
        }
    }
}

TEST_F(CommandLine, FallsBackToNothingWhereThereIsNoDevice) {
    for (const char* command : {"field", "sweep"})
        expect_failure(3, without_device({command, "scene.toml", "--out", "new.exr", "--engine", "gpu"}), {"Vulkan"});
    EXPECT_EQ(run(without_device({"field", "scene.toml", "--out", "auto.exr"})).code, 0);
    expect_failure(3, without_device({"validate", "scene.toml"}), {"Vulkan"});
    const Outcome live = run(without_device({"doctor", "--live", "--engine", "cpu"}));
    EXPECT_TRUE(says(live.out, "live loop at 1 kHz", "live loop at 4 kHz", "periods lost", "free cores"));
    const Outcome doctor = run(without_device({"doctor"}));
    EXPECT_EQ(doctor.code, 1);
    EXPECT_TRUE(says(doctor.out, "problem", "mesa-vulkan-drivers"));
    EXPECT_EQ(run(without_device({"gpus"})).code, 3);
    EXPECT_EQ(run(without_device({"field", "scene.toml", "--out", "cpu.exr", "--engine", "cpu"})).code, 0);
    EXPECT_EQ(run(without_device({"schema"})).code, 0);
}

TEST_F(CommandLine, DoesNotTakeSilenceForAFullOrClosedStdout) {
    for (const auto& command :
         std::vector<std::vector<std::string>>{{"schema"},
                                               {"gpus"},
                                               {"--help"},
                                               {"--version"},
                                               {"sweep", "--help"},
                                               {"validate", "scene.toml"},
                                               {"field", "scene.toml", "--out", "a.exr", "--json"},
                                               {"sweep", "three.toml", "--out", "out", "--json"}}) {
        Launch full = launch(command);
        full.out = "/dev/full";
        expect_failure(4, full, {"standard output"});
        Launch closed = launch(command);
        closed.closed_out = true;
        expect_failure(4, closed, {"standard output"});
    }
    // What was computed is there and whole: a closed stdout is not the first file that is opened.
    EXPECT_NO_THROW(read_exr(path("a.exr")));
    EXPECT_EQ(json_of({"sweep", "three.toml", "--out", "out", "--json"})["kept"], 3);
}

TEST_F(CommandLine, WorksOnWhereNobodyListens) {
    for (const bool closed : {false, true}) {
        Launch launch = this->launch({"sweep", "three.toml", "--out", "out", "--fresh", "--json"});
        launch.error = closed ? "" : "/dev/full";
        launch.closed_error = closed;
        const Outcome outcome = run(launch);
        EXPECT_EQ(outcome.code, 0);
        EXPECT_EQ(json::parse(outcome.out)["computed"], 3);
        launch.arguments = {"field", "nosuch.toml", "--out", "a.exr"};
        EXPECT_EQ(run(launch).code, 4) << "an error that cannot be told is still one";
    }
}

TEST_F(CommandLine, WorksFromAnyPlaceWithAnyName) {
    expect_success({"field", "scene.toml", "--out", "plain.exr"});
    const std::string expected = read_text(path("plain.exr"));
    const std::string odd = "a b/ü ' \" $(x) %s {}";
    std::filesystem::create_directories(path(odd));
    write(odd + "/scene.toml", kOneCase);
    Launch launch = this->launch({"field", "../../scene.toml", "--out", "here.exr"});
    launch.folder = path(odd);
    EXPECT_EQ(run(launch).code, 0);
    EXPECT_TRUE(read_text(path(odd) / "here.exr") == expected);
    launch.arguments = {"field", path(odd) / "scene.toml", "--out", path(odd) / "there.exr", "--also", "npy,vti,png"};
    launch.folder = "/";
    EXPECT_EQ(run(launch).code, 0);
    EXPECT_TRUE(read_text(path(odd) / "there.exr") == expected);
    for (const std::string& out : {odd + "/out", path("deep/er/out/").string(), std::string("./out/")}) {
        expect_success({"sweep", odd + "/scene.toml", "--out", out});
        EXPECT_TRUE(std::filesystem::exists(path(out) / "manifest.json")) << out;
    }
    launch.arguments = {"sweep", path("three.toml"), "--out", ".", "--replace"};
    launch.folder = path(odd) / "out";
    EXPECT_EQ(run(launch).code, 0);
}

TEST_F(CommandLine, DoesNotTouchWhatItDidNotWrite) {
    std::filesystem::create_directory(path("out"));
    for (const char* name : {"notes.txt", ".hidden", ".a.tmp", "a.exr", "report.html"})
        write(std::string("out/") + name, "mine");
    expect_success({"sweep", "three.toml", "--out", "out", "--fresh"});
    for (const char* name : {"notes.txt", ".hidden", ".a.tmp", "a.exr", "report.html"})
        EXPECT_EQ(read_text(path("out") / name), "mine") << name;
}

TEST_F(CommandLine, PrintsASchemaThatIsAScene) {
    write("default.toml", expect_success({"schema"}).out);
    write("study.toml", expect_success({"schema", "--default-study"}).out);
    expect_success({"field", "default.toml", "--out", "default.exr"});
    expect_success({"sweep", "study.toml", "--out", "out", "--only", "bump_radius-600mil_facets-1_shading-none"});
    EXPECT_TRUE(says(json_of({"schema", "--json"}).dump(), "\"experiment.track\""));
}

TEST_F(CommandLine, ReplacesNoFileUnasked) {
    const auto outcome = [&](const std::vector<std::string>& further) {
        Launch launch = this->launch({});
        launch.arguments = with({"field", "scene.toml", "--out", "a.exr"}, further);
        return run(launch);
    };
    EXPECT_EQ(outcome({}).code, 0);
    const std::string before = read_text(path("a.exr"));
    write("a.exr", "mine");
    const Outcome refused = outcome({"--also", "npy"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(says(refused.error, "a.exr is there already", "--overwrite", "--no-clobber"));
    EXPECT_TRUE(says(outcome({"--no-clobber"}).error, "a.exr is there already and stays"));
    EXPECT_FALSE(std::filesystem::exists(path("a.force.npy")));
    EXPECT_EQ(outcome({"--no-clobber", "--also", "npy", "--quiet"}).code, 0);
    EXPECT_TRUE(std::filesystem::exists(path("a.force.npy"))) << "what is missing is written";
    EXPECT_EQ(read_text(path("a.exr")), "mine");
    const Outcome replaced = outcome({"--overwrite", "--also", "npy"});
    EXPECT_EQ(read_text(path("a.exr")), before);
    EXPECT_TRUE(says(replaced.error, "wrote a.exr and a.force.npy"));
    EXPECT_EQ(outcome({"--overwrite", "--no-clobber"}).code, 2);
    write("paths.toml", "[paths]\ncount = 1\nsteps = 2\n");
    write("e.vtp", "mine");
    Launch explore = this->launch({});
    explore.arguments = {"explore", "paths.toml", "--out", "e.exr", "--also", "vtp", "--engine", "cpu"};
    EXPECT_EQ(run(explore).code, 2);
    explore.arguments.push_back("--no-clobber");
    EXPECT_EQ(run(explore).code, 0);
    EXPECT_EQ(read_text(path("e.vtp")), "mine");
    EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
}

TEST_F(CommandLine, KeepsALogOfWhatItSays) {
    const std::vector<std::string> quiet{"field", "scene.toml", "--out", "a.exr", "--quiet", "--log-file", "log.txt"};
    EXPECT_EQ(expect_success(quiet).error, "");
    const std::string log = read_text(path("log.txt"));
    EXPECT_TRUE(says(log, "Z forceshade ", "scene.toml --out a.exr", "Z a.exr: "));
    std::vector<std::string> wrong = quiet;
    wrong[1] = "none.toml";
    expect_failure(4, wrong, {"error: ", "none.toml"});
    EXPECT_TRUE(read_text(path("log.txt")).starts_with(log));
    EXPECT_TRUE(says(read_text(path("log.txt")), "Z error: "));
}

class Locale : public Workplace {
protected:
    Locale() {
        write("study.toml", small_study());
        write("wrong.toml", "[surface]\nradius = \"0,6 mm\"\n");
        static const Folder place;
        static const Outcome made =
            run({.arguments = {"-i", "de_DE", "-f", "UTF-8", place / "de_DE.UTF-8"}, .program = "/usr/bin/localedef"});
        german_ = {{"LOCPATH", place.path().string()}, {"LC_ALL", "de_DE.UTF-8"}, {"LANG", "de_DE.UTF-8"}};
        EXPECT_EQ(made.code, 0) << "package locales is missing? " << made.error;
    }
    Outcome speak_german(std::vector<std::string> arguments) const {
        Launch launch = this->launch(std::move(arguments));
        launch.environment.insert(german_.begin(), german_.end());
        return run(launch);
    }
    std::map<std::string, std::string> german_;
};

TEST_F(Locale, IsThere) {
    Launch launch{.arguments = {"%.2f", "1,5"}, .environment = german_, .program = "/usr/bin/printf"};
    EXPECT_EQ(run(launch).out, "1,50") << "else these tests test nothing";
}

TEST_F(Locale, GermanChangesNoByteOfASweep) {
    const std::vector<std::string> sweep{"sweep",  "study.toml",      "--only", "*1000mil*",
                                         "--also", "npy,vti,vtp,png", "--out"};
    const auto german = with(sweep, {"german"});
    expect_success(with(sweep, {"plain"}));
    EXPECT_EQ(speak_german(german).code, 0);
    EXPECT_EQ(differences(results_in(path("plain")), results_in(path("german"))), std::set<std::string>{});
    // Each reads what the other wrote.
    EXPECT_EQ(json_of(with(german, {"--json"}))["kept"], 17);
    EXPECT_TRUE(speak_german(german).error.starts_with("17 cases: 0 computed"));
}

TEST_F(Locale, GermanChangesNoWordOfTheOutput) {
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{"schema"},
                                               {"schema", "--json"},
                                               {"schema", "--default-study"},
                                               {"gpus"},
                                               {"doctor"},
                                               {"--help"},
                                               {"validate", "study.toml", "--only", "*facets-2*"},
                                               {"validate", "study.toml", "--only", "*facets-2*", "--json"},
                                               {"validate", "wrong.toml"},
                                               {"validate", "nosuch.toml"},
                                               {"field", "study.toml", "--out", "a.exr"}}) {
        const Outcome plain = forceshade(arguments), german = speak_german(arguments);
        EXPECT_EQ(plain.out, german.out);
        EXPECT_EQ(plain.code, german.code);
        if (plain.code != 0) {
            EXPECT_EQ(plain.error, german.error);
        }
    }
}

} // namespace
} // namespace forceshade::testing
