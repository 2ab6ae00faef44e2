// Findings of the study of energy follow its tables.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/study/energy_samples.h"

namespace forceshade::study {
namespace {

TEST(EnergyFindings, NameTheLeastAtEqualError) {
    StudyData data = sample();
    const std::string first = finding(data, "least_at_equal_error");
    EXPECT_NE(first.find("triangles none"), std::string::npos) << first;
    Table& equal = data.tables[2];
    for (auto& cells : equal.rows)
        if (std::get<std::string>(cells[equal.index("scheme")]) == "triangles none")
            cells[equal.index("eta")] = 0.9;
    const std::string second = finding(data, "least_at_equal_error");
    EXPECT_NE(second, first);
    EXPECT_NE(second.find("given by triangles mean_value"), std::string::npos) << second;
}

TEST(EnergyFindings, NameTheMostAtEqualError) {
    StudyData data = sample();
    const auto says = [&](const char* text) {
        const std::string found = finding(data, "least_at_equal_error");
        EXPECT_NE(found.find(text), std::string::npos) << found;
    };
    says("keep its direction error to 0.5 deg (RMS): no energy is to be had round a loop from triangles none (32 "
         "cells)");
    says("the most, 24 %, by shaded (1 facet)");
    says("the least, 0.6 % of the effort, is given by triangles mean_value (8 cells)");
    set(data.tables[2], "shaded", "eta", 0.02);
    says("the most, 7 %, by facets (32 facets)");
}

TEST(EnergyFindings, TellTheLeastThatIsTaken) {
    StudyData data = sample();
    set(data.tables[2], "facets", "eta", -0.013);
    const std::string one = finding(data, "least_at_equal_error");
    EXPECT_NE(one.find("takes at least 1.3 % of the effort from the hand with facets"), std::string::npos) << one;
    set(data.tables[2], "triangles mean_value", "eta", -0.0003);
    const std::string both = finding(data, "least_at_equal_error");
    EXPECT_NE(both.find("takes at least 0.03 to 1.3 % of the effort from the hand, by the scheme, with triangles "
                        "mean_value; facets"),
              std::string::npos)
        << both;
}

// In joules: a share of the effort would rise where the effort falls.
TEST(EnergyFindings, TellWhatShadingGivesBesideWhatFacetsGive) {
    StudyData data;
    data.tables = {loops_table({row("bump", "shaded", 512, 0, 0.07), row("bump", "shaded", 1, 0, 0.24),
                                row("bump", "facets", 1, 0, 0.0), row("bump", "facets", 512, 0, 0.06)})};
    EXPECT_EQ(finding(data, "shading"),
              "Round a loop over a bump the shaded force gives 0.36 mJ with 1 facet and 0.11 mJ with 512 facets, the "
              "unshaded one 0 mJ with 1 facet and 0.09 mJ with 512 facets.");
    data.tables = {loops_table({row("bump", "shaded", 512, 0, 0.07)})};
    EXPECT_EQ(finding(data, "shading"), "");
}

TEST(EnergyFindings, TellWhatTheGodObjectsHistoryDoes) {
    StudyData data;
    data.tables = {loops_table({row("mesh of triangles", "triangles none, god-object", 8, 2, -0.041)})};
    const std::string who = "The god-object on a mesh of 8 cells over the bump with a radius of 1000 mil, unshaded, ";
    EXPECT_EQ(finding(data, "history"),
              who + "takes at least 4.1 % of the effort from the hand, whichever way the loop goes.");
    set(data.tables[0], "triangles none, god-object", "eta", 0.02);
    EXPECT_EQ(finding(data, "history"), who + "gives up to 2 % of the effort.");
    set(data.tables[0], "triangles none, god-object", "eta", 1e-12);
    EXPECT_EQ(finding(data, "history"), who + "neither gives nor takes energy.");
    set(data.tables[0], "triangles none, god-object", "eta", Cell());
    EXPECT_EQ(finding(data, "history"), "");
}

TEST(EnergyFindings, OfTablesWithoutNumbersSayNothing) {
    StudyData data = sample();
    data.tables.push_back(curl_maps_table({{{"map", "a"}, {"mean_per_K", 0.5}}, {{"map", "b"}, {"mean_per_K", 0.01}}}));
    data.tables[1].rows = {{std::string("a law"), 600.0, 1.0, Cell(), 0.1, std::string("no")}};
    for (Table& table : data.tables)
        for (auto& cells : table.rows)
            for (Cell& one : cells)
                one = std::holds_alternative<double>(one) ? Cell() : one;
    for (const Finding& one : energy_findings(data))
        EXPECT_EQ(one.name, "laws") << one.text;
}

TEST(EnergyFindings, CompareTheMapsOfCurl) {
    StudyData data = sample();
    const auto map = [](const char* name, const char* scheme, double mean, double sampling) {
        return Json{{"map", name}, {"scheme", scheme}, {"mean_per_K", mean}, {"sampling_per_K", sampling}};
    };
    std::vector<Json> maps{map("a", "shaded", 0.5, 1e-9), map("b", "facets", 0.01, 0.003)};
    maps[0]["closed_form_difference_per_K"] = 1e-8;
    data.tables.push_back(curl_maps_table(maps));
    Table& table = data.tables.back();
    const std::string start = "Of curl, the mean size over a section's cells in contact: ",
                      end = "; that of the flat shaded plane is its closed form to 1e-08 K.";
    EXPECT_EQ(finding(data, "curl"), start + "the most has a (0.5 K), the least b (0.01 K)" + end);
    table.rows[1][table.index("mean_per_K")] = 0.7;
    EXPECT_EQ(finding(data, "curl"), start + "the most has b (0.7 K), the least a (0.5 K)" + end);
    table.rows[1][table.index("sampling_per_K")] = 0.8;
    EXPECT_EQ(finding(data, "curl"),
              start + "a (0.5 K) has some; no more than sampling leaves, up to 0.7 K, has b" + end);
}

TEST(EnergyFindings, CountNoCurlOfASchemeWhoseLoopsGiveNothing) {
    StudyData data = sample();
    data.tables.push_back(curl_maps_table({{{"map", "mesh"}, {"scheme", "triangles none"}, {"mean_per_K", 0.9}},
                                           {{"map", "bump"}, {"scheme", "shaded"}, {"mean_per_K", 0.1}}}));
    const std::string text = finding(data, "curl");
    EXPECT_NE(text.find("bump (0.1 K) has some; no more than sampling leaves, up to 0.9 K, has mesh."),
              std::string::npos)
        << text;
}

TEST(EnergyFindings, OfASceneNameLeastAndMost) {
    StudyData data = sample();
    EXPECT_EQ(finding(data, "scene"), "");
    data.tables.resize(1);
    const Table& loops = data.tables[0];
    for (auto& cells : data.tables[0].rows)
        cells[loops.index("loop")] = std::string("half");
    const std::string first = finding(data, "scene");
    EXPECT_NE(first.find("triangles none has the least"), std::string::npos) << first;
    EXPECT_NE(first.find("shaded has the most: a loop gives 24 %"), std::string::npos) << first;
    data.tables[0].rows[0][loops.index("eta")] = -0.5;
    EXPECT_NE(finding(data, "scene").find("takes at least 50 %"), std::string::npos);
}

} // namespace
} // namespace forceshade::study
