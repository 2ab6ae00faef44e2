// Ten thousand paths of a thousand steps over each kind of surface, open and closed loop: every sample and every metric
// has the oracle's bits.
#include <gtest/gtest.h>

#include "tests/gpu/path_case.h"
#include "tests/gpu/path_surfaces.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

class PathLong : public test::SoftwareDeviceTest {
protected:
    template <typename T> static void hold(const char* name, std::size_t steps) {
        static compute::PathKernel kernel(device());
        for (const test::Surface& surface : test::surfaces()) {
            if (std::string(surface.name) != name)
                continue;
            for (const layout::uint loop : {layout::kLoopOpen, layout::kLoopClosed}) {
                test::PathShape shape;
                shape.features.loop = loop;
                shape.features.channels = test::kAllPathChannels;
                shape.paths = 10000;
                shape.steps = steps;
                shape.own_hands = true;
                shape.coulomb = 0.05;
                shape.quantum = 3e-5;
                shape.delay = 1;
                test::PathCase<T> one(surface.scene, shape, surface.images);
                const test::PathComparison comparison = test::hold_paths(kernel, one, 1000);
                EXPECT_TRUE(is_equal(comparison)) << name << ", loop " << loop;
                EXPECT_EQ(comparison.samples, shape.paths * steps);
                EXPECT_GT(comparison.touching, shape.paths * steps / 10) << name << ", loop " << loop;
            }
            return;
        }
        FAIL() << "no surface " << name;
    }
};

TEST_F(PathLong, ShadedFacets) {
    hold<float>("shaded facets", 1000);
    hold<double>("shaded facets", 300);
}

TEST_F(PathLong, Cylinder) {
    hold<float>("cylinder", 1000);
    hold<double>("cylinder", 300);
}

TEST_F(PathLong, Sine) {
    hold<float>("sine", 1000);
    hold<double>("sine", 300);
}

TEST_F(PathLong, TexturedGaussian) {
    hold<float>("gaussian, textured", 1000);
    hold<double>("gaussian, textured", 300);
}

TEST_F(PathLong, TexturedSamples) {
    hold<float>("samples, textured by samples", 1000);
    hold<double>("samples, textured by samples", 300);
}

} // namespace
} // namespace forceshade
