// How a grid is cut into dispatches: for any grid and any device, every row once and every limit kept.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "compute/plan.h"
#include "tests/gpu/software_device.h"
#include "tests/io/folder.h"

namespace forceshade::compute {
namespace {

using std::uint64_t;

// Far below the 65 535 iterations after which software drivers end loops.
constexpr std::uint32_t kMostIterations = 30000;

template <typename Choice> uint64_t one_of(std::initializer_list<Choice> choices) {
    return static_cast<uint64_t>(*rc::gen::elementOf(std::vector<Choice>(choices)));
}

uint64_t between(uint64_t low, uint64_t high) {
    return *rc::gen::inRange<uint64_t>(low, high + 1);
}

// Small and odd, or large: both ends matter.
uint64_t extent() {
    return one_of({0, 1}) ? between(1, 40) : one_of({1, 63, 64, 65, 255, 512, 1000, 4096, 65537, 20000001});
}

// No device offers less than 128 invocations a group and 65535 groups: what Vulkan requires.
PlanLimits any_limits() {
    PlanLimits limits;
    limits.buffer_range = one_of({1u << 12, 1u << 16, 1u << 20, 128u << 20, 0xFFFFFFFFu});
    limits.chunk_bytes = one_of({1u << 10, 12345u, 1u << 16, 8u << 20, 1u << 30});
    limits.group_invocations = static_cast<std::uint32_t>(one_of({1, 32, 256}));
    limits.group_count = static_cast<std::uint32_t>(one_of({65535u, 0x7FFFFFFFu, 0xFFFFFFFFu}));
    limits.lanes = static_cast<std::uint32_t>(one_of({1, 4, 8}));
    limits.invocations = static_cast<std::uint32_t>(one_of({0, 1, 64, 2048, 1 << 20}));
    limits.along_z = one_of({0, 1});
    return limits;
}

SampleBytes any_sample() {
    return bytes_per_sample(static_cast<layout::uint>(between(1, 31)), one_of({4, 8}));
}

// The rows that a chunk's invocations take, as the kernel counts them.
uint64_t rows_reached(const FieldPlan& plan, uint64_t y_count, uint64_t z_count) {
    const uint64_t parts = plan.invocations(y_count, z_count) / plan.blocks;
    if (!plan.along_z)
        return std::min(parts * plan.rows, y_count * z_count);
    return y_count * std::min(parts / y_count * plan.rows, z_count);
}

void covers_every_row() {
    const uint64_t nx = extent(), ny = extent(), nz = extent();
    const PlanLimits limits = any_limits();
    const SampleBytes sample = any_sample();
    const uint64_t pitch = (nx + limits.lanes - 1) / limits.lanes * limits.lanes;
    FieldPlan plan;
    try {
        plan = plan_field(nx, ny, nz, sample, limits);
    } catch (const DeviceError& error) {
        RC_ASSERT(error.kind() == DeviceError::Kind::out_of_memory);
        const uint64_t widest = uint64_t(limits.group_count) * limits.group_invocations * limits.lanes;
        RC_ASSERT(pitch * sample.all > limits.chunk_bytes || pitch * sample.largest > limits.buffer_range ||
                  pitch > widest);
        return;
    }
    RC_ASSERT(plan.x_pitch == pitch);
    RC_ASSERT(uint64_t(plan.blocks) * limits.lanes == pitch);
    RC_ASSERT(plan.rows >= 1 && plan.rows <= kMostIterations);
    RC_ASSERT(plan.y_step >= 1 && plan.y_step <= ny && plan.z_step >= 1 && plan.z_step <= nz);
    RC_ASSERT(plan.y_step == ny || plan.z_step == 1);
    const uint64_t samples = pitch * plan.y_step * plan.z_step;
    RC_ASSERT(samples * sample.all <= limits.chunk_bytes);
    RC_ASSERT(samples * sample.largest <= limits.buffer_range);
    // Whole chunks and the last ones.
    for (const uint64_t y_count : {uint64_t(plan.y_step), (ny - 1) % plan.y_step + 1})
        for (const uint64_t z_count : {uint64_t(plan.z_step), (nz - 1) % plan.z_step + 1}) {
            const uint64_t invocations = plan.invocations(y_count, z_count);
            RC_ASSERT(invocations >= 1 && divide_up(invocations, limits.group_invocations) <= limits.group_count);
            RC_ASSERT(rows_reached(plan, y_count, z_count) == y_count * z_count);
        }
}

void sums_its_channels() {
    const auto channels = static_cast<layout::uint>(between(1, 31));
    const std::size_t real = one_of({4, 8});
    uint64_t all = 0, largest = 0;
    for (layout::uint bit = 1; bit <= layout::kChannelUnshaded; bit *= 2)
        if (channels & bit) {
            const SampleBytes one = bytes_per_sample(bit, real);
            RC_ASSERT(one.all == one.largest && one.all > 0);
            all += one.all;
            largest = std::max(largest, one.all);
        }
    RC_ASSERT(bytes_per_sample(channels, real).all == all);
    RC_ASSERT(bytes_per_sample(channels, real).largest == largest);
}

TEST(Plan, CoversEveryRowUnderEveryLimit) {
    EXPECT_TRUE(rc::check(covers_every_row));
}

TEST(Plan, BytesOfASampleAreTheSumOfItsChannels) {
    EXPECT_TRUE(rc::check(sums_its_channels));
}

// Whatever a scene asks for, no invocation goes round more than 30 000 times, and memory bounds what a dispatch holds.
TEST(Plan, DispatchesOfPathsAreShort) {
    for (const std::uint64_t facets : {1u, 3u, 1000000u})
        for (const layout::uint harmonics : {0u, 4u, 1000u})
            for (const std::uint64_t paths : {1u, 1000u, 16384u}) {
                layout::PathFeatures features;
                features.loop = layout::kLoopClosed;
                features.harmonics = harmonics;
                features.channels = layout::kChannelPosition | layout::kChannelForce | layout::kChannelFacet;
                const StepWork work = step_work({}, features, facets, sizeof(float));
                const std::uint64_t steps = steps_of_dispatch(work, paths, 1000000, 8 << 20);
                EXPECT_GE(steps, 1u);
                EXPECT_LE(steps * work.iterations, kMostIterations);
                EXPECT_LE(steps * work.bytes * paths, std::uint64_t(8) << 20);
                EXPECT_LE((steps - 1) * work.cost * paths, std::uint64_t(1) << 24);
            }
    EXPECT_EQ(steps_of_dispatch({}, 1, 10, 1), 10u);
}

TEST(Plan, NamesTheRowThatDoesNotFit) {
    PlanLimits limits;
    limits.buffer_range = 1000;
    limits.chunk_bytes = 1000;
    limits.group_invocations = 128;
    limits.group_count = 65535;
    limits.lanes = 4;
    EXPECT_TRUE(testing::says(test::device_error(DeviceError::Kind::out_of_memory,
                                                 [&] {
                                                     plan_field(100, 1, 1, {12, 12}, limits);
                                                 }),
                              "one row of 100 samples takes 1200 bytes"));
}

} // namespace
} // namespace forceshade::compute
