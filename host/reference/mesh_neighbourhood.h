// L6: the triangles that a short move of a god-object may come close to: leaves out of the tree, and of those the
// closest, laid out so that a move is checked against many at once.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "host/reference/mesh_cast.h"
#include "host/reference/mesh_nearest.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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
    MoveBox box = box_of(move, kBoxMargin<T> + 0.25F * reach);
    const T length = largest_coordinate(move.displacement);
    for (int i = 0; i < 3; ++i) {
        const float ahead = length > T(0) ? reach * static_cast<float>(move.displacement[i] / length) : 0.0F;
        box.low[i] += ahead < 0.0F ? ahead : 0.0F;
        box.high[i] += ahead > 0.0F ? ahead : 0.0F;
    }
    return box;
}

/// All triangles that meet a box (and some others), as planes in columns: one gathering serves the substeps of several
/// updates. Only saves time, as the neighbourhood that it is part of. Single precision, seen from the middle of the
/// box, excludes most of them for a move; the others are checked again.
template <typename T> struct CloseTriangles {
    static constexpr layout::uint kMost = 64;
    static constexpr layout::uint kFew = 16, kMany = 32;
    static constexpr layout::uint kRow = kLanes<float>; /* checked together */
    static constexpr layout::uint kPatience = 8;        /* moves that pass before the next box is tried */
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
    Vector<T> low{T(1)}, high{T(-1)}; /* moves between them approach only triangles that are here */
    Vector<T> middle{T(0)};
    float margin = 0;      /* further than this from a plane is further than kCulled */
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

/// Adds a run of triangles. False without room. Writes fours, the last ones to be written over: the length of a run
/// is unpredictable.
template <typename T>
bool add_close(const layout::MeshView<T>& mesh, layout::uint triangle, layout::uint end,
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
    float from[3], displacement[3];
};

template <typename T> CloseMove seen_from_middle(const CloseTriangles<T>& close, const Move<T>& move) noexcept {
    CloseMove seen;
    for (int i = 0; i < 3; ++i) {
        seen.from[i] = static_cast<float>(move.from[i] - close.middle[i]);
        seen.displacement[i] = static_cast<float>(move.until * move.displacement[i]);
    }
    return seen;
}

/// Bit i of the result: lane i of the mask is set.
inline unsigned bits_of(LaneMask<float> mask) noexcept {
#if defined(__SSE2__)
    return static_cast<unsigned>(_mm_movemask_ps(std::bit_cast<__m128>(mask)));
#else
    unsigned bits = 0;
    for (unsigned i = 0; i < kLanes<float>; ++i)
        bits |= static_cast<unsigned>(mask[i] != 0) << i;
    return bits;
#endif
}

inline Lanes<float> lanes_at(const float* numbers) noexcept {
    Lanes<float> lanes;
    std::memcpy(&lanes, numbers, sizeof lanes);
    return lanes;
}

/// Bit i of the result: the move may come within kCulled of the plane of triangle i of a row.
template <typename T>
unsigned row_meeting(const CloseTriangles<T>& close, layout::uint row, const CloseMove& move) noexcept {
    const Lanes<float> x = lanes_at(&close.normal_x[row]), y = lanes_at(&close.normal_y[row]);
    const Lanes<float> z = lanes_at(&close.normal_z[row]);
    const Lanes<float> begin = (x * move.from[0] + y * move.from[1] + z * move.from[2]) - lanes_at(&close.offset[row]);
    const Lanes<float> end = begin + (x * move.displacement[0] + y * move.displacement[1] + z * move.displacement[2]);
    const Lanes<float> lower = begin < end ? begin : end, upper = begin > end ? begin : end;
    return ~bits_of((lower > close.margin) | (upper < -close.margin)) & 15U;
}

/// Writes the triangles whose planes a move may come within kCulled of, and returns their number. The move must stay
/// within what is known.
template <typename T>
layout::uint sift(const CloseTriangles<T>& close, const Move<T>& move, layout::uint* left) noexcept {
    static_assert(CloseTriangles<T>::kMost <= 64);
    const CloseMove seen = seen_from_middle(close, move);
    // All rows before any bit: which row has one is unpredictable.
    std::uint64_t meeting = 0;
    for (layout::uint row = 0; row < close.count; row += CloseTriangles<T>::kRow)
        meeting |= std::uint64_t(row_meeting(close, row, seen)) << row;
    layout::uint count = 0;
    for (; meeting != 0; meeting &= meeting - 1)
        left[count++] = close.triangles[std::countr_zero(meeting)];
    return count;
}

/// The leaves of the tree that meet a box around where a god-object lately was, in fours as a node has its children.
/// Only saves time: results do not depend on it. One per thread and mesh; no mesh may take the
/// place of another under it.
template <typename T> struct Neighbourhood {
    static constexpr layout::uint kFours = 12;
    static constexpr layout::uint kFewFours = 3;
    layout::MeshNode fours[kFours];
    layout::uint count = 0; /* fours in use */
    MoveBox box = kNoBox;   /* leaves outside of it are unknown */
    float reach = 0x1p-3F;  /* how far beyond a move the next box goes */
    CloseTriangles<T> close;
};

/// Prefetches data that will be read soon. Inlined always, as what calls it alone: the compiler takes a function
/// with only this for one without effect, and drops the call.
[[gnu::always_inline]] inline void fetch([[maybe_unused]] const void* address) noexcept {
#if defined(__GNUC__)
    __builtin_prefetch(address);
#endif
}

/// The same for what a walk reads of the triangles across a triangle's edges: one of them comes next, most likely. No
/// more than that, since few lines of the cache can be on their way at once.
template <typename T>
[[gnu::always_inline]] inline void fetch_neighbours(const layout::MeshView<T>& mesh, layout::uint triangle) noexcept {
    fetch(&mesh.triangle_facets[triangle]);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t across = mesh.triangle_neighbours[3 * std::size_t(triangle) + i];
        if (across >= mesh.triangle_facets.size())
            continue;
        fetch(&mesh.triangle_corners[3 * across]);
        fetch(&mesh.triangle_normals[3 * across]);
        fetch(&mesh.triangle_neighbours[3 * across]);
        if (!mesh.obstacle_begins.empty())
            fetch(&mesh.obstacle_begins[across]);
    }
}

