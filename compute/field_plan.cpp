#include "compute/field_plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "compute/device.h"

namespace forceshade::compute {
namespace {

// 256 invocations a group were measured best; more gain nothing and fewer cost up to a third (tests/bench).
constexpr std::uint32_t kGroup = 256;
// Invocations of a group that lie side by side in x: a multiple of this, so that vector units are filled.
constexpr std::uint32_t kAbreast = 8;

std::uint64_t divided_up(std::uint64_t value, std::uint64_t by) {
    return (value + by - 1) / by;
}

} // namespace

SampleBytes bytes_per_sample(layout::uint channels, std::size_t real_size) {
    SampleBytes bytes{0, 0};
    const auto add = [&](layout::uint channel, std::uint64_t size) {
        if (!(channels & channel))
            return;
        bytes.all += size;
        bytes.largest = std::max(bytes.largest, size);
    };
    add(layout::kChannelForce, 3 * real_size);
    add(layout::kChannelDepth, real_size);
    add(layout::kChannelFacet, sizeof(layout::uint));
    add(layout::kChannelProxy, 3 * real_size);
    add(layout::kChannelUnshaded, 3 * real_size);
    return bytes;
}

FieldPlan plan_field(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                     const PlanLimits& limits) {
    const std::uint64_t pitch = nx + nx % 2;
    const std::uint64_t rows =
        std::min(limits.buffer_range / (pitch * sample.largest), limits.chunk_bytes / (pitch * sample.all));
    const std::uint64_t group = std::min(kGroup, limits.group_invocations);
    const std::uint64_t widest = std::min<std::uint64_t>(group, limits.group_size[0]);
    const std::uint64_t pairs = pitch / 2;
    const std::uint64_t groups_x = divided_up(pairs, widest);
    if (rows < 1 || groups_x > limits.group_count[0])
        throw DeviceError(
            DeviceError::Kind::out_of_memory,
            fmt::format("one row of {} samples takes {} bytes; a dispatch may hold {} and a buffer span {}: "
                        "make the grid narrower in x",
                        nx, pitch * sample.all, limits.chunk_bytes, limits.buffer_range));
    FieldPlan plan;
    plan.x_pitch = static_cast<std::uint32_t>(pitch);
    plan.groups_x = static_cast<std::uint32_t>(groups_x);
    const std::uint64_t local_x = std::min(widest, divided_up(divided_up(pairs, groups_x), kAbreast) * kAbreast);
    const std::uint64_t local_y = std::min({group / local_x, ny, std::uint64_t(limits.group_size[1])});
    plan.local_x = static_cast<std::uint32_t>(local_x);
    plan.local_y = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, local_y));
    const std::uint64_t y_most = std::uint64_t(limits.group_count[1]) * plan.local_y;
    plan.y_step = static_cast<std::uint32_t>(std::min({ny, rows, y_most}));
    std::uint64_t z_step = 1;
    if (plan.y_step == ny) {
        z_step = std::min({nz, rows / ny, std::uint64_t(limits.group_count[2]) * limits.layers});
        if (z_step > limits.layers && z_step < nz)
            z_step -= z_step % limits.layers;
    }
    plan.z_step = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, z_step));
    return plan;
}

} // namespace forceshade::compute
