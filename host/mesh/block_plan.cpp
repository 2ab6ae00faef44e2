#include "host/mesh/block_plan.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "host/mesh/block_worker.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

using reference::Vector;

namespace {

template <typename T> void grow(std::vector<T>& values, std::size_t count) {
    if (values.size() < count)
        values.resize(count + count / 2);
}

} // namespace

template <typename T> bool is_below(const PlanTriangle<T>& triangle, const PlanBox<T>& box, T slack) {
    const Vector<T>& n = triangle.normal;
    if (n.x == T(0) && n.y == T(0) && n.z == T(0))
        return true;
    const Vector<T> lowest{n.x > T(0) ? box.low.x : box.high.x, n.y > T(0) ? box.low.y : box.high.y,
                           n.z > T(0) ? box.low.z : box.high.z};
    return reference::dot(n, lowest) - triangle.offset > slack;
}

template <typename T>
void TriangleList<T>::fill(std::span<const layout::uint> ids, std::span<const PlanTriangle<T>> rows) {
    ids_.assign(ids.begin(), ids.end());
    for (auto& column : columns_)
        grow(column, ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const PlanTriangle<T>& row = rows[ids[i]];
        for (std::size_t c = 0; c < row.corners.size(); ++c)
            columns_[c][i] = row.corners[c];
        columns_.back()[i] = row.circle;
    }
    sample();
}

template <typename T> void TriangleList<T>::take(const TriangleList& all, std::span<const layout::uint> places) {
    const std::size_t count = places.size();
    ids_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        ids_[i] = all.ids_[places[i]];
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        grow(columns_[c], count);
        const T* const from = all.columns_[c].data(); // one by one: processors' gathering is no faster
        T* const to = columns_[c].data();
        for (std::size_t i = 0; i < count; ++i)
            to[i] = from[places[i]];
    }
    sample();
}

template <typename T>
void TriangleList<T>::narrow(const PlanBox<T>& box, const Witness<T>& witness,
                             std::vector<layout::uint>& places) const {
    const std::size_t count = size();
    scratch_.resize(std::max(scratch_.size(), count));
    const Vector<T> centre = box.centre(), side = box.high - box.low;
    Columns<T> columns;
    for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c] = columns_[c].data();
    const Vector<T> apart = centre - witness.point;
    const T limit = reference::dot(apart, apart) + witness.margin;
    all_excesses(columns, count, centre, side, witness.point, limit, scratch_.data());
    keep(count, places);
}

// The places of all whose excess in scratch_ is not above 0.
template <typename T> void TriangleList<T>::keep(std::size_t count, std::vector<layout::uint>& places) const {
    // What goes mostly goes together: eight marks that are all 0 are passed at once.
    constexpr std::size_t kMarks = sizeof(std::uint64_t);
    marks_.resize(std::max(marks_.size(), count + kMarks));
    mark_kept(scratch_.data(), count, marks_.data());
    std::fill_n(marks_.begin() + std::ptrdiff_t(count), kMarks, std::uint8_t(0));
    places.resize(std::max(places.size(), count + kMarks));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += kMarks) {
        std::uint64_t marks;
        std::memcpy(&marks, &marks_[i], kMarks);
        if (marks == 0)
            continue;
        for (std::size_t k = i; k < i + kMarks; ++k) {
            places[kept] = static_cast<layout::uint>(k);
            kept += marks_[k];
        }
    }
    places.resize(kept);
}

template <typename T> std::array<std::size_t, 8> TriangleList<T>::near_corners(const PlanBox<T>& box) {
    const std::size_t count = size();
    grow(squares_, 8 * count);
    Columns<T> columns;
    for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c] = columns_[c].data();
    all_squares_to_corners(columns, count, box.low, box.high, squares_.data());
    std::array<std::size_t, 8> places;
    for (std::size_t k = 0; k < 8; ++k)
        places[k] = near_least_of(squares_.data() + k * count, count);
    return places;
}

template <typename T>
void TriangleList<T>::narrow_corners(const std::array<T, 8>& limits, std::vector<layout::uint>& places) const {
    scratch_.resize(std::max(scratch_.size(), size()));
    all_beyond_limits(squares_.data(), columns_.back().data(), size(), limits, scratch_.data());
    keep(size(), places);
}

// First corners of every few triangles: each vertex is that of two triangles on average, and large boxes can do with
// fewer. The witness only has to be near.
template <typename T> void TriangleList<T>::sample() {
    constexpr std::size_t kEnough = 128;
    stride_ = std::max<std::size_t>(1, size() / kEnough);
    const std::size_t samples = (size() + stride_ - 1) / stride_;
    for (std::size_t c = 0; c < samples_.size(); ++c) {
        grow(samples_[c], samples);
        for (std::size_t i = 0; i < samples; ++i)
            samples_[c][i] = columns_[c][i * stride_];
    }
}

template <typename T> std::size_t TriangleList<T>::near_one(const Vector<T>& point) const {
    const std::size_t samples = (size() + stride_ - 1) / stride_;
    scratch_.resize(std::max(scratch_.size(), samples));
    all_squares(samples_[0].data(), samples_[1].data(), samples_[2].data(), samples, point, scratch_.data());
    return stride_ * near_least_of(scratch_.data(), samples);
}

template bool is_below(const PlanTriangle<float>&, const PlanBox<float>&, float);
template bool is_below(const PlanTriangle<double>&, const PlanBox<double>&, double);
template class TriangleList<float>;
template class TriangleList<double>;

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
