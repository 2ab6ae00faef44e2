// Findings on loops follow the tables.
#include <gtest/gtest.h>

#include "host/study/stability/loop.h"
#include "host/study/stability/loop_findings.h"
#include "host/study/stability/loop_maps.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

Json pressed(double grip) {
    return {{"depth", 1e-3}, {"rest", {0, 0, -1e-3}}, {"grip", grip}, {"held", false}};
}

// Two rows of three.
Json sample_map() {
    return {{"map", "plane-damping"},
            {"place", "plane"},
            {"title", "plane"},
            {"pressed", pressed(0)},
            {"mass", 0.1},
            {"x", {{"axis", static_cast<std::size_t>(LoopAxis::stiffness)}, {"values", {1000, 2000, 4000}}}},
            {"y", {{"axis", static_cast<std::size_t>(LoopAxis::damping)}, {"values", {5, 10}}}},
            {"states", {"sss", "sss"}},
            {"expected", {"sss", "sss"}},
            {"nominal", {1000, 1, 1000, 0, 0, 0}},
            {"curves", Json::array()}};
}

StudyData loop_sample() {
    const auto point = [](double mass, double damping, int delay, double measured, double wall, double linear,
                          const Json& flutter) {
        return Json{{"mass", mass},         {"damping", damping},
                    {"rate", 1000},         {"delay", delay},
                    {"measured", measured}, {"wall", wall},
                    {"linear", linear},     {"flutter", flutter},
                    {"own", nullptr},       {"passive", 2000 * damping / (1 + 2 * delay)}};
    };
    const Json plane{
        {"limits", "plane"},
        {"title", "plane"},
        {"flat", true},
        {"pressed", pressed(0)},
        {"own", nullptr},
        {"points",
         {point(0.1, 1, 0, 2003.5, 2003.3, 2003.3, nullptr), point(0.1, 1, 1, 668.6, 668.5, 668.5, nullptr),
          point(0.1, 5, 0, 10084.1, 10084, 10084, nullptr)}}};
    const Json dip{{"limits", "dip-shaded"},
                   {"title", "concave dip, shaded"},
                   {"flat", false},
                   {"pressed", pressed(150)},
                   {"points", {point(0.1, 1, 0, 69.3, 2003.3, 69.26, 71.5)}}};
    StudyData data;
    add_loop(data, {plane, dip, sample_map()});
    return data;
}

std::string loop_finding(const StudyData& data, const std::string& name) {
    for (const Finding& one : loop_findings(data))
        if (one.name == name)
            return one.text;
    return "";
}

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

// Every row of a surface's limits gets another number.
void alter(StudyData& data, const std::string& surface, const char* column, double factor) {
    for (Table& table : data.tables)
        if (table.name == "loop_limits")
            for (std::size_t row = 0; row < table.rows.size(); ++row)
                if (table.word(row, "surface") == surface && table.number(row, column))
                    table.rows[row][table.index(column)] = cell(factor * table.number(row, column).value());
}

TEST(LoopFindings, ScenesOwnStiffnessIsJudged) {
    StudyData data = loop_sample();
    EXPECT_EQ(loop_finding(data, "loop_scene"), "");
    for (Table& table : data.tables)
        if (table.name == "loop_limits")
            table.rows[0][table.index("own_N_per_m")] = cell(1000);
    EXPECT_TRUE(says(loop_finding(data, "loop_scene"), "its own 1000 N/m is 0.499 of that"))
        << loop_finding(data, "loop_scene");
    alter(data, "plane", "own_N_per_m", 4);
    EXPECT_TRUE(says(loop_finding(data, "loop_scene"), "its own 4000 N/m is 2 times too much"));
}

TEST(LoopFindings, SpringThatHoldsTheHandIsTold) {
    StudyData data = loop_sample();
    EXPECT_TRUE(
        says(loop_finding(data, "loop_surfaces"), "A spring of 150 N/m holds the hand sideways (concave dip, shaded)."))
        << loop_finding(data, "loop_surfaces");
    EXPECT_TRUE(says(data.notes.back(), "concave dip, shaded: 1 mm deep at x = 0 mm, y = 0 mm, where a spring of "
                                        "150 N/m holds it sideways"))
        << data.notes.back();
    alter(data, "dip-shaded", "grip_N_per_m", 0);
    EXPECT_TRUE(says(loop_finding(data, "loop_surfaces"), "Nothing holds the hand sideways."));
}

