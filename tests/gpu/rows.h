// The table of what kernels are held to, and how each row of it is run: a law (surface, shading, texture, channels), a
// grid or paths, and the ways in which dispatches are cut. tests/gpu/table_test.cpp holds every row in both precisions.
#pragma once

#include <array>
#include <compare>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "compute/kernels.h"
#include "host/field/prepared_case.h"
#include "host/mesh/block_plan.h"
#include "tests/gpu/held.h"
#include "tests/gpu/path_case.h"

namespace forceshade::test {

inline constexpr layout::uint kAllChannels = layout::kChannelForce | layout::kChannelDepth | layout::kChannelFacet |
                                             layout::kChannelProxy | layout::kChannelUnshaded;

/// Samples of a mesh's field: their number, and what part of the mesh's frame they span; [-1.05, 1.05] covers it.
struct MeshGrid {
    std::array<std::size_t, 3> size{33, 34, 35};
    glm::dvec3 from{-1.05}, to{1.05};
};

/// What a scene may add to a mesh: what tells its inside, the map that tilts its normals, that of its texture, and
/// where maps are read, m, if elsewhere than the mesh is.
struct Maps {
    InsideTest inside = InsideTest::pseudonormal;
    layout::uint map = layout::kMapNone, texture = layout::kMapNone;
    std::optional<double> map_x{};
    bool known_solid = true; /* where it is a solid */
};

/// A law: a scene with its images and mesh.
struct Ground {
    PreparedCase prepared;
    Maps maps{};
    const MeshStructure* mesh() const { return prepared.images.mesh ? &prepared.images.mesh->structure : nullptr; }
};
using MakeGround = std::function<Ground()>;

/// How a kernel is run; 0: as it chooses.
struct Way {
    std::size_t chunk_bytes = 0;        /* most for the results of a dispatch */
    std::uint32_t rows = 0;             /* of an invocation; of paths: steps of a dispatch */
    bool packed = true;                 /* two reals a store, of fields of analytic surfaces */
    bool staged = false;                /* results travel through a buffer of the host's */
    std::size_t batch = 0;              /* paths, or voxels of a slab */
    std::uint32_t pause = 0, limit = 0; /* loops: KernelOptions */
    friend auto operator<=>(const Way&, const Way&) = default;
};

/// What a row must show, or it says nothing.
struct Least {
    std::uint64_t touching = 0, rounds = 0, unstable = 0, host_updates = 0;
    std::uint64_t most_host_updates = std::numeric_limits<std::uint64_t>::max();
};

struct Row {
    std::string name; /* letters, digits and "_" */
    MakeGround ground;
    std::optional<PathShape> shape{}; /* of paths; else a field. A scene with [paths] has its own. */
    MeshGrid grid{};                  /* of a mesh's field */
    std::vector<Way> ways{{}};
    Least least{};
    bool f32 = true, f64 = true;
    bool referee = false;                /* an analytic field: within the bound of its closed form as well */
    FreeSpace free = FreeSpace::skipped; /* of a mesh's field */
    std::uint64_t slices = 1;            /* of paths: seeds that are taken one after the other */
};
inline std::ostream& operator<<(std::ostream& out, const Row& row) {
    return out << row.name;
}

Ground analytic(const Scene& scene, const SceneImages& images = {});
Ground mesh_of(const PolygonSoup& polygons, Shading shading = Shading::none, const Maps& maps = {});

inline constexpr layout::uint kLoops[] = {layout::kLoopOpen, layout::kLoopClosed};
inline constexpr const char* kLoopNames[] = {"open", "closed"};
inline constexpr const char* kMotionNames[] = {"strokes", "raster",      "circle",       "spiral",
                                               "taps",    "random_walk", "minimum_jerk", "recorded"};
/// "strokes_open"
inline std::string name_of(layout::uint motion, layout::uint loop) {
    return fmt::format("{}_{}", kMotionNames[motion], kLoopNames[loop]);
}

std::vector<Row> field_rows(); // of analytic surfaces
std::vector<Row> mesh_field_rows();
std::vector<Row> path_rows(); // over analytic surfaces
std::vector<Row> mesh_path_rows();
std::vector<Row> long_path_rows(); // two thousand paths of a thousand steps; with FORCESHADE_LONG ten
std::vector<Row> long_mesh_path_rows();

template <typename T> FieldTables<T> tables_of(const Ground& ground, const MeshGrid& grid = {});

/// A device and kernels on it, each made once for all rows.
class Kernels {
public:
    explicit Kernels(compute::Device& device) : device_(device) {}

    /// What came of the row, a way after the other.
    template <typename T> std::vector<Held> hold(const Row& row);

    template <typename T> Held field(const Way& way, const FieldTables<T>& tables);
    template <typename T>
    Held mesh_field(const Way& way, const FieldTables<T>& tables, FreeSpace free = FreeSpace::skipped);
    /// `length(path)`, steps.
    template <typename T>
    Held paths(const Way& way, const layout::PathInput<T>& input,
               const std::function<std::size_t(std::size_t)>& length);

private:
    template <typename Kernel> struct Kept {
        Kernel kernel;
        Sentinels sentinels;
        Kept(compute::Device& device, const Way& way);
    };
    template <typename Kernel> Kept<Kernel>& kept(const Way& way);

    compute::Device& device_;
    std::tuple<std::map<Way, Kept<compute::FieldKernel>>, std::map<Way, Kept<compute::MeshKernel>>,
               std::map<Way, Kept<compute::PathKernel>>, std::map<Way, Kept<compute::MeshPathKernel>>>
        kept_;
};

} // namespace forceshade::test
