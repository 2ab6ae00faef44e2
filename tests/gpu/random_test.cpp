// Random scenes, and random paths over random scenes with hands of every kind: the kernel's bits are the oracle's, no
// number is NaN; and fields are within the bound derived for each law of referees that share nothing with the kernel:
// the closed forms in extended precision, and the oracle in double.
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "host/referee/validate.h"
#include "tests/gpu/random_scene.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::Conditioning;

constexpr std::uint64_t kScenes = 300;
constexpr std::uint64_t kPathScenes = 40;
constexpr std::uint64_t kClosedFormScenes = 50;
constexpr std::uint32_t kMostFacets = 10000; // the closed forms loop over all of them

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
    shape.coupled = one_of(2);
    return shape;
}

// Stops at the first scene that differs: its seed and text say enough. Every eighth field is stored real by real. Most
// of the time goes into compiling kernels: the first three fifths of the scenes in single precision, the others in
// double.
template <typename T> void hold_all(bool paths) {
    compute::Device device = test::open_software_device(test::has_validation_layer());
    test::Kernels kernels(device);
    const std::uint64_t all = paths ? kPathScenes : kScenes, singles = all * 3 / 5;
    const bool single = std::is_same_v<T, float>;
    for (std::uint64_t seed = single ? 1 : singles + 1; seed <= (single ? singles : all); ++seed) {
        const PreparedCase prepared =
            test::random_scene(seed, paths && seed % 2 ? Conditioning::moderate : Conditioning::anything);
        test::Row row{
            .name = "random", .ground = [&] { return test::Ground{prepared}; }, .ways = {{.packed = seed % 8 != 0}}};
        if (paths) {
            row.shape = random_shape(seed, prepared.one.scene.surface.width);
            row.ways = {{}};
        }
        const test::Held held = kernels.hold<T>(row).front();
        ASSERT_TRUE(is_equal(held)) << "seed " << seed << ", f" << 8 * sizeof(T) << "\n" << prepared.scene;
        ASSERT_EQ(held.not_finite, 0u) << "seed " << seed;
        ASSERT_TRUE(paths || held.samples == 64u * 16 * 32);
    }
    for (const std::string& message : device.validation_messages())
        ADD_FAILURE() << message;
}

// Most of the time goes into compiling hundreds of pipelines, one after the other on a device: one thread a precision.
void hold_both(bool paths) {
    test::has_validation_layer();
    const std::jthread single(hold_all<float>, paths);
    hold_all<double>(paths);
}

TEST(RandomScenes, HaveTheOraclesBits) {
    hold_both(false);
}

TEST(RandomPaths, HaveTheOraclesBits) {
    hold_both(true);
}

class ClosedForm : public ::testing::TestWithParam<std::tuple<Conditioning, Precision>> {};

TEST_P(ClosedForm, HoldsWithinTheBound) {
    const auto [conditioning, precision] = GetParam();
    EngineOptions options;
    options.gpu = test::tested_gpu();
    options.needs_f64 = true;
    options.validation = test::has_validation_layer();
    const auto engine = make_engine(options);
    double largest = 0; // relative error against the closed form
    std::uint64_t voxels = 0, boundary = 0;
    for (std::uint64_t seed = 1; seed <= kClosedFormScenes; ++seed) {
        const PreparedCase prepared = test::random_scene(seed, conditioning);
        if (prepared.one.scene.surface.facets > kMostFacets)
            continue;
        const Comparison comparison = compare_case(*engine, prepared, precision);
        EXPECT_TRUE(comparison.passed) << "seed " << seed << ": " << comparison.beyond << " beyond, "
                                       << comparison.oracle.unexplained << " unexplained by the oracle, "
                                       << comparison.closed_form.unexplained << " by the closed form; "
                                       << comparison.first_difference << "\n"
                                       << prepared.scene;
        voxels += comparison.voxels;
        boundary += comparison.closed_form.boundary;
        largest = std::max(largest, comparison.relative(comparison.closed_form));
    }
    EXPECT_GE(voxels, kClosedFormScenes * 3 / 4 * 64 * 16 * 32);
    EXPECT_LT(boundary, voxels / 20); // a voxel that falls to the other side of an edge is the exception
    fmt::print("{} voxels, {} on boundaries, largest error {:.3g} of the largest force\n", voxels, boundary, largest);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ClosedForm,
                         ::testing::Combine(::testing::Values(Conditioning::moderate, Conditioning::anything),
                                            ::testing::Values(Precision::f32, Precision::f64)),
                         [](const auto& of) {
                             const bool moderate = std::get<0>(of.param) == Conditioning::moderate;
                             return fmt::format("{}_{}", moderate ? "moderate" : "anything",
                                                name_of(std::get<1>(of.param)));
                         });

} // namespace
} // namespace forceshade
