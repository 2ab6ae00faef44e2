// Wald 2007 (binned building) and Dammertz et al. 2008 (four children a node). Splits by the heuristic as long as the
// tree stays shallow enough, at the median from there on.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "host/mesh/structure.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

using Float4 = float __attribute__((vector_size(16))); // x, y, z, and one unused

constexpr float kFar = std::numeric_limits<float>::infinity();

struct Box {
    Float4 low{kFar, kFar, kFar, kFar}, high{-kFar, -kFar, -kFar, -kFar};

    void include(Float4 other_low, Float4 other_high) {
        low = other_low < low ? other_low : low;
        high = other_high > high ? other_high : high;
    }
    void include(const Box& other) { include(other.low, other.high); }
    float half_area() const {
        const Float4 size = high - low;
        return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    }
};

using Int4 = std::int32_t __attribute__((vector_size(16)));

/// The number of a triangle would be a denormal float, with which processors compute very slowly.
Box box_of(const TreeItem& item) {
    constexpr Int4 kUsed{-1, -1, -1, 0};
    Box box = std::bit_cast<Box>(item);
    box.low = Float4(Int4(box.low) & kUsed);
    return box;
}

struct Range {
    std::uint32_t first = 0, count = 0;
    Box box = {}, centroids = {}; // doubled: low + high

    void include(const Box& item) {
        box.include(item);
        centroids.include(item.low + item.high, item.low + item.high);
        ++count;
    }
};

constexpr int kBins = 16;
constexpr float kLeastExtent = 1e-30f; // of doubled centroids, below which an axis is not worth splitting

/// How doubled centroids fall into bins.
struct Binning {
    Float4 low, per_unit;

    explicit Binning(const Box& centroids) : low(centroids.low) {
        const Float4 extent = centroids.high - centroids.low;
        for (int axis = 0; axis < 4; ++axis)
            per_unit[axis] = extent[axis] > kLeastExtent ? 0.9999f * float(kBins) / extent[axis] : 0.0f;
        low[3] = 0;
        per_unit[3] = 0;
    }
    Int4 bins(const Box& item) const { return __builtin_convertvector((item.low + item.high - low) * per_unit, Int4); }
    bool splits(int axis) const { return per_unit[axis] > 0; }
};

struct Split {
    int axis = -1;
    int bin = 0; // first of the right side
    float cost = kFar;
    Box left, right;
};

/// The bins along one axis. Most are of few triangles: only those that have some are touched.
struct Bins {
    Float4 low[kBins], high[kBins];
    std::uint32_t counts[kBins];
    unsigned used; // a bit a bin; all else of the others is undefined

    void include(int bin, const Box& item) {
        if ((used >> bin & 1U) == 0) {
            used |= 1U << bin;
            low[bin] = item.low;
            high[bin] = item.high;
            counts[bin] = 1;
            return;
        }
        Box box{low[bin], high[bin]};
        box.include(item);
        low[bin] = box.low;
        high[bin] = box.high;
        ++counts[bin];
    }

    /// Replaces `best` by the best split along the axis, if that costs less.
    void improve(int axis, Split& best) const {
        std::array<Box, kBins> right_boxes; // of a bin and all behind it
        std::array<float, kBins> right_costs;
        Box box;
        std::uint32_t count = 0;
        for (unsigned left = used; left != 0;) {
            const int bin = static_cast<int>(std::bit_width(left)) - 1;
            left ^= 1U << bin;
            box.include(low[bin], high[bin]);
            count += counts[bin];
            right_boxes[std::size_t(bin)] = box;
            right_costs[std::size_t(bin)] = float(count) * box.half_area();
        }
        box = Box();
        count = 0;
        for (unsigned right = used; right != 0;) {
            const int bin = std::countr_zero(right);
            right &= right - 1;
            if (right == 0)
                break;
            box.include(low[bin], high[bin]);
            count += counts[bin];
            const auto next = static_cast<std::size_t>(std::countr_zero(right));
            const float cost = float(count) * box.half_area() + right_costs[next];
            if (cost < best.cost)
                best = {axis, bin + 1, cost, box, right_boxes[next]};
        }
    }
};

Split best_split(const std::vector<TreeItem>& items, const Range& range, const Binning& binning) {
    std::array<Bins, 3> bins;
    for (Bins& axis : bins)
        axis.used = 0;
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        const Box item = box_of(items[i]);
        const Int4 at = binning.bins(item);
        for (int axis = 0; axis < 3; ++axis)
            bins[std::size_t(axis)].include(at[axis], item);
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis)
        if (binning.splits(axis))
            bins[std::size_t(axis)].improve(axis, best);
    return best;
}

