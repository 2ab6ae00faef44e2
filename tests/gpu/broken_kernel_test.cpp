// Kernels broken on purpose: the comparisons that hold the program's kernel must catch every one of them, or they hold
// nothing.
#include <gtest/gtest.h>

#include "host/referee/validate.h"
#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::Break;

// Scenes that show the breaks. Facets begin exactly on samples: 0.5 mm apart, every fourth a vertex.
PreparedCase prepared(const std::string& surface, const std::string& shading) {
    PreparedCase prepared;
    prepared.scene = "surface = {" + surface + "}\nforce = {stiffness = \"1 N/mm\", shading = \"" + shading + "\"}\n" +
                     R"([grid]
size = [81, 3, 33]
origin = ["-20 mm", "0.3 mm", "-10 mm"]
spacing = "0.5 mm"
[output]
channels = ["force", "depth", "facet", "proxy", "unshaded"]
)";
    prepared.one = parse_scene(prepared.scene, "broken kernel");
    return prepared;
}

PreparedCase facets() {
    return prepared(R"(kind = "bump", width = "32 mm", radius = "20 mm", facets = 16, facet_spacing = "equal_x")",
                    "reference");
}
PreparedCase cylinder() {
    return prepared(R"(kind = "cylinder_bump", width = "32 mm", radius = "20 mm")", "none");
}
PreparedCase gaussian() {
    return prepared(R"(kind = "height_map", function = "gaussian", radius = "10 mm", height = "5 mm")", "height_map");
}

Comparison validate(Break broken, const PreparedCase& prepared, Precision precision) {
    test::choose_break(broken);
    EngineOptions options;
    options.gpu = "llvmpipe";
    options.needs_f64 = true;
    options.validation = test::has_validation_layer();
    return compare_case(*make_engine(options), prepared, precision);
}

struct Broken {
    const char* name;
    Break which;
    PreparedCase (*scene)();
    bool beyond_bound; // caught by the referees as well, not only by the bits
};

class BrokenKernel : public ::testing::TestWithParam<std::tuple<Broken, Precision>> {};

TEST_P(BrokenKernel, IsCaught) {
    const auto& [broken, precision] = GetParam();
    const PreparedCase scene = broken.scene();
    const Comparison intact = validate(Break::none, scene, precision);
    EXPECT_TRUE(intact.passed) << intact.first_difference;
    EXPECT_EQ(intact.differing, 0u);
    const Comparison caught = validate(broken.which, scene, precision);
    EXPECT_GT(caught.differing, 0u);
    EXPECT_EQ(caught.oracle.unexplained + caught.closed_form.unexplained > 0, broken.beyond_bound);
    EXPECT_FALSE(caught.passed);
    EXPECT_FALSE(caught.first_difference.empty());
}

// The same kernels against the bits alone, packed and not.
TEST_P(BrokenKernel, IsCaughtByTheBits) {
    const auto& [broken, precision] = GetParam();
    const Scene scene = broken.scene().one.scene;
    for (const bool packed : {true, false})
        for (const Break which : {Break::none, broken.which}) {
            test::choose_break(which);
            compute::Device device = test::open_software_device(false);
            compute::FieldKernelOptions options;
            options.packed_stores = packed;
            compute::FieldKernel kernel(device, options);
            const auto hold = [&](const auto& tables) { return test::hold_against_oracle(kernel, tables.input()); };
            const test::BitComparison comparison = precision == Precision::f32
                                                       ? hold(make_tables<float>(scene, {}, Extent::everything))
                                                       : hold(make_tables<double>(scene, {}, Extent::everything));
            EXPECT_EQ(comparison.equal(), which == Break::none) << (packed ? "packed" : "not packed");
        }
}

INSTANTIATE_TEST_SUITE_P(Breaks, BrokenKernel,
                         ::testing::Combine(::testing::Values(Broken{"sign", Break::sign, facets, true},
                                                              Broken{"component", Break::component, cylinder, true},
                                                              Broken{"edge", Break::edge, facets, false},
                                                              Broken{"channel", Break::channel, facets, true},
                                                              Broken{"imprecise", Break::imprecise, gaussian, false}),
                                            ::testing::Values(Precision::f32, Precision::f64)),
                         [](const auto& parameter) {
                             return std::string(std::get<0>(parameter.param).name) +
                                    (std::get<1>(parameter.param) == Precision::f32 ? "_f32" : "_f64");
                         });

} // namespace
} // namespace forceshade
