// L6: triangles around a god-object, laid out so that a move is checked against many at once.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

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
    MoveBox box = box_of(move, kBoxMargin<T> + 0.0625F * reach);
    const T length = largest_coordinate(move.way);
    for (int i = 0; i < 3; ++i) {
        const float ahead = length > T(0) ? reach * static_cast<float>(move.way[i] / length) : 0.0F;
        box.low[i] += ahead < 0.0F ? ahead : 0.0F;
        box.high[i] += ahead > 0.0F ? ahead : 0.0F;
    }
    return box;
}

/// All triangles that meet a box (and some others), as planes in columns: one gathering serves the substeps of several
/// updates. Only saves time, as the neighbourhood that it is part of. Single precision, seen from the middle of the
/// box, tells most of them apart from a move; what it lets pass is looked at again.
template <typename T> struct CloseTriangles {
    static constexpr layout::uint kMost = 64;
    static constexpr layout::uint kFew = 16, kMany = 32;
    static constexpr layout::uint kRow = 4;      /* checked together */
    static constexpr layout::uint kPatience = 8; /* moves that pass before the next box is tried */
    // What single precision makes of heights within the box is less than 20 roundings of its longest side.
    static constexpr float kRounding = 0x1p-18F;
    // What T makes of the height above a plane whose corner is far off.
    static constexpr float kFarCorner = static_cast<float>(T(16) * std::numeric_limits<T>::epsilon());
    static constexpr layout::uint kRoom = kMost + 4;
    float normal_x[kRoom], normal_y[kRoom], normal_z[kRoom];
    float offset[kRoom]; /* of the plane from the middle */
    layout::uint triangles[kRoom];
    layout::uint count = 0;
    layout::uint patience = 0;
    Vector<T> low{T(1)}, high{T(-1)}; /* moves between them come close to nothing that is not here */
    Vector<T> middle{T(0)};
    float margin = 0;      /* what is further than this from a plane is further than kCulled */
    float reach = 0x1p-6F; /* how far beyond a move the next box goes */

    void shrink(float share) noexcept { reach *= reach > 0x1p-20F ? share : 1.0F; }

    void forget() noexcept {
        low = Vector<T>(T(1));
        high = Vector<T>(T(-1));
    }

    /// Forgets all triangles; those that meet this box are to be put here.
    void begin(const MoveBox& box) noexcept {
        count = 0;
        float side = 0;
        for (int i = 0; i < 3; ++i) {
            middle[i] = (T(box.low[i]) + T(box.high[i])) * T(0.5);
            side = std::max(side, box.high[i] - box.low[i]);
        }
        margin = static_cast<float>(Skin<T>::kCulled) + kFarCorner + kRounding * side;
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

/// Adds a run of triangles. False if there is no room. Writes fours, the last ones to be written over: no processor
/// guesses how long a run is.
template <typename T>
bool put_close(const layout::MeshView<T>& mesh, layout::uint triangle, layout::uint end,
               CloseTriangles<T>& close) noexcept {
    const layout::uint first = close.count, count = end - triangle;
    if (first + count > CloseTriangles<T>::kMost)
        return false;
    const auto last = static_cast<layout::uint>(mesh.triangle_facets.size() - 1);
    for (layout::uint four = 0; four < count; four += 4)
        for (layout::uint i = four; i < four + 4; ++i) {
            const layout::uint index = std::min(triangle + i, last);
            const Vector<T> normal = vector_at(mesh.triangle_normals, index);
            const Vector<T> corner = vector_at(mesh.vertices, mesh.triangle_corners[3 * std::size_t(index)]);
            close.normal_x[first + i] = static_cast<float>(normal.x);
            close.normal_y[first + i] = static_cast<float>(normal.y);
            close.normal_z[first + i] = static_cast<float>(normal.z);
            close.offset[first + i] = static_cast<float>(dot(normal, corner - close.middle));
            close.triangles[first + i] = index;
        }
    close.count += count;
    return true;
}

/// Fills the last row with what no move meets.
template <typename T> void complete_row(CloseTriangles<T>& close) noexcept {
    for (layout::uint i = close.count; i % CloseTriangles<T>::kRow != 0; ++i) {
        close.normal_x[i] = close.normal_y[i] = close.normal_z[i] = 0;
        close.offset[i] = 16; /* far from everything */
    }
}

/// A move as the close triangles see it: from the middle of their box.
struct CloseMove {
    float from[3], way[3];
};

template <typename T> CloseMove seen_from_middle(const CloseTriangles<T>& close, const Move<T>& move) noexcept {
    CloseMove seen;
    for (int i = 0; i < 3; ++i) {
        seen.from[i] = static_cast<float>(move.from[i] - close.middle[i]);
        seen.way[i] = static_cast<float>(move.until * move.way[i]);
    }
    return seen;
}

/// Bit i of the result: the move may come within kCulled of the plane of triangle i of a row.
template <typename T>
unsigned row_meeting(const CloseTriangles<T>& close, layout::uint row, const CloseMove& move) noexcept {
#if defined(__SSE2__)
    const __m128 x = _mm_loadu_ps(&close.normal_x[row]), y = _mm_loadu_ps(&close.normal_y[row]);
    const __m128 z = _mm_loadu_ps(&close.normal_z[row]);
    const auto product = [&](const float* v) {
        return _mm_add_ps(_mm_add_ps(_mm_mul_ps(x, _mm_set1_ps(v[0])), _mm_mul_ps(y, _mm_set1_ps(v[1]))),
                          _mm_mul_ps(z, _mm_set1_ps(v[2])));
    };
    const __m128 begin = _mm_sub_ps(product(move.from), _mm_loadu_ps(&close.offset[row]));
    const __m128 end = _mm_add_ps(begin, product(move.way));
    const __m128 above = _mm_cmpgt_ps(_mm_min_ps(begin, end), _mm_set1_ps(close.margin));
    const __m128 under = _mm_cmplt_ps(_mm_max_ps(begin, end), _mm_set1_ps(-close.margin));
    return ~static_cast<unsigned>(_mm_movemask_ps(_mm_or_ps(above, under))) & 15U;
#else
    unsigned meeting = 0;
    for (unsigned i = 0; i < CloseTriangles<T>::kRow; ++i) {
        const layout::uint place = row + i;
        const auto product = [&](const float* v) {
            return close.normal_x[place] * v[0] + close.normal_y[place] * v[1] + close.normal_z[place] * v[2];
        };
        const float begin = product(move.from) - close.offset[place], end = begin + product(move.way);
        const bool apart =
            ((begin > close.margin) & (end > close.margin)) | ((begin < -close.margin) & (end < -close.margin));
        meeting |= static_cast<unsigned>(!apart) << i;
    }
    return meeting;
#endif
}

/// Writes the triangles whose planes a move may come within kCulled of, and returns their number. The move must stay
/// within what is known.
template <typename T>
layout::uint sift(const CloseTriangles<T>& close, const Move<T>& move, layout::uint* left) noexcept {
    static_assert(CloseTriangles<T>::kMost <= 64);
    const CloseMove seen = seen_from_middle(close, move);
    // All rows before any bit: a processor guesses badly in which row there is one.
    std::uint64_t meeting = 0;
    for (layout::uint row = 0; row < close.count; row += CloseTriangles<T>::kRow)
        meeting |= std::uint64_t(row_meeting(close, row, seen)) << row;
    layout::uint count = 0;
    for (; meeting != 0; meeting &= meeting - 1)
        left[count++] = close.triangles[std::countr_zero(meeting)];
    return count;
}

} // namespace forceshade::reference
