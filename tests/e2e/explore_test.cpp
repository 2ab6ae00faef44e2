// Probes along recorded paths, from the command line: streams, refusals, memory, interrupts.
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

class Explore : public Workplace {
protected:
    Explore() {
        write("scene.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n");
        write("in.csv",
              "path,t,x,y,z\n3,0,0.004,0,0.001\n3,0.001,0.005,0,0.001\n5,0,0,0,0.1\n3,0.002,-0.02,0,-0.001\n");
    }
    static std::vector<std::string> arguments(const std::vector<std::string>& further = {}) {
        return with({"explore", "scene.toml", "--paths", "in.csv", "--out", "out.csv", "--engine", "cpu"}, further);
    }
    // `count` rows on four paths.
    void write_long(int count) const {
        fmt::memory_buffer text;
        fmt::format_to(std::back_inserter(text), "path,t,x,y,z\n");
        for (int i = 0; i < count; ++i)
            fmt::format_to(std::back_inserter(text), "{},{},{}e-5,0.001234567,-0.000123456789\n", i / (count / 4), i,
                           i % 1000 - 500);
        write("in.csv", fmt::to_string(text));
    }
};

TEST_F(Explore, WritesWhatWasFeltAndSaysSo) {
    const Outcome outcome = expect_success(arguments());
    EXPECT_EQ(outcome.out, "") << "data only goes to stdout";
    EXPECT_TRUE(says(outcome.error, "out.csv: 2 paths of 3 steps on CPU reference, ", ", 75 % in contact, ",
                     ", largest force "));
    const std::string text = read_text(path("out.csv"));
    EXPECT_TRUE(text.starts_with("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n3,0,0.004,0,0.001,0.004,0,")) << text;
    EXPECT_TRUE(says(text, "\n3,0.002,-0.02,"));
    EXPECT_TRUE(text.ends_with("\n5,0,0,0,0.1,0,0,0.1,0,0,0,0,-1\n")) << "path after path";
    EXPECT_EQ(expect_success(arguments({"--quiet"})).error, "");
    EXPECT_EQ(read_text(path("out.csv")), text) << "the same bytes in every run";
    const nlohmann::json said = json_of(arguments({"--json"}));
    EXPECT_EQ(said["samples"], 4);
    EXPECT_EQ(said["contact_share"], 0.75);
    EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
}

TEST_F(Explore, WritesAPageOfWhatWasFelt) {
    for (const char* name : {"out.csv", "out.exr"}) {
        expect_success(
            {"explore", "scene.toml", "--paths", "in.csv", "--out", name, "--engine", "cpu", "--also", "html"});
        const bool timed = name == std::string("out.csv"); // an EXR file has no times of recorded paths
        EXPECT_TRUE(says(read_text(path("out.html")), "Force over place", timed ? "\"path 5\"" : "\"path 1\"",
                         timed ? "Force over time" : "Force over sample"));
    }
}

TEST_F(Explore, TakesThePrecisionThatIsAskedFor) {
    expect_success(arguments({"--precision", "f32"}));
    const std::string single = read_text(path("out.csv"));
    expect_success(arguments());
    EXPECT_EQ(read_text(path("out.csv")), single) << "a scene's own is f32";
    expect_success(arguments({"--precision", "f64"}));
    EXPECT_GT(read_text(path("out.csv")).size(), single.size() + 20) << "doubles have more digits";
}

TEST_F(Explore, TakesDoublePrecisionForAThinMesh) {
    write("thin.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.001\nv 1 0 0.001\nv 0 1 0.001\n"
                      "f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n");
    write("thin.csv", "path,t,x,y,z\n0,0,0.2,0.2,0.1\n0,0.001,0.2,0.2,0.0009\n");
    const std::string scene = "[surface]\nkind = \"mesh\"\nfile = \"thin.obj\"\n";
    for (const char* run : {"", "[run]\nprecision = \"auto\"\n", "[run]\nprecision = \"f32\"\n"}) {
        write("thin.toml", scene + run);
        const Outcome outcome = expect_success(
            {"explore", "thin.toml", "--paths", "thin.csv", "--out", "thin-out.csv", "--engine", "cpu", "--overwrite"});
        const bool single = std::string(run).find("f32") != std::string::npos;
        EXPECT_EQ(outcome.error.find("precision: f64") == std::string::npos, single) << outcome.error;
    }
    write("thin.toml", scene);
    for (const std::string flag : {"f32", "f64"}) {
        const Outcome outcome = expect_success({"explore", "thin.toml", "--paths", "thin.csv", "--out", "thin-out.csv",
                                                "--engine", "cpu", "--overwrite", "--precision", flag});
        EXPECT_EQ(outcome.error.find("precision: f64"), std::string::npos) << outcome.error;
    }
    write("thin.toml", scene + "[paths]\ncount = 1\nsteps = 9\ndepth = \"0.5 mm\"\n"); // a sweep keeps its precision
    const Outcome sweep = expect_success({"sweep", "thin.toml", "--out", "thin-sweep", "--engine", "cpu"});
    EXPECT_NE(sweep.error.find("too thin for f32: a proxy has no room"), std::string::npos) << sweep.error;
}

