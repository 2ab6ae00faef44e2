// The triangles that can be nearest to some point of a box, narrowed with the box. Arrays of numbers, so that compilers
// take several triangles at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/reference/elementary.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// A box in the mesh's frame.
template <typename T> struct PlanBox {
    reference::Vector<T> low, high;

    reference::Vector<T> centre() const { return (low + high) / T(2); }
    reference::Vector<T> half() const { return (high - low) / T(2); }
    T radius() const { return std::sqrt(reference::dot(half(), half())); }
};

/// A point of the surface, near to a box, and by how much a squared distance may be above that to it, nowhere to be
/// nearest.
template <typename T> struct Witness {
    reference::Vector<T> point;
    T margin; /* 1: what rounding in T may make of a difference of squared distances */
};

/// A triangle as plans see it, by rows.
template <typename T> struct PlanTriangle {
    std::array<T, 9> corners;     /* of the mesh's frame; a, b, c */
    T circle;                     /* squared radius of the least circle around it, and what rounding makes of it */
    reference::Vector<T> normal;  /* 1: 0 where it has none */
    T offset;                     /* normal . a */
    std::array<T, 2> unused = {}; /* a row is 16 numbers */
};

/// What narrowing needs of some triangles, by columns.
template <typename T> class TriangleList {
public:
    std::size_t size() const { return ids_.size(); }
    const std::vector<layout::uint>& ids() const { return ids_; }

    /// Becomes these triangles of `rows`.
    void fill(std::span<const layout::uint> ids, std::span<const PlanTriangle<T>> rows);
    /// Becomes those of `all` at these places.
    void select(const TriangleList& all, std::span<const layout::uint> places);
    /// The places of all that, by the witness, may be nearest to some point of the box.
    void narrow(const PlanBox<T>& box, const Witness<T>& witness, std::vector<layout::uint>& places) const;
    /// Per corner of the box, x running fastest, the place of a triangle one of whose corners is nearest to it; needs
    /// one.
    std::array<std::size_t, 8> near_corners(const PlanBox<T>& box);
    /// After near_corners: the places of all whose squared distance to some corner of the box may be within its limit.
    void narrow_corners(const std::array<T, 8>& limits, std::vector<layout::uint>& places) const;
    /// The place of a triangle whose first corner is near to a point, the nearest of some; needs one.
    std::size_t near_one(const reference::Vector<T>& point) const;

private:
    void sample();
    void keep(std::size_t count, std::vector<layout::uint>& places) const;

    std::array<std::vector<T>, 10> columns_; // corners, circle; may be longer than the list
    std::array<std::vector<T>, 3> samples_;
    std::size_t stride_ = 1;
    std::vector<layout::uint> ids_;
    std::vector<T> squares_; // of near_corners: eight rows
    mutable std::vector<T> scratch_;
    mutable std::vector<std::uint8_t> marks_;
};

} // namespace forceshade
