// Paths in sweeps and validated, from the command line.
#include <set>

#include <fmt/format.h>

#include "tests/e2e/path_workplace.h"

namespace forceshade::testing {
namespace {

TEST_F(Paths, stand_in_sweeps_beside_fields_or_alone) {
    write("study.toml",
          "[surface]\nfacets = [1, 3]\n[force]\nshading = \"reference\"\n[paths]\ncount = 5\nsteps = 40\n");
    expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu", "--also", "png"});
    const std::set<std::string> expected{"bump_facets-1.paths.exr",
                                         "bump_facets-1.paths.csv",
                                         "bump_facets-1.paths.png",
                                         "bump_facets-3.paths.exr",
                                         "bump_facets-3.paths.csv",
                                         "bump_facets-3.paths.png",
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
    EXPECT_EQ(rows[0].at("path_samples_differing"), "0");
    EXPECT_EQ(rows[0].at("voxels"), "0");
    // Again: all is kept. A file gone: made again, byte for byte.
    EXPECT_NE(expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu", "--also", "png"})
                  .error.find("0 computed, 2 kept"),
              std::string::npos);
    std::filesystem::remove(path("s/bump_facets-3.paths.csv"));
    EXPECT_NE(expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu"}).error.find("1 computed"),
              std::string::npos);
    EXPECT_EQ(differences(first, results_in(path("s"))), std::set<std::string>{});
    // The resolved study asks for the same.
    expect_success({"sweep", "s/study.toml", "--out", "t", "--engine", "cpu", "--also", "png"});
    EXPECT_EQ(differences(first, results_in(path("t"))), std::set<std::string>{});
    write("both.toml", read_text(path("study.toml")) + "[grid]\nsize = [8, 2, 4]\n");
    expect_success({"sweep", "both.toml", "--out", "b", "--engine", "cpu"});
    for (const char* name : {"bump_facets-1.exr", "bump_facets-1.paths.exr", "bump_facets-1.paths.csv"})
        EXPECT_TRUE(std::filesystem::exists(path("b") / name)) << name;
    EXPECT_EQ(read_json("b/manifest.json")["cases"][0]["paths"]["paths"], 5);
    expect_failure(2, {"field", "open.toml", "--out", "f.exr", "--engine", "cpu"}, {"[paths]", "[grid]", "explore"});
}

TEST_F(Paths, recorded_in_a_file_stand_in_sweeps_under_its_digest) {
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0.003\n0,1,0.001,0,0.003\n");
    write("study.toml", "[surface]\nfacets = [1, 3]\n[paths]\nkind = \"recorded\"\nfile = \"in.csv\"\n");
    const auto sweep = [&] { return expect_success({"sweep", "study.toml", "--out", "s", "--engine", "cpu"}).error; };
    EXPECT_NE(sweep().find("2 computed"), std::string::npos);
    EXPECT_NE(sweep().find("2 kept"), std::string::npos);
    EXPECT_EQ(read_json("s/manifest.json")["cases"][0]["inputs"][0]["name"], "in.csv");
    const Tree first = results_in(path("s"));
    EXPECT_NE(first.at("study.toml").find("sha256"), std::string::npos);
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0.003\n0,1,0.002,0,0.003\n");
    EXPECT_NE(sweep().find("2 computed"), std::string::npos) << "the file is another one";
    expect_failure(4, {"sweep", "s/study.toml", "--out", "t", "--engine", "cpu"}, {"in.csv"}); // it is not beside that
}

TEST_F(Paths, of_a_study_are_shared_out_among_shards) {
    write("study.toml", "[surface]\nfacets = [1, 2, 3]\n[paths]\ncount = 5\nsteps = 40\n");
    expect_success({"sweep", "study.toml", "--out", "all", "--engine", "cpu"});
    for (const char* shard : {"2/2", "1/2"})
        expect_success({"sweep", "study.toml", "--out", "shards", "--engine", "cpu", "--shard", shard});
    expect_success({"sweep", "study.toml", "--out", "shards", "--merge"});
    EXPECT_EQ(differences(results_in(path("all")), results_in(path("shards"))), std::set<std::string>{});
}

TEST_F(Paths, are_validated) {
    const Outcome outcome = expect_success({"validate", "closed.toml"});
    EXPECT_EQ(last_line(outcome.out), fmt::format("{} samples, 0 differ", 2 * 6 * 300));
    EXPECT_EQ(outcome.out.find("voxels"), std::string::npos) << outcome.out;
    write("both.toml", read_text(path("open.toml")) + "[grid]\nsize = [8, 2, 4]\n");
    const Outcome both = expect_success({"validate", "both.toml", "--engine", "cpu", "--precision", "f32"});
    EXPECT_EQ(last_line(both.out), "2000 samples, 0 differ");
    EXPECT_NE(both.out.find("\n64 voxels, 0 differ\n"), std::string::npos) << both.out;
}

} // namespace
} // namespace forceshade::testing