/// At the median of the longest axis, equal centroids by number.
std::pair<Range, Range> halved(std::vector<TreeItem>& items, const Range& range) {
    const Float4 extent = range.centroids.high - range.centroids.low;
    std::size_t axis = extent[1] > extent[0] ? 1 : 0;
    axis = extent[2] > extent[int(axis)] ? 2 : axis;
    const std::uint32_t half = range.count / 2;
    const auto begin = items.begin() + range.first, middle = begin + half, end = begin + range.count;
    std::nth_element(begin, middle, end, [axis](const TreeItem& one, const TreeItem& other) {
        const float at = one.low[axis] + one.high[axis], other_at = other.low[axis] + other.high[axis];
        return at < other_at || (at == other_at && one.triangle < other.triangle);
    });
    Range left{.first = range.first}, right{.first = range.first + half};
    for (auto item = begin; item != end; ++item)
        (item < middle ? left : right).include(box_of(*item));
    return {left, right};
}

/// By the surface-area heuristic over bins of centroids, the items being brought into order; at the median where all
/// centroids fall into one bin.
std::pair<Range, Range> split(std::vector<TreeItem>& items, const Range& range) {
    const Binning binning(range.centroids);
    const Split best = best_split(items, range, binning);
    if (best.axis < 0)
        return halved(items, range);
    Box left, right; // of doubled centroids
    std::uint32_t begin = range.first, end = range.first + range.count;
    while (begin < end) {
        const Box item = box_of(items[begin]);
        const Float4 centroid = item.low + item.high;
        if (binning.bins(item)[best.axis] < best.bin) {
            left.include(centroid, centroid);
            ++begin;
        } else {
            right.include(centroid, centroid);
            std::swap(items[begin], items[--end]);
        }
    }
    const std::uint32_t count = begin - range.first;
    return {{range.first, count, best.left, left}, {begin, range.count - count, best.right, right}};
}

/// A part of the tree that one thread builds, and the child of a node of the top that it is.
struct Task {
    Range range;
    unsigned depth;
    std::size_t parent, slot;
    std::vector<layout::MeshNode> nodes;
};

class Builder {
public:
    Builder(std::vector<TreeItem>& items, unsigned leaf) : items_(items), leaf_(leaf) {}

    /// Appends the node over the range and all below it; returns its index. Given `tasks`, children of no more than
    /// `task_items` become tasks.
    layout::uint build(const Range& range, unsigned depth, std::vector<layout::MeshNode>& nodes,
                       std::vector<Task>* tasks = nullptr, std::uint32_t task_items = 0) const {
        const auto index = static_cast<layout::uint>(nodes.size());
        nodes.push_back(empty_node());
        std::array<Range, layout::kMeshChildren> parts{range};
        const std::size_t count = range.count <= leaf_ ? 1 : split_in_parts(parts, depth);
        for (std::size_t i = 0; i < count; ++i) {
            set_bounds(nodes[index], i, parts[i].box);
            if (parts[i].count <= leaf_) {
                nodes[index].child[i] =
                    layout::kMeshLeaf | (parts[i].first * layout::kMeshLeafTriangles + parts[i].count - 1);
            } else if (tasks && parts[i].count <= task_items) {
                tasks->push_back({parts[i], depth + 1, index, i, {}});
            } else {
                const layout::uint child = build(parts[i], depth + 1, nodes, tasks, task_items);
                nodes[index].child[i] = child;
            }
        }
        return index;
    }

private:
    /// Splits the first part into those that become a node's children; returns their number.
    std::size_t split_in_parts(std::array<Range, layout::kMeshChildren>& parts, unsigned depth) const {
        // What a child at the next depth may hold so that medians still fit below it.
        const unsigned levels = reference::kMeshTreeDepth - 1 - depth;
        const std::uint64_t room = std::uint64_t(leaf_) << std::min(levels, 40u);
        const bool balanced = parts[0].count > room;
        std::size_t count = 1;
        for (; count < parts.size(); ++count) {
            std::size_t widest = count;
            float most = -1;
            for (std::size_t i = 0; i < count; ++i) {
                const float size = balanced ? float(parts[i].count) : parts[i].box.half_area();
                if (parts[i].count > leaf_ && size > most) {
                    most = size;
                    widest = i;
                }
            }
            if (widest == count)
                break;
            std::tie(parts[widest], parts[count]) =
                balanced ? halved(items_, parts[widest]) : split(items_, parts[widest]);
        }
        return count;
    }

