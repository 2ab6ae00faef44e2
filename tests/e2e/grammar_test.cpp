// The command line's grammar: what is wrong with a line and where to read on, short forms, help and its examples.
#include <algorithm>
#include <filesystem>
#include <set>

#include "tests/e2e/renderers.h"
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

class GrammarTest : public Workplace {
protected:
    GrammarTest() {
        write("scene.toml", kOneCase);
        write("three.toml", kThreeCases);
    }

    std::string help(std::vector<std::string> command, const std::string& columns) const {
        command.insert(command.begin(), "help");
        Launch launch = this->launch(std::move(command));
        launch.environment["COLUMNS"] = columns;
        const Outcome outcome = run(launch);
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        return outcome.out;
    }

    // As words, groups before what is in them; the program itself first.
    std::vector<std::vector<std::string>> commands(const std::vector<std::string>& group = {}) const {
        std::vector<std::vector<std::string>> all{group};
        bool in_list = false;
        for (const std::string& line : lines_of(help(group, "100"))) {
            if (in_list && line.size() > 2 && line[2] != ' ') {
                std::vector<std::string> command = group;
                command.push_back(line.substr(2, line.find(' ', 2) - 2));
                for (const auto& below : commands(command))
                    all.push_back(below);
            }
            in_list = line == "Commands:" || (in_list && !line.empty());
        }
        return all;
    }

    // What stands under "Examples:".
    std::vector<std::string> examples(const std::vector<std::string>& command) const {
        std::vector<std::string> found;
        bool inside = false;
        for (const std::string& line : lines_of(help(command, "100"))) {
            if (inside && line.starts_with("      forceshade "))
                found.push_back(line.substr(6));
            else if (inside && line.starts_with("          "))
                found.back() += "\n" + line;
            inside = line == "Examples:" || (inside && !line.empty());
        }
        return found;
    }
};

TEST_F(GrammarTest, SaysWhatIsWrongWithALineAndWhereToReadOn) {
    struct Mistake {
        std::vector<std::string> arguments, words;
        std::string topic;
    };
    for (const auto& [arguments, words, topic] : std::vector<Mistake>{
             {{}, {"a command is missing", "field, explore"}, ""},
             {{"feild", "scene.toml"}, {"did you mean forceshade field?"}, ""},
             {{"--quiet", "feild"}, {"did you mean forceshade field?"}, ""},
             {{"help", "feild"}, {"did you mean forceshade field?"}, ""},
             {{"experiment", "anlyse"}, {"did you mean forceshade experiment analyse?"}, " experiment"},
             {{"field", "scene.toml", "--ouput", "a.exr"}, {"no option --ouput, did you mean --out?"}, " field"},
             {{"field", "scene.toml", "--output", "a.exr"}, {"no option --output, did you mean --out?"}, " field"},
             {{"field", "scene.toml", "-out", "a.exr"}, {"no option -out, did you mean --out?"}, ""},
             {{"sweep", "three.toml", "-out", "out"}, {"no option -out, did you mean --out?"}, ""},
             {{"field", "scene.toml", "--precison=f64"}, {"did you mean --precision?"}, " field"},
             {{"field", "scene.toml", "--prec", "f64"}, {"did you mean --precision?"}, " field"},
             {{"field", "scene.toml", "--only", "x", "-o", "a.exr"},
              {"is not an option", "forceshade sweep"},
              " field"},
             {{"--out", "a.exr", "field", "scene.toml"}, {"--out belongs to forceshade field"}, " field"},
             {{"field"}, {"needs SCENE and --out FILE"}, " field"},
             {{"field", "scene.toml", "--out"}, {"--out needs a value: --out FILE"}, " field"},
             {{"sweep", "three.toml", "--out", "--also", "png"}, {"--out needs a value before --also"}, " sweep"},
             {{"field", "scene.toml", "a.exr"}, {"\"a.exr\" is one argument too many"}, " field"},
             {{"gpus", "x"}, {"takes none"}, " gpus"},
             {{"field", "scene.toml", "-o", "a.exr", "-o", "b.exr"}, {"--out is given 2 times"}, " field"},
             {{"gpus", "--engine", "gpuu"}, {"--engine \"gpuu\"", "did you mean gpu?", "auto"}, " gpus"},
             {{"field", "scene.toml", "-o", "a.exr", "--also", "npy,pgn"}, {"did you mean png?"}, " field"},
             {{"field", "scene.toml", "-o", "a.txt"}, {"--out a.txt", ".exr"}, " field"},
             {{"live", "scene.toml", "--cpu", "two"}, {"--cpu = two", "number"}, " live"},
             {{"live", "scene.toml", "--slew", "-1 N/ms"}, {"--slew must be positive"}, " live"},
             {{"gpus", "--json=maybe"}, {"--json takes no value"}, " gpus"},
             {{"gpus", "-vq"}, {"exclude each other"}, " gpus"}}) {
        const Outcome outcome = forceshade(arguments);
        const std::string said = ::testing::PrintToString(arguments) + ": " + outcome.error;
        EXPECT_EQ(outcome.code, 2) << said;
        EXPECT_EQ(outcome.out, "") << said;
        const std::vector<std::string> lines = lines_of(outcome.error);
        ASSERT_EQ(lines.size(), 2u) << said;
        EXPECT_TRUE(lines[0].starts_with("error: ")) << said;
        EXPECT_TRUE(says(lines[0], words)) << said;
        EXPECT_EQ(lines[1], "see forceshade help" + topic) << said;
    }
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"scene.toml", "three.toml"}));
}