/// Bit i of the result: child i of the node meets the box. Places without a child have boxes that meet no other.
inline unsigned children_meeting(const layout::MeshNode& node, const MoveBox& box) noexcept {
    const auto meets = [&](const float* low, const float* high, int axis) {
        return (lanes_at(low) <= box.high[axis]) & (lanes_at(high) >= box.low[axis]);
    };
    return bits_of(meets(node.low_x, node.high_x, 0) & meets(node.low_y, node.high_y, 1) &
                   meets(node.low_z, node.high_z, 2));
}

/// Calls visit(node, i) for every leaf that meets the box, until it returns false; then, or if the box is so large that
/// too many nodes wait, returns false. Nodes come level by level, so that their memory is there when it is their turn.
template <typename T, typename Visit>
bool visit_leaves(const layout::MeshView<T>& mesh, const MoveBox& box, Visit&& visit) noexcept {
    constexpr layout::uint kMost = 256;
    layout::uint queue[kMost];
    layout::uint next = 0, end = 0;
    queue[end++] = 0;
    while (next < end) {
        const layout::MeshNode& node = mesh.nodes[queue[next++]];
        for (unsigned meeting = children_meeting(node, box); meeting != 0; meeting &= meeting - 1) {
            const auto i = static_cast<unsigned>(std::countr_zero(meeting));
            if ((node.child[i] & layout::kMeshLeaf) != 0) {
                if (!visit(node, i))
                    return false;
                continue;
            }
            if (end == kMost)
                return false;
            const layout::MeshNode* child = &mesh.nodes[node.child[i]];
            fetch(child);
            fetch(&child->high_x[1]);
            queue[end++] = node.child[i];
        }
    }
    return true;
}

template <typename T>
void put_leaf(const layout::MeshNode& node, unsigned i, layout::uint place, Neighbourhood<T>& neighbourhood) noexcept {
    layout::MeshNode& four = neighbourhood.fours[place / 4];
    const layout::uint j = place % 4;
    four.low_x[j] = node.low_x[i];
    four.low_y[j] = node.low_y[i];
    four.low_z[j] = node.low_z[i];
    four.high_x[j] = node.high_x[i];
    four.high_y[j] = node.high_y[i];
    four.high_z[j] = node.high_z[i];
    four.child[j] = node.child[i];
}

/// Gathers the leaves around a move. False if they are too many: then it is empty.
template <typename T>
bool gather(const layout::MeshView<T>& mesh, const Move<T>& move, Neighbourhood<T>& neighbourhood) noexcept {
    constexpr layout::uint kMost = 4 * Neighbourhood<T>::kFours;
    const MoveBox box = box_ahead(move, neighbourhood.reach);
    layout::uint count = 0;
    const bool fits = visit_leaves(mesh, box, [&](const layout::MeshNode& node, unsigned i) {
        const bool room = count < kMost;
        if (room) {
            put_leaf(node, i, count++, neighbourhood);
            const std::size_t first = 3 * std::size_t(leaf_begin(node.child[i]));
            fetch(&mesh.triangle_corners[first]);
            fetch(&mesh.triangle_neighbours[first]);
            fetch(&mesh.triangle_facets[first / 3]);
            fetch(&mesh.triangle_normals[first]);
            fetch(&mesh.triangle_normals[first] + 64 / sizeof(T));
        }
        return room;
    });
    neighbourhood.count = fits ? (count + 3) / 4 : 0;
    neighbourhood.box = fits ? box : kNoBox;
    if (!fits) {
        neighbourhood.reach *= 0.5F;
        return false;
    }
    if (neighbourhood.count < Neighbourhood<T>::kFewFours && neighbourhood.reach < 1.0F)
        neighbourhood.reach *= 1.5F;
    for (; count % 4 != 0; ++count)
        neighbourhood.fours[count / 4].low_x[count % 4] = std::numeric_limits<float>::infinity();
    return true;
}

