// The plan of a solid's field by scan conversion: which samples are inside, and of each block of them the few triangles
// that can be nearest. What the sweeps of region_sweep.h find, and what of the surface is connected with it at about
// the same distance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "host/mesh/block_plan.h"
#include "shaders/shared/law.h"

namespace forceshade {

template <typename T> class SolidScan {
public:
    /// Null where it does not serve: the mesh is no solid, comes too near itself or is inside out, inside is not by
    /// pseudonormals, a triangle is too thin for its normal, or the grid is uneven, far larger than the mesh, or finer
    /// than single precision.
    static std::unique_ptr<const SolidScan> make(const layout::MeshView<T>& mesh, std::span<const T> x,
                                                 std::span<const T> y, std::span<const T> z, layout::uint inside,
                                                 unsigned threads);
    ~SolidScan();

    /// As BlockPlanner::plan. The samples that may be inside are those of BlockPlan::wanted.
    BlockPlan plan(std::size_t z_first, std::size_t z_count) const;

private:
    struct Implementation;
    explicit SolidScan(std::unique_ptr<const Implementation> implementation);
    std::unique_ptr<const Implementation> implementation_;
};

} // namespace forceshade
