// Renderers of other people in the studies of energy and stability of a scene.
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using Row = std::map<std::string, std::string>;

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
        EXPECT_EQ(outcome.code, 0) << outcome.error;
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

const std::string kCrash = std::string(BAD_RENDERER) + ":crash";

TEST_F(RendererStudy, OnAPlaneAPenaltyIsAsStableAsTheOracle) {
    write_box();
    const std::vector<Row> rows = study("stability", "loop_renderers", {PENALTY, kCrash, ONE_CONSTRAINT});
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

// Between two walls the penalty jumps from one to the other.
TEST_F(RendererStudy, InAGrooveAPenaltyIsStableAtNoStiffness) {
    write_groove();
    int hollow = 0;
    for (const Row& row : study("stability", "loop_renderers", {PENALTY}))
        if (row.at("place").starts_with("hollow")) {
            ++hollow;
            EXPECT_EQ(row.at("range"), "below");
            EXPECT_EQ(row.at("own_law_range"), "within");
        }
    EXPECT_GT(hollow, 0);
}

TEST_F(RendererStudy, AProxyThatMeetsOnePlaneAnUpdateGivesEnergyInAGroove) {
    write_groove();
    std::map<std::string, Row> rows;
    for (const Row& row : study("energy", "energy_renderers", {ONE_CONSTRAINT, PENALTY, kCrash}))
        rows[row.at("renderer")] = row;
    const Row &own = rows.at("own law"), &proxy = rows.at("one_constraint"), &failed = rows.at("bad_renderer:crash");
    EXPECT_LT(number(own, "largest_mJ"), 1e-3);
    EXPECT_LT(number(own, "rule_mJ"), 1e-3) << "the error of the sum";
    EXPECT_GT(number(proxy, "largest_mJ"), 1e-2);
    EXPECT_LT(number(rows.at("penalty"), "largest_mJ"), 1e-3) << "its force has a potential";
    EXPECT_EQ(number(proxy, "loops"), number(own, "loops"));
    EXPECT_EQ(failed.at("status"), "crashed (Segmentation fault) in update 1000 (loop 0)");
    EXPECT_EQ(failed.at("gain_mJ"), "");
    EXPECT_TRUE(says(said_, "one_constraint gives up to", "bad_renderer:crash crashed"));
    EXPECT_TRUE(std::filesystem::exists(path("out/energy/energy-renderers.svg")));
}

TEST_F(RendererStudy, IsOfASceneAndOfThreeStudies) {
    write_box();
    for (const char* const name : {"omission", "perception"})
        expect_failure(2, {"study", name, "scene.toml", "--out", "out", "--renderer", PENALTY}, {"energy SCENE"});
    for (const char* const name : {"energy", "stability", "error-time", "all"})
        expect_failure(2, {"study", name, "--out", "out", "--renderer", PENALTY}, {"stability SCENE"});
    expect_failure(4, {"study", "energy", "scene.toml", "--out", "out", "--renderer", "libnone.so"},
                   {"there is no file libnone.so"});
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

} // namespace
} // namespace forceshade::testing
