#include "host/mesh/structure_split.h"

#include <algorithm>

namespace forceshade {
namespace {

using Whole = std::int32_t __attribute__((vector_size(16)));

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr int kBins = 16;
constexpr float kLeastExtent = 1e-30f; // of doubled centroids, below which an axis is not worth splitting

struct Bin {
    Box box;
    std::uint32_t count = 0;
};

/// How doubled centroids fall into bins.
struct Binning {
    Lanes low, per_unit;

    explicit Binning(const Box& centroids) : low(centroids.low) {
        const Lanes extent = centroids.high - centroids.low;
        for (int axis = 0; axis < 4; ++axis)
            per_unit[axis] = extent[axis] > kLeastExtent ? 0.9999f * float(kBins) / extent[axis] : 0.0f;
        low[3] = 0;
        per_unit[3] = 0;
    }
    Whole bins(const Box& item) const {
        Lanes at = (item.low + item.high - low) * per_unit;
        at[3] = 0;
        return __builtin_convertvector(at, Whole);
    }
    bool splits(int axis) const { return per_unit[axis] > 0; }
};

struct Split {
    int axis = -1;
    int bin = 0; // first of the right side
    float cost = kFar;
};

Split best_on_axis(const std::array<Bin, kBins>& bins, int axis) {
    std::array<float, kBins> right_costs;
    Box box;
    std::uint32_t count = 0;
    for (int i = kBins - 1; i > 0; --i) {
        box.include(bins[std::size_t(i)].box);
        count += bins[std::size_t(i)].count;
        right_costs[std::size_t(i)] = count > 0 ? float(count) * box.half_area() : -1;
    }
    Split best;
    box = Box();
    count = 0;
    for (int i = 1; i < kBins; ++i) {
        box.include(bins[std::size_t(i - 1)].box);
        count += bins[std::size_t(i - 1)].count;
        const float right_cost = right_costs[std::size_t(i)];
        if (count == 0 || right_cost < 0)
            continue;
        const float cost = float(count) * box.half_area() + right_cost;
        if (cost < best.cost)
            best = {axis, i, cost};
    }
    return best;
}

Split best_split(const std::vector<TreeItem>& items, const Range& range, const Binning& binning) {
    std::array<std::array<Bin, kBins>, 3> bins{};
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
        const Box item = box_of(items[i]);
        const Whole at = binning.bins(item);
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[std::size_t(axis)][std::size_t(at[axis])];
            bin.box.include(item);
            ++bin.count;
        }
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        if (!binning.splits(axis))
            continue;
        const Split split = best_on_axis(bins[std::size_t(axis)], axis);
        if (split.cost < best.cost)
            best = split;
    }
    return best;
}

} // namespace

std::pair<Range, Range> split(std::vector<TreeItem>& items, const Range& range) {
    const Binning binning(range.centroids);
    const Split best = best_split(items, range, binning);
    if (best.axis < 0)
        return halved(items, range);
    Range left{.first = range.first}, right;
    std::uint32_t begin = range.first, end = range.first + range.count;
    while (begin < end) {
        const Box item = box_of(items[begin]);
        if (binning.bins(item)[best.axis] < best.bin) {
            left.include(item);
            ++begin;
        } else {
            right.include(item);
            std::swap(items[begin], items[--end]);
        }
    }
    right.first = begin;
    return {left, right};
}

std::pair<Range, Range> halved(std::vector<TreeItem>& items, const Range& range) {
    const Lanes extent = range.centroids.high - range.centroids.low;
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

} // namespace forceshade