    static layout::MeshNode empty_node() {
        layout::MeshNode node;
        for (std::size_t i = 0; i < layout::kMeshChildren; ++i) {
            node.low_x[i] = node.low_y[i] = node.low_z[i] = std::numeric_limits<float>::max();
            node.high_x[i] = node.high_y[i] = node.high_z[i] = std::numeric_limits<float>::lowest();
            node.child[i] = layout::kMeshNoChild;
        }
        return node;
    }

    static void set_bounds(layout::MeshNode& node, std::size_t i, const Box& box) {
        node.low_x[i] = box.low[0];
        node.low_y[i] = box.low[1];
        node.low_z[i] = box.low[2];
        node.high_x[i] = box.high[0];
        node.high_y[i] = box.high[1];
        node.high_z[i] = box.high[2];
    }

    std::vector<TreeItem>& items_;
    unsigned leaf_;
};

float rounded_down(double value) {
    const auto nearest = static_cast<float>(value);
    return double(nearest) > value ? std::nextafter(nearest, -2.0f) : nearest;
}

float rounded_up(double value) {
    const auto nearest = static_cast<float>(value);
    return double(nearest) < value ? std::nextafter(nearest, 2.0f) : nearest;
}

} // namespace

TreeItem tree_item(std::uint32_t triangle, const std::array<glm::dvec3, 3>& corners) {
    TreeItem item{{}, triangle, {}, 0};
    for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
        item.low[i] = rounded_down(low);
        item.high[i] = rounded_up(high);
    }
    return item;
}

std::vector<layout::MeshNode> build_tree(std::vector<TreeItem>& items, unsigned leaf_triangles, unsigned threads) {
    const Builder builder(items, leaf_triangles);
    std::vector<layout::MeshNode> nodes;
    std::vector<Task> tasks;
    Range everything;
    for (const TreeItem& item : items)
        everything.include(box_of(item));
    // The parts' size depends on the mesh alone, so the tree does not depend on the threads.
    builder.build(everything, 0, nodes, &tasks, std::max(4096u, everything.count / 16));
    reference::share_out(threads, tasks.size(), [&](std::size_t, std::size_t i) {
        builder.build(tasks[i].range, tasks[i].depth, tasks[i].nodes);
    });
    std::size_t total = nodes.size();
    for (const Task& task : tasks)
        total += task.nodes.size();
    nodes.reserve(total);
    for (const Task& task : tasks) {
        const auto offset = static_cast<layout::uint>(nodes.size());
        nodes[task.parent].child[task.slot] = offset;
        for (layout::MeshNode node : task.nodes) {
            for (layout::uint& child : node.child)
                if ((child & layout::kMeshLeaf) == 0)
                    child += offset;
            nodes.push_back(node);
        }
    }
    return nodes;
}

namespace {

/// What is below a node: a run of triangles, the sum of their area vectors and of these vectors' lengths.
struct Below {
    layout::uint first = std::numeric_limits<layout::uint>::max(), end = 0;
    glm::dvec3 area{0};
    double all = 0;

    void add(const Below& other) {
        first = std::min(first, other.first);
        end = std::max(end, other.end);
        area += other.area;
        all += other.all;
    }
};

glm::dvec3 corner_at(const MeshParts& parts, const MeshReals<double>& reals, std::size_t corner) {
    const double* at = &reals.vertices[3 * std::size_t(parts.triangle_corners[corner])];
    return {at[0], at[1], at[2]};
}

Below below_leaf(const MeshParts& parts, const MeshReals<double>& reals, layout::uint child) {
    Below below;
    reference::visit_leaf(child, [&](layout::uint first, layout::uint end) {
        for (std::size_t corner = 3 * std::size_t(first); corner < 3 * std::size_t(end); corner += 3) {
            const glm::dvec3 a = corner_at(parts, reals, corner);
            const glm::dvec3 area =
                glm::cross(corner_at(parts, reals, corner + 1) - a, corner_at(parts, reals, corner + 2) - a);
            below.area += area;
            below.all += glm::length(area);
        }
        below.first = first;
        below.end = end;
    });
    return below;
}

/// Sets the slab of a node's child.
void set_slab(const MeshParts& parts, const MeshReals<double>& reals, const Below& below, layout::MeshSlabs& slabs,
              std::size_t i) {
    constexpr double kFacesOneWay = 0.5;  // of the area; where less does, a slab is hardly thinner than the box
    constexpr double kLeastArea = 1e-140; // of smaller ones the squares underflow, and a normal would not be a unit
    slabs.low[i] = -kFar;
    slabs.high[i] = kFar;
    const double length = glm::length(below.area);
    if (!(length > kFacesOneWay * below.all && length > kLeastArea))
        return;
    const glm::dvec3 unit = below.area / (length * (1 + 4 * double(std::numeric_limits<float>::epsilon())));
    slabs.normal_x[i] = static_cast<float>(unit.x);
    slabs.normal_y[i] = static_cast<float>(unit.y);
    slabs.normal_z[i] = static_cast<float>(unit.z);
    const glm::dvec3 normal(slabs.normal_x[i], slabs.normal_y[i], slabs.normal_z[i]);
    double low = kFar, high = -kFar;
    for (std::size_t corner = 3 * std::size_t(below.first); corner < 3 * std::size_t(below.end); ++corner) {
        const double at = glm::dot(normal, corner_at(parts, reals, corner));
        low = std::min(low, at);
        high = std::max(high, at);
    }
    slabs.low[i] = std::nextafter(static_cast<float>(low), -kFar);
    slabs.high[i] = std::nextafter(static_cast<float>(high), kFar);
}

} // namespace

