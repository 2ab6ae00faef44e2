#include "host/mesh/block_worker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "host/mesh/block_plan.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

using reference::Vector;

namespace {

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FS_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FS_WIDE
#endif

// No iteration of the loop writes what another reads.
#if defined(__GNUC__) && !defined(__clang__)
#define FS_INDEPENDENT _Pragma("GCC ivdep")
#else
#define FS_INDEPENDENT
#endif

template <typename T>
[[gnu::always_inline]] inline void excesses(const Columns<T>& columns, std::size_t count, const Vector<T> centre,
                                            const Vector<T> side, const Vector<T> witness, const T limit,
                                            T* __restrict result) {
    const T* const __restrict a_x = columns[0], * const __restrict a_y = columns[1], * const __restrict a_z = columns[2];
    const T* const __restrict b_x = columns[3], * const __restrict b_y = columns[4], * const __restrict b_z = columns[5];
    const T* const __restrict c_x = columns[6], * const __restrict c_y = columns[7], * const __restrict c_z = columns[8];
    const T* const __restrict circle = columns[9];
    const auto excess = [&](T x, T y, T z) __attribute__((always_inline)) {
        const T dx = x - centre.x, dy = y - centre.y, dz = z - centre.z;
        return dx * dx + dy * dy + dz * dz -
               (side.x * std::abs(x - witness.x) + side.y * std::abs(y - witness.y) + side.z * std::abs(z - witness.z));
    };
    for (std::size_t i = 0; i < count; ++i) {
        const T a = excess(a_x[i], a_y[i], a_z[i]);
        const T b = excess(b_x[i], b_y[i], b_z[i]);
        const T c = excess(c_x[i], c_y[i], c_z[i]);
        const T ab = a < b ? a : b;
        result[i] = (ab < c ? ab : c) - circle[i] - limit;
    }
}

template <typename T>
[[gnu::always_inline]] inline void squares(const T* __restrict x, const T* __restrict y, const T* __restrict z,
                                           std::size_t count, const Vector<T> point, T* __restrict result) {
    for (std::size_t i = 0; i < count; ++i) {
        const T dx = x[i] - point.x, dy = y[i] - point.y, dz = z[i] - point.z;
        result[i] = dx * dx + dy * dy + dz * dz;
    }
}

// Squares are not below 0, so that their bits compare as they do. With the place in the last bits, one pass over
// integers, several at a time, finds it.
template <typename Bits, typename T>
[[gnu::always_inline]] inline std::size_t near_least(const T* __restrict values, std::size_t count) {
    const Bits places = static_cast<Bits>(std::bit_ceil(count) - 1);
    Bits least = std::numeric_limits<Bits>::max();
    for (std::size_t i = 0; i < count; ++i) {
        const Bits bits = (std::bit_cast<Bits>(values[i]) & ~places) | static_cast<Bits>(i);
        least = bits < least ? bits : least;
    }
    return static_cast<std::size_t>(least & places);
}

template <typename T>
[[gnu::always_inline]] inline void squares_to_corners(const Columns<T>& columns, std::size_t count, const Vector<T> low,
                                                      const Vector<T> high, T* __restrict rows) {
    const T* const __restrict a_x = columns[0], * const __restrict a_y = columns[1], * const __restrict a_z = columns[2];
    const T* const __restrict b_x = columns[3], * const __restrict b_y = columns[4], * const __restrict b_z = columns[5];
    const T* const __restrict c_x = columns[6], * const __restrict c_y = columns[7], * const __restrict c_z = columns[8];
    const auto square = [](T at, T from) __attribute__((always_inline)) {
        return (at - from) * (at - from);
    };
    const auto least = [](T a, T b, T c) __attribute__((always_inline)) {
        const T ab = a < b ? a : b;
        return ab < c ? ab : c;
    };
    FS_INDEPENDENT for (std::size_t i = 0; i < count; ++i) {
        const T ax[2] = {square(a_x[i], low.x), square(a_x[i], high.x)};
        const T ay[2] = {square(a_y[i], low.y), square(a_y[i], high.y)};
        const T az[2] = {square(a_z[i], low.z), square(a_z[i], high.z)};
        const T bx[2] = {square(b_x[i], low.x), square(b_x[i], high.x)};
        const T by[2] = {square(b_y[i], low.y), square(b_y[i], high.y)};
        const T bz[2] = {square(b_z[i], low.z), square(b_z[i], high.z)};
        const T cx[2] = {square(c_x[i], low.x), square(c_x[i], high.x)};
        const T cy[2] = {square(c_y[i], low.y), square(c_y[i], high.y)};
        const T cz[2] = {square(c_z[i], low.z), square(c_z[i], high.z)};
        const auto put = [&]<std::size_t... k>(std::index_sequence<k...>) __attribute__((always_inline)) {
            ((rows[k * count + i] =
                  least(ax[k & 1] + ay[k >> 1 & 1] + az[k >> 2], bx[k & 1] + by[k >> 1 & 1] + bz[k >> 2],
                        cx[k & 1] + cy[k >> 1 & 1] + cz[k >> 2])),
             ...);
        };
        put(std::make_index_sequence<8>());
    }
}

template <typename T>
[[gnu::always_inline]] inline void beyond_limits(const T* __restrict rows, const T* __restrict circle,
                                                 std::size_t count, const std::array<T, 8> limits,
                                                 T* __restrict result) {
    const auto less = [](T a, T b) __attribute__((always_inline)) {
        return a < b ? a : b;
    };
    FS_INDEPENDENT for (std::size_t i = 0; i < count; ++i) {
        const auto beyond = [&](std::size_t k) __attribute__((always_inline)) {
            return rows[k * count + i] - limits[k];
        };
        result[i] = less(less(less(beyond(0), beyond(1)), less(beyond(2), beyond(3))),
                         less(less(beyond(4), beyond(5)), less(beyond(6), beyond(7)))) -
                    circle[i];
    }
}

template <typename T>
[[gnu::always_inline]] inline void mark(const T* __restrict worst, std::size_t count, std::uint8_t* __restrict marks) {
    for (std::size_t i = 0; i < count; ++i)
        marks[i] = worst[i] > T(0) ? 0 : 1;
}

} // namespace

