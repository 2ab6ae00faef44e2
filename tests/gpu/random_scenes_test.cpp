// A thousand random scenes in both precisions: the kernel's bits are the oracle's, and no number is NaN or infinite.
#include <thread>

#include <gtest/gtest.h>

#include "tests/gpu/random_scene.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

constexpr std::uint64_t kScenes = 1000;

// Every eighth scene is stored real by real instead of in pairs.
class Kernels {
public:
    Kernels()
        : device_(test::open_software_device(test::has_validation_layer())), packed_(device_, options(true)),
          unpacked_(device_, options(false)) {}

    compute::FieldKernel& of(std::uint64_t seed) { return seed % 8 ? packed_ : unpacked_; }
    std::vector<std::string> messages() const { return device_.validation_messages(); }

private:
    static compute::FieldKernelOptions options(bool packed) {
        compute::FieldKernelOptions options;
        options.packed_stores = packed;
        return options;
    }

    compute::Device device_;
    compute::FieldKernel packed_, unpacked_;
};

// Stops at the first scene that differs: its seed and text say enough.
template <typename T> void hold_all() {
    Kernels kernels;
    for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
        const PreparedCase prepared = test::random_scene(seed, test::Conditioning::anything);
        const FieldTables<T> tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::everything);
        const test::BitComparison comparison = test::hold_against_oracle(kernels.of(seed), tables.input());
        ASSERT_TRUE(is_equal(comparison)) << "seed " << seed << ", f" << 8 * sizeof(T) << "\n" << prepared.scene;
        ASSERT_EQ(comparison.voxels, 64u * 16 * 32);
    }
    for (const std::string& message : kernels.messages())
        ADD_FAILURE() << message;
}

// Most of the time goes into compiling hundreds of pipelines, one after the other on a device: one thread a precision.
TEST(RandomScenes, EqualTheOracle) {
    test::has_validation_layer();
    const std::jthread single(hold_all<float>);
    hold_all<double>();
}

} // namespace
} // namespace forceshade
