// The paths that scenes describe, of every kind, on the device: samples and metrics have the oracle's bits.
#include <gtest/gtest.h>

#include "host/paths/scene_paths.h"
#include "tests/gpu/path_comparison.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

class PathScene : public test::SoftwareDeviceTest {
protected:
    template <typename T> static void hold(const std::string& kind, const std::string& drive) {
        static compute::PathKernel kernel(device());
        PreparedCase prepared;
        prepared.scene = R"(surface = {kind = "bump", facets = 3}
force = {stiffness = "500 N/m", shading = "reference"}
output = {channels = ["force", "depth", "facet", "proxy"]}
[paths]
count = 100
steps = 400
)" + std::string("kind = \"") +
                         kind + "\"\n" + drive + "\n";
        prepared.one = parse_scene(prepared.scene, kind);
        ScenePaths<T> paths(prepared);
        const layout::PathInput<T> input = paths.input();
        const test::PathComparison comparison =
            test::hold_input(kernel, input, [&](std::size_t) { return input.steps; });
        EXPECT_TRUE(is_equal(comparison)) << prepared.scene;
        EXPECT_EQ(comparison.paths, 100u);
        EXPECT_GT(comparison.touching, 0u) << prepared.scene;
        EXPECT_EQ(comparison.not_finite, 0u);
    }
};

TEST_F(PathScene, EveryKindOpenAndClosed) {
    const std::string tremor = "tremor = {amplitude = \"0.05 mm\", frequency = \"8 Hz\"}\n";
    for (const std::string kind : {"strokes", "raster", "circle", "spiral", "taps", "random_walk", "minimum_jerk"})
        for (const char* drive : {"depth = \"1 mm\"", "depth = \"1 mm\"\nloop = \"closed\""})
            hold<float>(kind, (kind == "random_walk" ? "" : tremor) + drive);
    hold<double>("strokes", "press = \"1 N\"");
}

} // namespace
} // namespace forceshade
