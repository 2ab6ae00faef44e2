// Ten thousand paths of a thousand steps over a mesh of a hundred thousand triangles, open and closed loop, and ones
// that wander over another with edges and folds: every sample and every metric has the oracle's bits.
#include <gtest/gtest.h>

#include "host/mesh/mesh_file.h"
#include "tests/gpu/mesh_path_case.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::MeshPathCase;
using test::PathShape;

class MeshPathLong : public test::SoftwareDeviceTest {
protected:
    static constexpr std::size_t kSlice = 1000; // paths held in memory at once

    static PathShape shape_of(layout::uint motion, layout::uint loop, std::size_t steps, std::uint64_t seed) {
        PathShape shape;
        shape.features.motion = motion;
        shape.features.loop = loop;
        shape.features.harmonics = motion == layout::kMotionRandomWalk ? 6 : 1;
        shape.features.channels = test::kAllPathChannels;
        shape.paths = kSlice;
        shape.steps = steps;
        shape.seed = seed;
        shape.reach = 0.004;
        shape.own_hands = true;
        shape.coulomb = 0.01;
        shape.delay = 1;
        return shape;
    }

    template <typename T>
    static test::PathComparison hold(const MeshStructure& structure, const PathShape& shape, test::Probes probes) {
        static compute::MeshPathKernel kernel(device());
        MeshPathCase<T> one(structure, shape, probes);
        one.law.features.shading = layout::kShadingBarycentric;
        test::MeshPathRunner runner{kernel};
        const test::PathComparison comparison =
            test::hold_input(runner, one.input(), [&](std::size_t path) { return one.length(path); });
        EXPECT_TRUE(is_equal(comparison)) << "f" << 8 * sizeof(T) << ", motion " << shape.features.motion << ", loop "
                                          << shape.features.loop << ", seed " << shape.seed;
        return comparison;
    }

    template <typename T> static void hold_on_sphere(std::size_t slices, std::size_t steps) {
        // 81 920 triangles; the top is the origin.
        const MeshStructure structure = build_structure(
            shapes::mesh_of(shapes::moved(shapes::icosphere(6), glm::dvec3(0.025), glm::dvec3(0, 0, -0.025))));
        std::uint64_t samples = 0, touching = 0;
        for (std::size_t slice = 0; slice < slices; ++slice) {
            const layout::uint motion = slice % 3 == 0   ? layout::kMotionStrokes
                                        : slice % 3 == 1 ? layout::kMotionCircle
                                                         : layout::kMotionRandomWalk;
            const layout::uint loop = slice % 2 == 0 ? layout::kLoopOpen : layout::kLoopClosed;
            const test::PathComparison one =
                hold<T>(structure, shape_of(motion, loop, steps, slice + 1), test::Probes::of_case);
            samples += one.samples;
            touching += one.touching;
        }
        EXPECT_EQ(samples, slices * kSlice * steps);
        EXPECT_GT(touching, samples / 10);
    }
};

TEST_F(MeshPathLong, Sphere) {
    hold_on_sphere<float>(10, 1000);
    hold_on_sphere<double>(10, 1000);
}

TEST_F(MeshPathLong, WanderingOverSpot) {
    const MeshStructure structure =
        build_structure(shapes::mesh_of(read_polygons(FORCESHADE_DATA "/spot.obj").polygons));
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const PathShape shape = shape_of(layout::kMotionRecorded, layout::kLoopOpen, 500, seed);
        EXPECT_GT(hold<float>(structure, shape, test::Probes::wandering).touching, 10000u);
        EXPECT_GT(hold<double>(structure, shape, test::Probes::wandering).touching, 10000u);
    }
}

} // namespace
} // namespace forceshade
