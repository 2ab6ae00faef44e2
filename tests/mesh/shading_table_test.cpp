// The table of direction errors of L7, on patches of triangles, quads and hexagons.
#include <cmath>

#include <gtest/gtest.h>

#include "host/touch/angle.h"
#include "tests/mesh/patch_errors.h"

namespace forceshade {
namespace {

using layout::uint;
using study::Cells;
using study::PatchErrors;
using study::PatchStudy;
using study::SmoothSurface;

struct Row {
    Cells kind;
    unsigned cells;
    PatchErrors flat, morgenbesser, exact;
};

class Table : public testing::TestWithParam<Row> {};

void expect_errors(const PatchErrors& found, const PatchErrors& printed) {
    EXPECT_NEAR(found.rms, printed.rms, 0.01 * printed.rms);
    EXPECT_NEAR(found.largest, printed.largest, 0.03 * printed.largest);
    EXPECT_NEAR(found.jump, printed.jump, 0.01 * printed.jump + 1e-9 / kDegree);
}

TEST_P(Table, OfDirectionErrorsOnACylinderIsReproduced) {
    const Row& row = GetParam();
    const PatchStudy cut(study::kUnitCylinder, row.kind, row.cells);
    expect_errors(cut.errors(layout::kShadingNone), row.flat);
    expect_errors(cut.errors(layout::kShadingMorgenbesser), row.morgenbesser);
    expect_errors(cut.errors(layout::kShadingMeanValue), row.exact);
    if (row.kind == Cells::triangles)
        expect_errors(cut.errors(layout::kShadingBarycentric), row.exact);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, Table,
    testing::Values(Row{Cells::triangles, 8, {2.12, 3.77, 7.42}, {1.26, 3.76, 3.47}, {0.076, 0.131, 0}},
                    Row{Cells::triangles, 32, {0.538, 0.98, 1.99}, {0.318, 0.97, 0.898}, {0.0064, 0.0135, 0}},
                    Row{Cells::quads, 8, {2.12, 3.76, 7.42}, {1.81, 3.34, 6.48}, {0.076, 0.131, 0}},
                    Row{Cells::hexagons, 8, {1.94, 3.85, 7.57}, {1.78, 3.64, 7.03}, {0.065, 0.133, 0}}));

TEST(Shading, ErrorsOnSphereAndSaddleAreReproduced) {
    const auto rms = [](const SmoothSurface& smooth, uint shading) {
        return PatchStudy(smooth, Cells::triangles, 8).errors(shading).rms;
    };
    EXPECT_NEAR(rms(study::kUnitSphere, layout::kShadingNone), 3.01, 0.0301);
    EXPECT_NEAR(rms(study::kUnitSphere, layout::kShadingMorgenbesser), 1.79, 0.0179);
    EXPECT_NEAR(rms(study::kUnitSphere, layout::kShadingMeanValue), 0.200, 0.00200);
    EXPECT_NEAR(rms(study::kSaddle, layout::kShadingNone), 2.74, 0.0274);
    EXPECT_NEAR(rms(study::kSaddle, layout::kShadingMorgenbesser), 1.64, 0.0164);
    EXPECT_NEAR(rms(study::kSaddle, layout::kShadingMeanValue), 0.098, 0.00098);
}

TEST(Shading, OrdersAreOneAndTwo) {
    const auto order = [](uint shading) {
        const double coarse = PatchStudy(study::kUnitCylinder, Cells::triangles, 16, 0.375).errors(shading).rms;
        const double fine = PatchStudy(study::kUnitCylinder, Cells::triangles, 32, 0.375).errors(shading).rms;
        return std::log2(coarse / fine);
    };
    EXPECT_NEAR(order(layout::kShadingNone), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingMorgenbesser), 1, 0.05);
    EXPECT_NEAR(order(layout::kShadingBarycentric), 2, 0.1);
    EXPECT_NEAR(order(layout::kShadingMeanValue), 2, 0.1);
}

} // namespace
} // namespace forceshade
