#include "compute/plan.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "compute/device.h"

namespace forceshade::compute {
namespace {

using layout::kMeshBlock;
using layout::uint;

// A column costs as much as six samples, so that more rows an invocation have no gain; and loops stay far from where
// drivers end them.
constexpr std::uint64_t kMostRows = 128;
// Software drivers end the loops of an invocation after 65 535 iterations, in silence; this is far from there.
constexpr std::uint32_t kMostIterations = 24000;
// Steps, weighed by their cost: a second's on a device ten times slower than two cores of software.
constexpr std::uint64_t kMostCost = std::uint64_t(1) << 24;
constexpr std::uint64_t kPhiloxRounds = 10;
constexpr std::uint32_t kUnroll = 8; // corners of a facet
constexpr std::uint32_t kBlockVoxels = kMeshBlock * kMeshBlock * kMeshBlock;

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

SampleBytes bytes_per_sample(uint channels, std::size_t real_size) {
    SampleBytes bytes{0, 0};
    for (const Channel& channel : kChannels)
        if (channels & channel.bit) {
            bytes.all += channel.bytes(real_size);
            bytes.largest = std::max<std::uint64_t>(bytes.largest, channel.bytes(real_size));
        }
    return bytes;
}

std::uint64_t FieldPlan::invocations(std::uint64_t y_count, std::uint64_t z_count) const {
    return blocks * (along_z ? y_count * divide_up(z_count, rows) : divide_up(y_count * z_count, rows));
}

FieldPlan plan_field(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                     const PlanLimits& limits) {
    const std::uint64_t blocks = divide_up(nx, limits.lanes);
    const std::uint64_t pitch = blocks * limits.lanes;
    const std::uint64_t most_invocations = std::uint64_t(limits.group_invocations) * limits.group_count;
    const std::uint64_t rows = std::min({limits.buffer_range / (pitch * sample.largest),
                                         limits.chunk_bytes / (pitch * sample.all), most_invocations / blocks});
    if (rows < 1)
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("one row of {} samples takes {} bytes; a dispatch may hold {} and a buffer span "
                                      "{}: make the grid narrower in x",
                                      nx, pitch * sample.all, limits.chunk_bytes, limits.buffer_range));
    FieldPlan plan;
    plan.x_pitch = static_cast<std::uint32_t>(pitch);
    plan.blocks = static_cast<std::uint32_t>(blocks);
    plan.along_z = limits.along_z;
    plan.y_step = static_cast<std::uint32_t>(std::min(ny, rows));
    plan.z_step = plan.y_step == ny ? static_cast<std::uint32_t>(std::min(nz, rows / ny)) : 1;
    const std::uint64_t filling = std::uint64_t(plan.y_step) * plan.z_step * blocks / std::max(1u, limits.invocations);
    plan.rows =
        limits.rows ? limits.rows : static_cast<std::uint32_t>(std::clamp<std::uint64_t>(filling, 1, kMostRows));
    return plan;
}

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
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("{} rows of {} samples take {} bytes; a dispatch may hold {} and a buffer span "
                                      "{}: make the grid narrower in x",
                                      kMeshBlock, x_pitch, kMeshBlock * x_pitch * sample.all, chunk_bytes,
                                      buffer_range));
    return steps;
}

