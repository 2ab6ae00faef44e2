#include "host/mesh/block_plan.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "host/mesh/block_worker.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {
namespace {

using layout::kMeshBlock;
using layout::uint;

// The blocks that a tile's worker found.
struct TilePart {
    std::size_t worker = 0, first = 0, count = 0;
};

// Runs work(worker, index) for every index below count, shared out among threads.
template <typename Work> void share_out(unsigned threads, std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{0};
    const auto run = [&](unsigned worker) {
        for (std::size_t i; (i = next++) < count;)
            work(worker, i);
    };
    std::vector<std::jthread> helpers;
    for (unsigned i = 1; i < threads; ++i)
        helpers.emplace_back(run, i);
    run(0);
}

std::size_t tiles_of(std::size_t samples) {
    return (samples + kPlanTile - 1) / kPlanTile;
}

// Tiles come by z; within a layer of them, blocks are sorted by z.
template <typename T>
void put_in_order(const std::vector<BlockWorker<T>>& workers, const std::vector<TilePart>& parts, BlockPlan& plan) {
    std::array<std::vector<std::pair<std::size_t, std::size_t>>, kPlanTile / kMeshBlock> layers; // worker, block
    const auto flush = [&] {
        for (auto& layer : layers) {
            for (const auto& [worker, index] : layer) {
                const BlockWorker<T>& from = workers[worker];
                layout::MeshBlock block = from.blocks[index];
                const auto first = from.candidates.begin() + block.first;
                block.first = static_cast<uint>(plan.candidates.size());
                plan.candidates.insert(plan.candidates.end(), first, first + block.count);
                plan.blocks.push_back(block);
                if (!from.inside.empty())
                    plan.inside.push_back(from.inside[index]);
            }
            layer.clear();
        }
    };
    std::size_t blocks = 0, candidates = 0;
    for (const BlockWorker<T>& worker : workers) {
        blocks += worker.blocks.size();
        candidates += worker.candidates.size();
    }
    plan.blocks.reserve(blocks);
    plan.candidates.reserve(candidates);
    std::size_t layer_z = 0;
    for (const TilePart& part : parts)
        for (std::size_t i = part.first; i < part.first + part.count; ++i) {
            const std::size_t z = workers[part.worker].blocks[i].z;
            if (z / kPlanTile != layer_z)
                flush();
            layer_z = z / kPlanTile;
            layers[z % kPlanTile / kMeshBlock].emplace_back(part.worker, i);
        }
    flush();
}

} // namespace

template <typename T> struct BlockPlanner<T>::Implementation {
    PlanInput<T> input;
    unsigned threads;

    std::uint64_t voxels(const std::vector<layout::MeshBlock>& blocks, std::size_t z_end) const {
        const auto clipped = [](std::size_t samples, uint first) {
            return std::min<std::uint64_t>(kMeshBlock, samples - first);
        };
        std::uint64_t sum = 0;
        for (const layout::MeshBlock& block : blocks)
            sum += clipped(input.axes[0].size(), block.x) * clipped(input.axes[1].size(), block.y) *
                   clipped(z_end, block.z);
        return sum;
    }
};

template <typename T>
BlockPlanner<T>::BlockPlanner(const layout::MeshView<T>& mesh, std::span<const T> x, std::span<const T> y,
                              std::span<const T> z, layout::uint inside, unsigned threads, FreeSpace free) {
    if (threads == 0)
        threads = std::max(1u, std::thread::hardware_concurrency());
    T largest = T(1);
    for (const auto axis : {x, y, z})
        largest = std::max({largest, std::abs(axis.front()), std::abs(axis.back())});
    auto made = std::make_unique<Implementation>(Implementation{
        {mesh, {x, y, z}, inside, reference::prune_slack(largest), {}, free == FreeSpace::visited}, threads});
    constexpr std::size_t kRun = 4096;
    auto& rows = made->input.rows;
    rows.resize(mesh.triangle_facets.size());
    share_out(threads, (rows.size() + kRun - 1) / kRun, [&](unsigned, std::size_t run) {
        for (std::size_t t = run * kRun; t < std::min(rows.size(), (run + 1) * kRun); ++t)
            rows[t] = plan_triangle(mesh, t, T(1) + largest);
    });
    implementation_ = std::move(made);
}

template <typename T> BlockPlanner<T>::~BlockPlanner() = default;

template <typename T> BlockPlan BlockPlanner<T>::plan(std::size_t z_first, std::size_t z_count) const {
    const PlanInput<T>& input = implementation_->input;
    const unsigned threads = implementation_->threads;
    const std::array<std::size_t, 3> ends{input.axes[0].size(), input.axes[1].size(), z_first + z_count};
    const std::size_t across = tiles_of(ends[0]), along = tiles_of(ends[1]);
    // Tiles stand where they do in the whole grid, so that slabs make no difference.
    const std::size_t first_layer = z_first / kPlanTile, layers = tiles_of(ends[2]) - first_layer;
    std::vector<BlockWorker<T>> workers(threads, BlockWorker<T>(input));
    std::vector<TilePart> parts(across * along * layers);
    share_out(threads, parts.size(), [&](unsigned worker, std::size_t index) {
        const std::array<std::size_t, 3> at{index % across, index / across % along,
                                            first_layer + index / across / along};
        SampleRange tile;
        for (std::size_t i = 0; i < 3; ++i) {
            tile.first[i] = static_cast<uint>(std::max(at[i] * kPlanTile, i == 2 ? z_first : 0));
            tile.last[i] = static_cast<uint>(std::min(ends[i], (at[i] + 1) * kPlanTile) - 1);
        }
        BlockWorker<T>& self = workers[worker];
        const std::size_t first = self.blocks.size();
        self.plan(tile);
        parts[index] = {worker, first, self.blocks.size() - first};
    });
    BlockPlan plan;
    put_in_order(workers, parts, plan);
    plan.voxels_evaluated = implementation_->voxels(plan.blocks, ends[2]);
    return plan;
}

template class BlockPlanner<float>;
template class BlockPlanner<double>;

} // namespace forceshade