TEST_F(Explore, DoesNotFallBackFromOneEngineToTheOther) {
    auto plain = arguments();
    plain.resize(plain.size() - 2);
    plain.insert(plain.end(), {"--gpu", "No such device"});
    expect_refused(plain, {"No such device"}, 3);
    expect_refused(arguments({"--gpu", "0"}), {"--gpu"});
}

TEST_F(Explore, RefusesNamesThatItCannotWrite) {
    auto to = [](const std::string& out) {
        auto all = arguments();
        all[5] = out;
        return all;
    };
    expect_refused(to("out"), {"--out out", ".exr", ".csv"});
    write("out.paths.csv", read_text(path("in.csv")));
    auto own_summary = to("out.exr");
    own_summary[3] = "out.paths.csv";
    expect_refused(own_summary, {"out.paths.csv", "read", "another name"});
    std::filesystem::remove(path("out.paths.csv"));
    expect_refused(to("in.csv"), {"in.csv", "read", "another name"});
    expect_refused(to(path("in.csv").string()), {"another name"});
    std::filesystem::create_symlink("in.csv", path("link.csv"));
    expect_refused(to("link.csv"), {"link.csv", "another name"});
    expect_refused(to("nosuch/out.csv"), {"nosuch/out.paths.csv", "create its folder first"}, 4);
    std::filesystem::create_directory(path("folder.csv"));
    expect_refused(to("folder.csv"), {"folder.csv"}, 4);
}

TEST_F(Explore, RefusesPathsThatAreNone) {
    auto all = arguments();
    for (const auto& [paths, words, code] :
         {std::tuple{"nosuch.csv", "nosuch.csv", 4}, {"scene.toml", "scene.toml:1:1: the header lacks", 2}}) {
        all[3] = paths;
        expect_refused(all, {words}, code);
    }
    expect_refused({"explore", "scene.toml", "--out", "out.csv", "--engine", "cpu"}, {"[paths]", "--paths"});
}

TEST_F(Explore, RefusesTimesThatDoNotIncreaseWhateverTheRoute) {
    const std::string head = "path,t,x,y,z\n3,0,0,0,0\n5,9,0,0,0\n3,0.5,0,0,0\n";
    for (const auto& [row, words] : {std::pair{"3,0.5,0,0,0\n", "t: 0.5 s comes after 0.5 s on path 3"},
                                     {"5,8,0,0,0\n", "t: 8 s comes after 9 s on path 5"}}) {
        write("in.csv", head + row);
        const std::string expected = std::string("error: in.csv:5:1: ") + words + ": times of a path must increase";
        for (const std::vector<std::string>& way : {std::vector<std::string>{}, {"--metrics-only"}, {"--also", "png"}})
            expect_refused(arguments(way), {expected});
        expect_refused({"explore", "scene.toml", "--paths", "in.csv", "--out", "out.csv"}, {expected});
        expect_refused({"explore", "scene.toml", "--paths", "in.csv", "--out", "out.exr"}, {expected});
    }
}

TEST_F(Explore, WarnsOfAFileThatMayBeCutOff) {
    write("in.csv", "path,t,x,y,z\n0,0,0,0,-0.001");
    EXPECT_TRUE(says(expect_success(arguments()).error, "warning: in.csv:2:15: the last line has no line feed"));
    EXPECT_EQ(expect_success(arguments({"--quiet"})).error, "");
}

// In a process of its own: until a child is another program its peak is that of the process that made it, with all that
// other tests left there.
TEST_F(Explore, OfAMillionSamplesTakesNoMoreMemoryThanOfAFew) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto measure = [&] {
        write_long(100000);
        const std::uint64_t few = expect_success(arguments()).peak_memory;
        write_long(1000000);
        const Outcome many = expect_success(arguments());
        EXPECT_LT(many.peak_memory, few + 2 * kMebibyte);
        EXPECT_LT(many.peak_memory, 64 * kMebibyte);
        EXPECT_TRUE(says(many.error, "4 paths of 250000 steps"));
        std::filesystem::remove_all(path("")); // nothing else does where a process exits
        std::exit(HasFailure() ? 1 : 0);
    };
    EXPECT_EXIT(measure(), ::testing::ExitedWithCode(0), "");
}

TEST_F(Explore, SaysThatADiskIsFull) {
    write_long(100000);
    Launch launch = this->launch(arguments());
    launch.most_file_bytes = kMebibyte;
    expect_refused(launch, {"out.csv"}, 4);
}

} // namespace
} // namespace forceshade::testing