FS_WIDE void all_excesses(const Columns<float>& columns, std::size_t count, const Vector<float>& centre,
                          const Vector<float>& side, const Vector<float>& witness, float limit, float* result) {
    excesses(columns, count, centre, side, witness, limit, result);
}

FS_WIDE void all_excesses(const Columns<double>& columns, std::size_t count, const Vector<double>& centre,
                          const Vector<double>& side, const Vector<double>& witness, double limit, double* result) {
    excesses(columns, count, centre, side, witness, limit, result);
}

FS_WIDE void all_squares(const float* x, const float* y, const float* z, std::size_t count, const Vector<float>& point,
                         float* result) {
    squares(x, y, z, count, point, result);
}

FS_WIDE void all_squares(const double* x, const double* y, const double* z, std::size_t count,
                         const Vector<double>& point, double* result) {
    squares(x, y, z, count, point, result);
}

FS_WIDE std::size_t near_least_of(const float* values, std::size_t count) {
    return near_least<std::int32_t>(values, count);
}

FS_WIDE std::size_t near_least_of(const double* values, std::size_t count) {
    return near_least<std::int64_t>(values, count);
}

FS_WIDE void all_squares_to_corners(const Columns<float>& columns, std::size_t count, const Vector<float>& low,
                                    const Vector<float>& high, float* rows) {
    squares_to_corners(columns, count, low, high, rows);
}

FS_WIDE void all_squares_to_corners(const Columns<double>& columns, std::size_t count, const Vector<double>& low,
                                    const Vector<double>& high, double* rows) {
    squares_to_corners(columns, count, low, high, rows);
}

FS_WIDE void all_beyond_limits(const float* rows, const float* circle, std::size_t count,
                               const std::array<float, 8>& limits, float* result) {
    beyond_limits(rows, circle, count, limits, result);
}

FS_WIDE void all_beyond_limits(const double* rows, const double* circle, std::size_t count,
                               const std::array<double, 8>& limits, double* result) {
    beyond_limits(rows, circle, count, limits, result);
}

FS_WIDE void mark_kept(const float* worst, std::size_t count, std::uint8_t* marks) {
    mark(worst, count, marks);
}

FS_WIDE void mark_kept(const double* worst, std::size_t count, std::uint8_t* marks) {
    mark(worst, count, marks);
}

using layout::kMeshBlock;
using layout::uint;
using reference::Vector;

namespace {

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

// The winding number is good to 1e-4 (mesh_winding.h), at both places that it is compared at.
constexpr double kWindingDoubt = 1e-3;

constexpr uint kLeastSided = 4; // samples a side of boxes whose side is asked for

} // namespace

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

template <typename T> PlanBox<T> PlanInput<T>::box(const SampleRange& range) const {
    PlanBox<T> box;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        box.low[i] = axes[axis][range.first[axis]];
        box.high[i] = axes[axis][range.last[axis]];
    }
    return box;
}

template <typename T> Witness<T> BlockWorker<T>::witness_from(const PlanBox<T>& box, const Vector<T>& point) const {
    const Vector<T> apart = box.centre() - point, half = box.half();
    const T reach = std::sqrt(reference::dot(apart, apart)) + T(2) * std::sqrt(reference::dot(half, half));
    return {point, T(4) * input_.slack * (reach + input_.slack)};
}

