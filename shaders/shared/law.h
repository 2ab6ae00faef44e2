// The input of a law, as views over the layout: its parameters and tables, a mesh, a grid, paths; and what
// comes back. C++ only, of standard types alone: compute takes these and links no folder of the host, the oracle takes
// the same.
#pragma once

#include <span>

#include "shaders/shared/layout.h"

namespace forceshade {
class Clearance;
}
namespace forceshade::reference {
template <typename T> class SurfaceForces;
}

namespace forceshade::layout {

// Along a direction of their own, within what bounds the triangles below a node's four children lie: where these face
// one way, they bound tighter than boxes. Host only.
struct MeshSlabs {
    float normal_x[kMeshChildren]; // 1: no longer than a unit vector
    float normal_y[kMeshChildren];
    float normal_z[kMeshChildren];
    float low[kMeshChildren]; // 1, of the mesh's frame: infinite where triangles face all ways
    float high[kMeshChildren];
};

// The triangles below a node as seen from far away, for the winding number: integrals over them, with a the vector area
// (half the cross product of two edges).
struct MeshMoment {
    double centre[3];     // 1, of the mesh's frame: mean of the centroids, weighted by area
    double radius;        // 1: no triangle reaches further from the centre
    double dipole[3];     // sum of a
    double quadrupole[6]; // symmetric part of the sum of a_i x_j, x from the centre: xx yy zz xy xz yz
    double octupole[10];  // of the sum of a_i x_j x_k: xxx yyy zzz xxy xxz xyy yyz xzz yzz xyz
};

// A mesh ready to evaluate, in its own frame. Triangles stand in the tree's order; the spans must outlive it.
template <typename real> struct MeshView {
    MeshParams<real> params{};
    std::span<const MeshNode> nodes;            // root first
    std::span<const MeshSlabs> slabs;           // 1 a node
    std::span<const real> vertices;             // 3 a vertex
    std::span<const uint> triangle_corners;     // 3 a triangle: vertices, counterclockwise seen from outside
    std::span<const uint> triangle_facets;      // 1 a triangle: id of the facet that it is part of
    std::span<const uint> triangle_neighbours;  // 3 a triangle: across the edge from corner i to corner i + 1
    std::span<const real> triangle_normals;     // 3 a triangle: unit, 0 where it has no area
    std::span<const real> vertex_pseudonormals; // 3 a vertex: angle-weighted sum of its triangles' normals
    std::span<const real> edge_pseudonormals;   // 3 an edge with more or fewer than two triangles
    std::span<const uint> facet_begins;         // facets + 1: where a facet's corners begin
    std::span<const uint> facet_corners;        // vertices
    std::span<const real> facet_normals;        // 3 a facet: unit Newell normal, 0 where it has no area
    std::span<const real> vertex_normals;       // 3 a vertex: unit, what L7 interpolates; 0 where they cancel
    // For the winding number (host only); empty unless asked for.
    bool solid = false;                   // bounds one solid, whose surface nowhere meets itself
    const Clearance* clearance = nullptr; // of a solid, for planning
    std::span<const MeshMoment> moments;  // 1 a node
    std::span<const uint> rims;           // 3 an edge where the surface ends: its vertices, how often more one way
    // For god-objects (host only); empty unless asked for.
    std::span<const uint> obstacle_begins; // triangles + 1: where the list of a triangle begins
    std::span<const uint> obstacles;       // triangles that one sliding over its front may meet; or kMeshAnyObstacle
};

// Where a mesh's force is, on one grid. Voxels of blocks that are not listed are out of contact.
struct MeshPlan {
    std::span<const MeshBlock> blocks; // by z
    std::span<const uint> candidates;  // triangles
    std::span<const uint> inside;      // kInsideWinding: 1 word a block, bit (z * 2 + y) * 2 + x of each voxel
    std::span<const uint> wanted{};    // 1 word a block, the same bits: voxels that may be in contact; empty: all
};

// The features that a scene uses; the compiled kernel has no others.
struct Features {
    uint surface = kSurfaceBump;
    uint shading = kShadingNone;
    uint depth = kDepthVertical;
    uint reference = kReferenceNormal;
    uint map = kMapNone;
    uint texture = kMapNone;
    uint channels = kChannelForce;
    uint inside = kInsidePseudonormal; // of a mesh
    friend bool operator==(const Features&, const Features&) = default;
};

// A force law, ready to evaluate at any point. The spans must outlive it.
template <typename real> struct Law {
    Features features;
    LawParams<real> params;
    std::span<const real> facet_vertices;    // m, n + 1 increasing x coordinates (bump only)
    std::span<const real> map_gradients;     // 1, rows * columns pairs (dU/dx, dU/dy), row 0 at the smallest y
    std::span<const real> texture_gradients; // the same for the texture
    MeshView<real> mesh{};                   // kSurfaceMesh only; L9: params.map and map_gradients tilt its normals
};

// A law over a grid.
template <typename real> struct FieldInput {
    Law<real> law;
    std::span<const real> x, y, z; // m, sample coordinates, each rounded once from double; of a mesh in its own frame
    MeshPlan plan{};               // of a mesh
};

// Consecutive rows of an evaluated field: z in [z_first, z_first + z_count), y in the same way. Row r = (z - z_first) *
// y_count + (y - y_first) begins at sample r * x_pitch. Channels that the features lack are empty. The spans die with
// the callback that receives them.
template <typename real> struct FieldChunk {
    std::size_t x_count, x_pitch;
    std::size_t y_first, y_count;
    std::size_t z_first, z_count;
    std::span<const real> force;                      // N, 3 a sample
    std::span<const real> depth;                      // m
    std::span<const uint> facet;                      // id
    std::span<const real> proxy;                      // m, 3 a sample
    std::span<const real> unshaded;                   // N, 3 a sample
    std::span<const real> angle{}, magnitude_error{}; // deg, N: against [compare], by the host
};

// What paths use; everything else is left out of the compiled kernel.
struct PathFeatures {
    uint motion = kMotionStrokes;
    uint loop = kLoopOpen;
    uint follow = kFollowPlane;
    uint harmonics = 0; // of each axis
    uint channels = 0;  // written; none: metrics alone
    friend bool operator==(const PathFeatures&, const PathFeatures&) = default;
};

// Consecutive paths as the host prepared them. Tables of harmonics: component, axis, path, the last fastest.
template <typename real> struct PathBatch {
    std::size_t first = 0; // path
    std::size_t count = 0;
    std::span<const MotionParams<real>> motions; // 1 a path; none: recorded
    std::span<const real> amplitudes;            // m
    std::span<const uint> phases;                // at step 0
    std::span<const uint> phase_steps;           // a sample
    std::span<const uint> steps;                 // recorded: samples of each path; none: PathInput::steps
    std::span<const ProxyStart<real>> proxies;   // of a mesh: 1 a path
    std::size_t longest = 0;                     // steps of the longest of them; 0: PathInput::steps
};

// Where a run of paths gets its tables; spans live until the next call of the same function.
template <typename real> class PathSource {
public:
    virtual ~PathSource() = default;
    virtual PathBatch<real> batch(std::size_t first, std::size_t count) = 0;
    // Recorded paths: positions, m, 3 a sample, of steps [step, step + steps) of the batch's paths, path fastest; where
    // a path has ended, anything.
    virtual std::span<const real> positions(std::size_t step, std::size_t steps) = 0;
};

// Paths through a law.
template <typename real> struct PathInput {
    Law<real> law;
    PathFeatures features;
    std::span<const HandParams<real>> hands; // closed loop: one for all, or one a path
    std::size_t paths = 0;
    std::size_t steps = 0; // of the longest
    PathSource<real>* source = nullptr;
    float stretch = 1e-3f; // m: the least distance that a turn of the force is counted over
    const reference::SurfaceForces<real>* surface = nullptr; // L10, L11, of the oracle alone; null: neither
};

// Some steps of some consecutive paths: sample (step, path) stands at step * pitch + path. Channels that were not asked
// for are empty. The spans die with the callback that receives them.
template <typename real> struct PathChunk {
    std::size_t path_first, path_count;
    std::size_t step_first, step_count;
    std::size_t pitch;
    std::span<const real> position; // m, 3 a sample
    std::span<const real> force;    // N, 3 a sample
    std::span<const real> depth;    // m
    std::span<const uint> facet;    // id
    std::span<const real> proxy;    // m, 3 a sample
};

// One update of a path's god-object that the kernel leaves to the host. In the mesh's frame.
template <typename real> struct MeshUpdate {
    real probe[3];
    real proxy[3]; // before, then after
    uint triangles[3];
    uint count;
    bool cornered;
    // The contact:
    real rest[3];
    uint triangle; // the first that holds it
    bool touching;
    bool back; // touched from behind
    bool finished;
    uint trail; // hash of the walk and of the triangles
    real reach; // 1: out of contact, no triangle is nearer to the proxy than this
};

} // namespace forceshade::layout