void cut_plan(const layout::MeshPlan& plan, const layout::MeshChunkParams& chunk, const std::vector<uint>& candidates,
              bool voxel_by_voxel, MeshChunkPlan& part) {
    const std::vector<uint> order = ordered_blocks(plan, chunk);
    // A chunk of one layer may begin within blocks.
    const uint in_chunk = chunk.z_first % kMeshBlock != 0 ? 0xF0u : 0xFFu;
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
        const uint wanted = in_chunk & (plan.wanted.empty() ? 0xFFu : plan.wanted[index]);
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

FacetLoops facet_loops(const layout::Features& features, std::span<const layout::uint> facet_begins) {
    if (features.shading == layout::kShadingNone || features.shading == layout::kShadingBarycentric)
        return {};
    layout::uint most = 0;
    for (std::size_t f = 0; f + 1 < facet_begins.size(); ++f)
        most = std::max(most, facet_begins[f + 1] - facet_begins[f]);
    if (most <= kMostIterations / kBlockVoxels)
        return {};
    if (most > kMostIterations * kUnroll)
        throw DeviceError(DeviceError::Kind::unsupported,
                          fmt::format("a facet of the mesh has {} corners and kernels interpolate over at most {}: use "
                                      "--engine cpu, or cut the facet",
                                      most, kMostIterations * kUnroll));
    return {kUnroll, true};
}

StepWork step_work(const layout::Features& law, const layout::PathFeatures& features, std::uint64_t facets,
                   std::size_t real_size) {
    const bool closed = features.loop == layout::kLoopClosed;
    StepWork work;
    work.iterations = 2 + features.harmonics; // a path that has left its bound takes its steps in a loop
    if (law.surface == layout::kSurfaceBump)  // the probe's facet, and that of the motion's place
        work.iterations += 2 * (1 + std::uint64_t(std::bit_width(facets)));
    if (features.motion == layout::kMotionMinimumJerk)
        work.iterations += 1 + 2 * kPhiloxRounds;
    work.cost = 1 + (closed ? 1 : 0) + features.harmonics;
    if (law.map == layout::kMapSamples || law.texture == layout::kMapSamples)
        work.cost += 1;
    work.cost *= real_size / sizeof(float);
    work.bytes = bytes_per_sample(features.channels, real_size).all;
    if (features.motion == layout::kMotionRecorded)
        work.bytes += 3 * real_size;
    return work;
}

std::uint32_t steps_of_dispatch(const StepWork& work, std::uint64_t paths, std::uint64_t steps,
                                std::uint64_t chunk_bytes) {
    std::uint64_t most = std::min(kMostIterations / work.iterations, kMostCost / (work.cost * paths));
    if (work.bytes != 0)
        most = std::min(most, chunk_bytes / (work.bytes * paths));
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(most, 1, std::max<std::uint64_t>(1, steps)));
}

Constants constants_of(const layout::Features& law, FacetLoops loops) {
    Constants values{};
    values[layout::kSpecSurface] = law.surface;
    values[layout::kSpecShading] = law.shading;
    values[layout::kSpecDepth] = law.depth;
    values[layout::kSpecReference] = law.reference;
    values[layout::kSpecInside] = law.inside;
    values[layout::kSpecMap] = law.map;
    values[layout::kSpecTexture] = law.texture;
    values[layout::kSpecChannels] = law.channels;
    values[layout::kSpecUnroll] = loops.unroll;
    return values;
}

template <typename T> Constants constants_of(const layout::PathInput<T>& input, FacetLoops loops) {
    const auto some_hand = [&](const auto& of) {
        return input.features.loop == layout::kLoopClosed &&
               std::ranges::any_of(input.hands, [&](const auto& hand) { return of(hand) > T(0); });
    };
    Constants values = constants_of(input.law.features, loops);
    values[layout::kSpecChannels] = input.features.channels;
    values[layout::kSpecMotion] = input.features.motion;
    values[layout::kSpecLoop] = input.features.loop;
    values[layout::kSpecFollow] = input.features.follow;
    values[layout::kSpecHarmonics] = input.features.harmonics;
    values[layout::kSpecFriction] = some_hand([](const auto& hand) { return hand.coulomb; });
    values[layout::kSpecQuantised] = some_hand([](const auto& hand) { return hand.quantum; });
    values[layout::kSpecCoupled] = some_hand([](const auto& hand) { return hand.coupling.depth; });
    return values;
}

template Constants constants_of<float>(const layout::PathInput<float>&, FacetLoops);
template Constants constants_of<double>(const layout::PathInput<double>&, FacetLoops);

} // namespace forceshade::compute