template <typename T>
reference::TrianglePoint<T> BlockWorker<T>::nearest_on(uint triangle, const Vector<T>& point) const {
    const PlanTriangle<T>& row = input_.rows[triangle];
    const auto corner = [&](std::size_t i) { return reference::vector_at(std::span<const T>(row.corners), i); };
    return reference::nearest_on_triangle(point, corner(0), corner(1), corner(2), row.normal);
}

// A point of the surface that is near, and often the nearest.
template <typename T> Vector<T> BlockWorker<T>::point_near(const TriangleList<T>& list, const Vector<T>& point) {
    hint_ = list.ids()[list.near_one(point)];
    return point + nearest_on(hint_, point).offset;
}

// Above the planes of all that may be nearest, and so of all that meet in the nearest point: outside by any
// pseudonormal.
template <typename T> bool BlockWorker<T>::is_outside(const TriangleList<T>& list, const PlanBox<T>& box) const {
    return std::ranges::all_of(places_,
                               [&](uint place) { return is_below(input_.rows[list.ids()[place]], box, input_.slack); });
}

// On which side a box is, told from its centre; `both` where that does not tell. Away from its surface a solid has one
// side, and the winding number changes little. `near` is on the surface: where it is near enough, nothing is asked.
template <typename T>
typename BlockWorker<T>::Side BlockWorker<T>::side_of(const PlanBox<T>& box, const Vector<T>& near) {
    const Vector<T> centre = box.centre(), half = box.half(), apart = near - centre;
    const T radius = std::sqrt(reference::dot(half, half)) + input_.slack;
    const auto is_apart = [&](T square) { return std::sqrt(square) > radius + input_.slack; };
    if (!is_apart(reference::dot(apart, apart)))
        return Side::both;
    const auto nearest = reference::nearest(input_.mesh, centre, hint_);
    hint_ = nearest.triangle;
    if (!is_apart(nearest.square))
        return Side::both;
    if (input_.inside != layout::kInsideWinding)
        return reference::inside_by_pseudonormal(input_.mesh, nearest) ? Side::inside : Side::outside;
    const Vector<double> probe(centre);
    const double winding = reference::winding_number(input_.mesh, probe);
    const double change = reference::winding_change(input_.mesh, probe, static_cast<double>(radius));
    if (!(std::abs(winding - 0.5) > change + kWindingDoubt))
        return Side::both;
    return winding > 0.5 ? Side::inside : Side::outside;
}

// True if no sample of the box can be inside. `side` is told as well, once it can be.
template <typename T>
bool BlockWorker<T>::is_free(const TriangleList<T>& list, const PlanBox<T>& box, const Vector<T>& near,
                             uint side_length, Side& side) {
    if (input_.visits_free)
        return false;
    if (input_.inside != layout::kInsideWinding) {
        if (side == Side::inside)
            return false;
        if (is_outside(list, box))
            return true;
        // In small boxes the planes tell nearly as much, for less.
        if (!input_.mesh.solid || side_length < kLeastSided)
            return false;
    }
    if (side == Side::both)
        side = side_of(box, near);
    return side == Side::outside;
}

// Through the tree: the least of the excess over a node's box, along each axis at one of the box's ends or between.
template <typename T> void BlockWorker<T>::collect(const PlanBox<T>& box, const Witness<T>& witness) {
    const auto least = [&](int axis, T low, T high) {
        const auto part = [&](T end) {
            const T beyond = low - end > end - high ? low - end : end - high;
            const T near = beyond > T(0) ? beyond : T(0), far = end - witness.point[axis];
            return near * near - far * far;
        };
        const T at_low = part(box.low[axis]), at_high = part(box.high[axis]);
        return at_low < at_high ? at_low : at_high;
    };
    collected_.clear();
    uint stack[reference::kMeshStack];
    uint height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const layout::MeshNode& node = input_.mesh.nodes[stack[--height]];
        T excess[layout::kMeshChildren];
        for (uint i = 0; i < layout::kMeshChildren; ++i)
            excess[i] = least(0, T(node.low_x[i]), T(node.high_x[i])) + least(1, T(node.low_y[i]), T(node.high_y[i])) +
                        least(2, T(node.low_z[i]), T(node.high_z[i]));
        for (uint i = 0; i < layout::kMeshChildren; ++i) {
            const uint child = node.child[i];
            if (child == layout::kMeshNoChild || excess[i] > witness.margin)
                continue;
            if ((child & layout::kMeshLeaf) == 0) {
                stack[height++] = child;
                continue;
            }
            const uint run = child & ~layout::kMeshLeaf;
            for (uint k = 0; k <= run % layout::kMeshLeafTriangles; ++k)
                collected_.push_back(run / layout::kMeshLeafTriangles + k);
        }
    }
}

