// The tree over triangles: four children a node, binned surface-area heuristic.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade {

/// The box of a triangle, rounded outwards to single precision.
struct TreeItem {
    std::array<float, 3> low;
    std::uint32_t triangle;
    std::array<float, 3> high;
    std::uint32_t unused;
};

/// Brings the items into the tree's order and returns its nodes, root first; leaves are runs of items. No path from the
/// root has more than reference::kMeshTreeDepth nodes, whatever the items. The same for any number of threads.
std::vector<layout::MeshNode> build_tree(std::vector<TreeItem>& items, unsigned leaf_triangles, unsigned threads);

// Runs of a tree's items, and how one is split in two.

using Lanes = float __attribute__((vector_size(16))); // x, y, z, and one that means nothing

struct Box {
    Lanes low{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
              std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
    Lanes high{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
               -std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

    void include(Lanes other_low, Lanes other_high) {
        low = other_low < low ? other_low : low;
        high = other_high > high ? other_high : high;
    }
    void include(const Box& other) { include(other.low, other.high); }
    float half_area() const {
        const Lanes size = high - low;
        return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    }
};

inline Box box_of(const TreeItem& item) {
    return std::bit_cast<Box>(item);
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

/// By the surface-area heuristic over bins of centroids, the items being brought into order; at the median where all
/// centroids fall into one bin.
std::pair<Range, Range> split(std::vector<TreeItem>& items, const Range& range);

/// At the median of the longest axis, equal centroids by number.
std::pair<Range, Range> halved(std::vector<TreeItem>& items, const Range& range);

} // namespace forceshade
