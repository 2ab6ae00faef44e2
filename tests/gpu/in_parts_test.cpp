// Work that is computed twice, as a whole and in parts (compute/kernels.h): intact kernels give the same bits, and what
// a single computation does not show is seen.
#include <gtest/gtest.h>

#include "host/field/engine.h"
#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/path_case.h"
#include "tests/gpu/software_device.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/unit/laws.h"

namespace forceshade {
namespace {

using test::Break;

class InParts : public ::testing::Test {
protected:
    void SetUp() override {
        options_.gpu = test::tested_gpu();
        options_.twice = true;
    }
    void TearDown() override { test::choose_break(Break::none); }

    static FieldTables<float> field() {
        Scene scene = test::bump(test::kRadii[0], 5, Shading::reference);
        scene.grid.size = {13, 7, 11};
        scene.grid.origin = {-0.015, -0.002, -0.004};
        scene.grid.spacing = {0.0025, 0.0007, 0.0006};
        return make_tables<float>(scene, {}, Extent::everything);
    }

    // All on a device of its own; how many samples were handed over.
    std::size_t evaluate(const layout::FieldInput<float>& input) {
        std::size_t samples = 0;
        make_engine(options_)->evaluate(input, [&](const layout::FieldChunk<float>& chunk) {
            samples += chunk.x_count * chunk.y_count * chunk.z_count;
        });
        return samples;
    }
    std::size_t explore(layout::uint loop) {
        test::PathShape shape;
        shape.features.loop = loop;
        shape.features.channels = layout::kChannelForce | layout::kChannelPosition | layout::kChannelFacet;
        shape.paths = 7;
        shape.steps = 90;
        const FieldTables<float> tables =
            test::tables_of<float>(test::analytic(test::bump(test::kRadii[0], 3, Shading::reference)));
        test::PathCase<float> one(tables, nullptr, shape);
        const layout::PathInput<float> input = one.input();
        std::size_t samples = 0;
        make_engine(options_)->explore(
            input, [&](const layout::PathChunk<float>& chunk) { samples += chunk.path_count * chunk.step_count; },
            [](std::size_t, std::span<const layout::PathMetrics<float>>) {});
        return samples;
    }
    static void expect_differs(const std::string& what, const std::function<void()>& work) {
        EXPECT_TRUE(testing::says(test::device_error(compute::DeviceError::Kind::differs_in_parts, work), what));
    }

    EngineOptions options_;
};

TEST_F(InParts, IntactKernelsGiveTheSame) {
    EXPECT_EQ(evaluate(field().input()), 13u * 7 * 11);
    EXPECT_EQ(explore(layout::kLoopOpen), 7u * 90);
    EXPECT_EQ(explore(layout::kLoopClosed), 7u * 90);
}

TEST_F(InParts, WhatIsWrittenBehindResultsIsSeen) {
    test::choose_break(Break::beyond);
    expect_differs("behind the end of its results", [&] { evaluate(field().input()); });
}

TEST_F(InParts, ADispatchThatTakesItselfForTheFirstIsSeen) {
    test::choose_break(Break::first);
    expect_differs("the field at y 0, z 1", [&] { evaluate(field().input()); });
    test::choose_break(Break::restart);
    expect_differs("path 0", [&] { explore(layout::kLoopClosed); });
}

} // namespace
} // namespace forceshade
