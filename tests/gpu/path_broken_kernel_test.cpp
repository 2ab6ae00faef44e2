// Kernels of paths broken on purpose: the comparison with the oracle must catch every one of them, or it holds nothing.
#include <gtest/gtest.h>

#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/path_case.h"
#include "tests/gpu/path_surfaces.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::Break;

struct BrokenPath {
    const char* name;
    Break which;
    layout::uint loop;
    bool samples; /* shows in samples, else in metrics alone */
};

template <typename T> test::PathComparison compare_broken(Break broken, layout::uint loop) {
    test::choose_break(broken);
    compute::Device device = test::open_software_device(false);
    compute::PathKernel kernel(device);
    test::PathShape shape;
    shape.features.loop = loop;
    shape.features.channels = test::kAllPathChannels;
    shape.steps = 1000;
    shape.coulomb = 0.1;
    test::PathCase<T> one(test::bump(test::kRadii[0], 3), shape);
    return test::hold_paths(kernel, one);
}

class PathBrokenKernel : public ::testing::TestWithParam<BrokenPath> {};

TEST_P(PathBrokenKernel, IsCaught) {
    const auto expect_caught = [&](const test::PathComparison& comparison) {
        EXPECT_GT(comparison.differing_metrics, 0u);
        EXPECT_EQ(comparison.differing > 0, GetParam().samples);
    };
    EXPECT_TRUE(is_equal(compare_broken<float>(Break::none, GetParam().loop)));
    EXPECT_TRUE(is_equal(compare_broken<double>(Break::none, GetParam().loop)));
    expect_caught(compare_broken<float>(GetParam().which, GetParam().loop));
    expect_caught(compare_broken<double>(GetParam().which, GetParam().loop));
}

INSTANTIATE_TEST_SUITE_P(Breaks, PathBrokenKernel,
                         ::testing::Values(BrokenPath{"sign", Break::sign, layout::kLoopOpen, true},
                                           BrokenPath{"friction", Break::friction, layout::kLoopClosed, true},
                                           BrokenPath{"kahan", Break::kahan, layout::kLoopOpen, false},
                                           BrokenPath{"late", Break::late, layout::kLoopClosed, true},
                                           BrokenPath{"lap", Break::lap, layout::kLoopOpen, false},
                                           BrokenPath{"adrift", Break::adrift, layout::kLoopOpen, false},
                                           BrokenPath{"imprecise", Break::imprecise, layout::kLoopOpen, false}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

// A vertex belongs to the facet at its right, also for a probe that comes from the left.
TEST(PathBrokenKernel, SeesWhoseAVertexIs) {
    const auto hold = [](Break broken) {
        test::choose_break(broken);
        compute::Device device = test::open_software_device(false);
        compute::PathKernel kernel(device);
        test::PathShape shape;
        shape.features.channels = layout::kChannelFacet;
        shape.features.motion = layout::kMotionRecorded;
        shape.own_lengths = false;
        shape.paths = 1;
        shape.steps = 8;
        test::PathCase<float> walk(test::bump(test::kRadii[0], 3), shape);
        const std::span<const float> vertices = walk.input().law.facet_vertices;
        for (std::size_t i = 0; i < 4; ++i) { // a facet's vertex, then its middle
            walk.place(2 * i, 0, {vertices[i], 0, -1e-3f});
            walk.place(2 * i + 1, 0, {i < 3 ? (vertices[i] + vertices[i + 1]) / 2 : 1, 0, -1e-3f});
        }
        return test::hold_paths(kernel, walk);
    };
    EXPECT_TRUE(is_equal(hold(Break::none)));
    EXPECT_GT(hold(Break::forgetful).differing, 0u);
}

} // namespace
} // namespace forceshade
