// Wald 2007 (binned building) and Dammertz et al. 2008 (four children a node). Splits by the heuristic as long as the
// tree stays shallow enough, at the median from there on.
#include "host/mesh/structure_tree.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#include "host/mesh/structure_split.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {
namespace {

constexpr std::uint32_t kTaskItems = 4096;

class Builder {
public:
    Builder(std::vector<TreeItem>& items, unsigned leaf) : items_(items), leaf_(leaf) {}

    Range everything() const {
        Range range;
        for (const TreeItem& item : items_)
            range.include(box_of(item));
        return range;
    }

    /// The up to four parts that become a node's children.
    std::vector<Range> children(const Range& range, unsigned depth) const {
        // What a child at the next depth may hold so that medians still fit below it.
        const unsigned levels = reference::kMeshTreeDepth - 1 - depth;
        const std::uint64_t room = std::uint64_t(leaf_) << std::min(levels, 40u);
        const bool balanced = range.count > room;
        std::vector<Range> parts{range};
        while (parts.size() < layout::kMeshChildren) {
            std::size_t widest = parts.size();
            float most = -1;
            for (std::size_t i = 0; i < parts.size(); ++i) {
                const float size = balanced ? float(parts[i].count) : parts[i].box.half_area();
                if (parts[i].count > leaf_ && size > most) {
                    most = size;
                    widest = i;
                }
            }
            if (widest == parts.size())
                break;
            const auto [left, right] = balanced ? halved(items_, parts[widest]) : split(items_, parts[widest]);
            parts[widest] = left;
            parts.push_back(right);
        }
        return parts;
    }

    bool is_leaf(const Range& range) const { return range.count <= leaf_; }

    static layout::uint leaf(const Range& range) {
        return layout::kMeshLeaf | (range.first * layout::kMeshLeafTriangles + range.count - 1);
    }

    /// Appends the node over the range and all below it; returns its index.
    layout::uint build(const Range& range, unsigned depth, std::vector<layout::MeshNode>& nodes) const {
        const auto index = static_cast<layout::uint>(nodes.size());
        nodes.push_back(empty_node());
        const std::vector<Range> parts = is_leaf(range) ? std::vector<Range>{range} : children(range, depth);
        for (std::size_t i = 0; i < parts.size(); ++i) {
            set_bounds(nodes[index], i, parts[i].box);
            const layout::uint child = is_leaf(parts[i]) ? leaf(parts[i]) : build(parts[i], depth + 1, nodes);
            nodes[index].child[i] = child;
        }
        return index;
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

private:
    std::vector<TreeItem>& items_;
    unsigned leaf_;
};

/// A part of the tree that one thread builds, and where it hangs.
struct Task {
    Range range;
    unsigned depth;
    std::size_t parent, slot;
    std::vector<layout::MeshNode> nodes;
};

/// The top of the tree, down to parts small enough to be shared out. Their size depends on the mesh alone.
std::vector<Task> build_top(const Builder& builder, const Range& everything, std::vector<layout::MeshNode>& nodes) {
    struct Open {
        Range range;
        unsigned depth;
    };
    const std::uint32_t task_items = std::max(kTaskItems, everything.count / 16);
    std::vector<Open> open{{everything, 0}};
    std::vector<Task> tasks;
    nodes.push_back(Builder::empty_node());
    for (std::size_t index = 0; index < open.size(); ++index) {
        const std::vector<Range> parts = builder.is_leaf(open[index].range)
                                             ? std::vector<Range>{open[index].range}
                                             : builder.children(open[index].range, open[index].depth);
        const unsigned depth = open[index].depth + 1;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            Builder::set_bounds(nodes[index], i, parts[i].box);
            if (builder.is_leaf(parts[i])) {
                nodes[index].child[i] = Builder::leaf(parts[i]);
            } else if (parts[i].count <= task_items) {
                tasks.push_back({parts[i], depth, index, i, {}});
            } else {
                nodes[index].child[i] = static_cast<layout::uint>(nodes.size());
                nodes.push_back(Builder::empty_node());
                open.push_back({parts[i], depth});
            }
        }
    }
    return tasks;
}

void run_tasks(const Builder& builder, std::vector<Task>& tasks, unsigned threads) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < tasks.size(); i = next++)
            builder.build(tasks[i].range, tasks[i].depth, tasks[i].nodes);
    };
    std::vector<std::jthread> others;
    for (unsigned i = 1; i < threads; ++i)
        others.emplace_back(work);
    work();
}

} // namespace

std::vector<layout::MeshNode> build_tree(std::vector<TreeItem>& items, unsigned leaf_triangles, unsigned threads) {
    const Builder builder(items, leaf_triangles);
    std::vector<layout::MeshNode> nodes;
    std::vector<Task> tasks = build_top(builder, builder.everything(), nodes);
    run_tasks(builder, tasks, threads);
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

} // namespace forceshade
