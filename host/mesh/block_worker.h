// One thread's part in planning blocks: boxes of samples are halved along each axis, the list of triangles that may be
// nearest is narrowed with them, and boxes that are outside all of these go.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/mesh/block_list.h"
#include "host/reference/mesh_triangle.h"

namespace forceshade {

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
