#include "host/mesh/triangle_list.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "host/reference/wide.h"

namespace forceshade {

using reference::Vector;

namespace {

// The loops that plans spend their time in, several triangles at a time where the processor can: same operations, same
// bits.

// Of triangles: corners, circle.
template <typename T> using Columns = std::array<const T*, 10>;

// No iteration of the loop writes what another reads.
#if defined(__GNUC__) && !defined(__clang__)
#define FS_INDEPENDENT _Pragma("GCC ivdep")
#else
#define FS_INDEPENDENT
#endif

// The least over a triangle's corners q of |centre - q|^2 - |side . (q - w)|, side the box's, less the circle and the
// limit: by how much the triangle is further than the witness w from that point of the box where it gains most.
template <typename T>
FS_INLINE void excesses(const Columns<T>& columns, std::size_t count, const Vector<T> centre, const Vector<T> side,
                        const Vector<T> witness, const T limit, T* __restrict result) {
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

// Squared distances from a point to others.
template <typename T>
FS_INLINE void squares(const T* __restrict x, const T* __restrict y, const T* __restrict z, std::size_t count,
                       const Vector<T> point, T* __restrict result) {
    for (std::size_t i = 0; i < count; ++i) {
        const T dx = x[i] - point.x, dy = y[i] - point.y, dz = z[i] - point.z;
        result[i] = dx * dx + dy * dy + dz * dz;
    }
}

// Squares are not below 0, so that their bits compare as they do. With the place in the last bits, one pass over
// integers, several at a time, finds it.
template <typename Bits, typename T> FS_INLINE std::size_t near_least(const T* __restrict values, std::size_t count) {
    const Bits places = static_cast<Bits>(std::bit_ceil(count) - 1);
    Bits least = std::numeric_limits<Bits>::max();
    for (std::size_t i = 0; i < count; ++i) {
        const Bits bits = (std::bit_cast<Bits>(values[i]) & ~places) | static_cast<Bits>(i);
        least = bits < least ? bits : least;
    }
    return static_cast<std::size_t>(least & places);
}

// Eight rows of squared distances, from each corner of a box, x running fastest, to the nearest corner of each
// triangle.
template <typename T>
FS_INLINE void squares_to_corners(const Columns<T>& columns, std::size_t count, const Vector<T> low,
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

// By how much each triangle, its circle less, is at least beyond the limits of all corners.
template <typename T>
FS_INLINE void beyond_limits(const T* __restrict rows, const T* __restrict circle, std::size_t count,
                             const std::array<T, 8> limits, T* __restrict result) {
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

template <typename T> Columns<T> pointers(const std::array<std::vector<T>, 10>& columns) {
    Columns<T> result;
    std::ranges::transform(columns, result.begin(), [](const std::vector<T>& column) { return column.data(); });
    return result;
}

template <typename T> void grow(std::vector<T>& values, std::size_t count) {
    if (values.size() < count)
        values.resize(count + count / 2);
}

// 1 where an excess is not above 0, else 0.
template <typename T>
FS_INLINE void mark(const T* __restrict worst, std::size_t count, std::uint8_t* __restrict marks) {
    for (std::size_t i = 0; i < count; ++i)
        marks[i] = worst[i] > T(0) ? 0 : 1;
}

} // namespace

// The loader picks the processor's own version, so these have external linkage and are not templates.
#define FS_WIDE_LOOPS(T, Bits)                                                                                         \
    FS_WIDE void all_excesses(const Columns<T>& columns, std::size_t count, const Vector<T>& centre,                   \
                              const Vector<T>& side, const Vector<T>& witness, T limit, T* result) {                   \
        excesses(columns, count, centre, side, witness, limit, result);                                                \
    }                                                                                                                  \
    FS_WIDE void all_squares(const T* x, const T* y, const T* z, std::size_t count, const Vector<T>& point,            \
                             T* result) {                                                                              \
        squares(x, y, z, count, point, result);                                                                        \
    }                                                                                                                  \
    FS_WIDE std::size_t near_least_of(const T* values, std::size_t count) {                                            \
        return near_least<Bits>(values, count);                                                                        \
    }                                                                                                                  \
    FS_WIDE void all_squares_to_corners(const Columns<T>& columns, std::size_t count, const Vector<T>& low,            \
                                        const Vector<T>& high, T* rows) {                                              \
        squares_to_corners(columns, count, low, high, rows);                                                           \
    }                                                                                                                  \
    FS_WIDE void all_beyond_limits(const T* rows, const T* circle, std::size_t count, const std::array<T, 8>& limits,  \
                                   T* result) {                                                                        \
        beyond_limits(rows, circle, count, limits, result);                                                            \
    }                                                                                                                  \
    FS_WIDE void mark_kept(const T* worst, std::size_t count, std::uint8_t* marks) {                                   \
        mark(worst, count, marks);                                                                                     \
    }
FS_WIDE_LOOPS(float, std::int32_t)
FS_WIDE_LOOPS(double, std::int64_t)

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

template <typename T> void TriangleList<T>::select(const TriangleList& all, std::span<const layout::uint> places) {
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
    const Vector<T> apart = centre - witness.point;
    const T limit = reference::dot(apart, apart) + witness.margin;
    all_excesses(pointers(columns_), count, centre, side, witness.point, limit, scratch_.data());
    keep(count, places);
}

// The places of all whose excess in scratch_ is not above 0.
template <typename T> void TriangleList<T>::keep(std::size_t count, std::vector<layout::uint>& places) const {
    // Triangles that are dropped mostly stand side by side: eight marks that are all 0 are passed at once.
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
    all_squares_to_corners(pointers(columns_), count, box.low, box.high, squares_.data());
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

template class TriangleList<float>;
template class TriangleList<double>;

} // namespace forceshade
