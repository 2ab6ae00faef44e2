// Where numbers leave the truth: errors on small cases, ranges from tables, and findings that follow the data.
#include <cmath>

#include <gtest/gtest.h>

#include "host/engine/engine.h"
#include "host/study/stability/number.h"
#include "host/study/stability/number_cases.h"
#include "host/study/stability/number_error.h"
#include "host/study/stability/number_findings.h"
#include "host/study/stability/promises.h"

namespace forceshade::study {
namespace {

std::unique_ptr<Engine> oracle() {
    EngineOptions options;
    options.cpu = true;
    return make_engine(options);
}

class EveryNumberSurface : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryNumberSurface, IsAsGoodAsTheFormulasSayWhereItIsPlain) {
    const auto engine = oracle();
    const NumberErrors single = single_errors(*engine, number_case(GetParam(), "stiffness", 1000));
    EXPECT_GT(single.force, 1e-9) << "single precision rounds";
    EXPECT_LT(single.force, single.predicted);
    const NumberErrors twice = double_errors(*engine, number_case(GetParam(), "stiffness", 1000));
    EXPECT_GT(twice.force, 0);
    EXPECT_LT(twice.force, twice.predicted);
    EXPECT_LT(twice.predicted, 1e-14);
}

TEST_P(EveryNumberSurface, LosesDifferencesOnAGridFinerThanItsNumbers) {
    const auto engine = oracle();
    EXPECT_GT(single_errors(*engine, number_case(GetParam(), "spacing", 1e-11)).step, 0.5);
    EXPECT_LT(single_errors(*engine, number_case(GetParam(), "spacing", 1e-5)).step, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, EveryNumberSurface, ::testing::ValuesIn(number_surfaces()));

TEST(NumberErrors, NameTheConditionThatWeighsMost) {
    const auto engine = oracle();
    const NumberErrors shallow = single_errors(*engine, number_case("bump", "depth", 1e-9));
    EXPECT_EQ(shallow.condition, "depth as a difference of heights: u U / d");
    EXPECT_GT(shallow.force, 1e-2);
    const NumberErrors far = single_errors(*engine, number_case("height map", "origin", 1e4));
    EXPECT_EQ(far.condition, "rounded coordinates: u |x|");
    EXPECT_GT(far.force, 1e-3);
    EXPECT_LT(single_errors(*engine, number_case("mesh", "origin", 1e4)).force, 1e-6) << "a mesh has its own frame";
    const NumberErrors stiff = single_errors(*engine, number_case("bump", "stiffness", 1e39));
    EXPECT_NE(stiff.refused.find("beyond single precision"), std::string::npos);
}

Column column(const char* name) {
    return {name, "", ""};
}

Table sample_number(double far_error) {
    Table table{"number",
                "",
                {column("surface"), column("axis"), column("value"), column("precision"), column("series"),
                 column("error"), column("predicted"), column("of_predicted"), column("step_predicted"),
                 column("value_shown"), column("step_error"), column("condition"), column("refused")},
                {}};
    const auto add = [&](const char* axis, double value, Cell error) {
        table.rows.push_back({std::string("bump"), std::string(axis), value, std::string("f32"),
                              std::string("bump, f32"), error, 0.25, 0.5, Cell(), value, Cell(),
                              std::string("a condition"), std::string(error.index() == 0 ? "too large" : "")});
    };
    add("stiffness", 1e-3, 1e-7);
    add("stiffness", 1e3, 1e-7);
    add("stiffness", 1e9, far_error);
    add("stiffness", 1e39, Cell());
    return table;
}

StudyData number_sample(double far_error) {
    StudyData data;
    data.study = "stability";
    data.tables = {sample_number(far_error)};
    data.tables.push_back(promises_table(data.tables[0]));
    data.tables.push_back(promised_table(data.tables[1]));
    return data;
}

std::string number_finding(const StudyData& data, const std::string& name) {
    for (const Finding& one : number_findings(data))
        if (one.name == name)
            return one.text;
    return "";
}

TEST(Promises, EndAtTheFirstValueThatIsWorse) {
    const Table promises = promises_table(sample_number(1e-5));
    ASSERT_EQ(promises.rows.size(), 3u);
    EXPECT_EQ(promises.number(0, "high"), 1e3) << "1e-6";
    EXPECT_EQ(promises.number(1, "high"), 1e9) << "1e-4";
    EXPECT_EQ(promises.number(1, "low"), 1e-3);
    EXPECT_EQ(promises.number(1, "tried_high"), 1e39);
    const Table promised = promised_table(promises);
    EXPECT_EQ(promised.word(0, "stiffness"), "0.001* to 1000");
    EXPECT_EQ(promised.word(0, "spacing"), "");
}

TEST(Failures, NameTheFirstValueThatIsLostAndWhy) {
    const Table failures = failures_table(sample_number(0.5));
    ASSERT_EQ(failures.rows.size(), 1u);
    EXPECT_EQ(failures.number(0, "kept"), 1e3);
    EXPECT_EQ(failures.number(0, "lost"), 1e9);
    EXPECT_EQ(failures.number(0, "error"), 0.5);
    EXPECT_EQ(failures.word(0, "condition"), "a condition");
    const Table refused = failures_table(sample_number(1e-7));
    EXPECT_EQ(refused.number(0, "lost"), 1e39);
    EXPECT_EQ(refused.word(0, "condition"), "refused: too large");
}

TEST(Promises, AreNoneWhereThePlainValueIsTooBad) {
    Table number = sample_number(1);
    for (auto& row : number.rows)
        row[number.index("error")] = 0.5;
    const Table promises = promises_table(number);
    EXPECT_FALSE(promises.number(0, "low"));
    EXPECT_EQ(promised_table(promises).word(0, "stiffness"), "nowhere");
}

TEST(NumberFindings, AForceThatIsNoNumberIsTheWorst) {
    StudyData data = number_sample(1e-7);
    EXPECT_NE(number_finding(data, "prediction").find("explain every error"), std::string::npos);
    Table& number = data.tables[0];
    number.rows[1][number.index("error")] = Cell(); // and not refused
    EXPECT_NE(number_finding(data, "prediction").find("Not every error"), std::string::npos);
    EXPECT_NE(number_finding(data, "where_f32_fails").find("by up to inf over stiffness (bump at 1000 N/m"),
              std::string::npos)
        << number_finding(data, "where_f32_fails");
}

TEST(NumberFindings, TellStepsAndTheForcesBesideThem) {
    StudyData data = number_sample(1e-7);
    Table& number = data.tables[0];
    for (std::size_t row = 0; row < 3; ++row) {
        number.rows[row][number.index("axis")] = std::string("spacing");
        number.rows[row][number.index("value")] = std::pow(10.0, double(row) - 9);
        number.rows[row][number.index("step_error")] = row == 0 ? 0.5 : 0.01;
    }
    EXPECT_NE(number_finding(data, "steps")
                  .find("up to a spacing of 1e-09 m (bump), where each force by itself is off by at "
                        "most 1e-07"),
              std::string::npos)
        << number_finding(data, "steps");
    number.rows[0][number.index("step_error")] = 0.01;
    EXPECT_NE(number_finding(data, "steps").find("at every spacing tried"), std::string::npos);
}

TEST(NumberFindings, FollowTheData) {
    const StudyData good = number_sample(1e-7), bad = number_sample(0.5);
    EXPECT_NE(number_finding(good, "promise_f32").find("stiffness 0.001 N/m to 1e+09 N/m (bump)"), std::string::npos);
    EXPECT_NE(number_finding(bad, "promise_f32").find("stiffness 0.001 N/m to 1000 N/m (bump)"), std::string::npos);
    EXPECT_NE(number_finding(good, "where_f32_fails").find("nowhere"), std::string::npos);
    EXPECT_NE(
        number_finding(bad, "where_f32_fails").find("by up to 0.5 over stiffness (bump at 1e+09 N/m; a condition)"),
        std::string::npos);
    EXPECT_NE(number_finding(good, "prediction").find("explain every error"), std::string::npos);
    StudyData odd = good;
    odd.tables[0].rows[1][odd.tables[0].index("of_predicted")] = 7.0;
    EXPECT_NE(number_finding(odd, "prediction").find("Not every error"), std::string::npos);
    EXPECT_NE(number_finding(good, "refused").find("4 settings 1 are refused"), std::string::npos);
    EXPECT_NE(number_finding(bad, "refused").find("1 are evaluated with forces off"), std::string::npos);
    EXPECT_TRUE(number_findings(StudyData{}).empty());
}

} // namespace
} // namespace forceshade::study
