#include "host/mesh/self_intersections.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <mutex>
#include <vector>

#include "host/mesh/exact.h"
#include "host/mesh/structure.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_neighbourhood.h"

namespace forceshade {

namespace {

// Draws the polygons together to at most 1 about the middle of their box. No order of coordinates is reversed on the
// way, so boxes that overlap still do; halves, so that no sum overflows.
class Frame {
public:
    explicit Frame(const MeshBox& box) : half_middle_(0.25 * box.low + 0.25 * box.high) {
        const glm::dvec3 sides = 0.5 * box.high - 0.5 * box.low;
        side_ = std::max({sides.x, sides.y, sides.z, std::numeric_limits<double>::min()});
    }
    glm::dvec3 operator()(const glm::dvec3& at) const { return (0.5 * at - half_middle_) / side_; }

private:
    glm::dvec3 half_middle_;
    double side_;
};

class Search {
public:
    Search(const PolygonSoup& polygons, std::span<const std::uint32_t> places, const MeshTriangles& triangles,
           std::size_t most_pairs, unsigned threads)
        : polygons_(polygons), places_(places), triangles_(triangles), most_pairs_(most_pairs),
          // Needles round a vertex of high valence all overlap in their boxes: pairs grow with the square of their
          // number.
          most_near_(20'000'000 + 50 * triangles.corners.size()), threads_(threads) {
        const Frame frame(bounding_box(polygons));
        for (std::uint32_t i = 0; i < triangles.corners.size(); ++i)
            if (triangles.normals[i] != glm::dvec3(0))
                items_.push_back(tree_item(i, {frame(corner(i, 0)), frame(corner(i, 1)), frame(corner(i, 2))}));
        if (items_.empty())
            return;
        nodes_ = build_tree(items_, 8, threads);
    }

    SelfIntersections run() const {
        constexpr std::size_t kNodes = 256; // a piece of work
        std::vector<Count> counts((nodes_.size() + kNodes - 1) / kNodes);
        Count all;
        std::atomic<bool> enough{false};
        std::mutex mutex;
        reference::share_out(threads_, counts.size(), [&](std::size_t, std::size_t piece) {
            if (enough)
                return;
            for (std::size_t node = piece * kNodes; node < std::min(nodes_.size(), (piece + 1) * kNodes); ++node)
                for (std::size_t child = 0; child < layout::kMeshChildren; ++child)
                    if (!is_enough(counts[piece]))
                        count_leaf(nodes_[node], child, counts[piece]);
            const std::lock_guard lock(mutex);
            all.add(counts[piece]);
            enough = is_enough(all);
        });
        // Whatever the threads were at, the pieces up to where it is enough were counted.
        Count sum;
        for (auto count = counts.begin(); count != counts.end() && !is_enough(sum); ++count)
            sum.add(*count);
        std::ranges::sort(sum.triangles);
        sum.triangles.erase(std::unique(sum.triangles.begin(), sum.triangles.end()), sum.triangles.end());
        return {std::min(sum.pairs, most_pairs_), std::move(sum.triangles), !is_enough(sum)};
    }

private:
    struct Count {
        std::size_t near = 0, tested = 0, pairs = 0;
        std::vector<std::uint32_t> triangles; // of the pairs

        void add(const Count& other) {
            near += other.near;
            tested += other.tested;
            pairs += other.pairs;
            triangles.insert(triangles.end(), other.triangles.begin(), other.triangles.end());
        }
    };

    bool is_enough(const Count& count) const {
        return count.near > most_near_ || count.tested >= 50 * most_pairs_ || count.pairs >= most_pairs_;
    }

    const glm::dvec3& corner(std::uint32_t triangle, std::size_t i) const {
        return polygons_.vertices[triangles_.corners[triangle][i]];
    }
    std::array<glm::dvec3, 3> corners(std::uint32_t triangle) const {
        return {corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
    }

    // The pairs of a leaf's triangles with one another and with those of leaves behind it.
    void count_leaf(const layout::MeshNode& node, std::size_t i, Count& count) const {
        if (node.child[i] == layout::kMeshNoChild || (node.child[i] & layout::kMeshLeaf) == 0)
            return;
        const reference::MoveBox box{{node.low_x[i], node.low_y[i], node.low_z[i]},
                                     {node.high_x[i], node.high_y[i], node.high_z[i]}};
        reference::visit_leaf(node.child[i], [&](layout::uint first, layout::uint end) {
            layout::uint stack[reference::kMeshStack];
            layout::uint height = 0;
            stack[height++] = 0;
            while (height > 0 && !is_enough(count)) {
                const layout::MeshNode& other = nodes_[stack[--height]];
                for (unsigned meeting = reference::children_meeting(other, box); meeting != 0; meeting &= meeting - 1) {
                    const layout::uint child = other.child[std::countr_zero(meeting)];
                    if ((child & layout::kMeshLeaf) == 0)
                        stack[height++] = child;
                    else
                        reference::visit_leaf(child, [&](layout::uint begin, layout::uint stop) {
                            for (layout::uint k = std::max(begin, first + 1); k < stop; ++k)
                                for (layout::uint one = first; one < std::min(end, k); ++one)
                                    count_pair(items_[one], items_[k], count);
                        });
                }
            }
        });
    }

    void count_pair(const TreeItem& one, const TreeItem& other, Count& count) const {
        using reference::lanes_at;
        const unsigned apart = reference::bits_of((lanes_at(one.low.data()) > lanes_at(other.high.data())) |
                                                  (lanes_at(other.low.data()) > lanes_at(one.high.data())));
        if ((apart & 7U) != 0) // of x, y and z
            return;
        ++count.near;
        for (const std::uint32_t i : triangles_.corners[one.triangle])
            for (const std::uint32_t j : triangles_.corners[other.triangle])
                if (places_[i] == places_[j])
                    return;
        if (!boxes_overlap(one.triangle, other.triangle))
            return;
        ++count.tested;
        if (!triangles_meet(corners(one.triangle), corners(other.triangle)))
            return;
        ++count.pairs;
        count.triangles.insert(count.triangles.end(), {one.triangle, other.triangle});
    }

    bool boxes_overlap(std::uint32_t one, std::uint32_t other) const {
        for (int axis = 0; axis < 3; ++axis) {
            const auto [low, high] = std::minmax({corner(one, 0)[axis], corner(one, 1)[axis], corner(one, 2)[axis]});
            const auto [other_low, other_high] =
                std::minmax({corner(other, 0)[axis], corner(other, 1)[axis], corner(other, 2)[axis]});
            if (low > other_high || other_low > high)
                return false;
        }
        return true;
    }

    const PolygonSoup& polygons_;
    std::span<const std::uint32_t> places_;
    const MeshTriangles& triangles_;
    std::size_t most_pairs_, most_near_;
    unsigned threads_;
    std::vector<TreeItem> items_; // in the tree's order
    std::vector<layout::MeshNode> nodes_;
};

} // namespace

SelfIntersections count_self_intersections(const PolygonSoup& polygons, std::span<const std::uint32_t> places,
                                           const MeshTriangles& triangles, std::size_t most_pairs, unsigned threads) {
    return Search(polygons, places, triangles, most_pairs, reference::threads_for(threads)).run();
}

} // namespace forceshade
