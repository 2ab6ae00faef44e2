// The live loop as a process: what it logs is what explore and the kernels compute, and what it reports is in the log.
#include "host/field/prepared_case.h"
#include "host/referee/rounding_bound.h"
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

TEST_F(Live, ALogReplaysThroughExploreToTheSameCharacters) {
    for (const char* const scene : {"bump.toml", "map.toml", "mesh.toml", "hand.toml"})
        for (const char* const precision : {"f32", "f64"}) {
            SCOPED_TRACE(fmt::format("{} {}", scene, precision));
            expect_success(live(scene, {"--fast", "--duration", "2 s", "--log", "log.csv", "--overwrite", "--quiet",
                                        "--precision", precision}));
            const std::string felt = felt_in(text("log.csv"));
            expect_success(replayed(scene, "log.csv", "out.csv", "cpu", precision));
            EXPECT_TRUE(felt == text("out.csv"));
            const Rows log = rows("log.csv");
            ASSERT_EQ(log.size(), 2000u);
            std::size_t in_contact = 0;
            for (const auto& row : log)
                in_contact += row.at("facet") != "-1";
            EXPECT_GT(in_contact, 1000u);
            // As a device again: the same numbers a second time.
            expect_success(live(scene, {"--fast", "--device", "replay:log.csv", "--log", "again.csv", "--overwrite",
                                        "--quiet", "--precision", precision}));
            EXPECT_TRUE(felt == felt_in(text("again.csv")));
        }
}

TEST_F(Live, ALogOfARunByTheClockReplaysLikewise) {
    expect_success(live("hand.toml", {"--duration", "1 s", "--log", "log.csv", "--quiet"}));
    expect_success(replayed("hand.toml", "log.csv", "out.csv", "cpu", "f64"));
    EXPECT_TRUE(felt_in(text("log.csv")) == text("out.csv"));
    EXPECT_EQ(rows("log.csv").size(), 1000u);
}

// Turned, scaled, moved on by the clutch and let go of: what is logged is the scene's, and replays.
TEST_F(Live, ALogOfAMappedSceneReplaysLikewise) {
    for (const char* const scene : {"bump.toml", "mesh.toml"}) {
        SCOPED_TRACE(scene);
        expect_success(live(scene, {"--fast", "--duration", "2 s", "--log", "log.csv", "--overwrite", "--quiet",
                                    "--device", "sim:1@0 s..1 s,1@1.2 s..9 s,2@1.5 s..1.6 s", "--dead-man", "1",
                                    "--clutch", "2", "--rotate", "z 90 deg, x 10 deg", "--scale", "1.5"}));
        expect_success(replayed(scene, "log.csv", "out.csv", "cpu", "f64"));
        EXPECT_TRUE(felt_in(text("log.csv")) == text("out.csv"));
        const Rows log = rows("log.csv");
        EXPECT_EQ(log[500].at("buttons"), "1");
        EXPECT_EQ(log[1550].at("buttons"), "3");
        EXPECT_TRUE(happened_in(log[1100], "dead_man"));
        EXPECT_TRUE(happened_in(log[1550], "clutched"));
        EXPECT_EQ(log[1599].at("x"), log[1500].at("x")) << "the probe stays";
        const nlohmann::json mapping = read_json("log.live.json")["mapping"];
        EXPECT_EQ(mapping["scale"], 1.5);
        EXPECT_EQ(mapping["scene_y"][0], -1);
    }
    expect_success(live("bump.toml", {"--fast", "--duration", "1 s", "--log", "log.csv", "--overwrite", "--quiet"}));
    EXPECT_EQ(rows("log.csv")[0].count("buttons"), 0u) << "of a device that has none";
}

TEST_F(Live, ARecordingsOwnRateIsRoundedToOneThatTheLoopHas) {
    std::string fast = "path,t,x,y,z\n", slow = fast;
    for (int i = 0; i < 200; ++i) {
        fast += fmt::format("7,{},0,0,-0.001\n", 0.0000999 * i);
        slow += fmt::format("7,{},0,0,-0.001\n", 0.01004 * i);
    }
    write("fast.csv", fast);
    write("slow.csv", slow);
    for (const auto& [name, rate] : {std::pair{"fast.csv", 10000}, {"slow.csv", 100}}) {
        EXPECT_EQ(json_of(live("plane.toml",
                               {"--fast", "--device", fmt::format("replay:{}", name), "--quiet", "--json"}))["rate_Hz"],
                  rate);
    }
}

