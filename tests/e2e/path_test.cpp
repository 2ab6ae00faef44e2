// Generated and recorded paths, from the command line: files, figures, refusals.
#include <csignal>
#include <set>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include "tests/e2e/path_workplace.h"

namespace forceshade::testing {
namespace {

constexpr std::uint64_t kMebibyte = 1 << 20;

TEST_F(Paths, become_an_exr_and_a_table) {
    const Outcome outcome = expect_success(explore("open.toml", "a.exr", {"--also", "npy,png"}));
    EXPECT_EQ(outcome.out, "");
    for (const char* word : {"a.exr: 20 paths of 100 steps", "million steps/s", "0 unstable", "0 differ"})
        EXPECT_NE(outcome.error.find(word), std::string::npos) << outcome.error;
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
    expect_success(explore("open.toml", "a.exr", {"--also", "npy,png", "--quiet"}));
    EXPECT_EQ(differences(first, tree_of(folder_.path())), std::set<std::string>{}) << "the same bytes in every run";
    EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
}

TEST_F(Paths, in_closed_loop_have_a_speed_ratio) {
    expect_success(explore("closed.toml", "a.csv"));
    for (const auto& row : table_in(read_text(path("a.paths.csv"))))
        EXPECT_GT(std::stod(row.at("speed_ratio")), 0);
    EXPECT_EQ(table_in(read_text(path("a.csv"))).size(), 6u * 300);
}

TEST_F(Paths, are_the_same_on_a_gpu) {
    write("roof.obj", "v -1 -1 0\nv 0 -1 1\nv 1 -1 0\nv -1 1 0\nv 0 1 1\nv 1 1 0\nf 1 2 5 4\nf 2 3 6 5\n");
    write("mesh.toml", "[surface]\nkind = \"mesh\"\nfile = \"roof.obj\"\nunit = \"cm\"\n[paths]\ncount = 7\n"
                       "steps = 300\ndepth = \"2 mm\"\nspeed = { mean = \"100 mm/s\", sd = \"5 mm/s\" }\n");
    for (const char* scene : {"open.toml", "closed.toml", "mesh.toml"})
        for (const char* precision : {"f32", "f64"}) {
            expect_success(explore(scene, "cpu.csv", {"--precision", precision}));
            expect_success({"explore", scene, "--out", "gpu.csv", "--precision", precision});
            EXPECT_EQ(read_text(path("cpu.csv")), read_text(path("gpu.csv"))) << scene << precision;
            EXPECT_EQ(read_text(path("cpu.paths.csv")), read_text(path("gpu.paths.csv"))) << scene << precision;
        }
}

TEST_F(Paths, of_metrics_alone_take_no_memory_for_steps) {
    expect_success(explore("open.toml", "a.exr"));
    const std::string table = read_text(path("a.paths.csv"));
    std::filesystem::remove(path("a.exr"));
    expect_success(explore("open.toml", "a.exr", {"--metrics-only"}));
    EXPECT_EQ(read_text(path("a.paths.csv")), table);
    EXPECT_FALSE(std::filesystem::exists(path("a.exr")));
    write("few.toml", scene("count = 50\nsteps = 1000\n"));
    write("many.toml", scene("count = 50\nsteps = 100000\n"));
    const std::uint64_t few = expect_success(explore("few.toml", "a.exr", {"--metrics-only"})).peak_memory;
    EXPECT_LT(expect_success(explore("many.toml", "a.exr", {"--metrics-only"})).peak_memory, few + 4 * kMebibyte);
    expect_failure(2, explore("open.toml", "a.exr", {"--metrics-only", "--also", "npy"}), {"--metrics-only"});
}

TEST_F(Paths, say_in_json_what_became_of_them) {
    const nlohmann::json said = nlohmann::json::parse(expect_success(explore("open.toml", "a.exr", {"--json"})).out);
    EXPECT_EQ(said["paths"], 20);
    EXPECT_EQ(said["steps"], 100);
    EXPECT_EQ(said["samples"], 2000);
    EXPECT_EQ(said["oracle"]["samples_compared"], 2000);
    EXPECT_EQ(said["oracle"]["samples_differing"], 0);
    EXPECT_EQ(said["files"][0]["name"], "a.exr");
    EXPECT_GT(said["steps_per_second"], 0);
    EXPECT_LT(said["work_J"], 1);
}

TEST_F(Paths, at_their_extremes_are_written) {
    write("one.toml", scene("count = 1\nsteps = 1\n"));
    write("still.toml", scene("count = 3\nsteps = 50\nlength = \"0 mm\"\n"));
    write("wide.toml", scene("count = 100000\nsteps = 1\n"));
    for (const char* out : {"a.exr", "a.csv"}) {
        expect_success(explore("one.toml", out, {"--also", "png"}));
        EXPECT_EQ(table_in(read_text(path("a.paths.csv"))).size(), 1u);
        expect_success(explore("still.toml", out, {"--also", "png"}));
        EXPECT_EQ(table_in(read_text(path("a.paths.csv"))).size(), 3u);
        expect_success(explore("wide.toml", out));
        EXPECT_EQ(table_in(read_text(path("a.paths.csv"))).size(), 100000u);
    }
}

TEST_F(Paths, leave_nothing_where_they_cannot_be_written) {
    const Tree before = tree_of(folder_.path());
    expect_failure(4, explore("open.toml", "nosuch/a.exr"), {"nosuch"});
    expect_failure(2, explore("open.toml", "a.png"), {".exr", ".csv"});
    expect_failure(2, explore("open.toml", "a.exr", {"--also", "vti"}), {"npy", "png"});
    write("long.toml", scene("count = 2000\nsteps = 500\n[output]\ncompression = \"none\"\n"));
    for (const char* out : {"a.exr", "a.csv"}) {
        Launch launch = this->launch(explore("long.toml", out));
        launch.most_file_bytes = kMebibyte;
        expect_failure(4, launch, {out});
    }
    std::filesystem::remove(path("long.toml"));
    EXPECT_EQ(differences(before, tree_of(folder_.path())), std::set<std::string>{});
}

TEST_F(Paths, leave_nothing_when_interrupted) {
    write("long.toml", scene("count = 200000\nsteps = 2000\n"));
    const std::vector<std::string> before = names();
    for (const char* out : {"a.exr", "a.csv"}) {
        Process process(launch(explore("long.toml", out)));
        while (process.running() && temporaries_in(folder_.path()).empty())
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        process.send(SIGINT);
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.code, 130) << outcome.error;
        EXPECT_EQ(names(), before);
    }
}

TEST_F(Paths, recorded_in_a_file_are_felt_alike_however_they_are_taken) {
    std::string rows = "path,t,x,y,z\n";
    for (int i = 0; i < 200; ++i)
        for (const int p : {30, 10, 20})
            if (p != 10 || i < 50)
                rows += fmt::format("{},{:.6g},{:.6g},{:.6g},0.003\n", p, i * 0.002, (i - 100) * 1.5e-4, p * 1e-4);
    write("in.csv", rows);
    write("plain.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n");
    const auto sorted = [&](const char* name) {
        std::istringstream lines(read_text(path(name)));
        std::multiset<std::string> all;
        for (std::string line; std::getline(lines, line);)
            all.insert(line);
        return all;
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
    EXPECT_TRUE(read_text(path("cpu.csv")).find("\n30,0,-0.015,") != std::string::npos);
    const auto table = table_in(read_text(path("cpu.paths.csv")));
    ASSERT_EQ(table.size(), 3u);
    EXPECT_EQ(table[0].at("path"), "30") << "in the order of their first samples";
    EXPECT_EQ(table[1].at("steps"), "50");
}

TEST_F(Paths, that_leave_their_bound_are_flagged_and_hold_no_nan) {
    write("wild.toml", "[surface]\nfacets = 3\n[force]\nstiffness = \"100 N/mm\"\n[paths]\ncount = 5\nsteps = 3000\n"
                       "press = \"1 N\"\nbound = \"20 mm\"\n[hand]\nmax_force = \"1000 N\"\ndelay_samples = 1\n");
    for (const char* engine : {"cpu", "gpu"}) {
        const Outcome outcome = expect_success({"explore", "wild.toml", "--out", "a.csv", "--engine", engine});
        EXPECT_NE(outcome.error.find("5 of 5 paths left the bound"), std::string::npos) << outcome.error;
        EXPECT_EQ(read_text(path("a.csv")).find("nan"), std::string::npos);
        EXPECT_EQ(read_text(path("a.csv")).find("inf"), std::string::npos);
        for (const auto& row : table_in(read_text(path("a.paths.csv")))) {
            EXPECT_EQ(row.at("unstable"), "1");
            EXPECT_GT(std::stod(row.at("unstable_time_s")), 0.01);
            EXPECT_LT(std::stod(row.at("unstable_time_s")), 3);
        }
    }
}

TEST_F(Paths, that_begin_within_a_mesh_are_told_of) {
    write("roof.obj", "v -1 -1 0\nv 0 -1 1\nv 1 -1 0\nv -1 1 0\nv 0 1 1\nv 1 1 0\nf 1 2 5 4\nf 2 3 6 5\n");
    write("mesh.toml",
          "[surface]\nkind = \"mesh\"\nfile = \"roof.obj\"\nunit = \"cm\"\n[paths]\ncount = 3\nsteps = 50\n"
          "length = \"4 mm\"\ndepth = \"5 mm\"\nspeed = { mean = \"100 mm/s\", sd = \"5 mm/s\" }\n");
    const Outcome outcome = expect_success(explore("mesh.toml", "a.exr", {"--also", "png"}));
    EXPECT_NE(outcome.error.find("3 of 3 paths begin behind the mesh's surface"), std::string::npos) << outcome.error;
    for (const auto& row : table_in(read_text(path("a.paths.csv")))) {
        EXPECT_EQ(row.at("began_inside"), "1");
        EXPECT_EQ(row.at("contact_time_s"), "0.05") << "pushed out at the nearest place";
    }
}

} // namespace
} // namespace forceshade::testing
