#include "host/mesh/block_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/long_run.h"
#include "host/mesh/solid_scan.h"
#include "host/mesh/structure.h"
#include "host/mesh/triangle_list.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

using layout::kMeshBlock;
using layout::uint;
using reference::Vector;

constexpr uint kPlanTile = 16; // samples along each side of a tile, which is planned as a whole

/// Samples of the grid, first to last along each axis.
struct SampleRange {
    std::array<uint, 3> first, last;
};

/// What threads share.
template <typename T> struct PlanInput {
    layout::MeshView<T> mesh;
    std::array<std::span<const T>, 3> axes;
    uint inside; /* layout::kInside... */
    T slack;     /* 1: what rounding to T can make of a distance, twice over */
    std::vector<PlanTriangle<T>> rows;
    bool visits_free = false; /* blocks without a voxel inside are listed too */

    PlanBox<T> box(const SampleRange& range) const {
        PlanBox<T> box;
        for (int i = 0; i < 3; ++i) {
            const auto axis = static_cast<std::size_t>(i);
            box.low[i] = axes[axis][range.first[axis]];
            box.high[i] = axes[axis][range.last[axis]];
        }
        return box;
    }
};

// The squared radius of the least circle around a triangle.
template <typename T> T circle_square(const Vector<T>& a, const Vector<T>& b, const Vector<T>& c) {
    std::array<T, 3> squares{reference::dot(b - a, b - a), reference::dot(c - b, c - b), reference::dot(a - c, a - c)};
    std::sort(squares.begin(), squares.end());
    if (!(squares[0] + squares[1] > squares[2])) // the longest edge is a diameter
        return squares[2] / T(4);
    const Vector<T> normal = reference::cross(Vector<T>(b - a), Vector<T>(c - a));
    const T area_square = reference::dot(normal, normal); // four times
    // Never larger than the circle about the corners' mean that the longest edge bounds.
    const T least = squares[2] / T(3);
    const T circle = squares[0] * squares[1] * (squares[2] / (T(4) * area_square));
    // Rounding of the edges turns slivers: the area is off by a few roundings of the longest edge's square.
    constexpr T kTurned = T(64) * std::numeric_limits<T>::epsilon();
    const T sure = circle + circle * (kTurned * (squares[2] / std::sqrt(area_square)));
    return sure < least ? sure : least;
}

// The winding number is good to 1e-4 (host/reference/mesh_contact.h), at both places that it is compared at.
constexpr double kWindingDoubt = 1e-3;

// Where more triangles may be nearest to some sample of a tile, to ask for each sample's own takes less than to narrow
// them down.
constexpr std::size_t kMostCollected = 16384; // measured on spheres of 100 k and 1 M triangles over 128^3 samples

constexpr uint kLeastSided = 4; // samples a side of boxes whose side is asked for

/// A row of PlanInput; no coordinate of mesh or grid is beyond `largest`.
template <typename T> PlanTriangle<T> plan_triangle(const layout::MeshView<T>& mesh, std::size_t triangle, T largest) {
    PlanTriangle<T> row;
    std::array<Vector<T>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = reference::vector_at(mesh.vertices, mesh.triangle_corners[3 * triangle + i]);
        for (int j = 0; j < 3; ++j)
            row.corners[3 * i + std::size_t(j)] = corners[i][j];
    }
    const T circle = circle_square(corners[0], corners[1], corners[2]);
    // What is subtracted of squares must not be below what their rounding adds.
    constexpr T kRounding = T(64) * std::numeric_limits<T>::epsilon();
    row.circle = circle + kRounding * (circle + largest * std::sqrt(circle));
    row.normal = reference::vector_at(mesh.triangle_normals, triangle);
    row.offset = reference::dot(row.normal, corners[0]);
    return row;
}

/// True if the whole box is at least `slack` above the triangle's plane, or it has none.
template <typename T> bool is_below(const PlanTriangle<T>& triangle, const PlanBox<T>& box, T slack) {
    const Vector<T>& n = triangle.normal;
    if (n.x == T(0) && n.y == T(0) && n.z == T(0))
        return true;
    const Vector<T> lowest{n.x > T(0) ? box.low.x : box.high.x, n.y > T(0) ? box.low.y : box.high.y,
                           n.z > T(0) ? box.low.z : box.high.z};
    return reference::dot(n, lowest) - triangle.offset > slack;
}

