#include "host/mesh/block_list.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace forceshade {

using reference::Vector;

namespace {

// Several triangles at a time where the processor can: same operations, same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FS_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FS_WIDE
#endif

template <typename T> using Columns = std::array<const T*, 10>; // corners, circle

// The least over a triangle's corners q of |centre - q|^2 - |side . (q - w)|, side the box's, less the circle: by how
// much the triangle is further than the witness w from that point of the box where it gains most, less a constant.
template <typename T>
[[gnu::always_inline]] inline void excesses(const Columns<T>& columns, std::size_t count, const Vector<T> centre,
                                            const Vector<T> side, const Vector<T> witness, const T limit,
                                            T* __restrict worst) {
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
        const T beyond = (ab < c ? ab : c) - circle[i] - limit;
        worst[i] = beyond > worst[i] ? beyond : worst[i];
    }
}

FS_WIDE void all_excesses(const Columns<float>& columns, std::size_t count, const Vector<float>& centre,
                          const Vector<float>& side, const Vector<float>& witness, float limit, float* worst) {
    excesses(columns, count, centre, side, witness, limit, worst);
}
FS_WIDE void all_excesses(const Columns<double>& columns, std::size_t count, const Vector<double>& centre,
                          const Vector<double>& side, const Vector<double>& witness, double limit, double* worst) {
    excesses(columns, count, centre, side, witness, limit, worst);
}

template <typename T>
[[gnu::always_inline]] inline void squares(const T* __restrict x, const T* __restrict y, const T* __restrict z,
                                           std::size_t count, const Vector<T> point, T* __restrict result) {
    for (std::size_t i = 0; i < count; ++i) {
        const T dx = x[i] - point.x, dy = y[i] - point.y, dz = z[i] - point.z;
        result[i] = dx * dx + dy * dy + dz * dz;
    }
}

FS_WIDE void all_squares(const float* x, const float* y, const float* z, std::size_t count, const Vector<float>& point,
                         float* result) {
    squares(x, y, z, count, point, result);
}
FS_WIDE void all_squares(const double* x, const double* y, const double* z, std::size_t count,
                         const Vector<double>& point, double* result) {
    squares(x, y, z, count, point, result);
}

// Squares are not below 0, so that their bits compare as they do; of integers compilers find the least several at a
// time.
template <typename Bits, typename T>
[[gnu::always_inline]] inline std::size_t first_least(const T* __restrict values, std::size_t count) {
    Bits least = std::numeric_limits<Bits>::max();
    for (std::size_t i = 0; i < count; ++i) {
        const Bits bits = std::bit_cast<Bits>(values[i]);
        least = bits < least ? bits : least;
    }
    std::size_t i = 0;
    while (std::bit_cast<Bits>(values[i]) != least)
        ++i;
    return i;
}

FS_WIDE std::size_t least_of(const float* values, std::size_t count) {
    return first_least<std::int32_t>(values, count);
}
FS_WIDE std::size_t least_of(const double* values, std::size_t count) {
    return first_least<std::int64_t>(values, count);
}

template <typename T>
[[gnu::always_inline]] inline void mark(const T* __restrict worst, std::size_t count, std::uint8_t* __restrict marks) {
    for (std::size_t i = 0; i < count; ++i)
        marks[i] = worst[i] > T(0) ? 0 : 1;
}

FS_WIDE void mark_kept(const float* worst, std::size_t count, std::uint8_t* marks) {
    mark(worst, count, marks);
}
FS_WIDE void mark_kept(const double* worst, std::size_t count, std::uint8_t* marks) {
    mark(worst, count, marks);
}

template <typename Value>
[[gnu::always_inline]] inline void gather(const Value* __restrict from, const layout::uint* __restrict places,
                                          std::size_t count, Value* __restrict to) {
    for (std::size_t i = 0; i < count; ++i)
        to[i] = from[places[i]];
}

FS_WIDE void gather_all(const float* from, const layout::uint* places, std::size_t count, float* to) {
    gather(from, places, count, to);
}
FS_WIDE void gather_all(const double* from, const layout::uint* places, std::size_t count, double* to) {
    gather(from, places, count, to);
}

template <typename T> void grow(std::vector<T>& values, std::size_t count) {
    if (values.size() < count)
        values.resize(count + count / 2);
}

} // namespace

template <typename T> bool is_below(const PlanTriangle<T>& triangle, const PlanBox<T>& box, T slack) {
    const Vector<T>& n = triangle.normal;
    if (n.x == T(0) && n.y == T(0) && n.z == T(0))
        return true;
    const Vector<T> lowest{n.x > T(0) ? box.low.x : box.high.x, n.y > T(0) ? box.low.y : box.high.y,
                           n.z > T(0) ? box.low.z : box.high.z};
    return reference::dot(n, lowest) - triangle.offset > slack;
}

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

template <typename T> void TriangleList<T>::take(const TriangleList& all, std::span<const layout::uint> places) {
    const std::size_t count = places.size();
    ids_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        ids_[i] = all.ids_[places[i]];
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        grow(columns_[c], count);
        gather_all(all.columns_[c].data(), places.data(), count, columns_[c].data());
    }
    sample();
}

template <typename T>
void TriangleList<T>::narrow(const PlanBox<T>& box, std::span<const Witness<T>> witnesses,
                             std::vector<layout::uint>& places) const {
    const std::size_t count = size();
    scratch_.resize(std::max(scratch_.size(), count));
    std::fill_n(scratch_.begin(), count, std::numeric_limits<T>::lowest());
    const Vector<T> centre = box.centre(), side = box.high - box.low;
    Columns<T> columns;
    for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c] = columns_[c].data();
    for (const Witness<T>& witness : witnesses) {
        const Vector<T> apart = centre - witness.point;
        const T limit = reference::dot(apart, apart) + witness.margin;
        all_excesses(columns, count, centre, side, witness.point, limit, scratch_.data());
    }
    // What goes mostly goes together: eight marks that are all 0 are passed at once.
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
    return stride_ * least_of(scratch_.data(), samples);
}

template bool is_below(const PlanTriangle<float>&, const PlanBox<float>&, float);
template bool is_below(const PlanTriangle<double>&, const PlanBox<double>&, double);
template class TriangleList<float>;
template class TriangleList<double>;

} // namespace forceshade
