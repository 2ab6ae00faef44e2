// Mesa's software driver ends loops after 65 535 iterations of an invocation and says nothing. The kernel must notice.
#include <gtest/gtest.h>

#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

class LoopLimit : public test::SoftwareDeviceTest {
protected:
    static constexpr std::uint64_t kRows = 100000;

    // A column of samples, all of which one invocation takes where `rows` says so.
    template <typename T> static compute::FieldTimes evaluate(std::uint32_t rows, const Scene& scene) {
        compute::FieldKernelOptions options;
        options.rows = rows;
        options.chunk_bytes = options.software_chunk_bytes = std::size_t(64) << 20;
        compute::FieldKernel kernel(device(), options);
        const FieldTables<T> tables = make_tables<T>(scene, {}, Extent::everything);
        compute::FieldTimes times;
        test::BitComparer<T> comparer(tables.input());
        times = kernel.evaluate<T>(tables.input(), [&](const layout::FieldChunk<T>& chunk) { comparer.add(chunk); });
        EXPECT_TRUE(is_equal(comparer.result()));
        return times;
    }

    static Scene column(bool varies_in_y) {
        Scene scene;
        scene.grid.size = {1, 1, kRows};
        scene.grid.spacing = {1e-3, 1e-3, 2e-7};
        if (varies_in_y) {
            scene.surface.kind = SurfaceKind::height_map;
            scene.force.shading = Shading::height_map;
            scene.surface.map.function = MapFunction::gaussian;
        }
        return scene;
    }

    template <typename T> static void expect_unfinished(const Scene& scene) {
        try {
            evaluate<T>(kRows, scene);
            FAIL() << "the driver no longer ends loops: this test needs another shape";
        } catch (const compute::DeviceError& error) {
            EXPECT_EQ(error.kind(), compute::DeviceError::Kind::unfinished) << error.what();
        }
        EXPECT_EQ(evaluate<T>(0, scene).dispatches, 1u); // and the kernel's own choice ends in time
    }
};

TEST_F(LoopLimit, IsNoticedInSinglePrecision) {
    expect_unfinished<float>(column(false));
    expect_unfinished<float>(column(true));
}

TEST_F(LoopLimit, IsNoticedInDoublePrecision) {
    expect_unfinished<double>(column(false));
    expect_unfinished<double>(column(true));
}

// The same kernel object serves on.
TEST_F(LoopLimit, LeavesTheKernelUsable) {
    compute::FieldKernelOptions options;
    options.rows = kRows;
    compute::FieldKernel kernel(device(), options);
    const auto never = [](const layout::FieldChunk<float>&) {};
    const FieldTables<float> bad = make_tables<float>(column(false), {}, Extent::everything);
    EXPECT_THROW(kernel.evaluate<float>(bad.input(), never), compute::DeviceError);
    const FieldTables<float> good = make_tables<float>(Scene{}, {}, Extent::what_varies);
    EXPECT_TRUE(is_equal(test::hold_against_oracle(kernel, good.input())));
}

} // namespace
} // namespace forceshade
