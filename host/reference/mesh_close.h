// L6: triangles around a god-object, laid out so that a move is checked against many at once.
#pragma once

#include <bit>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "host/reference/mesh_cast.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade::reference {

/// A box in single precision, rounded outwards by more than rounding within two units of the frame's middle can be off.
struct MoveBox {
    float low[3], high[3];

    bool within(const MoveBox& other) const noexcept {
        for (int i = 0; i < 3; ++i)
            if (!(low[i] >= other.low[i] && high[i] <= other.high[i]))
                return false;
        return true;
    }
};

constexpr MoveBox kNoBox{{1, 1, 1}, {-1, -1, -1}};

/// More than the skin and what rounding to single precision does: the margin of every box.
template <typename T> constexpr float kBoxMargin = static_cast<float>(Skin<T>::kCorner) + 0x1p-20F;

template <typename T> MoveBox box_of(const Move<T>& move, float margin) noexcept {
    const Vector<T> end = move.at(move.until);
    MoveBox box;
    for (int i = 0; i < 3; ++i) {
        const float one = static_cast<float>(move.from[i]), other = static_cast<float>(end[i]);
        box.low[i] = (one < other ? one : other) - margin;
        box.high[i] = (one < other ? other : one) + margin;
    }
    return box;
}

/// The box that a move is likely to go on in: further ahead than aside.
template <typename T> MoveBox box_ahead(const Move<T>& move, float reach) noexcept {
    MoveBox box = box_of(move, kBoxMargin<T> + 0.125F * reach);
    const T length = largest_coordinate(move.way);
    for (int i = 0; i < 3; ++i) {
        const float ahead = length > T(0) ? reach * static_cast<float>(move.way[i] / length) : 0.0F;
        box.low[i] += ahead < 0.0F ? ahead : 0.0F;
        box.high[i] += ahead > 0.0F ? ahead : 0.0F;
    }
    return box;
}

/// All triangles that meet a box (and some others), as planes in columns: one gathering serves the substeps of several
/// updates. Only saves time, as the neighbourhood that it is part of.
template <typename T> struct CloseTriangles {
    static constexpr layout::uint kMost = 64;
    static constexpr layout::uint kFew = 8, kMany = 16;
    static constexpr layout::uint kRow = 4;      /* checked together */
    static constexpr layout::uint kPatience = 8; /* moves that pass before the next box is tried */
    T normal_x[kMost], normal_y[kMost], normal_z[kMost];
    T corner_x[kMost], corner_y[kMost], corner_z[kMost]; /* the first of each */
    layout::uint triangles[kMost];
    layout::uint count = 0;
    layout::uint patience = 0;
    Vector<T> low{T(1)}, high{T(-1)}; /* moves between them come close to nothing that is not here */
    float reach = 0x1p-6F;            /* how far beyond a move the next box goes */

    void shrink(float share) noexcept { reach *= reach > 0x1p-20F ? share : 1.0F; }

    void forget() noexcept {
        low = Vector<T>(T(1));
        high = Vector<T>(T(-1));
    }

    /// All that meets the box was put here.
    void know(const MoveBox& box) noexcept {
        for (int i = 0; i < 3; ++i) {
            low[i] = T(box.low[i]) + T(kBoxMargin<T>);
            high[i] = T(box.high[i]) - T(kBoxMargin<T>);
        }
    }

    bool knows(const Vector<T>& place) const noexcept {
        return (place.x >= low.x) & (place.y >= low.y) & (place.z >= low.z) & (place.x <= high.x) &
               (place.y <= high.y) & (place.z <= high.z);
    }
};

/// Adds a run of triangles. False if there is no room.
template <typename T>
bool put_close(const layout::MeshView<T>& mesh, layout::uint triangle, layout::uint end,
               CloseTriangles<T>& close) noexcept {
    if (close.count + (end - triangle) > CloseTriangles<T>::kMost)
        return false;
    for (; triangle < end; ++triangle) {
        const layout::uint place = close.count++;
        const Vector<T> normal = vector_at(mesh.triangle_normals, triangle);
        const Vector<T> corner = vector_at(mesh.vertices, mesh.triangle_corners[3 * std::size_t(triangle)]);
        close.normal_x[place] = normal.x;
        close.normal_y[place] = normal.y;
        close.normal_z[place] = normal.z;
        close.corner_x[place] = corner.x;
        close.corner_y[place] = corner.y;
        close.corner_z[place] = corner.z;
        close.triangles[place] = triangle;
    }
    return true;
}

