// Mesa's software driver ends loops after 65 535 iterations of an invocation and says nothing. The kernel of paths must
// notice; left to itself it cuts long paths into dispatches that end in time.
#include <gtest/gtest.h>

#include "compute/plan.h"
#include "host/field/engine.h"
#include "tests/gpu/path_case.h"
#include "tests/gpu/path_surfaces.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::PathCase;
using test::PathShape;

class PathLimit : public test::SoftwareDeviceTest {
protected:
    static constexpr std::size_t kSteps = 100000;

    static PathShape shape_of(layout::uint loop) {
        PathShape shape;
        shape.features.loop = loop;
        shape.paths = 3;
        shape.steps = kSteps;
        return shape;
    }

    static Scene scene() { return test::bump(test::kRadii[0], 3, Shading::reference); }

    template <typename T> static void expect_unfinished(const PathShape& shape) {
        PathCase<T> one(scene(), shape);
        compute::PathKernelOptions options;
        options.steps = kSteps;
        compute::PathKernel kernel(device(), options);
        const auto ignore = [](const layout::PathChunk<T>&) {};
        const auto ignore_metrics = [](std::size_t, std::span<const layout::PathMetrics<T>>) {};
        try {
            kernel.explore<T>(one.input(), ignore, ignore_metrics);
            FAIL() << "the driver no longer ends loops: this test needs another shape";
        } catch (const compute::DeviceError& error) {
            EXPECT_EQ(error.kind(), compute::DeviceError::Kind::unfinished) << error.what();
        }
        compute::PathKernel own_choice(device());
        EXPECT_TRUE(is_equal(test::hold_paths(own_choice, one)));
        EXPECT_GT(own_choice.explore<T>(one.input(), ignore, ignore_metrics).dispatches, 4u);
    }
};

TEST_F(PathLimit, IsNoticed) {
    expect_unfinished<float>(shape_of(layout::kLoopOpen));
    expect_unfinished<double>(shape_of(layout::kLoopClosed));
}

// The loop of probes that have left their bound is one of its own.
TEST_F(PathLimit, IsNoticedWhereProbesHaveLeft) {
    PathShape shape = shape_of(layout::kLoopClosed);
    shape.bound = 0;
    shape.depth = 0.01;
    shape.features.channels = layout::kChannelDepth;
    expect_unfinished<float>(shape);
}

// Whatever a scene asks for, no invocation goes round more than 30 000 times, and memory bounds what a dispatch holds.
TEST_F(PathLimit, DispatchesAreShort) {
    for (const std::uint64_t facets : {1u, 3u, 1000000u})
        for (const layout::uint harmonics : {0u, 4u, 1000u})
            for (const std::uint64_t paths : {1u, 1000u, 16384u}) {
                layout::PathFeatures features;
                features.loop = layout::kLoopClosed;
                features.harmonics = harmonics;
                features.channels = test::kAllPathChannels;
                const compute::StepWork work = compute::step_work({}, features, facets, sizeof(float));
                const std::uint64_t steps = compute::steps_of_dispatch(work, paths, 1000000, 8 << 20);
                EXPECT_GE(steps, 1u);
                EXPECT_LE(steps * work.iterations, 30000u);
                EXPECT_LE(steps * work.bytes * paths, std::uint64_t(8) << 20);
                EXPECT_LE((steps - 1) * work.cost * paths, std::uint64_t(1) << 24);
            }
    EXPECT_EQ(compute::steps_of_dispatch({}, 1, 10, 1), 10u);
}

// What the command line calls: empty chunks without channels, and the same metrics.
TEST_F(PathLimit, EngineTakesPaths) {
    EngineOptions options;
    options.gpu = "llvmpipe";
    options.needs_f64 = true;
    const std::unique_ptr<Engine> engine = make_engine(options);
    options.cpu = true;
    const std::unique_ptr<Engine> oracle = make_engine(options);
    PathShape shape = shape_of(layout::kLoopClosed);
    shape.steps = 500;
    PathCase<double> one(scene(), shape);
    const auto metrics_of = [&](Engine& by) {
        std::vector<layout::PathMetrics<double>> all;
        by.explore(
            one.input(),
            [](const layout::PathChunk<double>& chunk) {
                EXPECT_TRUE(chunk.force.empty() && chunk.position.empty() && chunk.proxy.empty());
            },
            [&](std::size_t, std::span<const layout::PathMetrics<double>> some) {
                all.insert(all.end(), some.begin(), some.end());
            });
        return all;
    };
    const auto ours = metrics_of(*engine), theirs = metrics_of(*oracle);
    ASSERT_EQ(ours.size(), 3u);
    ASSERT_EQ(theirs.size(), 3u);
    EXPECT_EQ(std::memcmp(ours.data(), theirs.data(), sizeof(ours[0]) * ours.size()), 0);
}

} // namespace
} // namespace forceshade
