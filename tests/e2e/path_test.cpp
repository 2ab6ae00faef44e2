// Generated and recorded paths, from the command line and in sweeps: files, figures, refusals.
#include <algorithm>
#include <set>

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <fmt/format.h>

#include "tests/e2e/path_workplace.h"

namespace forceshade::testing {
namespace {

TEST_F(Paths, BecomeAnExrAndATable) {
    const Outcome outcome = expect_success(explore("open.toml", "a.exr", {"--also", "npy,png"}));
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(says(outcome.error, "differ")) << "the oracle is not compared with itself";
    EXPECT_TRUE(says(outcome.error, "a.exr: 20 paths of 100 steps", "million steps/s", "0 unstable"));
    for (const char* name : {"a.exr", "a.paths.csv", "a.force.npy", "a.position.npy", "a.paths.png"})
        EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
    Imf::MultiPartInputFile file(path("a.exr").c_str());
    EXPECT_EQ(file.parts(), 2);
    EXPECT_EQ(file.header(0).dataWindow().max, Imath::V2i(99, 19));
    const auto rows = table_in(read_text(path("a.paths.csv")));
    ASSERT_EQ(rows.size(), 20u);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].at("path"), std::to_string(i));
        EXPECT_EQ(rows[i].at("unstable"), "0");
        EXPECT_EQ(rows[i].at("speed_ratio"), "") << "open loop";
        EXPECT_GT(std::stod(rows[i].at("largest_force_N")), 0.5);
    }
    const Tree first = tree_of(folder_.path());
    const nlohmann::json said = json_of(explore("open.toml", "a.exr", {"--also", "npy,png", "--json"}));
    EXPECT_EQ(said["samples"], 2000);
    EXPECT_EQ(said["oracle"]["samples_differing"], 0);
    EXPECT_EQ(differences(first, tree_of(folder_.path())), std::set<std::string>{}) << "the same bytes in every run";
    EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
}

TEST_F(Paths, AreTheSameOnAGpu) {
    write("roof.obj", "v -1 -1 0\nv 0 -1 1\nv 1 -1 0\nv -1 1 0\nv 0 1 1\nv 1 1 0\nf 1 2 5 4\nf 2 3 6 5\n");
    write("mesh.toml", "[surface]\nkind = \"mesh\"\nfile = \"roof.obj\"\nunit = \"cm\"\n[paths]\ncount = 7\n"
                       "steps = 300\ndepth = \"2 mm\"\nspeed = { mean = \"100 mm/s\", sd = \"5 mm/s\" }\n");
    for (const char* scene : {"open.toml", "closed.toml", "mesh.toml"})
        for (const char* precision : {"f32", "f64"}) {
            expect_success(explore(scene, "cpu.csv", {"--precision", precision}));
            const Outcome outcome =
                expect_success({"explore", scene, "--out", "gpu.csv", "--precision", precision, "--engine", "gpu"});
            EXPECT_TRUE(says(outcome.error, "compared with the oracle, 0 differ"));
            EXPECT_EQ(read_text(path("cpu.csv")), read_text(path("gpu.csv"))) << scene << precision;
            EXPECT_EQ(read_text(path("cpu.paths.csv")), read_text(path("gpu.paths.csv"))) << scene << precision;
        }
}

TEST_F(Paths, WithFrictionRunOnTheCpuAlone) {
    write("rubs.toml", scene("count = 3\nsteps = 200\n[friction]\n[grid]\nsize = [9, 2, 9]\n"));
    const Outcome outcome = expect_success({"explore", "rubs.toml", "--out", "a.csv"});
    EXPECT_TRUE(says(outcome.error, "friction and vibration run on the CPU"));
    for (const auto& row : table_in(read_text(path("a.paths.csv"))))
        EXPECT_LT(std::stod(row.at("work_J")), -1e-4);
    for (const std::vector<std::string>& gpu : {std::vector<std::string>{"--engine", "gpu"}, {"--gpu", "0"}}) {
        std::vector<std::string> arguments{"explore", "rubs.toml", "--out", "b.csv"};
        arguments.insert(arguments.end(), gpu.begin(), gpu.end());
        expect_failure(2, arguments, {"friction and vibration run on the CPU; leave --engine gpu out"});
    }
    expect_failure(2, {"sweep", "rubs.toml", "--out", "s", "--engine", "gpu"}, {"leave --engine gpu out"});
    const Outcome validated = expect_success({"validate", "rubs.toml"});
    EXPECT_TRUE(says(validated.error, "its paths are left out"));
    EXPECT_FALSE(says(validated.out, "samples"));
    // Recorded positions of its own give the same forces.
    expect_success({"explore", "rubs.toml", "--paths", "a.csv", "--open-loop", "--engine", "cpu", "--out", "c.csv"});
    const auto first = table_in(read_text(path("a.csv"))), again = table_in(read_text(path("c.csv")));
    ASSERT_EQ(first.size(), again.size());
    for (std::size_t i = 0; i < first.size(); ++i)
        ASSERT_EQ(first[i].at("fx"), again[i].at("fx")) << i;
}

