#include "compute/mesh_chunk.h"

#include <algorithm>

#include <fmt/format.h>

#include "compute/device.h"

namespace forceshade::compute {
namespace {

using layout::kMeshBlock;
using layout::uint;

// Blocks of the plan within the chunk, by falling number of candidates (to within the last of the buckets).
std::vector<uint> ordered_blocks(const layout::MeshPlan& plan, const layout::MeshChunkParams& chunk) {
    constexpr uint kBuckets = 1024;
    const auto bucket = [&](const layout::MeshBlock& block) {
        return kBuckets - 1 - std::min(block.count, kBuckets - 1);
    };
    const auto below = [](const layout::MeshBlock& block, uint z) { return block.z < z; };
    const auto first =
        std::lower_bound(plan.blocks.begin(), plan.blocks.end(), chunk.z_first / kMeshBlock * kMeshBlock, below);
    const auto last = std::lower_bound(first, plan.blocks.end(), chunk.z_first + chunk.z_count, below);
    const auto is_listed = [&](const layout::MeshBlock& block) {
        return block.count > 0 && block.y >= chunk.y_first && block.y < chunk.y_first + chunk.y_count;
    };
    std::vector<uint> begin(kBuckets + 1, 0);
    for (auto block = first; block != last; ++block)
        if (is_listed(*block))
            ++begin[bucket(*block) + 1];
    for (uint b = 0; b < kBuckets; ++b)
        begin[b + 1] += begin[b];
    std::vector<uint> order(begin.back());
    for (auto block = first; block != last; ++block)
        if (is_listed(*block))
            order[begin[bucket(*block)]++] = static_cast<uint>(block - plan.blocks.begin());
    return order;
}

} // namespace

MeshChunkSteps plan_mesh_chunks(std::uint64_t x_pitch, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                                std::uint64_t buffer_range, std::uint64_t chunk_bytes) {
    constexpr std::uint64_t kPatience = 4;
    const auto rows_within = [&](std::uint64_t bytes) {
        return std::min(buffer_range / (x_pitch * sample.largest), bytes / (x_pitch * sample.all));
    };
    const auto whole = [](std::uint64_t samples, std::uint64_t all) {
        return static_cast<std::uint32_t>(samples >= all ? all : samples / kMeshBlock * kMeshBlock);
    };
    const std::uint64_t pair = std::min<std::uint64_t>(nz, kMeshBlock);
    const std::uint64_t rows = rows_within(chunk_bytes);
    if (rows >= pair * ny)
        return {static_cast<std::uint32_t>(ny), std::max(static_cast<std::uint32_t>(pair), whole(rows / ny, nz))};
    if (rows_within(kPatience * chunk_bytes) >= pair * ny)
        return {static_cast<std::uint32_t>(ny), static_cast<std::uint32_t>(pair)};
    const MeshChunkSteps steps{whole(rows, ny), 1};
    if (steps.y_step == 0)
        throw DeviceError(
            DeviceError::Kind::out_of_memory,
            fmt::format("{} rows of {} samples take {} bytes; a dispatch may hold {} and a buffer span {}: "
                        "make the grid narrower in x",
                        kMeshBlock, x_pitch, kMeshBlock * x_pitch * sample.all, chunk_bytes, buffer_range));
    return steps;
}

void cut_plan(const layout::MeshPlan& plan, const layout::MeshChunkParams& chunk, const std::vector<uint>& candidates,
              bool voxel_by_voxel, MeshChunkPlan& part) {
    const std::vector<uint> order = ordered_blocks(plan, chunk);
    // A chunk of one layer may begin within blocks.
    const uint wanted = chunk.z_first % kMeshBlock != 0 ? 0xF0u : 0xFFu;
    const uint parts = voxel_by_voxel ? kMeshBlock * kMeshBlock * kMeshBlock : 1;
    part.blocks = static_cast<std::uint32_t>(order.size() * parts);
    const std::size_t begin = std::size_t(layout::kMeshBlockWords) * part.blocks;
    std::size_t size = begin;
    for (const uint index : order)
        size += plan.blocks[index].count;
    part.words.resize(size);
    std::size_t to = begin, at = 0;
    for (const uint index : order) {
        const layout::MeshBlock& block = plan.blocks[index];
        const uint inside = plan.inside.empty() ? 0 : plan.inside[index];
        for (uint i = 0; i < parts; ++i) {
            part.words[at++] = block.x;
            part.words[at++] = block.y - chunk.y_first;
            part.words[at++] = block.z - chunk.z_first;
            part.words[at++] = static_cast<uint>(to - begin);
            part.words[at++] = block.count;
            part.words[at++] = inside | (wanted & (voxel_by_voxel ? 1u << i : 0xFFu)) << 8;
        }
        for (const uint triangle : plan.candidates.subspan(block.first, block.count))
            part.words[to++] = candidates[triangle];
    }
}

} // namespace forceshade::compute
