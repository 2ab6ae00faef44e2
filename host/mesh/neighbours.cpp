// What is near a triangle: triangles that touch or cross, parts too thin for single precision, and the obstacles of a
// god-object.
#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <mutex>

#include <glm/common.hpp>

#include "host/mesh/exact.h"
#include "host/mesh/findings.h"
#include "host/mesh/structure.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_nearest.h"
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

namespace {

constexpr std::size_t kMostLooks = std::size_t(1) << 16;
constexpr double kTouching = 1e-9; /* nearer facets coincide, as the two sides of a sheet */
constexpr double kBeside = 1e-12;  /* what rounding makes of a place on a triangle */

using Place = reference::Vector<double>;

bool is_crossed(const reference::Triangle<double>& triangle, const Place& from, const Place& to, double reach) {
    const double begin = reference::dot(triangle.normal, from - triangle.corners[0]);
    const double end = reference::dot(triangle.normal, to - triangle.corners[0]);
    if (!(begin * end <= 0) || begin == end)
        return false;
    const double time = begin / (begin - end);
    const Place crossing = from + time * (to - from);
    return time * reach > kTouching && reference::nearest_on_triangle(crossing, triangle).square < kBeside * kBeside;
}

bool meets(const layout::MeshNode& node, layout::uint child, const Place& low, const Place& high) {
    return node.low_x[child] <= high.x && node.high_x[child] >= low.x && node.low_y[child] <= high.y &&
           node.high_y[child] >= low.y && node.low_z[child] <= high.z && node.high_z[child] >= low.z;
}

/// Whether a triangle other than this one crosses a straight line from its middle.
bool is_faced(const layout::MeshView<double>& mesh, layout::uint index, double reach) {
    const reference::Triangle<double> triangle = reference::triangle_at(mesh, index);
    const Place middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
    bool faced = false;
    for (const double side : {-reach, reach}) {
        const Place end = middle + side * triangle.normal;
        const Place low = glm::min(middle, end), high = glm::max(middle, end);
        reference::visit_tree(
            mesh, [&](layout::uint) { return !faced; },
            [&](const layout::MeshNode& node, layout::uint child) { return meets(node, child, low, high); },
            [&](layout::uint first, layout::uint last) {
                for (; first < last; ++first)
                    faced = faced ||
                            (first != index && is_crossed(reference::triangle_at(mesh, first), middle, end, reach));
            });
    }
    return faced;
}

} // namespace

bool has_thin_parts(const MeshStructure& structure, double reach) {
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 0);
    const layout::MeshView<double> mesh = tables.view();
    const std::size_t every = std::max<std::size_t>(1, structure.triangles() / kMostLooks);
    for (std::size_t i = 0; i < structure.triangles(); i += every)
        if (is_faced(mesh, static_cast<layout::uint>(i), reach))
            return true;
    return false;
}

using layout::uint;
using reference::Vector;

namespace {

/// Whether a proxy that slides over the front of a triangle, from place to place above it to a skin beyond its edges,
/// may meet another: errs on the side of meeting it.
template <typename T> class SlideOver {
    using Skin = reference::Skin<T>;

public:
    SlideOver(const layout::MeshView<T>& mesh, uint index)
        : mesh_(mesh), index_(index), triangle_(reference::triangle_at(mesh, index)) {
        for (uint i = 0; i < 3; ++i) {
            const Vector<T> edge = triangle_.corners[(i + 1) % 3] - triangle_.corners[i];
            inwards_[i] = reference::cross(triangle_.normal, edge);
            aside_[i] = -kReach * std::sqrt(reference::dot(edge, edge));
        }
    }

    /// Appends what it may meet; kMeshAnyObstacle if that is much, which the tree finds faster.
    void find(std::vector<uint>& obstacles) const {
        constexpr std::size_t kMost = 48;
        const std::size_t before = obstacles.size();
        const auto add = [&](const layout::MeshNode& node, unsigned i) {
            reference::visit_leaf(node.child[i], [&](uint triangle, uint end) {
                for (; triangle < end; ++triangle)
                    if (may_meet(triangle))
                        obstacles.push_back(triangle);
            });
            return obstacles.size() - before <= kMost;
        };
        const bool has_area = reference::dot(triangle_.normal, triangle_.normal) > T(0);
        if (has_area && reference::visit_leaves(mesh_, box(), add))
            return;
        obstacles.resize(before);
        obstacles.push_back(layout::kMeshAnyObstacle);
    }

private:
    reference::MoveBox box() const {
        reference::MoveBox box;
        for (int i = 0; i < 3; ++i) {
            const auto [low, high] =
                std::minmax({triangle_.corners[0][i], triangle_.corners[1][i], triangle_.corners[2][i]});
            box.low[i] = static_cast<float>(low) - kMargin;
            box.high[i] = static_cast<float>(high) + kMargin;
        }
        return box;
    }

    bool may_meet(uint other) const {
        if (other == index_)
            return false;
        const reference::Triangle<T> triangle = reference::triangle_at(mesh_, other);
        T heights[3];
        for (int i = 0; i < 3; ++i)
            heights[i] = reference::dot(triangle_.normal, triangle.corners[i] - triangle_.corners[0]);
        const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
        // As TouchPool::lies_below has it, to the bit.
        if (high <= Skin::kFlush || low > kReach)
            return false;
        for (uint i = 0; i < 3; ++i) {
            const auto side = [&](int corner) {
                return reference::dot(inwards_[i], triangle.corners[corner] - triangle_.corners[i]);
            };
            if (std::max({side(0), side(1), side(2)}) < aside_[i])
                return false;
        }
        return true;
    }

    static constexpr T kReach = Skin::kCorner; /* four times what a slide reaches over the face and beyond its edges */
    static constexpr float kMargin = reference::kBoxMargin<T>;
    const layout::MeshView<T>& mesh_;
    uint index_;
    reference::Triangle<T> triangle_;
    Vector<T> inwards_[3];
    T aside_[3];
};

} // namespace

template <typename T> void find_obstacles(MeshTables<T>& tables, unsigned threads) {
    constexpr std::size_t kShare = 4096; // triangles that a thread takes at once
    const layout::MeshView<T> mesh = tables.view();
    const std::size_t count = mesh.triangle_facets.size();
    std::vector<std::vector<uint>> shares((count + kShare - 1) / kShare);
    auto found = std::make_shared<MeshObstacles>();
    found->begins.resize(count + 1);
    reference::share_out(threads, shares.size(), [&](std::size_t, std::size_t share) {
        const std::size_t end = std::min(count, (share + 1) * kShare);
        for (std::size_t i = share * kShare; i < end; ++i) {
            SlideOver<T>(mesh, static_cast<uint>(i)).find(shares[share]);
            found->begins[i + 1] = static_cast<uint>(shares[share].size());
        }
    });
    for (std::size_t share = 0; share < shares.size(); ++share) {
        const auto first = static_cast<uint>(found->triangles.size());
        for (std::size_t i = share * kShare; i < std::min(count, (share + 1) * kShare); ++i)
            found->begins[i + 1] += first;
        found->triangles.insert(found->triangles.end(), shares[share].begin(), shares[share].end());
    }
    tables.obstacles = std::move(found);
}

template void find_obstacles(MeshTables<float>&, unsigned);
template void find_obstacles(MeshTables<double>&, unsigned);

} // namespace forceshade