TEST_F(Paths, OfMetricsAloneTakeNoMemoryForSteps) {
    expect_success(explore("open.toml", "a.exr"));
    const std::string table = read_text(path("a.paths.csv"));
    std::filesystem::remove(path("a.exr"));
    EXPECT_TRUE(
        says(expect_success(explore("open.toml", "a.exr", {"--metrics-only"})).error, "; every sample: metrics"));
    EXPECT_EQ(read_text(path("a.paths.csv")), table);
    EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
    write("few.toml", scene("count = 50\nsteps = 1000\n"));
    write("many.toml", scene("count = 50\nsteps = 100000\n"));
    const std::uint64_t few = expect_success(explore("few.toml", "a.exr", {"--metrics-only"})).peak_memory;
    EXPECT_LT(expect_success(explore("many.toml", "a.exr", {"--metrics-only"})).peak_memory, few + 4 * kMebibyte);
    expect_failure(2, explore("open.toml", "a.exr", {"--metrics-only", "--also", "npy"}), {"--metrics-only"});
}

TEST_F(Paths, LeaveOutWhatNoFileHolds) {
    EXPECT_TRUE(says(expect_success(explore("open.toml", "a.exr")).error, "channels depth, facet, proxy (5 numbers"));
    EXPECT_TRUE(
        says(expect_success(explore("open.toml", "b.exr", {"--also", "vtp"})).error, "channels proxy (3 numbers"));
}

TEST_F(Paths, LeaveNothingWhereTheyCannotBeWritten) {
    expect_refused(explore("open.toml", "nosuch/a.exr"), {"nosuch"}, 4);
    expect_refused(explore("open.toml", "a.png"), {".exr", ".csv", ".npy"});
    expect_refused(explore("open.toml", "a.exr", {"--also", "vti"}), {"vtp", "npy", "png"});
    write("long.toml", scene("count = 2000\nsteps = 500\n[output]\ncompression = \"none\"\n"));
    for (const auto& [out, file] : {std::pair{"a.exr", "a.exr"}, {"a.csv", "a.csv"}, {"a.npy", "a.force.npy"}}) {
        Launch launch = this->launch(explore("long.toml", out));
        launch.most_file_bytes = kMebibyte;
        expect_refused(launch, {file}, 4);
    }
}

TEST_F(Paths, LeaveNothingWhereNobodyMayWrite) {
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0.003\n0,1,0,0,0.003\n");
    std::filesystem::create_directory(path("theirs"));
    std::filesystem::permissions(path("theirs"), std::filesystem::perms(0555));
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
    const std::vector<std::vector<std::string>> ways{{"--metrics-only"}, {"--also", "npy"}, {"--paths", "in.csv"}};
    for (const std::vector<std::string>& way : ways)
        for (const char* out : {"theirs/a.exr", "theirs/a.csv", "theirs/a.npy"}) {
            Launch launch = this->launch(explore("open.toml", out, way));
            if (is_root())
                launch.user = kNobody;
            expect_failure(4, launch, {"theirs/", "Permission denied"});
            EXPECT_TRUE(std::filesystem::is_empty(path("theirs")));
        }
}

TEST_F(Paths, RecordedInAFileAreFeltAlikeHoweverTheyAreTaken) {
    std::string rows = "path,t,x,y,z\n";
    for (int i = 0; i < 200; ++i)
        for (const int p : {30, 10, 20})
            if (p != 10 || i < 50)
                rows += fmt::format("{},{:.6g},{},{:.6g},0.003\n", p, i * 0.002, (i - 100) * 1.5e-4, p * 1e-4);
    write("in.csv", rows);
    write("plain.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n");
    const auto sorted = [&](const char* name) {
        std::vector<std::string> lines = lines_of(read_text(path(name)));
        std::ranges::sort(lines);
        return lines;
    };
    for (const char* precision : {"f32", "f64"}) {
        expect_success(explore("plain.toml", "row.csv", {"--paths", "in.csv", "--precision", precision}));
        expect_success(
            explore("plain.toml", "cpu.csv", {"--paths", "in.csv", "--precision", precision, "--also", "png"}));
        expect_success({"explore", "plain.toml", "--paths", "in.csv", "--out", "gpu.csv", "--precision", precision});
        EXPECT_EQ(sorted("row.csv"), sorted("cpu.csv")) << "but for the order of the rows";
        EXPECT_EQ(read_text(path("cpu.csv")), read_text(path("gpu.csv")));
        EXPECT_EQ(read_text(path("row.paths.csv")), read_text(path("cpu.paths.csv")));
        EXPECT_EQ(read_text(path("row.paths.csv")), read_text(path("gpu.paths.csv")));
    }
    EXPECT_TRUE(says(read_text(path("cpu.csv")), "\n30,0,-0.015,"));
    const auto table = table_in(read_text(path("cpu.paths.csv")));
    ASSERT_EQ(table.size(), 3u);
    EXPECT_EQ(table[0].at("path"), "30") << "in the order of their first samples";
    EXPECT_EQ(table[1].at("steps"), "50");
}

