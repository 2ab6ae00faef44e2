// The triangles that can be nearest to some point of a box, narrowed with the box. Arrays of numbers, so that compilers
// take several triangles at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
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

/// True if the whole box is at least `slack` above the triangle's plane, or it has none.
template <typename T> bool is_below(const PlanTriangle<T>& triangle, const PlanBox<T>& box, T slack);

/// What narrowing needs of some triangles, by columns.
template <typename T> class TriangleList {
public:
    std::size_t size() const { return ids_.size(); }
    const std::vector<layout::uint>& ids() const { return ids_; }

    /// Becomes these triangles of `rows`.
    void fill(std::span<const layout::uint> ids, std::span<const PlanTriangle<T>> rows);
    /// Becomes those of `all` at these places.
    void take(const TriangleList& all, std::span<const layout::uint> places);
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

extern template bool is_below(const PlanTriangle<float>&, const PlanBox<float>&, float);
extern template bool is_below(const PlanTriangle<double>&, const PlanBox<double>&, double);
extern template class TriangleList<float>;
extern template class TriangleList<double>;

// Where on a grid a mesh's field is not 0, and which triangles can be the nearest ones there: what the mesh kernel is
// told. Conservative: a kernel that follows a plan gives what evaluating every voxel against every triangle would.

/// Owns what a layout::MeshPlan only points to.
struct BlockPlan {
    std::vector<layout::MeshBlock> blocks; /* by z */
    std::vector<layout::uint> candidates;  /* triangles */
    std::vector<layout::uint> inside;      /* layout::kInsideWinding: 8 bits a block */
    std::uint64_t voxels_evaluated = 0;    /* of the grid, in listed blocks */

    layout::MeshPlan view() const { return {blocks, candidates, inside}; }
};

/// A run of candidates is no longer, whatever the mesh: where more triangles might be nearest, the planner finds the
/// nearest ones itself. So a plan takes at most 24 + 4 kMostCandidates bytes a block of 8 voxels.
constexpr layout::uint kMostCandidates = 512;

/// What is planned of blocks in which no voxel can be inside.
enum class FreeSpace {
    skipped, /* not listed */
    visited, /* listed with their candidates: the same field for more work, which shows what skipping saves */
};

/// Plans the blocks of one mesh on one grid, a slab at a time. Results do not depend on the threads.
template <typename T> class BlockPlanner {
public:
    /// The grid x * y * z, coordinates in the mesh's frame, increasing. `inside` is layout::kInside...;
    /// kInsideWinding needs mesh.moments. All spans must outlive the planner. `threads` 0: as many as the machine has
    /// cores.
    BlockPlanner(const layout::MeshView<T>& mesh, std::span<const T> x, std::span<const T> y, std::span<const T> z,
                 layout::uint inside, unsigned threads = 0, FreeSpace free = FreeSpace::skipped);
    ~BlockPlanner();

    /// Blocks of the samples z in [z_first, z_first + z_count), z_first even, in which a voxel may be inside; all of
    /// them where free space is visited.
    BlockPlan plan(std::size_t z_first, std::size_t z_count) const;

private:
    struct Implementation;
    std::unique_ptr<const Implementation> implementation_;
};

/// The plan of a whole grid.
template <typename T>
BlockPlan plan_blocks(const layout::MeshView<T>& mesh, std::span<const T> x, std::span<const T> y, std::span<const T> z,
                      layout::uint inside, unsigned threads = 0, FreeSpace free = FreeSpace::skipped) {
    return BlockPlanner<T>(mesh, x, y, z, inside, threads, free).plan(0, z.size());
}

extern template class BlockPlanner<float>;
extern template class BlockPlanner<double>;

} // namespace forceshade
