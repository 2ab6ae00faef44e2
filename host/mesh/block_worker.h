// The loops that plans spend their time in, several triangles at a time where the processor can: same operations, same
// bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/mesh/block_plan.h"
#include "host/reference/elementary.h"
#include "host/reference/mesh_nearest.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Of triangles: corners, circle.
template <typename T> using Columns = std::array<const T*, 10>;

/// The least over a triangle's corners q of |centre - q|^2 - |side . (q - w)|, side the box's, less the circle and the
/// limit: by how much the triangle is further than the witness w from that point of the box where it gains most.
void all_excesses(const Columns<float>& columns, std::size_t count, const reference::Vector<float>& centre,
                  const reference::Vector<float>& side, const reference::Vector<float>& witness, float limit,
                  float* result);
void all_excesses(const Columns<double>& columns, std::size_t count, const reference::Vector<double>& centre,
                  const reference::Vector<double>& side, const reference::Vector<double>& witness, double limit,
                  double* result);

/// Squared distances from a point to others.
void all_squares(const float* x, const float* y, const float* z, std::size_t count,
                 const reference::Vector<float>& point, float* result);
void all_squares(const double* x, const double* y, const double* z, std::size_t count,
                 const reference::Vector<double>& point, double* result);

/// The place of about the least of some numbers, none below 0: the more they are, the fewer of their digits count.
std::size_t near_least_of(const float* values, std::size_t count);
std::size_t near_least_of(const double* values, std::size_t count);

/// Eight rows of squared distances, from each corner of a box, x running fastest, to the nearest corner of each
/// triangle.
void all_squares_to_corners(const Columns<float>& columns, std::size_t count, const reference::Vector<float>& low,
                            const reference::Vector<float>& high, float* rows);
void all_squares_to_corners(const Columns<double>& columns, std::size_t count, const reference::Vector<double>& low,
                            const reference::Vector<double>& high, double* rows);

/// By how much each triangle, its circle less, is at least beyond the limits of all corners.
void all_beyond_limits(const float* rows, const float* circle, std::size_t count, const std::array<float, 8>& limits,
                       float* result);
void all_beyond_limits(const double* rows, const double* circle, std::size_t count, const std::array<double, 8>& limits,
                       double* result);

/// 1 where an excess is not above 0, else 0.
void mark_kept(const float* result, std::size_t count, std::uint8_t* marks);
void mark_kept(const double* result, std::size_t count, std::uint8_t* marks);

// One thread's part in planning blocks: boxes of samples are halved along each axis, the list of triangles that may be
// nearest is narrowed with them, and boxes that are outside all of these go.

constexpr layout::uint kPlanTile = 16; // samples along each side of what is planned as a whole

/// Samples of the grid, first to last along each axis.
struct SampleRange {
    std::array<layout::uint, 3> first, last;
};

/// What threads share.
template <typename T> struct PlanInput {
    layout::MeshView<T> mesh;
    std::array<std::span<const T>, 3> axes;
    layout::uint inside; /* layout::kInside... */
    T slack;             /* 1: what rounding to T can make of a distance, twice over */
    std::vector<PlanTriangle<T>> rows;
    bool visits_free = false; /* blocks without a voxel inside are listed too */

    PlanBox<T> box(const SampleRange& range) const;
};

/// A row of PlanInput; no coordinate of mesh or grid is beyond `largest`.
template <typename T> PlanTriangle<T> plan_triangle(const layout::MeshView<T>& mesh, std::size_t triangle, T largest);

template <typename T> class BlockWorker {
public:
    explicit BlockWorker(const PlanInput<T>& input) : input_(input) {}

    /// Appends the blocks of a tile to what was found.
    void plan(const SampleRange& tile);

    std::vector<layout::MeshBlock> blocks; /* runs of `candidates` */
    std::vector<layout::uint> candidates, inside;

private:
    static constexpr std::size_t kLevels = 4;  // of boxes that have lists: 16 to 4 samples, and what was collected
    static constexpr std::size_t kLong = 48;   // lists beyond are narrowed to their samples
    enum class Side { outside, inside, both }; // of the surface, as far as a box is wholly on one

    void collect(const PlanBox<T>& box, const Witness<T>& witness);
    Witness<T> witness_from(const PlanBox<T>& box, const reference::Vector<T>& point) const;
    reference::TrianglePoint<T> nearest_on(layout::uint triangle, const reference::Vector<T>& point) const;
    reference::Vector<T> point_near(const TriangleList<T>& list, const reference::Vector<T>& point);
    bool is_outside(const TriangleList<T>& list, const PlanBox<T>& box) const;
    Side side_of(const PlanBox<T>& box, const reference::Vector<T>& near);
    bool is_free(const TriangleList<T>& list, const PlanBox<T>& box, const reference::Vector<T>& near,
                 layout::uint side_length, Side& side);
    void split(const SampleRange& range, std::size_t level, layout::uint side_length, Side side);
    void leaf(const SampleRange& range, const PlanBox<T>& box, const TriangleList<T>& list, Side side);
    void narrow_to_samples(const PlanBox<T>& box, const TriangleList<T>& list);
    layout::uint inside_bits(const SampleRange& range, Side side) const;
    void add_nearest(const SampleRange& range);

    const PlanInput<T>& input_;
    layout::uint hint_ = 0;
    std::array<TriangleList<T>, kLevels> lists_;
    TriangleList<T> long_list_;
    std::vector<layout::uint> collected_, places_; // places_: of what was narrowed last, in its list
};

extern template struct PlanInput<float>;
extern template struct PlanInput<double>;
extern template PlanTriangle<float> plan_triangle(const layout::MeshView<float>&, std::size_t, float);
extern template PlanTriangle<double> plan_triangle(const layout::MeshView<double>&, std::size_t, double);
extern template class BlockWorker<float>;
extern template class BlockWorker<double>;

} // namespace forceshade