TEST_F(Paths, RecordedAtTimesOfTheirOwnAreInContactAsLongAsThoseSay) {
    // In contact at x = 0 and z = 0.003, away at z = 0.1. A sample counts until the next, the last as the one before.
    write("in.csv", "path,t,x,y,z\n7,100,0,0,0.003\n7,100.5,0,0,0.1\n7,102,0,0,0.003\n7,102.25,0,0,0.003\n"
                    "8,3,0,0,0.003\n9,0,0,0,0.1\n9,10,0,0,0.003\n");
    write("plain.toml", "[surface]\nfacets = 3\n");
    write("rate.toml", "[surface]\nfacets = 3\n[paths]\nrate = \"10 Hz\"\n");
    for (const char* scene : {"plain.toml", "rate.toml"})
        for (const char* precision : {"f32", "f64"}) {
            expect_success(explore(scene, "a.csv", {"--paths", "in.csv", "--precision", precision}));
            const std::string table = read_text(path("a.paths.csv"));
            const auto rows = table_in(table);
            ASSERT_EQ(rows.size(), 3u);
            EXPECT_EQ(rows[0].at("contact_time_s"), "1") << "0.5 + 0.25 + 0.25";
            EXPECT_EQ(rows[1].at("contact_time_s"), "0") << "one sample has no time";
            EXPECT_EQ(rows[2].at("contact_time_s"), "10");
            for (const char* how : {"a.exr", "--metrics-only"}) {
                expect_success({"explore", scene, "--paths", "in.csv", "--precision", precision, "--engine", "gpu",
                                "--out", how[0] == 'a' ? how : "a.csv", how[0] == 'a' ? "--quiet" : how});
                EXPECT_EQ(read_text(path("a.paths.csv")), table) << how;
            }
        }
}

TEST_F(Paths, RecordedThatLeaveTheirBoundSayAtWhichOfTheirTimes) {
    std::string rows = "path,t,x,y,z\n";
    for (int p = 0; p < 3; ++p)
        for (int i = 0; i < 2000; ++i) // a clock's times
            rows += fmt::format("{},{:.3f},{:.6f},0,0.005\n", p, 1700000000 + 10 * p + i * 0.001, i * 1e-6);
    write("in.csv", rows);
    write("wild.toml", "[surface]\nfacets = 3\n[force]\nstiffness = \"100 N/mm\"\n[paths]\nkind = \"recorded\"\n"
                       "file = \"in.csv\"\npress = \"1 N\"\nbound = \"20 mm\"\n[hand]\nmax_force = \"1000 N\"\n"
                       "delay_samples = 1\n");
    for (const char* engine : {"cpu", "gpu"}) {
        expect_success({"explore", "wild.toml", "--out", "a.csv", "--engine", engine});
        const auto samples = table_in(read_text(path("a.csv")));
        const auto table = table_in(read_text(path("a.paths.csv")));
        ASSERT_EQ(table.size(), 3u);
        for (std::size_t p = 0; p < 3; ++p) {
            ASSERT_EQ(table[p].at("unstable"), "1");
            const std::string left = table[p].at("unstable_time_s");
            EXPECT_GT(std::stod(left), 1700000000 + 10.0 * double(p)) << left;
            const auto at = std::ranges::find_if(samples, [&](const auto& row) { return row.at("t") == left; });
            ASSERT_NE(at, samples.end()) << left << " is the t of a sample";
            EXPECT_EQ(at->at("fz"), "0") << "it feels nothing from there on";
            EXPECT_NE((at - 1)->at("x"), "");
        }
    }
    rows.insert(rows.find("0,1700000001.000"), "0,1700000000.9995,0,0,0.005\n");
    write("in.csv", rows);
    expect_failure(2, explore("wild.toml", "a.csv"), {"in.csv:1002:1: t: ", "paths.rate", "resample"});
}

