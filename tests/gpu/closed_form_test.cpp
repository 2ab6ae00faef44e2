// Random scenes of moderate conditioning against referees that share nothing with the kernel: the closed forms in
// extended precision, and the oracle in double; within the bound derived for each law.
#include <gtest/gtest.h>

#include "host/validate/validate.h"
#include "tests/gpu/random_scene.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

constexpr std::uint64_t kScenes = 100;

class ClosedForm : public ::testing::TestWithParam<Precision> {};

TEST_P(ClosedForm, HoldsWithinTheBound) {
    EngineOptions options;
    options.gpu = "llvmpipe";
    options.needs_f64 = true;
    options.validation = test::has_validation_layer();
    const auto engine = make_engine(options);
    double largest = 0; // relative error against the closed form
    std::uint64_t voxels = 0, boundary = 0;
    for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
        const PreparedCase prepared = test::random_scene(seed, test::Conditioning::moderate);
        const Comparison comparison = compare_case(*engine, prepared, GetParam());
        EXPECT_TRUE(comparison.passed) << "seed " << seed << ": " << comparison.beyond << " beyond, "
                                       << comparison.oracle.unexplained << " unexplained by the oracle, "
                                       << comparison.closed_form.unexplained << " by the closed form; "
                                       << comparison.first_difference << "\n"
                                       << prepared.scene;
        voxels += comparison.voxels;
        boundary += comparison.closed_form.boundary;
        largest = std::max(largest, comparison.relative(comparison.closed_form));
    }
    EXPECT_EQ(voxels, kScenes * 64 * 16 * 32);
    // A voxel that falls to the other side of an edge is the exception.
    EXPECT_LT(boundary, voxels / 20);
    RecordProperty("boundary_voxels", std::to_string(boundary));
    fmt::print("{} voxels, {} on boundaries, largest error {:.3g} of the largest force\n", voxels, boundary, largest);
}

INSTANTIATE_TEST_SUITE_P(Precisions, ClosedForm, ::testing::Values(Precision::f32, Precision::f64),
                         [](const auto& parameter) { return parameter.param == Precision::f32 ? "f32" : "f64"; });

} // namespace
} // namespace forceshade