/// Fills the last row with what no move meets.
template <typename T> void complete_row(CloseTriangles<T>& close) noexcept {
    for (layout::uint i = close.count; i % CloseTriangles<T>::kRow != 0; ++i) {
        // Far from everything.
        close.normal_x[i] = T(1);
        close.normal_y[i] = close.normal_z[i] = close.corner_y[i] = close.corner_z[i] = T(0);
        close.corner_x[i] = T(16);
    }
}

#if defined(__SSE2__)
/// Bit i of the result: a move comes within kCulled of the plane of triangle i of a row.
inline unsigned row_meeting(const CloseTriangles<double>& close, layout::uint row, const Move<double>& move) noexcept {
    const auto both = [](double one) { return _mm_set1_pd(one); };
    const __m128d far = both(Skin<double>::kCulled), below = both(-Skin<double>::kCulled), until = both(move.until);
    unsigned meeting = 0;
    for (unsigned i = 0; i < 4; i += 2) {
        const __m128d x = _mm_loadu_pd(&close.normal_x[row + i]);
        const __m128d y = _mm_loadu_pd(&close.normal_y[row + i]);
        const __m128d z = _mm_loadu_pd(&close.normal_z[row + i]);
        const auto product = [&](__m128d u, __m128d v, __m128d w) {
            return _mm_add_pd(_mm_add_pd(_mm_mul_pd(x, u), _mm_mul_pd(y, v)), _mm_mul_pd(z, w));
        };
        const __m128d begin = product(_mm_sub_pd(both(move.from.x), _mm_loadu_pd(&close.corner_x[row + i])),
                                      _mm_sub_pd(both(move.from.y), _mm_loadu_pd(&close.corner_y[row + i])),
                                      _mm_sub_pd(both(move.from.z), _mm_loadu_pd(&close.corner_z[row + i])));
        const __m128d rate = product(both(move.way.x), both(move.way.y), both(move.way.z));
        const __m128d end = _mm_add_pd(begin, _mm_mul_pd(until, rate));
        const __m128d above = _mm_cmpgt_pd(_mm_min_pd(begin, end), far);
        const __m128d under = _mm_cmplt_pd(_mm_max_pd(begin, end), below);
        meeting |= (~static_cast<unsigned>(_mm_movemask_pd(_mm_or_pd(above, under))) & 3U) << i;
    }
    return meeting;
}
#endif

/// The same in any precision.
template <typename T>
unsigned row_meeting(const CloseTriangles<T>& close, layout::uint row, const Move<T>& move) noexcept {
    constexpr T kFar = Skin<T>::kCulled;
    unsigned meeting = 0;
    for (unsigned i = 0; i < CloseTriangles<T>::kRow; ++i) {
        const layout::uint place = row + i;
        const T begin = close.normal_x[place] * (move.from.x - close.corner_x[place]) +
                        close.normal_y[place] * (move.from.y - close.corner_y[place]) +
                        close.normal_z[place] * (move.from.z - close.corner_z[place]);
        const T rate = close.normal_x[place] * move.way.x + close.normal_y[place] * move.way.y +
                       close.normal_z[place] * move.way.z;
        const T end = begin + move.until * rate;
        const bool apart = ((begin > kFar) & (end > kFar)) | ((begin < -kFar) & (end < -kFar));
        meeting |= static_cast<unsigned>(!apart) << i;
    }
    return meeting;
}

/// Writes the triangles whose planes a move comes within kCulled of, and returns their number.
template <typename T>
layout::uint sift(const CloseTriangles<T>& close, const Move<T>& move, layout::uint* left) noexcept {
    layout::uint count = 0;
    for (layout::uint row = 0; row < close.count; row += CloseTriangles<T>::kRow)
        for (unsigned meeting = row_meeting(close, row, move); meeting != 0; meeting &= meeting - 1)
            left[count++] = close.triangles[row + static_cast<unsigned>(std::countr_zero(meeting))];
    return count;
}

} // namespace forceshade::reference