/// One thread's part in planning blocks: boxes of samples are halved along each axis, the list of triangles that may be
/// nearest is narrowed with them, and boxes that are outside all of these go.
template <typename T> class BlockWorker {
public:
    explicit BlockWorker(const PlanInput<T>& input) : input_(input) {}

    /// Appends the blocks of a tile to the result.
    void plan(const SampleRange& tile) {
        const PlanBox<T> box = input_.box(tile);
        const auto nearest = reference::nearest(input_.mesh, box.centre(), hint_);
        hint_ = nearest.triangle;
        const Witness<T> witness = witness_from(box, Vector<T>(box.centre() + nearest.offset));
        collect(box, witness);
        Side side = Side::both;
        if (collected_.size() > kMostCollected)
            return ask(tile, kPlanTile, side);
        lists_[0].fill(collected_, input_.rows);
        lists_[0].narrow(box, witness, places_);
        if (is_free(lists_[0], box, witness.point, kPlanTile, side))
            return;
        lists_[1].select(lists_[0], places_);
        split(tile, 1, kPlanTile, side);
    }

    std::vector<layout::MeshBlock> blocks; /* runs of `candidates` */
    std::vector<uint> candidates, inside;

private:
    static constexpr std::size_t kLevels = 4;  // of boxes that have lists: 16 to 4 samples, and what was collected
    static constexpr std::size_t kLong = 48;   // lists beyond are narrowed to their samples
    enum class Side { outside, inside, both }; // of the surface, as far as a box is wholly on one

    Witness<T> witness_from(const PlanBox<T>& box, const Vector<T>& point) const {
        const Vector<T> apart = box.centre() - point, half = box.half();
        const T reach = std::sqrt(reference::dot(apart, apart)) + T(2) * std::sqrt(reference::dot(half, half));
        return {point, T(4) * input_.slack * (reach + input_.slack)};
    }

    reference::TrianglePoint<T> nearest_on(uint triangle, const Vector<T>& point) const {
        const PlanTriangle<T>& row = input_.rows[triangle];
        const auto corner = [&](std::size_t i) { return reference::vector_at(std::span<const T>(row.corners), i); };
        return reference::nearest_on_triangle(point, corner(0), corner(1), corner(2), row.normal);
    }

    // A point of the surface that is near, and often the nearest.
    Vector<T> point_near(const TriangleList<T>& list, const Vector<T>& point) {
        hint_ = list.ids()[list.near_one(point)];
        return point + nearest_on(hint_, point).offset;
    }

    // Above the planes of all that may be nearest, and so of all that meet in the nearest point: outside by any
    // pseudonormal.
    bool is_outside(const TriangleList<T>& list, const PlanBox<T>& box) const {
        return std::ranges::all_of(
            places_, [&](uint place) { return is_below(input_.rows[list.ids()[place]], box, input_.slack); });
    }

    // On which side a box is, decided at its centre; `both` if that is not enough. Away from its surface a solid has
    // one side, and the winding number changes little. `near` is on the surface: where it is near enough, the answer is
    // `both` at once.
    Side side_of(const PlanBox<T>& box, const Vector<T>& near) {
        const Vector<T> apart = near - box.centre();
        return is_apart(box, reference::dot(apart, apart)) ? side_of(box) : Side::both;
    }

    // Whether a place at this distance from a box's centre is beyond its corners.
    bool is_apart(const PlanBox<T>& box, T square) const {
        return std::sqrt(square) > box.radius() + T(2) * input_.slack;
    }

    Side side_of(const PlanBox<T>& box) {
        const Vector<T> centre = box.centre();
        const T radius = box.radius() + input_.slack;
        const auto nearest = reference::nearest(input_.mesh, centre, hint_);
        hint_ = nearest.triangle;
        if (!is_apart(box, nearest.square))
            return Side::both;
        if (input_.inside != layout::kInsideWinding)
            return reference::inside_by_pseudonormal(input_.mesh, nearest) ? Side::inside : Side::outside;
        const Vector<double> probe(centre);
        const double change = reference::winding_change(input_.mesh, probe, static_cast<double>(radius));
        const double winding = reference::decisive_winding(input_.mesh, probe, change);
        if (!(std::abs(winding - 0.5) > change + kWindingDoubt))
            return Side::both;
        return winding > 0.5 ? Side::inside : Side::outside;
    }

    // True if no sample of the box can be inside. Sets `side`, too, once it is known.
    bool is_free(const TriangleList<T>& list, const PlanBox<T>& box, const Vector<T>& near, uint side_length,
                 Side& side) {
        if (input_.visits_free)
            return false;
        if (input_.inside != layout::kInsideWinding) {
            if (side == Side::inside)
                return false;
            if (is_outside(list, box))
                return true;
            // In small boxes the planes exclude nearly as much, for less time.
            if (!input_.mesh.solid || side_length < kLeastSided)
                return false;
        }
        if (side == Side::both)
            side = side_of(box, near);
        return side == Side::outside;
    }

    // Through the tree: the least of the excess over a node's box, along each axis at one of the box's ends or between.
    void collect(const PlanBox<T>& box, const Witness<T>& witness) {
        const auto least = [&](int axis, T low, T high) {
            const auto part = [&](T end) {
                const T beyond = low - end > end - high ? low - end : end - high;
                const T near = beyond > T(0) ? beyond : T(0), far = end - witness.point[axis];
                return near * near - far * far;
            };
            const T at_low = part(box.low[axis]), at_high = part(box.high[axis]);
            return at_low < at_high ? at_low : at_high;
        };
        const auto meets = [&](const layout::MeshNode& node, uint i) {
            const T excess = least(0, T(node.low_x[i]), T(node.high_x[i])) +
                             least(1, T(node.low_y[i]), T(node.high_y[i])) +
                             least(2, T(node.low_z[i]), T(node.high_z[i]));
            return !(excess > witness.margin);
        };
        collected_.clear();
        reference::visit_tree(
            input_.mesh, [&](uint) { return collected_.size() <= kMostCollected; }, meets,
            [&](uint triangle, uint end) {
                for (; triangle < end; ++triangle)
                    collected_.push_back(triangle);
            });
    }

    // Calls use(sample, bit), bit (z * 2 + y) * 2 + x in the range.
    template <typename Use> void for_each_sample(const SampleRange& range, const Use& use) const {
        for (uint z = range.first[2]; z <= range.last[2]; ++z)
            for (uint y = range.first[1]; y <= range.last[1]; ++y)
                for (uint x = range.first[0]; x <= range.last[0]; ++x)
                    use(Vector<T>(input_.axes[0][x], input_.axes[1][y], input_.axes[2][z]),
                        ((z - range.first[2]) * 2 + y - range.first[1]) * 2 + x - range.first[0]);
    }

    // The bit of each sample that is inside by the winding number.
    uint inside_bits(const SampleRange& range, Side side) const {
        uint bits = 0;
        for_each_sample(range, [&](const Vector<T>& sample, uint bit) {
            if (side == Side::inside || reference::inside_by_winding(input_.mesh, sample))
                bits |= 1u << bit;
        });
        return bits;
    }

    // By each sample's distance to a triangle that is near to it.
    void narrow_to_samples(const PlanBox<T>& box, const TriangleList<T>& list) {
        long_list_.select(list, places_);
        const std::array<std::size_t, 8> near = long_list_.near_corners(box);
        std::array<T, 8> limits;
        for (uint i = 0; i < 8; ++i) {
            const Vector<T> sample{i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                                   i & 4 ? box.high.z : box.low.z};
            const T square = nearest_on(long_list_.ids()[near[i]], sample).square;
            limits[i] = square + T(4) * input_.slack * (std::sqrt(square) + input_.slack);
        }
        long_list_.narrow_corners(limits, places_);
    }

    // A block whose candidates stand at places_ of the list.
    void leaf(const SampleRange& range, const PlanBox<T>& box, const TriangleList<T>& list, Side side) {
        const uint bits = is_winding() ? inside_bits(range, side) : 0;
        if (is_winding() && bits == 0 && !input_.visits_free)
            return;
        const bool is_long = places_.size() > kLong;
        if (is_long)
            narrow_to_samples(box, list);
        const std::vector<uint>& ids = is_long ? long_list_.ids() : list.ids();
        const std::size_t first = candidates.size();
        for (const uint place : places_)
            candidates.push_back(ids[place]);
        add_block(range, first, bits);
    }

    // A block with the candidates from `first` on.
    void add_block(const SampleRange& range, std::size_t first, uint bits) {
        blocks.push_back({range.first[0], range.first[1], range.first[2], static_cast<uint>(first),
                          static_cast<uint>(candidates.size() - first)});
        if (is_winding())
            inside.push_back(bits);
    }

    // A box whose samples are asked one by one, but for parts of it that are outside.
    void ask(const SampleRange& range, uint side_length, Side side) {
        if (side_length == kMeshBlock)
            return ask_block(range, side);
        if (side == Side::both && (input_.mesh.solid || is_winding()))
            side = side_of(input_.box(range));
        if (side == Side::outside && !input_.visits_free)
            return;
        for_each_eighth(range, side_length, [&](const SampleRange& eighth) { ask(eighth, side_length / 2, side); });
    }

    void ask_block(const SampleRange& range, Side side) {
        const std::size_t first = candidates.size();
        bool is_free = true;
        uint bits = 0;
        for_each_sample(range, [&](const Vector<T>& sample, uint bit) {
            const auto nearest = reference::nearest(input_.mesh, sample, hint_);
            hint_ = nearest.triangle;
            if (std::find(candidates.begin() + std::ptrdiff_t(first), candidates.end(), hint_) == candidates.end())
                candidates.push_back(hint_);
            const bool is_inside =
                side == Side::inside || (is_winding() ? reference::inside_by_winding(input_.mesh, sample)
                                                      : reference::inside_by_pseudonormal(input_.mesh, nearest));
            is_free = is_free && !is_inside;
            bits |= uint(is_inside) << bit;
        });
        if (is_free && !input_.visits_free)
            candidates.resize(first);
        else
            add_block(range, first, bits);
    }

    template <typename Use> static void for_each_eighth(const SampleRange& range, uint side_length, const Use& use) {
        const uint half = side_length / 2;
        for (uint part = 0; part < 8; ++part) {
            SampleRange eighth;
            bool empty = false;
            for (std::size_t i = 0; i < 3; ++i) {
                eighth.first[i] = range.first[i] + (part >> i & 1 ? half : 0);
                eighth.last[i] = std::min(range.last[i], eighth.first[i] + half - 1);
                empty = empty || eighth.first[i] > range.last[i];
            }
            if (!empty)
                use(eighth);
        }
    }

    // The eighths of a box whose list stands at `level`.
    void split(const SampleRange& range, std::size_t level, uint side_length, Side side) {
        const uint half = side_length / 2;
        for_each_eighth(range, side_length, [&](const SampleRange& eighth) {
            const PlanBox<T> box = input_.box(eighth);
            const TriangleList<T>& list = lists_[level];
            const Witness<T> witness = witness_from(box, point_near(list, box.centre()));
            list.narrow(box, witness, places_);
            Side eighth_side = side;
            if (is_free(list, box, witness.point, half, eighth_side))
                return;
            if (half == kMeshBlock)
                return places_.size() > kMostCandidates ? ask_block(eighth, eighth_side)
                                                        : leaf(eighth, box, list, eighth_side);
            lists_[level + 1].select(list, places_);
            split(eighth, level + 1, half, eighth_side);
        });
    }

    bool is_winding() const { return input_.inside == layout::kInsideWinding; }

    const PlanInput<T>& input_;
    uint hint_ = 0;
    std::array<TriangleList<T>, kLevels> lists_;
    TriangleList<T> long_list_;
    std::vector<uint> collected_, places_; // places_: of what was narrowed last, in its list
};