TEST_F(GrammarTest, DoesNotTakeAFileForOneMoreValueOfAList) {
    expect_success({"sweep", "--also", "npy", "three.toml", "--out", "out"});
    expect_failure(4, {"experiment", "run", "--participant", "observer", "--out", "data", "--subject", "01", "no.toml"},
                   {"no.toml"});
}

TEST_F(GrammarTest, HasShortForms) {
    expect_success({"field", "scene.toml", "--out", "long.exr"});
    EXPECT_EQ(expect_success({"field", "scene.toml", "-qo", "short.exr"}).error, "");
    EXPECT_TRUE(read_text(path("long.exr")) == read_text(path("short.exr")));
    EXPECT_EQ(expect_success({"-V"}).out, expect_success({"--version"}).out);
    const std::string text = expect_success({"field", "--help"}).out;
    EXPECT_EQ(expect_success({"field", "-h"}).out, text);
    EXPECT_EQ(expect_success({"help", "field"}).out, text);
    EXPECT_EQ(expect_success({"field", "--help", "--ouput"}).out, text);
    EXPECT_EQ(expect_success({"help"}).out, expect_success({"--help"}).out);
    EXPECT_TRUE(says(expect_success({"help", "experiment", "run"}).out, "--participant"));
}

TEST_F(GrammarTest, WrapsHelpAndGivesTwoExamplesOfEveryCommand) {
    const auto all = commands();
    EXPECT_GT(all.size(), 18u);
    for (const auto& command : all) {
        EXPECT_GE(examples(command).size(), 2u) << ::testing::PrintToString(command);
        for (const std::size_t columns : {40, 80})
            for (const std::string& line : lines_of(help(command, std::to_string(columns))))
                EXPECT_LE(line.size(), columns) << line;
    }
}

TEST_F(GrammarTest, GivesExamplesThatWork) {
    const std::string bump =
        "[surface]\nkind = \"bump\"\nradius = \"600 mil\"\nfacets = 2\n[grid]\nsize = [16, 8, 8]\n"
        "origin = [\"-14 mm\", \"-3 mm\", \"-4 mm\"]\nspacing = [\"1.8 mm\", \"1 mm\", \"0.6 mm\"]\n";
    write("bump.toml", bump);
    std::filesystem::create_symlink(kPenalty, path("libmine.so"));
    write("strokes.toml", bump + "[paths]\ncount = 20\npress = \"1 N\"\n");
    std::filesystem::rename(path("three.toml"), path("study.toml"));
    write("bone.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
                      "3 0 1 2\n");
    // Of live, before explore reads it again.
    expect_success({"live", "bump.toml", "--duration", "0.1 s", "--fast", "--log", "felt.csv"});
    std::size_t tried = 0;
    for (const auto& command : commands())
        for (const std::string& example : examples(command)) {
            // Seconds to minutes, tried by hand; a person; a second device.
            const auto slow = {"--only",       "study e",      "study s", "study all",     "experiment",
                               "device check", "--device sim", "doctor",  "results/paper", "report"};
            if (std::ranges::any_of(slow, [&](const char* word) { return bool(says(example, word)); }))
                continue;
            Launch launch =
                this->launch({"-c", "forceshade() { " + in_build("forceshade") + " \"$@\" --overwrite; }\n" + example});
            launch.program = "/bin/sh";
            const Outcome outcome = run(launch);
            EXPECT_EQ(outcome.code, 0) << example << "\n" << outcome.error;
            ++tried;
        }
    EXPECT_GT(tried, 18u);
}

