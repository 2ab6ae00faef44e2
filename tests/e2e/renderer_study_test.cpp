// Renderers of other people, and friction and vibration, in the studies of energy and stability of a scene.
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "tests/e2e/renderers.h"
#include "tests/e2e/workplace.h"
#include "tests/vibration/made_up_models.h"

namespace forceshade::testing {
namespace {

using Row = std::map<std::string, std::string>;

const std::string kCrash = kBadRenderer + ":crash";

class RendererStudy : public Workplace {
protected:
    void write_scene(const std::string& mesh) const {
        write("shape.obj", mesh);
        write("scene.toml", "[surface]\nkind = \"mesh\"\nfile = \"shape.obj\"\nunit = \"mm\"\n");
    }
    // A cube of 40 mm, its top at z = 0.
    void write_box() const {
        std::string mesh;
        for (const double z : {-40.0, 0.0})
            for (const auto& [x, y] : {std::pair(-20, -20), {20, -20}, {20, 20}, {-20, 20}})
                mesh += fmt::format("v {} {} {}\n", x, y, z);
        write_scene(mesh + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    }
    // A groove along y, 90 degrees wide, its bottom at z = -10 mm.
    void write_groove() const {
        write_scene("v -20 -20 10\nv -20 20 10\nv 0 -20 -10\nv 0 20 -10\nv 20 -20 10\nv 20 20 10\n"
                    "v -20 -20 -30\nv -20 20 -30\nv 20 -20 -30\nv 20 20 -30\n"
                    "f 1 3 4 2\nf 3 5 6 4\nf 5 9 10 6\nf 9 7 8 10\nf 7 1 2 8\nf 1 7 9 5 3\nf 2 4 6 10 8\n");
    }
    // The rows of a table of a study with these renderers.
    std::vector<Row> study(const std::string& name, const std::string& table,
                           const std::vector<std::string>& renderers) const {
        std::vector<std::string> all{"study", name,       "scene.toml", "--quick", "--out",
                                     "out",   "--engine", "cpu",        "--fresh"};
        for (const std::string& renderer : renderers)
            all.insert(all.end(), {"--renderer", renderer});
        Launch launched = launch(all);
        launched.timeout = 300;
        const Outcome outcome = run(launched);
        EXPECT_EQ(outcome.code, std::ranges::count(renderers, kCrash) > 0 ? 1 : 0) << outcome.error;
        said_ = outcome.error;
        std::vector<Row> rows;
        const std::vector<std::string> lines = lines_of(read_text(path("out/" + name + "/" + table + ".csv")));
        const std::vector<std::string> header = cells_of(lines.front());
        for (std::size_t i = 1; i < lines.size(); ++i) {
            const std::vector<std::string> cells = cells_of(lines[i]);
            Row& row = rows.emplace_back();
            for (std::size_t column = 0; column < header.size(); ++column)
                row[header[column]] = cells[column];
        }
        return rows;
    }
    static double number(const Row& row, const char* column) { return std::stod(row.at(column)); }

    mutable std::string said_;
};

TEST_F(RendererStudy, OnAPlaneAPenaltyIsAsStableAsTheOracle) {
    write_box();
    const std::vector<Row> rows = study("stability", "loop_renderers", {kPenalty, kCrash, kOneConstraint});
    std::map<std::string, int> found;
    for (const Row& row : rows) {
        ++found[row.at("renderer")];
        if (row.at("renderer") == "bad_renderer:crash") {
            EXPECT_EQ(row.at("status"), "crashed (Segmentation fault) in update 1000");
            EXPECT_EQ(row.at("limit_N_per_m"), "");
            continue;
        }
        EXPECT_EQ(row.at("status"), "ok");
        EXPECT_EQ(row.at("range"), "within");
        EXPECT_NEAR(number(row, "ratio_1"), 1, 0.03) << row.at("place");
        EXPECT_NEAR(number(row, "limit_N_per_m") / number(row, "wall_N_per_m"), 1, 0.03) << "K_crit in closed form";
    }
    EXPECT_EQ(found, (std::map<std::string, int>{{"penalty", 4}, {"one_constraint", 4}, {"bad_renderer:crash", 1}}));
    EXPECT_TRUE(says(said_, "penalty is stable up to", "the scene's own law is stable up to",
                     "bad_renderer:crash crashed (Segmentation fault)"));
    EXPECT_TRUE(std::filesystem::exists(path("out/stability/loop-renderers.svg")));
}

// Between two walls the penalty settles on one of them; a proxy of one plane at a time leaves the place.
TEST_F(RendererStudy, InAGrooveAProxyOfOnePlaneIsStableAtNoStiffness) {
    write_groove();
    int hollow = 0;
    for (const Row& row : study("stability", "loop_renderers", {kPenalty, kOneConstraint}))
        if (row.at("place").starts_with("hollow")) {
            ++hollow;
            const bool penalty = row.at("renderer") == "penalty";
            EXPECT_EQ(row.at("range"), penalty ? "within" : "below");
            EXPECT_EQ(number(row, "moved_um") > 10, !penalty);
            EXPECT_GT(number(row, "moved_um"), 0.1);
            EXPECT_EQ(row.at("own_law_range"), "within");
        }
    EXPECT_GT(hollow, 0);
    EXPECT_TRUE(says(said_, "the probe moves", "away and swings by"));
}

TEST_F(RendererStudy, AProxyThatMeetsOnePlaneAnUpdateGivesEnergyInAGroove) {
    write_groove();
    std::map<std::string, Row> rows;
    for (const Row& row : study("energy", "energy_renderers", {kOneConstraint, kPenalty, kCrash}))
        rows[row.at("renderer")] = row;
    const Row &own = rows.at("own law"), &proxy = rows.at("one_constraint"), &failed = rows.at("bad_renderer:crash");
    EXPECT_LT(number(own, "largest_mJ"), 1e-3);
    EXPECT_LT(number(own, "rule_mJ"), 1e-3) << "the error of the sum";
    EXPECT_GT(number(proxy, "largest_mJ"), 1e-2);
    EXPECT_LT(number(rows.at("penalty"), "largest_mJ"), 1e-3) << "its force has a potential";
    EXPECT_EQ(number(proxy, "closed_strokes"), number(own, "closed_strokes"));
    EXPECT_EQ(failed.at("status"), "crashed (Segmentation fault) in update 1000 (closed stroke 0)");
    EXPECT_EQ(failed.at("gain_mJ"), "");
    EXPECT_TRUE(says(said_, "one_constraint gives up to", "bad_renderer:crash crashed"));
    EXPECT_TRUE(std::filesystem::exists(path("out/energy/energy-renderers.svg")));
}

class RubbingStudy : public RendererStudy {
protected:
    void write_plane(const std::string& more) const {
        write("m.xml", made_up_models());
        write("scene.toml", "[surface]\nfacets = 1\n[paths]\n" + more);
    }
    std::map<std::string, Row> energies() const {
        std::map<std::string, Row> rows;
        for (const Row& row : study("energy", "energy_renderers", {}))
            rows[row.at("renderer")] = row;
        return rows;
    }
};

// On a plane the work of sliding is the coefficient times the depth times the stiffness, over the way.
TEST_F(RubbingStudy, FrictionTakesEnergyAndVibrationDoesNotKeepIt) {
    write_plane("[friction]\ncoefficient = 0.4\n[texture]\nvibration = \"m.xml\"\n");
    const std::map<std::string, Row> rows = energies();
    const Row &own = rows.at("own law"), &rubs = rows.at("own law with friction");
    EXPECT_EQ(rows.size(), 4U);
    EXPECT_LT(std::abs(number(own, "largest_mJ")), 1e-9);
    EXPECT_LT(number(rubs, "largest_mJ"), 0);
    EXPECT_NEAR(number(rubs, "gain_mJ") / -number(rubs, "effort_mJ"), 0.74, 0.2) << "part of the effort is upright";
    EXPECT_GT(number(rows.at("own law with vibration"), "gain_to_mJ"), 1e-3);
    EXPECT_LT(number(rows.at("own law with both"), "largest_mJ"), 0);
    EXPECT_TRUE(says(said_, "own law with friction takes at least", "own law with vibration gives up to"));
}

// A bristle is a wall along the surface; beyond that wall's limit no stiffness is stable.
TEST_F(RubbingStudy, ABristleIsStableUpToTheLimitOfAWall) {
    for (const double bristle : {5800.0, 9000.0}) {
        write_plane(fmt::format("[friction]\ncoefficient = 0.4\nstiffness = \"{} N/m\"\n", bristle));
        for (const Row& row : study("stability", "loop_renderers", {}))
            if (row.at("hand") == "own") {
                const double wall = number(row, "wall_N_per_m");
                EXPECT_EQ(number(row, "limit_N_per_m") > 0.98 * wall, bristle < wall) << bristle;
            }
        EXPECT_TRUE(says(said_, bristle < 6030 ? "along the surface: stable" : "along the surface: unstable"));
    }
}

// Sliding, it comes to rest elsewhere: that is a rest, too.
TEST_F(RubbingStudy, FrictionMayHoldAProbeOffItsPlace) {
    write_plane("");
    write("scene.toml", "[surface]\nradius = \"600 mil\"\nfacets = 8\n[force]\nshading = \"reference\"\n[paths]\n"
                        "press = \"1 N\"\n[friction]\ncoefficient = 0.3\nstatic_coefficient = 0.4\n");
    for (const Row& row : study("stability", "loop_renderers", {})) {
        EXPECT_EQ(row.at("range"), "within") << row.at("place");
        EXPECT_GT(number(row, "limit_N_per_m"), 0.98 * number(row, "own_law_N_per_m"));
        EXPECT_LT(number(row, "swing_um"), 1e-3 * number(row, "moved_um"));
    }
}

TEST_F(RubbingStudy, AVibrationOfItsOwnSpeedDoesNotComeToRest) {
    write_plane("[texture]\nvibration = \"m.xml\"\n");
    for (const Row& row : study("stability", "loop_renderers", {})) {
        EXPECT_EQ(row.at("renderer"), "own law with vibration");
        EXPECT_EQ(row.at("range"), "below") << "its noise is the same at any speed";
        EXPECT_GT(number(row, "swing_um"), 1);
        EXPECT_LT(number(row, "swing_um"), 2000);
    }
    const Outcome outcome =
        expect_success({"study", "error-time", "scene.toml", "--quick", "--out", "e", "--engine", "cpu"});
    EXPECT_TRUE(says(outcome.error, "without its friction and vibration"));
}

TEST_F(RendererStudy, IsOfASceneAndOfThreeStudies) {
    write_box();
    for (const char* const name : {"omission", "perception"})
        expect_failure(2, {"study", name, "scene.toml", "--out", "out", "--renderer", kPenalty}, {"energy SCENE"});
    for (const char* const name : {"energy", "stability", "error-time", "all"})
        expect_failure(2, {"study", name, "--out", "out", "--renderer", kPenalty}, {"stability SCENE"});
    expect_failure(4, {"study", "energy", "scene.toml", "--out", "out", "--renderer", "libnone.so"},
                   {"there is no file libnone.so"});
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

} // namespace
} // namespace forceshade::testing
