// Kernels of paths on meshes broken on purpose: the comparison with the oracle must catch every one of them, or it
// holds nothing.
#include <algorithm>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/mesh_path_case.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::Break;

/// Samples that differ on paths that wander over every terrain; in pits a triangle left too early leads elsewhere.
template <typename T> std::uint64_t differing(Break broken) {
    test::choose_break(broken);
    compute::Device device = test::open_software_device(false);
    compute::MeshPathKernel kernel(device);
    std::uint64_t differing = 0;
    std::vector<walks::Terrain> terrains = walks::terrains();
    std::ranges::copy(walks::pits(), std::back_inserter(terrains));
    for (const walks::Terrain& terrain : terrains) {
        test::PathShape shape;
        shape.features.motion = layout::kMotionRecorded;
        shape.features.channels = test::kAllPathChannels;
        shape.paths = 24;
        shape.steps = 100;
        test::MeshPathCase<T> one(build_structure(shapes::mesh_of(terrain.polygons)), shape, test::Probes::wandering,
                                  terrain.focus);
        one.law.features.shading = layout::kShadingBarycentric;
        test::MeshPathRunner runner{kernel};
        const test::PathComparison comparison =
            test::hold_input(runner, one.input(), [&](std::size_t path) { return one.length(path); });
        differing += comparison.differing + comparison.differing_metrics;
    }
    return differing;
}

/// The same on a path that goes round the rim of an open sheet and presses it from behind.
template <typename T> std::uint64_t differing_behind(Break broken) {
    test::choose_break(broken);
    compute::Device device = test::open_software_device(false);
    compute::MeshPathKernel kernel(device);
    test::PathShape shape;
    shape.features.motion = layout::kMotionRecorded;
    shape.features.channels = test::kAllPathChannels;
    shape.own_lengths = false;
    shape.paths = 1;
    shape.steps = 4;
    PolygonSoup sheet;
    sheet.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    sheet.corners = {0, 1, 2};
    sheet.begins = {0, 3};
    test::MeshPathCase<T> one(build_structure(shapes::mesh_of(sheet)), shape);
    const T places[4][3] = {{3, 0, 1}, {3, 0, -1}, {0, 0, T(-0.5)}, {T(0.1), 0, T(0.25)}};
    for (std::size_t step = 0; step < 4; ++step)
        one.place(step, 0, {places[step][0], places[step][1], places[step][2]});
    test::MeshPathRunner runner{kernel};
    const test::PathComparison comparison =
        test::hold_input(runner, one.input(), [](std::size_t) { return std::size_t(4); });
    EXPECT_EQ(comparison.touching, 1u);
    return comparison.differing;
}

class MeshPathBrokenKernel : public ::testing::TestWithParam<std::pair<const char*, Break>> {};

TEST_P(MeshPathBrokenKernel, IsCaught) {
    EXPECT_GT(differing<float>(GetParam().second), 0u); // of the same text as those in double precision
}

TEST(MeshPathBrokenKernel, ThatIsWholeIsNot) {
    EXPECT_EQ(differing<float>(Break::none), 0u);
    EXPECT_EQ(differing<double>(Break::none), 0u);
}

TEST(MeshPathBrokenKernel, SeesWhatIsHeldFromBehind) {
    EXPECT_EQ(differing_behind<float>(Break::none), 0u);
    EXPECT_EQ(differing_behind<double>(Break::none), 0u);
    EXPECT_GT(differing_behind<float>(Break::behind), 0u);
    EXPECT_GT(differing_behind<double>(Break::behind), 0u);
}

INSTANTIATE_TEST_SUITE_P(Breaks, MeshPathBrokenKernel,
                         ::testing::Values(std::pair{"tunnel", Break::tunnel}, std::pair{"slip", Break::slip},
                                           std::pair{"imprecise", Break::imprecise}),
                         [](const auto& parameter) { return std::string(parameter.param.first); });

} // namespace
} // namespace forceshade
