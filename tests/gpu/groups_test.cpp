// Sizes of work groups, tried out by the dispatches of real work.
#include "compute/groups.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/gpu/software_device.h"
#include "tests/unit/laws.h"

namespace forceshade {
namespace {

using compute::GroupSizes;
using compute::kGroups;

constexpr std::uint64_t kKernel = 7, kOther = 8;
constexpr double kEver = INFINITY;

// Dispatches of `work` until the size stays, on a device on which `best` is fastest; the last one's size.
std::uint32_t settle(GroupSizes& sizes, std::uint32_t best, std::uint64_t work = 1000) {
    std::uint32_t size = 0;
    for (int i = 0; i < 100; ++i) {
        size = sizes.next(kKernel, 64);
        const double slowness = 1 + std::abs(std::log2(double(size) / double(best)));
        sizes.add(kKernel, size, work, 1e-3 * slowness * (1 + 0.1 * (i % 3)));
    }
    return size;
}

TEST(GroupSizes, TheFastestStays) {
    for (const std::uint32_t best : kGroups) {
        GroupSizes sizes(1024, 0, {});
        EXPECT_EQ(settle(sizes, best), best);
        EXPECT_EQ(sizes.usual(kKernel, 64), best);
        EXPECT_EQ(sizes.usual(kOther, 64), 64u) << "each kernel has its own";
        const GroupSizes later(1024, kEver, sizes.kept());
        EXPECT_EQ(later.usual(kKernel, 64), best) << "kept for a later run";
    }
}

TEST(GroupSizes, NoneIsTriedWhereItMattersNot) {
    GroupSizes never(1024, kEver, {}), late(1024, 0.5, {}), one(32, 0, {});
    for (int i = 0; i < 400; ++i) {
        EXPECT_EQ(never.next(kKernel, 64), 64u);
        never.add(kKernel, 64, 1, 1);
        EXPECT_EQ(one.next(kKernel, 64), 32u) << "the device has no other";
        one.add(kKernel, 32, 1, 1);
        EXPECT_EQ(late.next(kKernel, 64), 64u) << "0.4 s in all";
        late.add(kKernel, 64, 1, 1e-3);
    }
    settle(late, 256);
    EXPECT_EQ(settle(late, 256), 256u);
    EXPECT_TRUE(never.kept().empty() && one.kept().empty());
}

TEST(GroupSizes, ADeviceTakesNoneThatItLacks) {
    GroupSizes sizes(128, 0, {});
    EXPECT_EQ(settle(sizes, 256), 128u);
    GroupSizes large(1024, 0, {});
    settle(large, 256);
    EXPECT_EQ(GroupSizes(128, 0, large.kept()).usual(kKernel, 64), 64u) << "found on another device";
    std::vector<std::byte> damaged = large.kept();
    damaged[8] = std::byte{3};
    EXPECT_EQ(GroupSizes(1024, 0, damaged).usual(kKernel, 64), 64u);
    EXPECT_EQ(GroupSizes(1024, 0, std::span(damaged).first(10)).usual(kKernel, 64), 64u);
}

// Small dispatches are slow for other reasons.
TEST(GroupSizes, DispatchesOfLittleWorkSayNothing) {
    GroupSizes sizes(1024, 0, {});
    for (int i = 0; i < 100; ++i) {
        const std::uint32_t size = sizes.next(kKernel, 64);
        const bool small = i % 3 == 0;
        const double unit = small ? (size == 32 ? 1e-9 : 1) : size == 128 ? 1e-6 : 2e-6;
        sizes.add(kKernel, size, small ? 10 : 1000, unit * (small ? 10 : 1000));
    }
    EXPECT_EQ(sizes.usual(kKernel, 64), 128u);
}

// On the device: bits stay while sizes change from dispatch to dispatch, and what was found serves a later run.
TEST(GroupSizes, LeaveTheBits) {
    const auto open = [](std::span<const std::byte> cache) {
        compute::DeviceOptions options;
        options.wanted = test::tested_gpu();
        options.try_groups_after = 0;
        options.try_groups_on_software = true;
        options.cache = cache;
        return compute::Device(options);
    };
    Scene scene = test::bump(test::kRadii[0], 5, Shading::reference);
    scene.output.channels = test::kAllChannels;
    scene.grid.size = {65, 40, 50};
    scene.grid.origin = {-0.015, -0.002, -0.004};
    scene.grid.spacing = {0.0005, 0.0001, 0.0001};
    const FieldTables<float> tables = make_tables<float>(scene, {}, Extent::everything);
    compute::Device device = open({});
    compute::KernelOptions options;
    options.chunk_bytes = options.software_chunk_bytes = 200'000;
    compute::FieldKernel kernel(device, options);
    EXPECT_TRUE(is_equal(test::hold_field(kernel, tables.input())));
    const auto group_on = [&](compute::Device& on) {
        compute::FieldKernel again(on, options);
        return again.evaluate<float>(tables.input(), [](const layout::FieldChunk<float>&) {}).group;
    };
    const std::uint32_t found = group_on(device);
    EXPECT_EQ(group_on(device), found) << "it stays";
    const std::vector<std::byte> kept = device.cache();
    compute::Device later = open(kept);
    EXPECT_EQ(group_on(later), found);
}

} // namespace
} // namespace forceshade