TEST_F(Live, TheReportSaysWhatTheLogHolds) {
    const Outcome outcome =
        expect_success(live("hand.toml", {"--fast", "--duration", "2 s", "--log", "log.csv", "--max-force", "1.5 N",
                                          "--slew", "0.05 N/ms", "--json"}));
    const nlohmann::json said = read_json("log.live.json");
    EXPECT_EQ(outcome.out, text("log.live.json"));
    EXPECT_TRUE(says(outcome.error, "2000 samples", text("log.live.txt"))) << "the text is what the terminal got";
    EXPECT_TRUE(says(text("log.live.html"), "Force over time"));
    const Rows log = rows("log.csv");
    ASSERT_EQ(log.size(), 2000u);
    EXPECT_EQ(said["samples"], log.size());
    EXPECT_EQ(said["log"]["samples"], log.size());
    EXPECT_EQ(said["log"]["lost"], 0);
    EXPECT_EQ(said["log"]["file"], "log.csv");
    EXPECT_EQ(said["compute"]["count"], log.size());
    std::size_t in_contact = 0;
    double force = 0, commanded = 0, depth = 0, energy = 0, late = 0, computing = 0;
    for (const auto& row : log) {
        in_contact += row.at("facet") != "-1";
        force = std::max(force, size_in(row, "fx", "fy", "fz"));
        commanded = std::max(commanded, size_in(row, "cx", "cy", "cz"));
        depth = std::max(depth, number_in(row, "depth"));
        energy = std::max(energy, number_in(row, "energy"));
        late = std::max(late, number_in(row, "late_ns"));
        computing = std::max(computing, number_in(row, "compute_ns"));
    }
    EXPECT_EQ(said["in_contact"], in_contact);
    EXPECT_NEAR(said["largest_force_N"], force, 1e-12);
    EXPECT_NEAR(said["largest_commanded_N"], commanded, 1e-12);
    EXPECT_NEAR(commanded, 1.5, 1e-12) << "the limit is reached and not passed";
    EXPECT_EQ(said["largest_depth_m"], depth);
    EXPECT_EQ(said["largest_energy_J"], energy);
    EXPECT_EQ(said["energy_J"], number_in(log.back(), "energy"));
    EXPECT_EQ(said["compute"]["largest_ns"], computing);
    for (const auto& [name, count] : said["happened"].items()) {
        std::size_t rows = 0;
        for (const auto& row : log)
            rows += happened_in(row, name);
        EXPECT_EQ(count, rows) << name;
    }
    for (const char* const name : {"clamped", "slewed", "ramping"})
        EXPECT_GT(said["happened"][name], 0) << name;
    for (std::size_t i = 1; i < log.size(); ++i) {
        if (log[i].at("path") != log[i - 1].at("path")) { // the hand has lost its path: switched off
            EXPECT_LE(size_in(log[i], "cx", "cy", "cz"), 0.05);
            continue;
        }
        const double rise = size_in(log[i], "cx", "cy", "cz") - size_in(log[i - 1], "cx", "cy", "cz");
        ASSERT_LE(rise, 0.05 * (1 + 1e-9)) << "row " << i;
    }
}

TEST_F(Live, AStiffnessThatTheHandCannotHoldIsNamedBeforeItIsFelt) {
    write("stiff.toml", "surface.facets = 2\nforce.stiffness = \"20 N/mm\"\n");
    const Outcome outcome = expect_success(live("stiff.toml", {"--fast", "--duration", "0.1 s", "--json"}));
    EXPECT_TRUE(says(outcome.error, "this loop is unstable"));
    EXPECT_TRUE(says(outcome.out, "comes to rest below"));
    EXPECT_FALSE(says(expect_success(live("bump.toml", {"--fast", "--duration", "0.1 s"})).error, "unstable"));
}

// At 20 N/mm the loop cycles; the damping that a scene asks for is that of its session, unless the command states
// another.
TEST_F(Live, ASceneMayAskForThePassivityController) {
    const std::string stiff = "surface.facets = 2\nforce.stiffness = \"20 N/mm\"\n";
    write("free.toml", stiff);
    write("damped.toml", stiff + "[hand]\npassivity = \"20 N s/m\"\n");
    const auto reported = [&](const char* scene, std::vector<std::string> options) {
        options.insert(options.end(), {"--fast", "--duration", "0.5 s", "--json", "--without-fade"});
        return json_of(live(scene, options));
    };
    const auto free = reported("free.toml", {}), damped = reported("damped.toml", {});
    EXPECT_EQ(free["damped_J"], 0);
    EXPECT_GT(damped["damped_J"], 0);
    EXPECT_LT(damped["largest_energy_J"], free["largest_energy_J"]);
    EXPECT_EQ(reported("damped.toml", {"--passivity", "--damping", "20 N s/m"})["damped_J"], damped["damped_J"]);
    EXPECT_NE(reported("damped.toml", {"--passivity", "--damping", "1 N s/m"})["damped_J"], damped["damped_J"]);
}

TEST_F(Live, QuietSaysNothingAndTheReportGoesWhereItIsTold) {
    const Outcome outcome =
        expect_success(live("bump.toml", {"--fast", "--duration", "0.5 s", "--report", "said", "--quiet"}));
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.error, "");
    EXPECT_EQ(read_json("said.json")["samples"], 500);
    EXPECT_EQ(read_json("said.json")["log"]["file"], nullptr);
    for (const char* const name : {"said.txt", "said.html"})
        EXPECT_GT(text(name).size(), 100u) << name;
    const Tree before = tree_of(folder_.path());
    EXPECT_EQ(expect_success(live("bump.toml", {"--fast", "--duration", "0.5 s", "--quiet"})).error, "");
    EXPECT_EQ(differences(before, tree_of(folder_.path())), std::set<std::string>{}) << "nobody asked for files";
}

} // namespace
} // namespace forceshade::testing
