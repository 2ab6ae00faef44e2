// Where numbers leave the truth: errors on small cases, ranges from tables, and findings that follow the data.
#include <cmath>

#include <gtest/gtest.h>

#include "host/field/engine.h"
#include "host/study/stability/stability.h"

namespace forceshade::study {
namespace {

std::unique_ptr<Engine> oracle() {
    EngineOptions options;
    options.cpu = true;
    return make_engine(options);
}

class EveryNumberSurface : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryNumberSurface, RoundsOnlyItsLastDigits) {
    const auto engine = oracle();
    const PrecisionErrors single = single_errors(*engine, number_case(GetParam(), "stiffness", 1000));
    EXPECT_GT(single.force, 1e-9) << "single precision rounds";
    EXPECT_LT(single.force, GetParam() == "mesh" ? 1e-5 : single.bound);
    const PrecisionErrors twice = double_errors(*engine, number_case(GetParam(), "stiffness", 1000));
    EXPECT_GT(twice.force, 0);
    EXPECT_LT(twice.force, GetParam() == "mesh" ? 1e-14 : twice.bound);
}

TEST_P(EveryNumberSurface, LosesDifferencesOnAGridFinerThanItsNumbers) {
    const auto engine = oracle();
    EXPECT_GT(single_errors(*engine, number_case(GetParam(), "spacing", 1e-11)).step, 0.5);
    EXPECT_LT(single_errors(*engine, number_case(GetParam(), "spacing", 1e-5)).step, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, EveryNumberSurface, ::testing::ValuesIn(number_surfaces()));

TEST(NumberErrors, AreLargeWhereDigitsAreLost) {
    const auto engine = oracle();
    for (const char* bump : {"bump", "shaded bump"})
        EXPECT_GT(single_errors(*engine, number_case(bump, "depth", 1e-9)).force, 1e-2) << "a difference of heights";
    EXPECT_GT(single_errors(*engine, number_case("height map", "origin", 1e4)).force, 1e-3) << "rounded coordinates";
    EXPECT_LT(single_errors(*engine, number_case("mesh", "origin", 1e4)).force, 1e-6) << "a mesh has its own frame";
    const PrecisionErrors stiff = single_errors(*engine, number_case("bump", "stiffness", 1e39));
    EXPECT_NE(stiff.refused.find("beyond single precision"), std::string::npos);
}

// Two facets are equally near on the bisector below every ridge, so that rounding chooses there.
TEST(WorstRounding, IsAJumpOnTies) {
    std::deque<std::vector<LawRounding>> by_law;
    std::vector<LawRounding> found;
    for (const Part& part : worst_rounding_parts(nullptr, true, by_law))
        if (part.name.find("8 x 4 cells") != std::string::npos)
            part.compute();
    for (const std::vector<LawRounding>& rows : by_law)
        found.insert(found.end(), rows.begin(), rows.end());
    const auto worst = [&](const std::string& law, bool same) {
        const auto at = std::ranges::find_if(
            found, [&](const LawRounding& one) { return one.law.ends_with(law) && one.same_facet == same; });
        return at == found.end() ? 0 : at->error;
    };
    EXPECT_LT(worst(" none", true), 1e-4);
    EXPECT_GT(worst(" none", true), 1e-7) << "samples away from edges say 1e-7";
    EXPECT_NEAR(worst(" none", false), std::sqrt(2), 1e-3) << "under the block's right-angled edges, at every depth";
    EXPECT_GT(worst("morgenbesser", false), 1.1) << "whatever the shading:";
    EXPECT_GT(worst("mean_value", false), 0.55)
        << "its normals continue over an edge, but not over a bisector below it";
    EXPECT_GT(worst("two_pass", false), 4) << "near facets square to its direction";
    EXPECT_LT(worst("none, god-object", true), 1e-5);
    EXPECT_GT(worst("none, god-object", false), 0.5) << "where strokes fork";
    StudyData data;
    add_worst_rounding(data, found, true);
    ASSERT_EQ(data.findings.size(), 1u);
    EXPECT_NE(data.findings[0].text.find("equally near"), std::string::npos);
}

} // namespace
} // namespace forceshade::study