TEST(LoopFindings, LeastSurfaceIsNamed) {
    StudyData data = loop_sample();
    EXPECT_TRUE(says(loop_finding(data, "loop_surfaces"), "The concave dip, shaded gives way first, 28.9 times below"))
        << loop_finding(data, "loop_surfaces");
    alter(data, "dip-shaded", "measured_N_per_m", 30);
    alter(data, "dip-shaded", "over_wall_1", 30);
    alter(data, "dip-shaded", "over_passive_1", 30);
    EXPECT_TRUE(says(loop_finding(data, "loop_surfaces"), "None gives way far below"));
    EXPECT_TRUE(says(loop_finding(data, "loop_delay"), "33.4 %")) << loop_finding(data, "loop_delay");
}

TEST(LoopFindings, ShadingIsComparedWithItsAbsence) {
    const auto point = [](double damping, double measured) {
        return Json{{"mass", 0.1},          {"damping", damping}, {"rate", 1000},       {"delay", 0},
                    {"measured", measured}, {"wall", measured},   {"linear", measured}, {"passive", measured},
                    {"flutter", nullptr},   {"own", nullptr}};
    };
    const auto surface = [](const char* name, const Json& points) {
        return Json{{"limits", name}, {"title", name}, {"flat", false}, {"pressed", pressed(200)}, {"points", points}};
    };
    StudyData data;
    add_loop(data, {surface("bump", {point(1, 1769), point(10, 17922)}),
                    surface("bump-shaded", {point(1, 1183), point(10, 1190)})});
    EXPECT_EQ(loop_finding(data, "loop_shading_bump"),
              "Shading the bump lowers its limit from 17922 N/m to 1190 N/m at 10 N s/m; from 1 to 10 N s/m it rises "
              "1.01 times with shading, 10.1 times without: damping helps little against it. A spring of 200 N/m holds "
              "the hand "
              "sideways.");
    alter(data, "bump-shaded", "measured_N_per_m", 20);
    EXPECT_FALSE(says(loop_finding(data, "loop_shading_bump"), "does not rise"));
    EXPECT_TRUE(says(loop_finding(data, "loop_shading_bump"), "raises its limit from 17922 N/m to 23800 N/m"));
}

TEST(LoopFindings, FrictionHoldsOrNot) {
    Json map = sample_map();
    map["y"] = {{"axis", static_cast<std::size_t>(LoopAxis::friction)}, {"values", {0.01, 0.1}}};
    map["nominal"][static_cast<std::size_t>(LoopAxis::damping)] = 5;
    map["nominal"][static_cast<std::size_t>(LoopAxis::quantum)] = 5e-5; // 2 f_c / quantum: 400 and 4000 N/m
    map["states"] = {"qqq", "sss"};
    StudyData data;
    add_loop(data, {map});
    EXPECT_EQ(loop_finding(data, "loop_friction"),
              "With rounded positions, all of 3 loops on the plane within K <= min(2 b / T, 2 f_c / quantum) come to "
              "rest; where friction is less than that and damping is not, 100 % of 3 chatter on.");
    Json other = map;
    other["place"] = "bump";
    other["states"] = map["states"] = {"qss", "ssu"};
    data.tables.clear();
    add_loop(data, {map, other});
    const std::string text = loop_finding(data, "loop_friction");
    EXPECT_TRUE(says(text, "2 of 3 loops on the plane")) << text;
    EXPECT_TRUE(says(text, "does not hold for all")) << text;
    EXPECT_TRUE(says(text, "33.3 % of 3 chatter on")) << text;
    EXPECT_TRUE(says(text, "no promise: 1 of 3 within it do not")) << text;
}

} // namespace
} // namespace forceshade::study
