#include "compute/field_plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "compute/device.h"

namespace forceshade::compute {
namespace {

// A small group shares few rows out evenly; on the software device 64 to 256 run alike.
constexpr std::uint32_t kGroup = 64;
// A column costs as much as six samples, so that more rows an invocation gain nothing; and loops stay far from where
// drivers end them.
constexpr std::uint64_t kMostRows = 128;

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

std::uint32_t FieldPlan::groups(std::uint64_t y_count, std::uint64_t z_count) const {
    const std::uint64_t parts = along_z ? y_count * divided_up(z_count, rows) : divided_up(y_count * z_count, rows);
    return static_cast<std::uint32_t>(divided_up(parts * blocks, group));
}

FieldPlan plan_field(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                     const PlanLimits& limits) {
    const std::uint64_t blocks = divided_up(nx, limits.abreast);
    const std::uint64_t pitch = blocks * limits.abreast;
    const std::uint64_t group = std::min(kGroup, limits.group_invocations);
    const std::uint64_t most_invocations = group * limits.group_count;
    const std::uint64_t rows = std::min({limits.buffer_range / (pitch * sample.largest),
                                         limits.chunk_bytes / (pitch * sample.all), most_invocations / blocks});
    if (rows < 1)
        throw DeviceError(
            DeviceError::Kind::out_of_memory,
            fmt::format("one row of {} samples takes {} bytes; a dispatch may hold {} and a buffer span {}: "
                        "make the grid narrower in x",
                        nx, pitch * sample.all, limits.chunk_bytes, limits.buffer_range));
    FieldPlan plan;
    plan.x_pitch = static_cast<std::uint32_t>(pitch);
    plan.group = static_cast<std::uint32_t>(group);
    plan.blocks = static_cast<std::uint32_t>(blocks);
    plan.along_z = limits.along_z;
    plan.y_step = static_cast<std::uint32_t>(std::min(ny, rows));
    plan.z_step = plan.y_step == ny ? static_cast<std::uint32_t>(std::min(nz, rows / ny)) : 1;
    const std::uint64_t filling = std::uint64_t(plan.y_step) * plan.z_step * blocks / std::max(1u, limits.invocations);
    plan.rows =
        limits.rows ? limits.rows : static_cast<std::uint32_t>(std::clamp<std::uint64_t>(filling, 1, kMostRows));
    return plan;
}

} // namespace forceshade::compute
