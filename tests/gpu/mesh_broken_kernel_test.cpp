// Mesh kernels broken on purpose: the comparison with the oracle must catch every one of them, or it holds nothing.
#include <algorithm>

#include <gtest/gtest.h>

#include "host/mesh/block_plan.h"
#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/mesh_case.h"

namespace forceshade {
namespace {

using test::Break;

template <typename T> test::BitComparison held(Break broken) {
    test::choose_break(broken);
    compute::Device device = test::open_software_device(false);
    compute::MeshKernel kernel(device);
    // A dented sphere for edges, tetrahedra twice for ties (turned over, or they would count once), on samples that are
    // not symmetric to them.
    const PolygonSoup some = shapes::random_polyhedra(20, 7);
    PolygonSoup over = some;
    std::reverse(over.corners.begin(), over.corners.end());
    const PolygonSoup dented = shapes::nested_shells(1, true);
    const MeshStructure structure =
        build_structure(shapes::mesh_of(shapes::merged(dented, shapes::merged(some, over))));
    const test::MeshCase<T> mesh_case(structure, {{33, 34, 35}, glm::dvec3(-1.03), glm::dvec3(1.05)},
                                      layout::kShadingMeanValue);
    layout::FieldInput<T> input = mesh_case.input();
    const BlockPlan plan = plan_blocks<T>(input.law.mesh, input.x, input.y, input.z, layout::kInsidePseudonormal);
    input.plan = plan.view();
    return test::hold_against_oracle<T>(kernel, input);
}

class MeshBrokenKernel : public ::testing::TestWithParam<std::pair<const char*, Break>> {};

TEST_P(MeshBrokenKernel, IsCaught) {
    EXPECT_TRUE(is_equal(held<float>(Break::none)));
    EXPECT_TRUE(is_equal(held<double>(Break::none)));
    EXPECT_GT(held<float>(GetParam().second).differing, 0u);
    EXPECT_GT(held<double>(GetParam().second).differing, 0u);
}

INSTANTIATE_TEST_SUITE_P(Breaks, MeshBrokenKernel,
                         ::testing::Values(std::pair{"tie", Break::tie}, std::pair{"outward", Break::outward},
                                           std::pair{"tangent", Break::tangent},
                                           std::pair{"imprecise", Break::imprecise}),
                         [](const auto& parameter) { return std::string(parameter.param.first); });

} // namespace
} // namespace forceshade
