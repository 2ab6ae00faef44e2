// Runs of a tree's items, and how one is split in two.
#pragma once

#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "host/mesh/structure_tree.h"

namespace forceshade {

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