/// Whether a box grown by the margin meets a move: its interval of times along each axis.
template <typename T>
bool meets_move(const layout::MeshNode& node, unsigned i, const Move<T>& move, const Vector<T>& inverse) noexcept {
    constexpr T kMargin = T(kBoxMargin<T>);
    const T lows[3] = {T(node.low_x[i]), T(node.low_y[i]), T(node.low_z[i])};
    const T highs[3] = {T(node.high_x[i]), T(node.high_y[i]), T(node.high_z[i])};
    T begin = T(0), end = move.until;
    for (int axis = 0; axis < 3; ++axis) {
        const T one = (lows[axis] - kMargin - move.from[axis]) * inverse[axis];
        const T other = (highs[axis] + kMargin - move.from[axis]) * inverse[axis];
        const T first = one < other ? one : other, last = one < other ? other : one;
        begin = first > begin ? first : begin;
        end = last < end ? last : end;
    }
    return begin <= end;
}

/// Walks the tree along a long move; `move.until` may shrink meanwhile.
template <typename T, typename Visit>
void visit_along(const layout::MeshView<T>& mesh, const Move<T>& move, Visit&& visit) noexcept {
    constexpr T kSteep = Skin<T>::kDouble ? T(1e30) : T(1e15);
    Vector<T> inverse;
    for (int i = 0; i < 3; ++i)
        inverse[i] = std::abs(move.displacement[i]) * kSteep > T(1) ? T(1) / move.displacement[i] : kSteep;
    visit_tree(
        mesh, [](layout::uint) { return true; },
        [&](const layout::MeshNode& node, layout::uint i) { return meets_move(node, i, move, inverse); }, visit);
}

/// Calls visit(first, end) for the leaves known around that meet a box, which must contain the move's. False if not all
/// are known.
template <typename T, typename Visit>
bool visit_known(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Move<T>& move,
                 const MoveBox& box, Visit&& visit) noexcept {
    if (!box.within(neighbourhood.box)) {
        const Vector<T> length = move.at(move.until) - move.from;
        if (largest_coordinate(length) > T(neighbourhood.reach) || !gather(mesh, move, neighbourhood) ||
            !box.within(neighbourhood.box))
            return false;
    }
    for (layout::uint i = 0; i < neighbourhood.count; ++i)
        for (unsigned meeting = children_meeting(neighbourhood.fours[i], box); meeting != 0; meeting &= meeting - 1)
            visit_leaf(neighbourhood.fours[i].child[std::countr_zero(meeting)], visit);
    return true;
}

/// Calls visit(first, end) for runs of triangles with all that come within kCorner of the move, and some others, in any
/// order; `visit` may shorten the move. The move must stay within two units of the frame's middle.
template <typename T, typename Visit>
void visit_runs_near(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Move<T>& move,
                     Visit&& visit) noexcept {
    if (!visit_known(mesh, neighbourhood, move, box_of(move, kBoxMargin<T>), visit))
        visit_along(mesh, move, visit);
}

/// Ensures that every triangle within kCorner of the move is among the close triangles. False if they are too many.
template <typename T>
bool update_close(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Move<T>& move) noexcept {
    CloseTriangles<T>& close = neighbourhood.close;
    if (close.knows(move.from) && close.knows(move.at(move.until)))
        return true;
    if (close.patience > 0) {
        --close.patience;
        return false;
    }
    // What is left of the displacement, most likely, is walked next.
    const Move<T> whole{move.from, move.displacement,
                        largest_coordinate(move.displacement) <= T(neighbourhood.reach) ? T(1) : move.until};
    const MoveBox box = box_ahead(whole, close.reach);
    close.begin(box);
    bool fits = true;
    const bool known = visit_known(mesh, neighbourhood, whole, box, [&](layout::uint triangle, layout::uint end) {
        fits = fits && add_close(mesh, triangle, end, close);
    });
    complete_row(close);
    if (!known || !fits) {
        close.forget();
        close.shrink(0.5F);
        close.patience = CloseTriangles<T>::kPatience;
        return false;
    }
    close.know(box);
    if (close.count > CloseTriangles<T>::kMany)
        close.shrink(0.75F);
    else if (close.count < CloseTriangles<T>::kFew && close.reach < 0.25F * neighbourhood.reach)
        close.reach *= 1.5F;
    return true;
}

/// Calls visit(triangle) for the same triangles.
template <typename T, typename Visit>
void visit_near(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Move<T>& move,
                Visit&& visit) noexcept {
    visit_runs_near(mesh, neighbourhood, move, [&](layout::uint triangle, layout::uint end) {
        for (; triangle < end; ++triangle)
            visit(triangle);
    });
}

} // namespace forceshade::reference
