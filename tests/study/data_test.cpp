// A study's data survive their files, and what is no such file is told.
#include <limits>
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/output/json.h"
#include "host/study/study_data.h"
#include "tests/io/folder.h"

namespace forceshade::study {
namespace {

using testing::says;

StudyData written_sample() {
    StudyData data;
    data.study = "energy";
    data.program = "0.1.0+test";
    data.device = "a \"device\"";
    data.quick = true;
    data.seconds = 1.5;
    data.notes = {"A note."};
    data.tables = {{"loops",
                    "Loops",
                    {{"scheme", "", "which"}, {"work_J", "J", "work"}},
                    {{"none, flat", 0.1}, {"x", std::numeric_limits<double>::quiet_NaN()}}}};
    Figure figure;
    figure.name = "f";
    figure.kind = FigureKind::bars;
    figure.table = "loops";
    figure.where = {{"scheme", "x"}};
    figure.y = {"work_J", "work / J", true};
    figure.value_limit = 0.5;
    figure.curves = {{"loops", {}, "work_J", "work_J", "a curve", true}};
    figure.panels = figure.pick = "scheme";
    figure.linked = {"g"};
    data.figures = {figure};
    data.findings = {{"name", "A sentence."}};
    data.files = {{"loops.csv", "11ee", 34}};
    data.volumes = {{"curl.exr", "00ff", 12}};
    return data;
}

TEST(StudyFiles, HoldEverything) {
    const std::string text = data_json(written_sample());
    EXPECT_EQ(data_json(parse_data(parse_json(text))), text);
    EXPECT_EQ(table_csv(written_sample().tables[0]), "scheme,work_J\n\"none, flat\",0.1\nx,\n");
}

TEST(StudyFiles, WhatIsNoNumberIsNothing) {
    EXPECT_EQ(Cell(std::numeric_limits<double>::infinity()).text(), "");
    const StudyData data = parse_data(parse_json(data_json(written_sample())));
    EXPECT_FALSE(data.table("loops").number(1, "work_J"));
    EXPECT_EQ(data.table("loops").word(1, "scheme"), "x");
}

// A cell is drawn in its panel.
TEST(Ratios, SayNoMoreThanTheirIntervals) {
    EXPECT_EQ(times_as_long({1.2, 1.3, 1.4}, "b"), "takes 1.30 [1.09, 1.54] times as long as b");
    EXPECT_EQ(times_as_long({0.97, 1.01, 1.05}, "b"), "takes [0.88, 1.16] times as long as b");
    EXPECT_EQ(times_as_long({1.05, 1.10, 1.20}, "b"), "takes [0.95, 1.32] times as long as b")
        << "another run may not see that";
    EXPECT_EQ(times_as_long({1.12, 1.15, 1.20}, "b"), "takes [1.02, 1.32] times as long as b") << "nor that";
}

TEST(Ratios, AreWrittenSoThatTheirEndsDifferFromOne) {
    EXPECT_EQ(ratio_text({1.21, 1.3, 1.42}), "1.30 [1.21, 1.42]");
    EXPECT_EQ(ratio_text({0.82, 0.84, 0.998}), "0.840 [0.820, 0.998]");
    EXPECT_EQ(ratio_text({0.9, 1, 1.001}), "1.00 [0.90, 1.00]") << "not significant";
    EXPECT_TRUE(was_busy({0.9, 1, 1.3}));
    EXPECT_FALSE(was_busy({0.9, 1, 1.1}));
}

TEST(StudyFigures, HavePanels) {
    StudyData data;
    data.tables = {{"cells", "", {{"law", "", ""}, {"x", "m", ""}}, {}}};
    for (int i = 0; i < 6; ++i)
        data.tables[0].rows.push_back({std::string(i < 3 ? "unshaded" : "shaded"), cell(i)});
    Figure figure;
    figure.kind = FigureKind::cells;
    figure.table = "cells";
    figure.x = figure.y = {"x", "x / m", false};
    figure.value = "x";
    figure.panels = "law";
    data.figures = {figure};
    const auto drawn = [&] { // names within an SVG file are counted on from file to file
        return std::regex_replace(figure_files(data)[0].text, std::regex("(clip|surface|glyph)[0-9-]*"), "");
    };
    const std::string before = drawn();
    EXPECT_EQ(drawn(), before);
    data.tables[0].rows[2][0] = std::string("shaded");
    EXPECT_NE(drawn(), before);
}

std::string complaint_about(const std::string& text) {
    return testing::message_of<DataError>([&] { parse_data(parse_json(text)); });
}

TEST(StudyFiles, DamageIsTold) {
    const std::string text = data_json(written_sample());
    EXPECT_TRUE(says(complaint_about(text.substr(0, text.size() / 2)), "damaged"));
    EXPECT_TRUE(says(complaint_about("[]"), "not a study file"));
    for (const char* cores : {"1e30", "-1", "4294967296", "1.5", "\"4\""})
        EXPECT_TRUE(says(complaint_about(std::regex_replace(text, std::regex("\"cores\":[0-9]+"),
                                                            fmt::format("\"cores\":{}", cores))),
                         "damaged"))
            << cores;
    EXPECT_TRUE(says(complaint_about(R"({"format": 0, "study": "energy"})"), "format is 0"));
    std::string ragged = text;
    const std::string cells = "[0.1,null]";
    ASSERT_TRUE(says(ragged, cells));
    ragged.replace(ragged.find(cells), cells.size(), "[0.1,null,2]");
    EXPECT_TRUE(says(complaint_about(ragged), "row 3 of table loops: 1 of 2 columns"));
}

TEST(StudyFiles, UnknownTablesColumnsAndStudiesAreTold) {
    const StudyData data = written_sample();
    EXPECT_THROW(data.table("points"), DataError);
    EXPECT_THROW(data.tables[0].number(0, "work_mJ"), DataError);
    EXPECT_EQ(data.tables[0].needed(0, "work_J"), 0.1);
    EXPECT_THROW(data.tables[0].needed(1, "work_J"), DataError);
}

} // namespace
} // namespace forceshade::study