TEST_F(GrammarTest, HasATestOfEveryOption) {
    std::string tests;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(in_source("tests")))
        if (const std::string kind = entry.path().extension(); kind == ".cpp" || kind == ".h" || kind == ".sh")
            tests += read_text(entry.path());
    std::set<std::string> options;
    for (const auto& command : commands())
        for (const std::string& line : lines_of(help(command, "100")))
            if (const std::size_t at = line.find("--"); at == 2 || (at == 6 && line[2] == '-'))
                options.insert(line.substr(at, line.find_first_of(" ,[", at) - at));
    EXPECT_GT(options.size(), 70u);
    for (const std::string& option : options)
        EXPECT_TRUE(says(tests, option + '"') || says(tests, option + ' ') || says(tests, option + '=')) << option;
}

// A field, a mesh, paths and a sweep: the same bytes, whatever the threads.
TEST_F(GrammarTest, ComputesTheSameWithAnyNumberOfThreads) {
    write("spot.toml", "[surface]\nkind = \"mesh\"\nfile = \"" + in_source("tests/data/spot.obj") +
                           "\"\ntransform = { scale = 0.05 }\n[force]\nshading = \"mean_value\"\n"
                           "[grid]\nsamples = 16\n[paths]\ncount = 20\nsteps = 100\n");
    const std::vector<std::vector<std::string>> lines{
        {"field", "scene.toml", "--also", "npy,vti,png", "--engine", "cpu", "--out", "scene.exr"},
        {"field", "spot.toml", "--engine", "cpu", "--out", "spot.exr"},
        {"explore", "spot.toml", "--engine", "cpu", "--out", "paths.exr"},
        {"sweep", "three.toml", "--engine", "cpu", "--out", "."}};
    const auto computed = [&](const std::string& jobs) {
        std::filesystem::create_directory(path(jobs));
        for (std::vector<std::string> line : lines) {
            line[1] = "../" + line[1];
            Launch launch = this->launch(with(line, {"--jobs", jobs}));
            launch.folder = path(jobs);
            const Outcome outcome = run(launch);
            EXPECT_EQ(outcome.code, 0) << outcome.error;
        }
        return results_in(path(jobs));
    };
    const Tree one = computed("1");
    EXPECT_GT(one.size(), 8u);
    EXPECT_EQ(differences(one, computed("3")), (std::set<std::string>{}));
}

TEST_F(GrammarTest, TakesAsManyThreadsAsItMay) {
    const auto engine_of = [&](const std::string& before, const std::string& after) {
        Launch launch = this->launch(
            {"-c", before + " " + in_build("forceshade") + " field scene.toml --overwrite --out a.exr " + after});
        launch.program = "/bin/sh";
        return run(launch).error;
    };
    EXPECT_TRUE(says(engine_of("", "-j1"), "(1 thread)"));
    EXPECT_TRUE(says(engine_of("", "-j 7"), "(7 threads)"));
    const std::string first = "$(taskset -cp $$ | sed 's/.*: //; s/[-,].*//')";
    EXPECT_TRUE(says(engine_of("taskset -c " + first, ""), "(1 thread)"));
    for (const char* jobs : {"0", "-1", "two", "3.5", "99999"})
        expect_failure(2, {"field", "scene.toml", "-o", "a.exr", "--jobs", jobs}, {"--jobs", jobs, "1 to"});
}

} // namespace
} // namespace forceshade::testing
