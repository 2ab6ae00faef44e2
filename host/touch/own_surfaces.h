// The surfaces of the studies' own: the list of them, and how they are made: a bump of the paper's, meshes of its
// cylinder (a closed block, and an open patch that can be tessellated anew), and other forms of it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"

namespace forceshade {

struct BumpMesh {
    double half_width = 0.0127; /* a, m */
    double radius = 0.0254;     /* R, m: above a */
    unsigned cells = 8;         /* over 2 a along x */
    unsigned rows = 8;          /* over 2 a along y */
};

/// A block of triangles whose top lies on the circle of G1 (z = 0 at |x| = a) between equal arcs, over |y| <= a and, at
/// least a cell beyond |x| = a, to about 1.5 a; diagonals from (i, j) to (i + 1, j + 1). Deeper than wide, so that a
/// probe below the top is nearest to it. Moved by `shift`, m.
std::shared_ptr<const SceneMesh> bump_mesh(const BumpMesh& bump, const glm::dvec3& shift = glm::dvec3(0));

/// A tessellation turned and moved at random, for a disc of `reach`, m along the surface, about the middle.
struct DrawnPatch {
    double reach = 0;
    std::uint64_t seed = 0;
};

/// The cylinder alone as triangles between equal arcs, an open mesh; `bump` gives the cells' size and, unless drawn,
/// their number.
std::shared_ptr<const SceneMesh> cylinder_patch(const BumpMesh& bump, const std::optional<DrawnPatch>& drawn = {});

inline constexpr double kOwnHalfWidth = 0.0127;         /* a, m: half the width of the paper's bumps */
inline constexpr double kOwnRadius = 0.01524;           /* R, m: 600 mil, the paper's most curved bump */
inline constexpr double kMapRadius = 2 * kOwnHalfWidth; /* R, m: of its height maps */
inline constexpr double kOwnWavelength = 0x1p-6; /* m: of the sine; a power of two, so that whole ones add up exactly */

/// A bump of the paper's width about the origin, or another form of it.
struct OwnSurface {
    SurfaceKind kind = SurfaceKind::bump;
    MapFunction function = MapFunction::cylinder; /* of a height map */
    bool shaded = false;                          /* of a mesh by mean value coordinates */
    double radius = kOwnRadius;                   /* R, m */
    std::uint32_t facets = 8;                     /* of a bump; of a mesh the cells along x */
    std::uint32_t rows = 8;                       /* of a mesh: cells along y */
    double stiffness = 1000;                      /* N/m */
    std::optional<Shading> shading{};             /* other than those that `shaded` chooses */
    double texture = 0;                           /* m: peak of a sine of 2 mm, as stiff as the surface; 0: none */
};

/// `shift`, m: of a mesh.
PreparedCase own_case(const OwnSurface& own, const glm::dvec3& shift = glm::dvec3(0));

/// What is examined of a surface; error-time and energy take some of them with other numbers of facets or cells.
enum Examined : unsigned {
    kLimits = 1,   /* the largest stable stiffness */
    kLoops = 2,    /* that over one quantity after the other, basins, couplings, swings at edges */
    kNumbers = 4,  /* rounding over sizes, stiffnesses and distances */
    kRounding = 8, /* the place where single precision errs most */
    kDevices = 16  /* a GPU against the CPU */
};

/// m: where it is touched.
struct TouchedBox {
    glm::dvec3 low, high;
};
inline constexpr TouchedBox kFlatBox{{-0.005, -0.005, -0.003}, {0.005, 0.005, 0.002}};
inline constexpr TouchedBox kBumpBox{{-0.0152, -0.005, -0.003}, {0.0152, 0.005, 0.008}}; /* 2.5 mm beyond it in x */
inline constexpr TouchedBox kMapBox{{-0.0152, -0.005, -0.003}, {0.0152, 0.005, 0.002}};
inline constexpr TouchedBox kMeshBox{{-0.0105, -0.008, -0.001}, {0.0105, 0.008, 0.008}}; /* not to its borders */

struct StudiedSurface {
    const char* name;
    OwnSurface own;
    TouchedBox box;
    unsigned examined;
    TouchedBox volume{}; /* narrower: what volumes and grids of error-time hold */
};

inline constexpr std::uint32_t kMeshCells = 8; // over the width of a bump, along x and y

constexpr OwnSurface studied_mesh(Shading shading, std::uint32_t rows = kMeshCells) {
    return {.kind = SurfaceKind::mesh, .facets = kMeshCells, .rows = rows, .shading = shading};
}
constexpr OwnSurface studied_map(MapFunction function) {
    return {.kind = SurfaceKind::height_map, .function = function, .shaded = true, .radius = kMapRadius};
}

/// Thin meshes have cells of 32 times their width.
inline constexpr StudiedSurface kStudiedSurfaces[] = {
    {"plane", {.facets = 1}, kFlatBox, kLimits | kLoops},
    {"textured plane", {.facets = 1, .texture = 1e-5}, kFlatBox, kLimits | kLoops | kDevices},
    {"bump of 2 facets", {.facets = 2}, kBumpBox, kLimits | kLoops},
    {"shaded bump of 2 facets", {.shaded = true, .facets = 2}, kBumpBox, kLimits | kLoops},
    {"bump of 8 facets",
     {},
     kBumpBox,
     kLimits | kNumbers | kRounding | kDevices,
     {{-0.0147, -0.002, -0.0025}, {0.0147015, 0.0019998, 0.00695}}},
    {"shaded bump of 8 facets", {.shaded = true}, kBumpBox, kLimits | kNumbers | kRounding | kDevices},
    {"textured bump of 8 facets", {.shaded = true, .texture = 1e-4}, kBumpBox, kRounding | kDevices},
    {"cylinder", {.kind = SurfaceKind::cylinder_bump}, kBumpBox, kNumbers | kDevices},
    {"height map of a bump", studied_map(MapFunction::cylinder), kMapBox, kLimits | kLoops | kNumbers | kRounding},
    {"height map of a dip", studied_map(MapFunction::dip), kMapBox, kLimits | kLoops},
    {"height map of a sine", studied_map(MapFunction::sine), kMapBox, kNumbers | kDevices},
    {"mesh",
     studied_mesh(Shading::none),
     kMeshBox,
     kLimits | kLoops | kRounding | kDevices,
     {{-0.009, -0.006, 0.0015}, {0.009, 0.006, 0.007}}},
    {"shaded mesh", studied_mesh(Shading::mean_value), kMeshBox, kLimits | kLoops | kNumbers | kRounding | kDevices},
    {"morgenbesser mesh", studied_mesh(Shading::morgenbesser), kMeshBox, kLimits | kRounding | kDevices},
    {"barycentric mesh", studied_mesh(Shading::barycentric), kMeshBox, kLimits | kRounding | kDevices},
    {"two_pass mesh", studied_mesh(Shading::two_pass), kMeshBox, kLimits | kRounding | kDevices},
    {"thin mesh", studied_mesh(Shading::none, 256), kMeshBox, kRounding},
    {"shaded thin mesh", studied_mesh(Shading::mean_value, 256), kMeshBox, kRounding},
    {"morgenbesser thin mesh", studied_mesh(Shading::morgenbesser, 256), kMeshBox, kRounding},
    {"barycentric thin mesh", studied_mesh(Shading::barycentric, 256), kMeshBox, kRounding},
    {"two_pass thin mesh", studied_mesh(Shading::two_pass, 256), kMeshBox, kRounding},
};

/// That of a name. \throws std::out_of_range, or does not compile, without one.
constexpr const StudiedSurface& studied_surface(std::string_view name) {
    for (const StudiedSurface& one : kStudiedSurfaces)
        if (name == one.name)
            return one;
    throw std::out_of_range(std::string(name));
}

/// Those of the list of which `what` is examined.
std::vector<StudiedSurface> studied_surfaces(Examined what);

/// Samples of a box, in its corners too.
GridSpec grid_over(const TouchedBox& box, const std::array<std::uint64_t, 3>& size);

} // namespace forceshade
