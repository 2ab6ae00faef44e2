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

TEST(EnergyFindings, TellHowShadingGoesWithFacets) {
    const auto text = [](double one, double three, double many) {
        StudyData data;
        data.tables = {loops_table({row("bump", "shaded", 512, 0, many), row("bump", "shaded", 1, 0, one),
                                    row("bump", "shaded", 3, 0, three)})};
        return finding(data, "shading");
    };
    const std::string first =
        "Force shading a bump with a radius of 1000 mil and 1 facet gives 0.36 mJ a round, 24 % of "
        "the effort; ";
    EXPECT_EQ(text(0.24, 0.02, 0.07),
              first + "it is least with 3 facets, 2 %; with 512, the most facets here, it is 7 %.");
    EXPECT_EQ(text(0.24, 0.1, 1e-15), first + "with 512, the most facets here, it is least, 0 %.");
    EXPECT_EQ(text(0.24, 0.3, 0.4), first + "that is the least: with 512, the most facets here, it is 40 %.");
    EXPECT_EQ(text(0.24, 0.241, 0.242), first + "up to 512, the most facets here, it stays so.");
}

TEST(EnergyFindings, TellWhereEnergyIsMeant) {
    Json few = row("bump", "shaded", 1, 0, 0.24), many = row("bump", "shaded", 3, 0, 0.5);
    for (Json* one : {&few, &many})
        one->update({{"stiffness_N_per_m", 500.0}, {"out_mm", 2.0}, {"back_mm", 1.0}, {"radius_mil", 1000.0}});
    Json other = many;
    other.update({{"scheme", "facets"}, {"radius_mil", 600.0}, {"eta", 0.53}});
    StudyData data;
    data.tables = {loops_table({few, many, other})};
    EXPECT_NE(finding(data, "shading").find("0.36 mJ a round (K = 500 N/m, out 2 mm deep and back 1 mm deep), 24 %"),
              std::string::npos)
        << finding(data, "shading");
    EXPECT_EQ(finding(data, "conservative"),
              "No scheme here is conservative; the most, 53 % of the effort, is given by "
              "facets (3 facets, radius of 600 mil).");
    set(data.tables[0], "facets", "eta", -0.53);
    set(data.tables[0], "facets", "loop", std::string("whole"));
    EXPECT_NE(
        finding(data, "conservative")
            .find("the most, 53 % of the effort, is taken by facets (3 facets, radius of 600 mil, the whole loop)"),
        std::string::npos)
        << finding(data, "conservative");
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

TEST(EnergyFindings, TellHowFarTheEnginesSamplesAre) {
    StudyData data = sample();
    set(data.tables[0], "shaded", "engine_difference", 3e-7);
    const std::string text =
        "Work added up from the engine's samples is the oracle's within {} of the effort; the most is at {}.";
    EXPECT_EQ(finding(data, "engine"),
              fmt::format(fmt::runtime(text), "3e-07", "shaded (1 facet, radius of 1000 mil)"));
    set(data.tables[0], "facets", "engine_difference", 0.02);
    EXPECT_EQ(finding(data, "engine"),
              fmt::format(fmt::runtime(text), "0.02", "facets (8 facets, radius of 1000 mil)"));
    const auto all = [&](double off) {
        for (const char* scheme : {"facets", "shaded", "triangles none", "triangles mean_value"})
            set(data.tables[0], scheme, "engine_difference", off);
        return finding(data, "engine");
    };
    EXPECT_EQ(all(0), "Work added up from the engine's samples is the oracle's to the last bit.");
    EXPECT_EQ(all(3e-16), "Work added up from the engine's samples is the oracle's to rounding, 3e-16 of the effort at "
                          "facets (8 facets, radius of 1000 mil).");
    for (auto& cells : data.tables[0].rows)
        cells[data.tables[0].index("engine_difference")] = Cell();
    EXPECT_EQ(finding(data, "engine"), "");
}

TEST(EnergyFindings, OfTablesWithoutNumbersSayNothing) {
    StudyData data = sample();
    data.tables.push_back(curl_maps_table({{{"map", "a"}, {"mean_per_K", 0.5}}, {{"map", "b"}, {"mean_per_K", 0.01}}}));
    data.tables[1].rows = {{std::string("a law"), 600.0, 1.0, Cell(), 0.1, std::string("no")}};
    EXPECT_NE(finding(data, "laws").find("a law at 600 mil: no number, printed 1"), std::string::npos);
    for (Table& table : data.tables)
        for (auto& cells : table.rows)
            for (Cell& one : cells)
                one = std::holds_alternative<double>(one) ? Cell() : one;
    for (const Finding& one : energy_findings(data))
        EXPECT_EQ(one.name, "laws") << one.text;
}

TEST(EnergyFindings, TellWhetherTheLawsAreReproduced) {
    StudyData data = sample();
    Table& laws = data.tables[1];
    laws.rows = {{std::string("a law"), 600.0, 1.0, 1.0, 0.1, std::string("yes")}};
    EXPECT_NE(finding(data, "laws").find("1 of 1"), std::string::npos);
    laws.rows.push_back({std::string("another"), 600.0, 1.0, 2.0, 0.1, std::string("no")});
    EXPECT_NE(finding(data, "laws").find("another at 600 mil: 2, printed 1"), std::string::npos);
}

TEST(EnergyFindings, SayWhichSchemesAreConservative) {
    StudyData data = sample();
    EXPECT_NE(finding(data, "conservative").find("triangles none"), std::string::npos);
    Table& loops = data.tables[0];
    for (auto& cells : loops.rows)
        cells[loops.index("eta")] = 0.1;
    EXPECT_NE(finding(data, "conservative").find("No scheme"), std::string::npos);
}

TEST(EnergyFindings, CallNothingConservativeThatMissesItsClosedForm) {
    StudyData data = sample();
    Table& loops = data.tables[0];
    const auto alter = [&](double eta) {
        set(loops, "triangles none", "closed_form_mJ", 0.0);
        set(loops, "triangles none", "eta", eta);
        set(loops, "triangles none", "closed_form_difference", eta);
        set(loops, "triangles none", "loop", std::string("half"));
        set(loops, "shaded", "loop", std::string("half"));
    };
    const auto scene = [&] {
        StudyData alone;
        alone.tables = {loops};
        return finding(alone, "scene");
    };
    alter(1e-8);
    EXPECT_NE(finding(data, "conservative").find("Conservative, to 2e-08 of the effort: triangles none;"),
              std::string::npos);
    EXPECT_NE(scene().find("a loop gives none"), std::string::npos) << scene();
    alter(0.002);
    EXPECT_NE(finding(data, "conservative").find("No scheme"), std::string::npos);
    EXPECT_NE(scene().find("a loop gives 0.2 % of the effort"), std::string::npos) << scene();
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