// The blocks that a tile's worker found.
struct TilePart {
    std::size_t worker = 0, first = 0, count = 0;
};

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

// How dense a mesh's triangles are on a grid, and how rough they are.
struct Fineness {
    double density; /* triangles to an area of surface that is as large as a voxel's face */
    double reflex;  /* mean over edges of the sine of the angle by which the inner side exceeds 180 degrees; 0 if not */
};

// By some 4096 triangles of a closed mesh, evenly chosen.
template <typename T> Fineness fineness_of(const layout::MeshView<T>& mesh, double voxel) {
    constexpr std::size_t kLooked = 4096;
    const std::size_t all = mesh.triangle_facets.size(), step = std::max<std::size_t>(1, all / kLooked);
    double count = 0, area = 0, length = 0, reflex = 0;
    for (std::size_t t = 0; t < all; t += step) {
        const auto triangle = reference::triangle_at(mesh, static_cast<uint>(t));
        std::array<Vector<double>, 3> edges;
        for (std::size_t i = 0; i < 3; ++i)
            edges[i] = Vector<double>(triangle.corners[(i + 1) % 3]) - Vector<double>(triangle.corners[i]);
        const Vector<double> normal(triangle.normal), twice = reference::cross(edges[0], edges[1]);
        ++count;
        area += std::sqrt(reference::dot(twice, twice)) / 2;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector<double> across(
                reference::vector_at(mesh.triangle_normals, mesh.triangle_neighbours[3 * t + i]));
            length += std::sqrt(reference::dot(edges[i], edges[i]));
            reflex += std::max(0.0, -reference::dot(reference::cross(normal, across), edges[i]));
        }
    }
    return {count * voxel * voxel / area, reflex / length};
}