void bound_by_slabs(MeshParts& parts, const MeshReals<double>& reals, unsigned threads) {
    std::vector<Below> below(layout::kMeshChildren * parts.nodes.size()); // of each child
    // Children come after their parents.
    for (std::size_t node = parts.nodes.size(); node-- > 0;)
        for (std::size_t i = 0; i < layout::kMeshChildren; ++i) {
            const layout::uint child = parts.nodes[node].child[i];
            Below& here = below[layout::kMeshChildren * node + i];
            if (child == layout::kMeshNoChild)
                continue;
            if ((child & layout::kMeshLeaf) != 0)
                here = below_leaf(parts, reals, child);
            else
                for (std::size_t k = 0; k < layout::kMeshChildren; ++k)
                    here.add(below[layout::kMeshChildren * child + k]);
        }
    parts.slabs.assign(parts.nodes.size(), {});
    reference::share_out(threads, parts.nodes.size(), [&](std::size_t, std::size_t node) {
        for (std::size_t i = 0; i < layout::kMeshChildren; ++i)
            set_slab(parts, reals, below[layout::kMeshChildren * node + i], parts.slabs[node], i);
    });
}

namespace {

// z of a triangle at (x, y), or lower than everything where it does not cover that. Of two triangles with a common edge
// one at least covers each place of it: both compute the same number for it, but for its sign.
double height_on(const glm::dvec3 (&corners)[3], double x, double y) {
    double areas[3], sum = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 &from = corners[(i + 1) % 3], &to = corners[(i + 2) % 3];
        areas[i] = (from.x - x) * (to.y - y) - (to.x - x) * (from.y - y);
        sum += areas[i];
    }
    const bool inside =
        (areas[0] >= 0 && areas[1] >= 0 && areas[2] >= 0) || (areas[0] <= 0 && areas[1] <= 0 && areas[2] <= 0);
    if (!inside)
        return -std::numeric_limits<double>::infinity();
    const auto [low, high] = std::minmax({corners[0].z, corners[1].z, corners[2].z});
    if (sum == 0) // seen edge-on
        return high;
    return std::clamp((areas[0] * corners[0].z + areas[1] * corners[1].z + areas[2] * corners[2].z) / sum, low, high);
}

} // namespace

std::optional<double> height_at(const MeshStructure& structure, double x, double y) {
    const MeshParts& parts = *structure.parts;
    const glm::dvec3 at = to_mesh_frame(structure, {x, y, 0});
    double best = -std::numeric_limits<double>::infinity();
    layout::MeshView<double> tree{};
    tree.nodes = parts.nodes;
    reference::visit_tree(
        tree, [](layout::uint) { return true; },
        [&](const layout::MeshNode& node, layout::uint i) {
            return at.x >= node.low_x[i] && at.x <= node.high_x[i] && at.y >= node.low_y[i] && at.y <= node.high_y[i] &&
                   node.high_z[i] >= best;
        },
        [&](layout::uint first, layout::uint end) {
            for (std::size_t corner = 3 * std::size_t(first); corner < 3 * std::size_t(end); corner += 3) {
                const glm::dvec3 corners[] = {corner_at(parts, *structure.reals, corner),
                                              corner_at(parts, *structure.reals, corner + 1),
                                              corner_at(parts, *structure.reals, corner + 2)};
                best = std::max(best, height_on(corners, at.x, at.y));
            }
        });
    if (best == -std::numeric_limits<double>::infinity())
        return std::nullopt;
    return structure.centre.z + structure.scale * best;
}

} // namespace forceshade
