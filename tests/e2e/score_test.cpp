// Renderers of other people, scored: the faults of the two examples are found, and none of them can end the program.
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "tests/e2e/renderers.h"
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using Row = std::map<std::string, std::string>;

class Score : public Workplace {
protected:
    // A box of 40 x 40 x `thickness` mm, its top at z = 0.
    void write_plate(double thickness) const {
        std::string mesh;
        for (const double z : {-thickness, 0.0})
            for (const auto& [x, y] : {std::pair(-20, -20), {20, -20}, {20, 20}, {-20, 20}})
                mesh += fmt::format("v {} {} {}\n", x, y, z);
        write("shape.obj", mesh + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
        write_scene();
    }
    // A groove along y, 90 degrees wide, its bottom at z = -10 mm.
    void write_groove() const {
        write("shape.obj", "v -20 -20 10\nv -20 20 10\nv 0 -20 -10\nv 0 20 -10\nv 20 -20 10\nv 20 20 10\n"
                           "v -20 -20 -30\nv -20 20 -30\nv 20 -20 -30\nv 20 20 -30\n"
                           "f 1 3 4 2\nf 3 5 6 4\nf 5 9 10 6\nf 9 7 8 10\nf 7 1 2 8\nf 1 7 9 5 3\nf 2 4 6 10 8\n");
        write_scene();
    }
    void write_scene() const {
        write("scene.toml", "[surface]\nkind = \"mesh\"\nfile = \"shape.obj\"\nunit = \"mm\"\n");
    }
    // Strokes along x (y in a groove), a second each, at 1 kHz: from 1 mm above `top` down to `deepest` below it.
    void write_strokes(double deepest, double top = 0, const char* along = "x", int strokes = 2) const {
        std::string text = "path,t,x,y,z\n";
        for (int path = 0; path < strokes; ++path)
            for (int i = 0; i < 1000; ++i) {
                const double share = i / 999.0, way = (share - 0.5) * 0.02;
                const double down = std::sin(share * 3.14159265358979);
                const double z = top + 1e-3 - (1e-3 + deepest) * std::min(1.5 * down, 1.0);
                const double aside = 2e-3 * path + 1e-4; // not on a diagonal
                text += fmt::format("{},{},{},{},{}\n", path, i / 1000.0, *along == 'x' ? way : 0.0,
                                    *along == 'x' ? aside : way, z);
            }
        write("strokes.csv", text);
    }
    std::map<std::string, Row> table(const std::string& name = "renderers") const {
        std::map<std::string, Row> rows;
        const std::vector<std::string> lines = lines_of(read_text(path("out/score/" + name + ".csv")));
        const std::vector<std::string> header = cells_of(lines.front());
        for (std::size_t i = 1; i < lines.size(); ++i) {
            const std::vector<std::string> cells = cells_of(lines[i]);
            for (std::size_t column = 0; column < header.size(); ++column)
                rows[cells[0]][header[column]] = cells[column];
        }
        return rows;
    }
    Outcome score(std::vector<std::string> more) const {
        std::vector<std::string> all{"score", "scene.toml", "--paths", "strokes.csv", "--out", "out"};
        all.insert(all.end(), more.begin(), more.end());
        return forceshade(all);
    }
    static double number(const Row& row, const char* column) { return std::stod(row.at(column)); }
};

TEST_F(Score, FindsThatAPenaltyPopsThroughAThinPlateAndAProxyDoesNot) {
    write_plate(2);
    write_strokes(1.5e-3); // the other side is nearer from 1 mm on
    EXPECT_EQ(score({"--renderer", kPenalty, "--renderer", kOneConstraint}).code, 0);
    const auto rows = table();
    EXPECT_EQ(number(rows.at("penalty"), "pop_throughs"), 2) << "one a stroke";
    EXPECT_EQ(number(rows.at("one_constraint"), "pop_throughs"), 0);
    EXPECT_EQ(number(rows.at("field, without history"), "pop_throughs"), 2) << "nor has the field a memory";
    EXPECT_LT(number(rows.at("one_constraint"), "error_percent"), 0.5) << "on a plane it is right, but for its skin";
    EXPECT_GT(number(rows.at("penalty"), "error_percent"), 50);
    EXPECT_GT(number(rows.at("penalty"), "boundary_ns"), 0);
    for (const char* const measure : {"error_rms_N", "direction_rms_deg", "phantom_largest_N", "drop_outs",
                                      "pop_throughs", "added_100Hz_mN", "excess_work_mJ", "delay_ms", "not_finite"})
        EXPECT_EQ(number(rows.at("oracle (f64)"), measure), 0) << measure;
    EXPECT_EQ(table("faults").at("penalty").at("fault"), "pop-through");
    EXPECT_TRUE(std::filesystem::exists(path("out/report.html")));
}

TEST_F(Score, HearsTheRippleOfAProxyThatMeetsOnePlaneAnUpdate) {
    write_groove();
    write_strokes(2e-3, -0.010, "y"); // pressed into the bottom, where two planes hold a proxy
    EXPECT_EQ(score({"--renderer", kPenalty, "--renderer", kOneConstraint}).code, 0);
    const auto rows = table();
    const double ripple = number(rows.at("one_constraint"), "added_100Hz_mN");
    EXPECT_GT(ripple, 100) << "of 2 N";
    EXPECT_GT(ripple, 0.9 * number(rows.at("one_constraint"), "added_30Hz_mN")) << "all of it is high";
    EXPECT_LT(number(rows.at("oracle in f32"), "added_100Hz_mN"), 0.1);
}

TEST_F(Score, ALibraryThatDoesWrongCostsItsRowAlone) {
    write_plate(20);
    write_strokes(1e-3);
    const std::string bad = kBadRenderer;
    std::vector<std::string> all{"--patience", "1 s", "--renderer", kOneConstraint};
    for (const char* const what : {"crash", "exit", "sleep", "beyond", "fail", "refuse", "crash in open", "nan", "huge",
                                   "latin", "throw", "crash in close"})
        all.insert(all.end(), {"--renderer", bad + ":" + what});
    all.insert(all.end(), {"--renderer", kBadVersion, "--renderer", kBadSymbols});
    const Outcome outcome = score(all);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_TRUE(says(outcome.error, "11 renderers failed and have no score"));
    auto rows = table();
    EXPECT_LT(number(rows.at("one_constraint"), "error_percent"), 1);
    const auto status = [&](const std::string& name) { return rows.at("bad_renderer:" + name).at("status"); };
    EXPECT_EQ(status("crash"), "crashed (Segmentation fault) in update 1000 (path 0, t = 0.999 s)");
    EXPECT_EQ(status("exit"), "ended its process (exit 3) in update 1000 (path 0, t = 0.999 s)");
    EXPECT_EQ(status("sleep"), "gave no answer within 1 s in update 1000 (path 0, t = 0.999 s)");
    EXPECT_EQ(status("beyond"), "wrote beyond its answer in update 1000 (path 0, t = 0.999 s)");
    EXPECT_EQ(status("fail"), "returned error 4 in update 1000 (path 0, t = 0.999 s)");
    EXPECT_EQ(status("refuse"), "returned error 7: this scene has no mesh that I like in fsr_open");
    EXPECT_EQ(status("crash in open"), "crashed (Aborted) in fsr_open");
    EXPECT_TRUE(says(status("latin"), "returned error 5: zu gro\xEF\xBF\xBD in update 1000"));
    EXPECT_EQ(status("throw"), "threw an exception: out of ideas in update 1000 (path 0, t = 0.999 s)");
    EXPECT_EQ(status("crash in close"), "ok");
    EXPECT_TRUE(says(outcome.error, "bad_renderer:crash in close crashed (Aborted) in fsr_close; its scores stand"));
    EXPECT_EQ(status("nan"), "ok");
    EXPECT_EQ(number(rows.at("bad_renderer:nan"), "not_finite"), 1001) << "from the 1000th on";
    EXPECT_EQ(status("huge"), "ok");
    EXPECT_TRUE(says(rows.at("bad_version").at("status"), "is of version 2 of forceshade_renderer.h"));
    EXPECT_TRUE(says(rows.at("bad_symbols").at("status"), "has no function fsr_error"));
}

TEST_F(Score, TakesAnotherProgramsLogByItsOwnNames) {
    write_plate(20);
    write_strokes(1e-3);
    expect_success({"explore", "scene.toml", "--paths", "strokes.csv", "--out", "felt.csv", "--precision", "f64"});
    std::string log = "sec,pos.x,pos.y,pos.z,F1,F2,F3\n"; // z-up as x-up, in mm and mN
    const std::vector<std::string> lines = lines_of(read_text(path("felt.csv")));
    for (std::size_t i = 1; i < lines.size(); ++i) {
        std::vector<double> n;
        for (const std::string& cell : cells_of(lines[i]))
            n.push_back(std::stod(cell));
        log += fmt::format("{},{},{},{},{},{},{}\n", n[1] + n[0], 1e3 * n[4], 1e3 * n[3], -1e3 * n[2], 1e3 * n[10],
                           1e3 * n[9], -1e3 * n[8]);
    }
    write("log.csv", log);
    const std::string map = "t=sec s, x=-pos.z mm, y=pos.y mm, z=pos.x mm, fx=-F3 mN, fy=F2 mN, fz=F1 mN";
    expect_success({"score", "scene.toml", "--forces", "log.csv", "--map", map, "--out", "out"});
    expect_failure(2, {"score", "scene.toml", "--forces", "log.csv", "--map", map, "--out", "out"}, {"--overwrite"});
    EXPECT_LT(number(table().at("log"), "error_percent"), 1e-6);
    const auto doubted = [&](const std::string& forces) {
        return expect_success(
                   {"score", "scene.toml", "--forces", "log.csv", "--map", map.substr(0, map.find("fx")) + forces})
            .error;
    };
    EXPECT_TRUE(says(doubted("fx=-F3 N, fy=F2 N, fz=F1 N"), "1e+03 times the oracle's; are they in another unit?"));
    EXPECT_TRUE(says(doubted("fx=F3 mN, fy=F2 mN, fz=-F1 mN"), "point the other way"));
    write("rubs.toml", read_text(path("scene.toml")) + "[friction]\n");
    EXPECT_TRUE(says(expect_success({"score", "rubs.toml", "--forces", "log.csv", "--map", map}).error,
                     "the oracle is the scene's law without its friction and vibration"));
    expect_failure(2, {"score", "scene.toml", "--forces", "log.csv", "--out", "other"},
                   {"no column is called", "--map"});
    expect_failure(2, {"score", "scene.toml", "--out", "other"}, {"--paths"});
    EXPECT_FALSE(std::filesystem::exists(path("other"))) << "where there is no score";
    expect_failure(4, {"score", "scene.toml", "--paths", "strokes.csv", "--renderer", "libnone.so"},
                   {"there is no file libnone.so"});
    write("away.csv", "t,x,y,z\n0,0,0,0.01\n0.001,0,0,0.01\n");
    expect_failure(2, {"score", "scene.toml", "--paths", "away.csv"}, {"no sample touches the surface"});
}

// The course is written by `init`; here of two scenes, so that it is another one.
TEST_F(Score, ACourseHasARowForEachRenderer) {
    expect_success({"init", "course", "--out", "course"});
    for (const auto& entry : std::filesystem::directory_iterator(path("course")))
        if (entry.path().extension() == ".toml" && entry.path().stem() != "plane" && entry.path().stem() != "needle")
            std::filesystem::remove(entry.path());
    std::filesystem::create_directories(path("mine"));
    std::filesystem::copy(path("course/oracle"), path("mine"), std::filesystem::copy_options::recursive);
    const std::vector<std::string> command{"score", "course", "--renderer", kPenalty, "--forces", "mine,course/oracle",
                                           "--out", "out"};
    const Outcome outcome = expect_success(command);
    EXPECT_TRUE(says(outcome.out, "needle", "plane", "24 strokes"));
    const auto rows = table();
    for (const char* const name : {"mine", "oracle", "penalty"})
        ASSERT_TRUE(rows.contains(name)) << name;
    EXPECT_LT(number(rows.at("mine"), "error_percent"), 1e-5);
    EXPECT_EQ(number(rows.at("penalty"), "pop_throughs"), 2) << "on the needle";
    EXPECT_TRUE(says(read_text(path("out/score/study.json")), "is not version 1 of the standard course"));
    std::filesystem::remove(path("mine/needle.csv"));
    expect_failure(4, {"score", "course", "--forces", "mine"}, {"mine/needle.csv", "there is no such file"});
}

TEST_F(Score, ARendererStandsInForTheEngineOfOtherCommands) {
    write_plate(20);
    write_strokes(1e-3);
    const std::string bad = kBadRenderer;
    expect_success({"explore", "scene.toml", "--paths", "strokes.csv", "--out", "own.csv", "--renderer", kPenalty});
    expect_success({"explore", "scene.toml", "--paths", "strokes.csv", "--out", "oracle.csv", "--precision", "f64"});
    const std::vector<std::string> own = lines_of(read_text(path("own.csv"))),
                                   oracle = lines_of(read_text(path("oracle.csv")));
    ASSERT_EQ(own.size(), oracle.size());
    for (std::size_t i = 1; i < own.size(); ++i)
        EXPECT_NEAR(std::stod(cells_of(own[i])[10]), std::stod(cells_of(oracle[i])[10]), 1e-5) << "fz, line " << i;
    write("hand.toml", read_text(path("scene.toml")) + "[paths]\nfollow = \"surface\"\npress = \"1 N\"\ncount = 1\n"
                                                       "steps = 1500\nlength = \"10 mm\"\n");
    const auto hand = nlohmann::json::parse(
        expect_success({"explore", "hand.toml", "--out", "hand.csv", "--renderer", kOneConstraint, "--json"}).out);
    EXPECT_EQ(hand["engine"]["kind"], "renderer");
    EXPECT_NEAR(hand["mean_depth_m"].get<double>(), 1e-3, 2e-4) << "a hand of 1 N on 1000 N/m";
    expect_failure(
        1, {"explore", "scene.toml", "--paths", "strokes.csv", "--out", "none.csv", "--renderer", bad + ":crash"},
        {"bad_renderer:crash crashed (Segmentation fault) in update 1000"});
    EXPECT_FALSE(std::filesystem::exists(path("none.csv")));
    expect_failure(1, {"explore", "hand.toml", "--out", "none.csv", "--renderer", bad + ":nan"},
                   {"gave a force that is not finite"});
    expect_failure(1,
                   {"explore", "scene.toml", "--paths", "strokes.csv", "--out", "none.csv", "--renderer", bad + ":nan"},
                   {"bad_renderer:nan gave a force that is not finite in step 999, at ("});
    expect_failure(2,
                   {"explore", "scene.toml", "--paths", "strokes.csv", "--out", "none.csv", "--renderer", kPenalty,
                    "--engine", "cpu"},
                   {"leave --engine and --gpu out"});
    // The static field of a mesh is that of its nearest facet, and so is the penalty's: at every voxel.
    write("field.toml", read_text(path("scene.toml")) +
                            "[grid]\nsize = [8, 8, 8]\norigin = [\"-12.3 mm\", \"-11.9 mm\", "
                            "\"-3.1 mm\"]\nspacing = [\"3 mm\", \"3 mm\", \"0.7 mm\"]\n");
    expect_success({"field", "field.toml", "--out", "field.exr", "--renderer", kPenalty});
    const Outcome same = forceshade({"validate", "field.toml", "--renderer", kPenalty, "--json"});
    const auto found = nlohmann::json::parse(same.out)["cases"][0]["oracle_f64"];
    EXPECT_LT(found["largest_error_N"].get<double>(), 1e-12);
    EXPECT_EQ(found["unexplained_voxels"], 0);
    EXPECT_EQ(forceshade({"validate", "field.toml", "--renderer", bad + ":huge"}).code, 1) << "1 N everywhere";
    // A renderer of a bump may give forces that depend on y, which the bump's own do not.
    write("bump.toml",
          "[surface]\nkind = \"bump\"\n[grid]\nsize = [4, 5, 3]\norigin = [\"-1 mm\", \"-2 mm\", \"-1 mm\"]\n"
          "spacing = [\"0.7 mm\", \"1 mm\", \"0.7 mm\"]\n");
    const auto by_y = nlohmann::json::parse(
        expect_success({"field", "bump.toml", "--out", "by_y.exr", "--renderer", bad + ":y", "--json"}).out);
    EXPECT_EQ(by_y["voxels_evaluated"], 4 * 5 * 3);
    EXPECT_NEAR(by_y["largest_force_N"].get<double>(), std::sqrt(5), 1e-6) << "2 N along x at y = 2 mm, 1 N along z";
}

TEST_F(Score, WithoutAFileTheScenesOwnPathsAreTheStrokes) {
    write_plate(2);
    write("scene.toml", read_text(path("scene.toml")) + "[paths]\nkind = \"taps\"\ncount = 2\nsteps = 400\n"
                                                        "depth = \"1.5 mm\"\n");
    expect_success({"score", "scene.toml", "--renderer", kPenalty, "--out", "out"});
    const Row own = table().at("penalty");
    expect_success({"explore", "scene.toml", "--out", "paths.csv", "--precision", "f64"});
    expect_success(
        {"score", "scene.toml", "--paths", "paths.csv", "--renderer", kPenalty, "--out", "out", "--overwrite"});
    for (const char* const measure : {"error_rms_N", "direction_p95_deg", "pop_throughs", "above_100Hz_mN"})
        EXPECT_EQ(own.at(measure), table().at("penalty").at(measure)) << measure;
    EXPECT_GT(number(own, "pop_throughs"), 0);
    write_scene();
    write("scene.toml", read_text(path("scene.toml")) + "[paths]\npress = \"1 N\"\n");
    expect_failure(2, {"score", "scene.toml", "--renderer", kPenalty}, {"of a hand", "--paths"});
    expect_failure(2, {"score", "scene.toml", "--rate", "1 kHz"}, {"--rate is of a file without times"});
}

// The scene has paths and no grid of its own.
TEST_F(Score, AStudyPutsARendererOnItsFrontOfErrorAgainstTime) {
    write("scene.toml", "[surface]\nkind = \"bump\"\nfacets = 6\n[paths]\ncount = 2\nsteps = 200\n");
    expect_failure(1,
                   {"study", "error-time", "scene.toml", "--quick", "--out", "out", "--renderer", kPenalty,
                    "--renderer", kBadRenderer + ":crash"},
                   {"bad_renderer:crash crashed"});
    std::map<std::string, double> errors; // by family
    const std::vector<std::string> lines = lines_of(read_text(path("out/error-time/ways.csv")));
    const std::vector<std::string> header = cells_of(lines.front());
    const auto column = [&](const char* name) { return std::size_t(std::ranges::find(header, name) - header.begin()); };
    for (std::size_t i = 1; i < lines.size(); ++i)
        if (const std::vector<std::string> cells = cells_of(lines[i]); cells[column("typical_rms_1")] != "")
            errors[cells[column("family")]] = std::stod(cells[column("typical_rms_1")]);
    ASSERT_TRUE(errors.contains("renderer, penalty")) << lines.front();
    EXPECT_GT(errors["renderer, penalty"], 0);
    EXPECT_FALSE(errors.contains("renderer, bad_renderer:crash"));
    EXPECT_TRUE(says(read_text(path("out/report.html")), "crashed (Segmentation fault) in update 1000; it has no row"));
    expect_failure(2, {"study", "omission", "scene.toml", "--out", "out", "--renderer", kPenalty}, {"--renderer"});
}

TEST_F(Score, ALiveLoopTakesARendererForASimulatedHandAlone) {
    write_plate(20);
    const std::string bad = kBadRenderer;
    expect_success({"live", "scene.toml", "--duration", "0.3 s", "--fast", "--log", "log.csv", "--renderer", kPenalty});
    expect_failure(1, {"live", "scene.toml", "--duration", "2 s", "--fast", "--renderer", bad + ":crash"},
                   {"crashed (Segmentation fault)", "no force from then on"});
    expect_failure(2, {"live", "scene.toml", "--device", "haply", "--renderer", kPenalty},
                   {"--device sim", "--unstable"});
    expect_failure(2, {"live", "scene.toml", "--watch", "--renderer", kPenalty}, {"--renderer and --watch"});
}

} // namespace
} // namespace forceshade::testing
