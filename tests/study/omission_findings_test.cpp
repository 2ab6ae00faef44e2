// What omissions save is told by the data, and told from what is the measurement's own.
#include <set>

#include <gtest/gtest.h>

#include "host/study/data/data_error.h"
#include "host/study/omission/omission_findings.h"
#include "host/study/omission/tables.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

// Two scenes' worth of made-up results.
StudyData omission_sample() {
    const std::vector<BaseScene> scenes = own_scenes(true);
    std::vector<Comparison> comparisons;
    for (Comparison& one : comparisons_of(scenes.front(), false))
        if (std::set<std::string>{kControl, "shading", "flat texture", "facet channel", "every y"}.contains(
                one.feature))
            comparisons.push_back(std::move(one));
    std::vector<Json> results;
    for (const Comparison& one : comparisons) {
        const double ratio = one.feature == "every y" ? 16 : one.feature == "facet channel" ? 1.5 : 1;
        Json side{{"kernel_s", {1e-3, 1e-3, 1e-3}},
                  {"whole_s", {2e-3, 2e-3, 2e-3}},
                  {"uploaded", 1000},
                  {"received", 9000},
                  {"evaluated", 100},
                  {"samples", 1000},
                  {"file", 500}};
        Json with = side;
        for (Json& value : with["kernel_s"])
            value = ratio * value.get<double>();
        with["received"] = ratio * 9000;
        results.push_back({{"with", with},
                           {"without", side},
                           {"compared", 1000},
                           {"in_contact", 500},
                           {"differing", 0},
                           {"largest", 0.0}});
    }
    StudyData data;
    data.study = "omission";
    data.tables = {features_table(comparisons, results), omitted_table(scenes, comparisons)};
    return data;
}

std::string omission_finding(const StudyData& data, const std::string& name) {
    for (const Finding& one : omission_findings(data))
        if (one.name == name)
            return one.text;
    return "";
}

void set(StudyData& data, const std::string& feature, const char* column, Cell value) {
    Table& table = data.tables.front();
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (table.word(row, "feature") == feature)
            table.rows[row][table.index(column)] = value;
}

bool says(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

TEST(OmissionFindings, FollowTheTimes) {
    StudyData data = omission_sample();
    EXPECT_TRUE(
        says(omission_finding(data, "most_kernel_time"), "Leaving out every y (bump) saves the most kernel time"));
    EXPECT_TRUE(says(omission_finding(data, "most_kernel_time"), "16 times as long (quartiles 16 to 16)"));
    EXPECT_TRUE(says(omission_finding(data, "most_kernel_time"), "facet channel (bump) with 1.50 times"));
    EXPECT_TRUE(says(omission_finding(data, "most_kernel_time"), "saves 94 % of the time"));
    EXPECT_TRUE(says(omission_finding(data, "saves_nothing"), ": flat texture (bump 0.0 %)"));
    EXPECT_FALSE(says(omission_finding(data, "saves_nothing"), "nothing (bump)")) << "the control is no feature";
    EXPECT_TRUE(says(omission_finding(data, "most_time"), "No omission saves time by the clock"));
    set(data, "facet channel", "kernel_ratio", 40.0);
    EXPECT_TRUE(says(omission_finding(data, "most_kernel_time"), "Leaving out facet channel (bump)"));
    set(data, "shading", "kernel_verdict", std::string("saves"));
    set(data, "shading", "kernel_ratio", 400.0);
    EXPECT_TRUE(says(omission_finding(data, "most_kernel_time"), "Leaving out facet channel (bump)"))
        << "another law is no omission";
    set(data, "facet channel", "kernel_verdict", std::string("costs"));
    set(data, "every y", "kernel_verdict", std::string("within the spread"));
    EXPECT_TRUE(says(omission_finding(data, "most_kernel_time"), "No omission saves kernel time"));
}

TEST(OmissionFindings, FollowTheBytes) {
    StudyData data = omission_sample();
    EXPECT_TRUE(says(omission_finding(data, "most_bytes"), "every y (bump) saves the most bytes"));
    EXPECT_TRUE(says(omission_finding(data, "most_bytes"), "no omission makes a file smaller"));
    set(data, "facet channel", "bytes_ratio", 100.0);
    set(data, "facet channel", "file_ratio", 1.25);
    EXPECT_TRUE(says(omission_finding(data, "most_bytes"), "facet channel (bump) saves the most bytes"));
    EXPECT_TRUE(says(omission_finding(data, "most_bytes"), "1.25 times as large"));
}

TEST(OmissionTables, TellEffectsFromTheSpread) {
    const std::vector<BaseScene> scenes = own_scenes(true);
    std::vector<Comparison> comparisons;
    for (Comparison& one : comparisons_of(scenes.front(), false))
        if (one.feature == kControl || one.feature == "shading")
            comparisons.push_back(std::move(one));
    ASSERT_EQ(comparisons.size(), 2u);
    const auto result = [](std::vector<double> with) {
        Json without{{"kernel_s", {1.0, 1.0, 1.0}},
                     {"whole_s", {1.0, 1.0, 1.0}},
                     {"uploaded", 1},
                     {"received", 1},
                     {"evaluated", 1},
                     {"samples", 1}};
        Json side = without;
        side["kernel_s"] = with;
        return Json{{"with", side},    {"without", without}, {"compared", 1},
                    {"in_contact", 1}, {"differing", 0},     {"largest", 0.0}};
    };
    const auto verdict = [&](std::vector<double> control, std::vector<double> with) {
        return features_table(comparisons, {result(control), result(with)}).word(1, "kernel_verdict");
    };
    EXPECT_EQ(verdict({1, 1, 1}, {1.1, 1.1, 1.1}), "saves");
    EXPECT_EQ(verdict({1, 1, 1}, {0.9, 0.9, 0.9}), "costs");
    EXPECT_EQ(verdict({1, 1, 1}, {1.01, 1.01, 1.01}), "within the spread");
    EXPECT_EQ(verdict({1, 1, 1}, {0.5, 1.1, 1.1}), "within the spread") << "a quartile below 1";
    EXPECT_EQ(verdict({0.8, 1.2, 1.5}, {1.1, 1.1, 1.1}), "within the spread") << "the control is as far from 1";
}

} // namespace
} // namespace forceshade::study
