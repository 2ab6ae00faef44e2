// Where numbers leave the truth: errors on small cases, ranges from tables, and findings that follow the data.
#include <cmath>

#include <gtest/gtest.h>

#include "host/field/engine.h"
#include "host/study/error_time/subject.h"
#include "host/study/stability/stability.h"
#include "tests/places.h"

namespace forceshade::study {
namespace {

std::unique_ptr<Engine> oracle() {
    EngineOptions options;
    options.cpu = true;
    return make_engine(options);
}

class EveryNumberSurface : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryNumberSurface, RoundsOnlyItsLastDigitsWhereverItsGridLies) {
    const auto engine = oracle();
    for (std::uint64_t draw = 0; draw < 3; ++draw) {
        const NumberCase one = number_case(GetParam(), "stiffness", 1000, draw);
        const PrecisionErrors single = single_errors(*engine, one), twice = double_errors(*engine, one);
        EXPECT_GT(single.force, 1e-9) << "single precision rounds";
        EXPECT_LT(single.force, GetParam() == "shaded mesh" ? 1e-5 : single.bound);
        EXPECT_GT(twice.force, 0);
        EXPECT_LT(twice.force, GetParam() == "shaded mesh" ? 1e-14 : twice.bound);
    }
}

TEST_P(EveryNumberSurface, LosesDifferencesOnAGridFinerThanItsNumbers) {
    const auto engine = oracle();
    EXPECT_GT(single_errors(*engine, number_case(GetParam(), "spacing", 1e-11)).step, 0.5);
    EXPECT_LT(single_errors(*engine, number_case(GetParam(), "spacing", 1e-5)).step, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, EveryNumberSurface, ::testing::ValuesIn(number_surfaces()));

TEST(NumberErrors, AreLargeWhereDigitsAreLost) {
    const auto engine = oracle();
    for (const char* bump : {"bump of 8 facets", "shaded bump of 8 facets"})
        EXPECT_GT(single_errors(*engine, number_case(bump, "depth", 1e-9)).force, 1e-2) << "a difference of heights";
    EXPECT_GT(single_errors(*engine, number_case("height map of a sine", "origin", 1e4)).force, 1e-3)
        << "rounded coordinates";
    EXPECT_LT(single_errors(*engine, number_case("shaded mesh", "origin", 1e4)).force, 1e-6)
        << "a mesh has its own frame";
    const PrecisionErrors stiff = single_errors(*engine, number_case("bump of 8 facets", "stiffness", 1e39));
    EXPECT_NE(stiff.refused.find("beyond single precision"), std::string::npos);
}

// Two facets are equally near on the bisector below every ridge, so that rounding chooses there.
TEST(WorstRounding, IsAJumpOnTies) {
    std::deque<std::vector<LawRounding>> by_law;
    std::vector<LawRounding> found;
    for (const Part& part : worst_rounding_parts(nullptr, true, by_law))
        if (part.name.find("mesh") != std::string::npos && part.name.find("thin") == std::string::npos)
            part.compute();
    for (const std::vector<LawRounding>& rows : by_law)
        found.insert(found.end(), rows.begin(), rows.end());
    const auto worst = [&](const std::string& law, bool same) {
        const auto at = std::ranges::find_if(
            found, [&](const LawRounding& one) { return one.law == law && one.same_facet == same; });
        return at == found.end() ? 0 : at->error;
    };
    EXPECT_LT(worst("mesh", true), 1e-4);
    EXPECT_GT(worst("mesh", true), 1e-7) << "samples away from edges say 1e-7";
    EXPECT_NEAR(worst("mesh", false), std::sqrt(2), 1e-3) << "under the block's right-angled edges, at every depth";
    EXPECT_GT(worst("morgenbesser mesh", false), 1.5) << "between triangles of a flat face, too; whatever the shading:";
    EXPECT_GT(worst("shaded mesh", false), 0.55)
        << "its normals continue over an edge, but not over a bisector below it";
    EXPECT_GT(worst("two_pass mesh", false), 4) << "near facets square to its direction";
    EXPECT_LT(worst("mesh, god-object", true), 1e-5);
    EXPECT_GT(worst("mesh, god-object", false), 0.5) << "where strokes fork";
    StudyData data;
    add_worst_rounding(data, found, true);
    ASSERT_EQ(data.findings.size(), 1u);
    EXPECT_NE(data.findings[0].text.find("equally near"), std::string::npos);
}

// Between opposite sides of thin parts: on other ways as many places end at 0.5.
TEST(WorstRounding, IsSoughtOnTheMedialAxis) {
    const PreparedCase spot = CasePreparation().prepare(parse_scene(
        "surface = {kind = \"mesh\", file = \"" + in_source("tests/data/spot.obj") + "\", unit = \"cm\"}", "spot"));
    EXPECT_GT(worst_rounding(spot, 2000).back().error, 1.7) << "from fifty times as many places 1.85";
}

// A stroke between arcs about the axis of a cylinder of 8 x 8 cells, deep under a ridge, and the largest change of a
// force from one step to the next.
struct Jump {
    double force = 0, at = 0; /* N; degrees past the ridge */
};
class UnderARidge : public ::testing::TestWithParam<const char*> {
protected:
    static constexpr double kStiffness = 1000, kRadius = 0.01524, kDeep = 0.013; /* N/m, m, m: of the stroke */
    static inline const double kHalf = std::asin(0.0127 / kRadius) / 8;          /* rad: from a facet's middle to it */

    UnderARidge()
        : subject_(error_time::own_subjects({{4}, {8}, {0.4e-3}, 10, 10, 1}).back()),
          prepared_(
              *std::ranges::find(subject_.variants, std::string("8 cells, ") + GetParam(), &error_time::Variant::name)
                   ->prepared) {}

    // Past the ridge, and from the axis.
    static glm::dvec3 place(double degrees, double radius = kDeep) {
        const double angle = degrees * kDegree,
                     below = std::sqrt(kRadius * kRadius - 0.0127 * 0.0127); // m: of the axis
        return {radius * std::sin(angle), 1.5e-3, radius * std::cos(angle) - below};
    }
    // In so many steps; `force_at`, N, of a place.
    template <typename Force> static Jump largest(double from, double to, int steps, const Force& force_at) {
        Jump most;
        reference::Vector<double> before = force_at(place(from));
        for (int i = 1; i <= steps; ++i) {
            const double degrees = from + (to - from) * i / steps;
            const reference::Vector<double> force = force_at(place(degrees));
            if (const double jump = reference::length(force - before); jump > most.force)
                most = {jump, degrees};
            before = force;
        }
        return most;
    }
    Jump of_static(double from, double to, int steps) const {
        StaticForce<double> law(prepared_);
        return largest(from, to, steps, [&](const glm::dvec3& at) { return law.force(law.input({.at = at})); });
    }
    // After coming down onto the middle of the facet before the ridge.
    Jump of_god_object(double from, double to, int steps) const {
        const auto probe = std::make_unique<CaseProbe<double>>(prepared_);
        const auto force_at = [&](const glm::dvec3& at) { return probe->at(at).contact.force; };
        probe->begin_path();
        for (int i = 0; i <= 50; ++i)
            force_at(place(-kHalf / kDegree, kDeep + (kRadius - kDeep + 1e-3) * (1 - i / 50.0)));
        largest(-kHalf / kDegree, from, 200, force_at);
        return largest(from, to, steps, force_at);
    }

    error_time::Subject subject_;
    PreparedCase prepared_;
};

// Below the ridge both facets are equally near: the static field jumps there whatever the step and the shading, a
// god-object's force changes by no more than its probe moves. It jumps later, where the foot of its own facet's normal
// passes the ridge and the proxy slides down to the other's: unshaded by K d sin(2 a), d the depth below its
// facet.
TEST_P(UnderARidge, TheStaticFieldJumpsAndAGodObjectLater) {
    const double step = kDeep * 2 * kDegree / 1000; // m: of 1000 steps
    const Jump coarse = of_static(-1, 1, 1000), fine = of_static(-1, 1, 2000);
    EXPECT_NEAR(fine.force, coarse.force, 2 * kStiffness * step);
    EXPECT_GT(fine.force, 50 * kStiffness * step);
    EXPECT_NEAR(fine.at, 0, 0.01);
    const Jump kept = of_god_object(-1, 1, 1000), halved = of_god_object(-1, 1, 2000);
    EXPECT_LT(kept.force, 1.5 * kStiffness * step);
    EXPECT_NEAR(halved.force, kept.force / 2, 0.05 * kept.force);
    const double passed = std::asin(kRadius * std::sin(kHalf) / kDeep) - kHalf; // rad
    const Jump late = of_god_object(0, 3, 1500), finer = of_god_object(0, 3, 3000);
    EXPECT_NEAR(finer.at, passed / kDegree, 0.01);
    EXPECT_NEAR(finer.force, late.force, 2 * kStiffness * step);
    EXPECT_GT(finer.force, 50 * kStiffness * step);
    if (GetParam() == std::string("none")) {
        EXPECT_NEAR(fine.force, 2 * kStiffness * (kRadius - kDeep) * std::cos(kHalf) * std::sin(kHalf),
                    2 * kStiffness * step);
        const double depth = kRadius * std::cos(kHalf) - kDeep * std::cos(passed + kHalf);
        EXPECT_NEAR(finer.force, kStiffness * depth * std::sin(2 * kHalf), 2 * kStiffness * step);
    }
}

INSTANTIATE_TEST_SUITE_P(Shadings, UnderARidge,
                         ::testing::Values("none", "morgenbesser", "barycentric", "mean_value", "two_pass"));

} // namespace
} // namespace forceshade::study
