#include "host/mesh/block_loops.h"

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

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

} // namespace forceshade
