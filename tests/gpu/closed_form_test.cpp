// Random scenes, moderate and extreme, against referees that share nothing with the kernel: the closed forms in
// extended precision, and the oracle in double; within the bound derived for each law.
#include <gtest/gtest.h>

#include "host/referee/validate.h"
#include "tests/gpu/random_scene.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

constexpr std::uint64_t kClosedFormScenes = 100;
constexpr std::uint32_t kMostFacets = 10000; // the closed forms loop over all of them

class ClosedForm : public ::testing::TestWithParam<std::tuple<test::Conditioning, Precision>> {};

TEST_P(ClosedForm, HoldsWithinTheBound) {
    const auto [conditioning, precision] = GetParam();
    EngineOptions options;
    options.gpu = "llvmpipe";
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
    // A voxel that falls to the other side of an edge is the exception.
    EXPECT_LT(boundary, voxels / 20);
    RecordProperty("boundary_voxels", std::to_string(boundary));
    fmt::print("{} voxels, {} on boundaries, largest error {:.3g} of the largest force\n", voxels, boundary, largest);
}

std::string name_of(const ::testing::TestParamInfo<ClosedForm::ParamType>& info) {
    const bool moderate = std::get<0>(info.param) == test::Conditioning::moderate;
    const bool single = std::get<1>(info.param) == Precision::f32;
    return std::string(moderate ? "moderate" : "anything") + (single ? "_f32" : "_f64");
}

INSTANTIATE_TEST_SUITE_P(Scenes, ClosedForm,
                         ::testing::Combine(::testing::Values(test::Conditioning::moderate,
                                                              test::Conditioning::anything),
                                            ::testing::Values(Precision::f32, Precision::f64)),
                         name_of);

} // namespace
} // namespace forceshade
