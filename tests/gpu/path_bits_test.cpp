// Exploration paths over every analytic surface, motion and hand: samples and metrics have the oracle's bits.
#include <gtest/gtest.h>

#include "tests/gpu/path_case.h"
#include "tests/gpu/path_surfaces.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::PathCase;
using test::PathShape;
using test::Surface;
using test::surfaces;

class PathBits : public test::SoftwareDeviceTest {
protected:
    static compute::PathKernel& kernel() {
        static compute::PathKernel one(device());
        return one;
    }

    template <typename T> static test::PathComparison hold(const Surface& surface, const PathShape& shape) {
        PathCase<T> one(surface.scene, shape, surface.images);
        const test::PathComparison comparison = test::hold_paths(kernel(), one);
        EXPECT_TRUE(is_equal(comparison)) << surface.name << ", motion " << shape.features.motion << ", loop "
                                          << shape.features.loop << ", seed " << shape.seed << ", f" << 8 * sizeof(T);
        return comparison;
    }
};

PathShape shape_of(layout::uint motion, layout::uint loop) {
    PathShape shape;
    shape.features.motion = motion;
    shape.features.loop = loop;
    shape.features.channels = test::kAllPathChannels;
    return shape;
}

TEST_F(PathBits, EveryMotionOpenAndClosed) {
    const Surface surface = surfaces()[1];
    for (layout::uint motion = layout::kMotionStrokes; motion <= layout::kMotionRecorded; ++motion)
        for (const layout::uint loop : {layout::kLoopOpen, layout::kLoopClosed}) {
            PathShape shape = shape_of(motion, loop);
            shape.features.harmonics = motion == layout::kMotionRecorded ? 0 : motion % 3;
            const auto single = hold<float>(surface, shape);
            const auto twofold = hold<double>(surface, shape);
            EXPECT_GT(single.touching, 0u) << motion;
            EXPECT_GT(twofold.touching, 0u) << motion;
        }
}

// As many as a path keeps, and more.
TEST_F(PathBits, ManyHarmonics) {
    for (const layout::uint harmonics : {1u, 16u, 17u, 40u}) {
        PathShape shape = shape_of(layout::kMotionRandomWalk, layout::kLoopOpen);
        shape.features.harmonics = harmonics;
        hold<float>(surfaces()[1], shape);
        hold<double>(surfaces()[1], shape);
    }
}

TEST_F(PathBits, EverySurfaceOpenAndClosed) {
    for (const Surface& surface : surfaces())
        for (const layout::uint loop : {layout::kLoopOpen, layout::kLoopClosed})
            for (const layout::uint follow : {layout::kFollowPlane, layout::kFollowSurface}) {
                PathShape shape = shape_of(layout::kMotionStrokes, loop);
                shape.features.follow = follow;
                const auto single = hold<float>(surface, shape);
                hold<double>(surface, shape);
                EXPECT_GT(single.touching, 0u) << surface.name;
                EXPECT_GT(single.rounds, 0u) << surface.name;
            }
}

TEST_F(PathBits, EveryHand) {
    const Surface surface = surfaces()[1];
    for (unsigned bits = 0; bits < 32; ++bits) {
        PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopClosed);
        shape.seed = bits + 1;
        shape.coulomb = bits & 1 ? 0.1 : 0;
        shape.quantum = bits & 2 ? 3e-5 : 0;
        shape.delay = bits & 4 ? 1 : 0;
        shape.max_force = bits & 8 ? 0.3 : 8.5;
        shape.own_hands = bits & 16;
        hold<float>(surface, shape);
        hold<double>(surface, shape);
    }
}

// A wall far too stiff for the sampling throws the probe off; it is held where it left its bound.
TEST_F(PathBits, UnstableLoops) {
    for (const double bound : {0.005, 0.1}) {
        Surface surface = surfaces()[1];
        surface.scene.force.stiffness = 1e6;
        PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopClosed);
        shape.bound = bound;
        shape.max_force = 1e30;
        shape.own_hands = true;
        shape.depth = 3e-3;
        EXPECT_GT(hold<float>(surface, shape).unstable, 0u);
        EXPECT_GT(hold<double>(surface, shape).unstable, 0u);
    }
}

TEST_F(PathBits, OddCounts) {
    const Surface surface = surfaces()[1];
    for (const std::size_t paths : {std::size_t(1), std::size_t(31), std::size_t(33), std::size_t(257)})
        for (const std::size_t steps : {std::size_t(1), std::size_t(2), std::size_t(67)})
            for (const layout::uint motion : {layout::kMotionStrokes, layout::kMotionRecorded})
                for (const layout::uint loop : {layout::kLoopOpen, layout::kLoopClosed}) {
                    PathShape shape = shape_of(motion, loop);
                    shape.paths = paths;
                    shape.steps = steps;
                    hold<float>(surface, shape);
                }
}

// Windows and batches of any size give the same paths, through a staging buffer or not.
TEST_F(PathBits, ChunksAndBatches) {
    const Surface surface = surfaces()[1];
    for (const bool staging : {false, true})
        for (const std::uint32_t steps : {0u, 1u, 7u, 200u})
            for (const layout::uint motion : {layout::kMotionStrokes, layout::kMotionRecorded}) {
                compute::PathKernelOptions options;
                options.batch_paths = steps == 7 ? 64 : 40;
                options.steps = steps;
                options.chunk_bytes = 64 << 10;
                options.force_staging = staging;
                compute::PathKernel small(device(), options);
                for (const layout::uint channels : {test::kAllPathChannels, layout::kChannelForce, 0u}) {
                    PathShape shape = shape_of(motion, layout::kLoopClosed);
                    shape.features.channels = channels;
                    shape.features.harmonics = motion == layout::kMotionRecorded ? 0 : 2;
                    shape.paths = 150;
                    shape.own_hands = true;
                    PathCase<float> one(surface.scene, shape);
                    EXPECT_TRUE(is_equal(test::hold_paths(small, one))) << staging << " " << steps << " " << motion;
                }
            }
}

} // namespace
} // namespace forceshade
