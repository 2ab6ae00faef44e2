// Short of memory: smaller chunks while they fit, a clear error once nothing does. The software device's memory is the
// process's, so that a limit on the address space makes it short.
#include <fstream>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kOwnsAddressSpace = false; // sanitizers map terabytes
#else
constexpr bool kOwnsAddressSpace = true;
#endif

// While it lives, the process may take `more` bytes of address space and no further.
class AddressSpaceLimit {
public:
    explicit AddressSpaceLimit(std::size_t more) {
        std::ifstream status("/proc/self/statm");
        std::size_t pages = 0;
        status >> pages;
        getrlimit(RLIMIT_AS, &before_);
        rlimit limit = before_;
        limit.rlim_cur = pages * 4096 + more;
        setrlimit(RLIMIT_AS, &limit);
    }
    ~AddressSpaceLimit() { setrlimit(RLIMIT_AS, &before_); }
    AddressSpaceLimit(const AddressSpaceLimit&) = delete;
    AddressSpaceLimit& operator=(const AddressSpaceLimit&) = delete;

private:
    rlimit before_{};
};

class Memory : public test::SoftwareDeviceTest {
protected:
    void SetUp() override {
        if (!kOwnsAddressSpace)
            GTEST_SKIP() << "sanitizers take the address space that this test limits";
        if (!on_llvmpipe())
            GTEST_SKIP() << "the limit is one of llvmpipe's memory";
    }

    static constexpr std::size_t kMebibyte = std::size_t(1) << 20;

    static compute::KernelOptions options() {
        compute::KernelOptions options;
        options.chunk_bytes = options.software_chunk_bytes = 128 * kMebibyte;
        return options;
    }

    static Scene scene_of(std::array<std::uint64_t, 3> size) {
        Scene scene;
        scene.output.channels = test::kAllChannels;
        scene.grid.size = size;
        scene.grid.spacing = {1e-6, 1e-6, 1e-6};
        return scene;
    }

    // The driver's compiler ends the program where it finds no memory: pipelines come first.
    static void compile(compute::FieldKernel& kernel) {
        const FieldTables<double> tables = make_tables<double>(scene_of({8, 1, 1}), {}, Extent::everything);
        kernel.evaluate<double>(tables.input(), [](const layout::FieldChunk<double>&) {});
    }
};

// 84 MiB of results, where there is memory for two chunks of 42 MiB, or three of 28: what a larger one took is given
// back.
TEST_F(Memory, ChunksAreHalvedWhileItIsShort) {
    const FieldTables<double> tables = make_tables<double>(scene_of({256, 64, 64}), {}, Extent::everything);
    compute::FieldKernel kernel(device(), options());
    compile(kernel);
    std::vector<double> forces(3 * tables.x.size() * tables.y.size() * tables.z.size());
    std::size_t at = 0;
    const auto keep = [&](const layout::FieldChunk<double>& chunk) {
        std::copy(chunk.force.begin(), chunk.force.end(), forces.begin() + static_cast<std::ptrdiff_t>(at));
        at += chunk.force.size();
    };
    compute::FieldTimes times;
    {
        const AddressSpaceLimit limit(110 * kMebibyte);
        times = kernel.evaluate<double>(tables.input(), keep);
    }
    EXPECT_GT(times.dispatches, 1u);
    EXPECT_LT(times.dispatches, 16u) << "64 where buffers are kept";
    // With memory enough it is one chunk, and the same bytes.
    compute::FieldKernel unlimited(device(), options());
    times = unlimited.evaluate<double>(tables.input(), [&](const layout::FieldChunk<double>& chunk) {
        ASSERT_EQ(chunk.force.size(), forces.size());
        EXPECT_EQ(std::memcmp(chunk.force.data(), forces.data(), chunk.force.size_bytes()), 0);
    });
    EXPECT_EQ(times.dispatches, 1u);
}

// A row of 336 MB cannot be halved, nor does memory that others have freed hold it.
TEST_F(Memory, WhereNothingFitsTheErrorIsClear) {
    const FieldTables<double> tables = make_tables<double>(scene_of({4000000, 1, 1}), {}, Extent::everything);
    compute::FieldKernel kernel(device(), options());
    compile(kernel);
    std::string message;
    {
        const AddressSpaceLimit limit(64 * kMebibyte);
        message = test::device_error(compute::DeviceError::Kind::out_of_memory, [&] {
            kernel.evaluate<double>(tables.input(), [](const layout::FieldChunk<double>&) {});
        });
    }
    EXPECT_NE(message.find("out of device memory while allocating a buffer of"), std::string::npos) << message;
    // With memory again the same kernel serves.
    EXPECT_TRUE(is_equal(test::hold_field(kernel, tables.input())));
}

} // namespace
} // namespace forceshade