// Whether a scan of a solid takes less time than halving boxes. Measured on 30 solids of 12 to 1 M triangles over 16^3
// to 256^3 voxels, in CPU time of plan and field, one thread:
// - Finding out whether the surface keeps clear of itself takes as long as some voxels a triangle.
// - On a processor in double precision a scan's short lists save more than all of the plan: 0.1 to 0.8 of the time.
// - Else the plans themselves count. A box's list is longer the denser triangles are; a scan takes longer the more room
//   there is at reflex edges. From this density on, plans took 0.3 to 1.1 of the time, plan and field 0.3 to 0.9; below
//   it up to 3.3 and 1.8. Small fields take some milliseconds either way.
template <typename T>
bool is_scan_faster(const layout::MeshView<T>& mesh, const std::array<std::span<const T>, 3>& axes,
                    Evaluator evaluator) {
    constexpr double kLeastVoxels = 1 << 16, kLeastDensity = 0.5, kMoreByReflex = 15, kMostReflex = 0.2;
    double voxels = 1, volume = 1;
    for (const auto axis : axes) {
        voxels *= static_cast<double>(axis.size());
        const double length = static_cast<double>(axis.back()) - static_cast<double>(axis.front());
        volume *= length / std::max(1.0, static_cast<double>(axis.size() - 1));
    }
    if (voxels < static_cast<double>(mesh.triangle_facets.size()))
        return false;
    if (std::is_same_v<T, double> && evaluator == Evaluator::processor)
        return true;
    if (voxels < kLeastVoxels)
        return false;
    const Fineness fineness = fineness_of(mesh, std::cbrt(volume));
    return fineness.reflex < kMostReflex && fineness.density > kLeastDensity + kMoreByReflex * fineness.reflex;
}

} // namespace

