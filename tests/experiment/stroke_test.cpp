// Strokes in closed loop: in the rigid limit they give the cues of the shape itself.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/experiment/fit.h"
#include "host/experiment/stroke.h"
#include "host/scene/study.h"

namespace forceshade::experiment {
namespace {

PreparedCase bump(unsigned facets, bool shaded, double radius, const char* more = "") {
    const std::string kind =
        facets == 0 ? "kind = \"cylinder_bump\"" : fmt::format("kind = \"bump\"\nfacets = {}", facets);
    return CasePreparation().prepare(
        parse_scene(fmt::format("[surface]\n{}\nwidth = \"1000 mil\"\nradius = \"{} mil\"\n{}{}", kind, radius,
                                shaded ? "[force]\nshading = \"reference\"\n" : "[force]\n", more),
                    "test"));
}

Cues stroked_cues(const PreparedCase& stimulus, const Manner& manner) {
    const auto passes = passes_over(feature_of(stimulus), stroke(stimulus, manner));
    EXPECT_EQ(passes.size(), manner.passes);
    return passes.empty() ? Cues{} : cues_of(passes.front(), ObserverParameters{}.level);
}

TEST(Strokes, CrossTheWholeFeature) {
    const Manner manner;
    for (const unsigned facets : {0u, 1u, 2u, 3u}) {
        const PreparedCase stimulus = bump(facets, facets == 1, 600);
        EXPECT_NEAR(feature_of(stimulus).width, 0.0254, 1e-9);
        const auto passes = passes_over(feature_of(stimulus), stroke(stimulus, manner));
        EXPECT_GE(passes.size(), manner.passes - 1) << facets;
        for (const StrokeSignals& pass : passes) {
            EXPECT_LT(pass.x.front(), -0.012);
            EXPECT_GT(pass.x.back(), 0.012);
        }
    }
}

// Slow, stiff, and stepped finely, so that the probe follows the facets.
TEST(Strokes, InTheRigidLimitGiveTheCuesOfTheShape) {
    Manner manner;
    manner.speed = 3e-3;
    manner.press = 1;
    manner.rate = 1e5;
    manner.passes = 1;
    const char* rigid =
        "stiffness = \"4e6 N/m\"\n[hand]\nmass = \"0.01 kg\"\ndamping = \"300 N s/m\"\nmax_force = \"100 N\"\n"
        "grip_stiffness = \"2e4 N/m\"\n";
    struct Row {
        unsigned facets;
        bool shaded;
        double radius; // mil
    };
    for (const Row& row :
         {Row{2, false, 1000}, Row{3, false, 600}, Row{1, true, 1000}, Row{3, true, 1400}, Row{2, true, 1000}}) {
        const Cues felt = stroked_cues(bump(row.facets, row.shaded, row.radius, rigid), manner);
        const Cues shape =
            cues_of(rigid_signals(row.radius * 25.4e-6, 0.0254, row.facets, row.shaded), ObserverParameters{}.level);
        constexpr double kClose = 1e-3;
        EXPECT_NEAR(felt.force_jump, shape.force_jump, kClose) << row.facets;
        EXPECT_NEAR(felt.path_jump, shape.path_jump, kClose) << row.facets;
        EXPECT_NEAR(felt.force_level, shape.force_level, kClose) << row.facets;
        EXPECT_NEAR(felt.path_level, shape.path_level, kClose) << row.facets;
        EXPECT_NEAR(felt.steepest, shape.steepest, kClose) << row.facets;
    }
}

TEST(Strokes, AnswersNeedAPass) {
    EXPECT_THROW(answer_shares({}, ObserverParameters{}), UsageError);
}

} // namespace
} // namespace forceshade::experiment