TEST_F(Paths, StandInSweepsBesideFieldsOrAlone) {
    write("study.toml",
          "[surface]\nfacets = [1, 3]\n[force]\nshading = \"reference\"\n[paths]\ncount = 5\nsteps = 40\n");
    expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu", "--also", "png,vtp"});
    const std::set<std::string> expected{"bump_facets-1.paths.exr",
                                         "bump_facets-1.paths.csv",
                                         "bump_facets-1.paths.png",
                                         "bump_facets-1.paths.vtp",
                                         "bump_facets-3.paths.exr",
                                         "bump_facets-3.paths.csv",
                                         "bump_facets-3.paths.png",
                                         "bump_facets-3.paths.vtp",
                                         "summary.csv",
                                         "study.toml"};
    const Tree first = results_in(path("s"));
    std::set<std::string> there;
    for (const auto& [name, text] : first)
        there.insert(name);
    EXPECT_EQ(there, expected);
    const auto rows = table_in(first.at("summary.csv"));
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].at("paths"), "5");
    EXPECT_EQ(rows[0].at("path_samples"), "200");
    EXPECT_EQ(rows[0].at("path_samples_differing"), "") << "the CPU engine is the oracle";
    EXPECT_EQ(rows[0].at("voxels"), "0");
    // Again: all is kept. A file gone: made again, byte for byte.
    EXPECT_TRUE(
        says(expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu", "--also", "png,vtp"}).error,
             "0 computed, 2 kept"));
    std::filesystem::remove(path("s/bump_facets-3.paths.csv"));
    EXPECT_TRUE(says(expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu"}).error, "1 computed"));
    EXPECT_EQ(differences(first, results_in(path("s"))), std::set<std::string>{});
    // The resolved study asks for the same.
    expect_success({"sweep", "s/study.toml", "--out", "t", "--engine", "cpu", "--also", "png,vtp"});
    EXPECT_EQ(differences(first, results_in(path("t"))), std::set<std::string>{});
    write("both.toml", read_text(path("study.toml")) + "[grid]\nsize = [8, 2, 4]\n");
    expect_success({"sweep", "both.toml", "--out", "b", "--engine", "cpu"});
    for (const char* name : {"bump_facets-1.exr", "bump_facets-1.paths.exr", "bump_facets-1.paths.csv"})
        EXPECT_TRUE(std::filesystem::exists(path("b") / name)) << name;
    EXPECT_EQ(read_json("b/manifest.json")["cases"][0]["paths"]["paths"], 5);
    expect_failure(2, {"field", "open.toml", "--out", "f.exr", "--engine", "cpu"}, {"[paths]", "[grid]", "explore"});
}

TEST_F(Paths, RecordedInAFileStandInSweepsUnderItsDigest) {
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0.003\n0,1,0.001,0,0.003\n");
    write("study.toml", "[surface]\nfacets = [1, 3]\n[paths]\nkind = \"recorded\"\nfile = \"in.csv\"\n");
    const auto sweep = [&] { return expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu"}).error; };
    EXPECT_TRUE(says(sweep(), "2 computed"));
    EXPECT_TRUE(says(sweep(), "2 kept"));
    EXPECT_EQ(read_json("s/manifest.json")["cases"][0]["inputs"][0]["name"], "in.csv");
    const Tree first = results_in(path("s"));
    EXPECT_TRUE(says(first.at("study.toml"), "sha256"));
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0.003\n0,1,0.002,0,0.003\n");
    EXPECT_TRUE(says(sweep(), "2 computed")) << "the file is another one";
    expect_failure(4, {"sweep", "s/study.toml", "--out", "t", "--engine", "cpu"}, {"in.csv"}); // it is not beside that
}

TEST_F(Paths, OfAStudyAreSharedOutAmongShards) {
    write("study.toml", "[surface]\nfacets = [1, 2, 3]\n[paths]\ncount = 5\nsteps = 40\n");
    expect_success({"sweep", "study.toml", "--out", "all", "--engine", "cpu"});
    for (const char* shard : {"2/2", "1/2"})
        expect_success({"sweep", "study.toml", "--out", "shards", "--engine", "cpu", "--shard", shard});
    expect_success({"sweep", "study.toml", "--out", "shards", "--merge"});
    EXPECT_EQ(differences(results_in(path("all")), results_in(path("shards"))), std::set<std::string>{});
}

TEST_F(Paths, AreValidated) {
    const Outcome outcome = expect_success({"validate", "closed.toml"});
    EXPECT_EQ(last_line(outcome.out), fmt::format("{} samples, 0 differ", 2 * 6 * 300));
    EXPECT_FALSE(says(outcome.out, "voxels"));
    write("both.toml", read_text(path("open.toml")) + "[grid]\nsize = [8, 2, 4]\n");
    const Outcome both = expect_success({"validate", "both.toml", "--engine", "cpu", "--precision", "f32"});
    EXPECT_EQ(last_line(both.out), "2000 samples, 0 differ");
    EXPECT_TRUE(says(both.out, "\n64 voxels, 0 differ\n"));
}

} // namespace
} // namespace forceshade::testing
