// Random paths over random scenes, with hands of every kind: the kernel's bits are the oracle's, and no number is NaN.
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "tests/gpu/path_case.h"
#include "tests/gpu/random_scene.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

constexpr std::uint64_t kPathScenes = 40; // most of the time goes into compiling their kernels

test::PathShape random_shape(std::uint64_t seed, double width) {
    std::mt19937_64 random(seed);
    const auto one_of = [&](std::uint64_t n) { return static_cast<layout::uint>(random() % n); };
    test::PathShape shape;
    shape.seed = seed;
    shape.features.motion = one_of(8);
    shape.features.loop = one_of(2);
    shape.features.follow = shape.features.motion == layout::kMotionRecorded ? 0 : one_of(2);
    shape.features.harmonics = shape.features.motion == layout::kMotionRecorded ? 0 : one_of(4);
    shape.features.channels = one_of(4) == 0 ? 0 : test::kAllPathChannels & (1 + one_of(63));
    shape.paths = 1 + one_of(90);
    shape.steps = 1 + one_of(300);
    shape.reach = 0.6 * width;
    shape.depth = width / (2 + one_of(100));
    shape.coulomb = one_of(2) ? 0.02 * one_of(10) : 0;
    shape.quantum = one_of(2) ? 1e-6 * (1 + one_of(100)) : 0;
    shape.max_force = one_of(2) ? 8.5 : 0.1 * (1 + one_of(10));
    shape.gain = one_of(3) ? 1 : -0.5;
    shape.grip = one_of(2) ? 500 : 0;
    shape.bound = one_of(2) ? 10 * width : 0.02 * width;
    shape.delay = one_of(2);
    shape.own_hands = one_of(2);
    return shape;
}

template <typename T> void hold_all() {
    compute::Device device = test::open_software_device(test::has_validation_layer());
    compute::PathKernel kernel(device);
    for (std::uint64_t seed = 1; seed <= kPathScenes; ++seed) {
        const PreparedCase prepared =
            test::random_scene(seed, seed % 2 ? test::Conditioning::moderate : test::Conditioning::anything);
        const Scene& scene = prepared.one.scene;
        const test::PathShape shape = random_shape(seed, scene.surface.width);
        test::PathCase<T> one(scene, shape, prepared.images);
        const test::PathComparison comparison = test::hold_paths(kernel, one);
        ASSERT_TRUE(is_equal(comparison)) << "seed " << seed << ", motion " << shape.features.motion << ", loop "
                                          << shape.features.loop << ", f" << 8 * sizeof(T) << "\n"
                                          << prepared.scene;
        EXPECT_EQ(comparison.not_finite, 0u) << "seed " << seed;
    }
    for (const std::string& message : device.validation_messages())
        ADD_FAILURE() << message;
}

TEST(PathRandom, EqualsTheOracle) {
    test::has_validation_layer();
    const std::jthread single(hold_all<float>);
    hold_all<double>();
}

} // namespace
} // namespace forceshade