template <typename T> struct BlockPlanner<T>::Implementation {
    PlanInput<T> input;
    unsigned threads;
    std::unique_ptr<const SolidScan<T>> scan; /* instead of the rest, where it serves */
};

template <typename T>
BlockPlanner<T>::BlockPlanner(const layout::MeshView<T>& mesh, std::span<const T> x, std::span<const T> y,
                              std::span<const T> z, uint inside, unsigned threads, FreeSpace free,
                              Evaluator evaluator) {
    threads = reference::threads_for(threads);
    T largest = T(1);
    for (const auto axis : {x, y, z})
        largest = std::max({largest, std::abs(axis.front()), std::abs(axis.back())});
    auto made = std::make_unique<Implementation>(Implementation{
        {mesh, {x, y, z}, inside, reference::prune_slack(largest), {}, free == FreeSpace::visited}, threads, nullptr});
    if (mesh.solid && inside == layout::kInsidePseudonormal && free == FreeSpace::skipped &&
        is_scan_faster(mesh, made->input.axes, evaluator))
        made->scan = SolidScan<T>::make(mesh, x, y, z, inside, threads);
    if (made->scan) {
        implementation_ = std::move(made);
        return;
    }
    constexpr std::size_t kRun = 4096;
    auto& rows = made->input.rows;
    rows.resize(mesh.triangle_facets.size());
    reference::share_out(threads, (rows.size() + kRun - 1) / kRun, [&](std::size_t, std::size_t run) {
        for (std::size_t t = run * kRun; t < std::min(rows.size(), (run + 1) * kRun); ++t)
            rows[t] = plan_triangle(mesh, t, T(1) + largest);
    });
    implementation_ = std::move(made);
}

template <typename T> BlockPlanner<T>::~BlockPlanner() = default;

template <typename T> BlockPlan BlockPlanner<T>::plan(std::size_t z_first, std::size_t z_count) const {
    const Stage stage("finding the blocks that may be inside");
    if (implementation_->scan)
        return implementation_->scan->plan(z_first, z_count);
    const PlanInput<T>& input = implementation_->input;
    const unsigned threads = implementation_->threads;
    const std::array<std::size_t, 3> ends{input.axes[0].size(), input.axes[1].size(), z_first + z_count};
    const std::size_t across = tiles_of(ends[0]), along = tiles_of(ends[1]);
    // Tiles stand where they do in the whole grid, so that slabs make no difference.
    const std::size_t first_layer = z_first / kPlanTile, layers = tiles_of(ends[2]) - first_layer;
    std::vector<BlockWorker<T>> workers(threads, BlockWorker<T>(input));
    std::vector<TilePart> parts(across * along * layers);
    reference::share_out(threads, parts.size(), [&](std::size_t worker, std::size_t index) {
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
    const auto clipped = [&](std::size_t axis, uint first) {
        return std::min<std::uint64_t>(kMeshBlock, ends[axis] - first);
    };
    for (const layout::MeshBlock& block : plan.blocks)
        plan.voxels_evaluated += clipped(0, block.x) * clipped(1, block.y) * clipped(2, block.z);
    return plan;
}

template class BlockPlanner<float>;
template class BlockPlanner<double>;

} // namespace forceshade
