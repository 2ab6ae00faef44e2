// Every case of the paper's study, every voxel and every channel: the kernel's bits are the oracle's.
#include <gtest/gtest.h>

#include "host/scene/study.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::kAllChannels;

class BitEquality : public test::SoftwareDeviceTest {
protected:
    template <typename T> static void hold_all(const compute::FieldKernelOptions& options, std::size_t every) {
        compute::FieldKernel kernel(device(), options);
        const Study study = default_study();
        ASSERT_EQ(study.cases.size(), 51u);
        for (std::size_t i = 0; i < study.cases.size(); i += every) {
            Scene scene = study.cases[i].scene;
            scene.output.channels = kAllChannels;
            const FieldTables<T> tables = make_tables<T>(scene, {}, Extent::everything);
            const test::BitComparison comparison = test::hold_against_oracle(kernel, tables.input());
            EXPECT_TRUE(is_equal(comparison)) << study.cases[i].name;
            EXPECT_EQ(comparison.voxels, 256u * 64 * 128);
        }
    }

    // Chunks that stay in the caches are compared faster.
    static compute::FieldKernelOptions options(bool packed) {
        compute::FieldKernelOptions options;
        options.chunk_bytes = std::size_t(4) << 20;
        options.packed_stores = packed;
        return options;
    }
};

TEST_F(BitEquality, SinglePrecisionEveryCase) {
    hold_all<float>(options(true), 1);
}

TEST_F(BitEquality, SinglePrecisionWithoutPackedStores) {
    hold_all<float>(options(false), 5);
}

TEST_F(BitEquality, DoublePrecisionEveryCase) {
    hold_all<double>(options(true), 1);
}

} // namespace
} // namespace forceshade
