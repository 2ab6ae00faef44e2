// The surfaces of the studies' own: meshes of the reference cylinder (a closed block under its bump, and an open patch
// that can be tessellated anew), and cases of them and of other forms of the bump.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

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

inline constexpr double kOwnHalfWidth = 0.0127;  /* a, m: half the width of the paper's bumps */
inline constexpr double kOwnRadius = 0.01524;    /* R, m: 600 mil, the paper's most curved bump */
inline constexpr double kOwnWavelength = 0x1p-6; /* m: of the sine; a power of two, so that whole ones add up exactly */

/// A bump of the paper's width about the origin, or another form of it.
struct OwnSurface {
    SurfaceKind kind = SurfaceKind::bump;
    MapFunction function = MapFunction::cylinder; /* of a height map */
    bool shaded = false;                          /* of a mesh by mean value coordinates */
    double radius = 2 * kOwnHalfWidth;            /* R, m */
    std::uint32_t facets = 8;                     /* of a bump; of a mesh the cells along x */
    std::uint32_t rows = 8;                       /* of a mesh: cells along y */
    double stiffness = 1000;                      /* N/m */
    std::optional<Shading> shading{};             /* other than those that `shaded` chooses */
    double texture = 0;                           /* m: peak of a sine of 2 mm, as stiff as the surface; 0: none */
};

/// `shift`, m: of a mesh.
PreparedCase own_case(const OwnSurface& own, const glm::dvec3& shift = glm::dvec3(0));

// The list of those that the study of stability presses, and the page of studies compares.

struct StudiedSurface {
    const char* name;
    OwnSurface own;
    glm::dvec3 low, high;      /* m: the box that places are within */
    bool limits_alone = false; /* nothing else is examined */
};

/// Of a bump or height map 2.5 mm beyond it on either side, of a mesh not to its borders.
inline constexpr glm::dvec3 kPressedBumpLow{-0.0152, -0.005, -0.003}, kPressedBumpHigh{0.0152, 0.005, 0.008};
inline constexpr glm::dvec3 kPressedMeshLow{-0.0105, -0.008, -0.003}, kPressedMeshHigh{0.0105, 0.008, 0.008};
inline constexpr std::uint32_t kMeshCells = 8; // over the width of a bump, along x and y

constexpr OwnSurface studied_mesh(Shading shading) {
    return {
        .kind = SurfaceKind::mesh, .radius = kOwnRadius, .facets = kMeshCells, .rows = kMeshCells, .shading = shading};
}

inline constexpr StudiedSurface kStudiedSurfaces[] = {
    {"plane", {.facets = 1}, {-0.005, -0.005, -0.003}, {0.005, 0.005, 0.002}},
    {"textured plane", {.facets = 1, .texture = 1e-5}, {-0.005, -0.005, -0.003}, {0.005, 0.005, 0.002}},
    {"bump", {.radius = kOwnRadius, .facets = 2}, kPressedBumpLow, kPressedBumpHigh},
    {"shaded bump", {.shaded = true, .radius = kOwnRadius, .facets = 2}, kPressedBumpLow, kPressedBumpHigh},
    {"bump of 8 facets", {.radius = kOwnRadius}, kPressedBumpLow, kPressedBumpHigh, true},
    {"shaded bump of 8 facets", {.shaded = true, .radius = kOwnRadius}, kPressedBumpLow, kPressedBumpHigh, true},
    {"height map of a bump",
     {.kind = SurfaceKind::height_map, .shaded = true},
     {-0.0152, -0.005, -0.003},
     {0.0152, 0.005, 0.002}},
    {"height map of a dip",
     {.kind = SurfaceKind::height_map, .function = MapFunction::dip, .shaded = true},
     {-0.0152, -0.005, -0.003},
     {0.0152, 0.005, 0.002}},
    {"mesh", studied_mesh(Shading::none), kPressedMeshLow, kPressedMeshHigh},
    {"shaded mesh", studied_mesh(Shading::mean_value), kPressedMeshLow, kPressedMeshHigh},
    {"morgenbesser mesh", studied_mesh(Shading::morgenbesser), kPressedMeshLow, kPressedMeshHigh, true},
    {"barycentric mesh", studied_mesh(Shading::barycentric), kPressedMeshLow, kPressedMeshHigh, true},
    {"two_pass mesh", studied_mesh(Shading::two_pass), kPressedMeshLow, kPressedMeshHigh, true},
};

} // namespace forceshade