// The nearest triangle of each voxel, where too many may be.
template <typename T> void BlockWorker<T>::add_nearest(const SampleRange& range) {
    const std::size_t first = candidates.size();
    for (uint z = range.first[2]; z <= range.last[2]; ++z)
        for (uint y = range.first[1]; y <= range.last[1]; ++y)
            for (uint x = range.first[0]; x <= range.last[0]; ++x) {
                const Vector<T> probe{input_.axes[0][x], input_.axes[1][y], input_.axes[2][z]};
                hint_ = reference::nearest(input_.mesh, probe, hint_).triangle;
                if (std::find(candidates.begin() + std::ptrdiff_t(first), candidates.end(), hint_) == candidates.end())
                    candidates.push_back(hint_);
            }
}

// Bit (z * 2 + y) * 2 + x of each sample that is inside by the winding number.
template <typename T> uint BlockWorker<T>::inside_bits(const SampleRange& range, Side side) const {
    uint bits = 0;
    for (uint z = range.first[2]; z <= range.last[2]; ++z)
        for (uint y = range.first[1]; y <= range.last[1]; ++y)
            for (uint x = range.first[0]; x <= range.last[0]; ++x) {
                const Vector<T> probe{input_.axes[0][x], input_.axes[1][y], input_.axes[2][z]};
                const uint bit = ((z - range.first[2]) * 2 + y - range.first[1]) * 2 + x - range.first[0];
                if (side == Side::inside || reference::inside_by_winding(input_.mesh, probe))
                    bits |= 1u << bit;
            }
    return bits;
}

// By each sample's distance to a triangle that is near to it.
template <typename T> void BlockWorker<T>::narrow_to_samples(const PlanBox<T>& box, const TriangleList<T>& list) {
    long_list_.take(list, places_);
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
template <typename T>
void BlockWorker<T>::leaf(const SampleRange& range, const PlanBox<T>& box, const TriangleList<T>& list, Side side) {
    const bool winding = input_.inside == layout::kInsideWinding;
    const uint bits = winding ? inside_bits(range, side) : 0;
    if (winding && bits == 0 && !input_.visits_free)
        return;
    const bool is_long = places_.size() > kLong;
    if (is_long)
        narrow_to_samples(box, list);
    const std::vector<uint>& ids = is_long ? long_list_.ids() : list.ids();
    const auto first = static_cast<uint>(candidates.size());
    if (places_.size() > kMostCandidates)
        add_nearest(range);
    else
        for (const uint place : places_)
            candidates.push_back(ids[place]);
    blocks.push_back(
        {range.first[0], range.first[1], range.first[2], first, static_cast<uint>(candidates.size()) - first});
    if (winding)
        inside.push_back(bits);
}

// The eighths of a box whose list stands at `level`.
template <typename T>
void BlockWorker<T>::split(const SampleRange& range, std::size_t level, uint side_length, Side side) {
    const uint half = side_length / 2;
    for (uint part = 0; part < 8; ++part) {
        SampleRange eighth;
        bool empty = false;
        for (std::size_t i = 0; i < 3; ++i) {
            eighth.first[i] = range.first[i] + (part >> i & 1 ? half : 0);
            eighth.last[i] = std::min(range.last[i], eighth.first[i] + half - 1);
            empty = empty || eighth.first[i] > range.last[i];
        }
        if (empty)
            continue;
        const PlanBox<T> box = input_.box(eighth);
        const TriangleList<T>& list = lists_[level];
        const Witness<T> witness = witness_from(box, point_near(list, box.centre()));
        list.narrow(box, witness, places_);
        Side eighth_side = side;
        if (is_free(list, box, witness.point, half, eighth_side))
            continue;
        if (half == kMeshBlock) {
            leaf(eighth, box, list, eighth_side);
            continue;
        }
        lists_[level + 1].take(list, places_);
        split(eighth, level + 1, half, eighth_side);
    }
}

template <typename T> void BlockWorker<T>::plan(const SampleRange& tile) {
    const PlanBox<T> box = input_.box(tile);
    const auto nearest = reference::nearest(input_.mesh, box.centre(), hint_);
    hint_ = nearest.triangle;
    const Witness<T> witness = witness_from(box, Vector<T>(box.centre() + nearest.offset));
    collect(box, witness);
    lists_[0].fill(collected_, input_.rows);
    lists_[0].narrow(box, witness, places_);
    Side side = Side::both;
    if (is_free(lists_[0], box, witness.point, kPlanTile, side))
        return;
    lists_[1].take(lists_[0], places_);
    split(tile, 1, kPlanTile, side);
}

template struct PlanInput<float>;
template struct PlanInput<double>;
template PlanTriangle<float> plan_triangle(const layout::MeshView<float>&, std::size_t, float);
template PlanTriangle<double> plan_triangle(const layout::MeshView<double>&, std::size_t, double);
template class BlockWorker<float>;
template class BlockWorker<double>;

} // namespace forceshade
