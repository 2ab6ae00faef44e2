// The nouns that kernels and CPU oracle share: structs, enums, binding and constant numbers. No verbs: nothing here
// computes. Read by C++ and by GLSL. Structs hold scalars only, largest first, so that std430 offsets equal C++'s (a
// test compares them). `real` is float or double: a template parameter in C++, a macro in GLSL. Laws G1 to L8:
// shaders/README.md.
#ifdef __cplusplus
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
namespace forceshade::layout {
using uint = std::uint32_t;
#define FS_CONSTANT inline constexpr uint
#define FS_STRUCT template <typename real> struct
#define FS_REAL_STRUCT(name) name<real>
#else
#define FS_CONSTANT const uint
#define FS_STRUCT struct
#define FS_REAL_STRUCT(name) name
#endif

// Which law gives the nominal surface.
FS_CONSTANT kSurfaceBump = 0u;         // L1, L3, L4: n facets on a plane
FS_CONSTANT kSurfaceCylinderBump = 1u; // L2: plane and cylinder superposed
FS_CONSTANT kSurfaceHeightMap = 2u;    // L5: the plane, shaded by a height map
FS_CONSTANT kSurfaceMesh = 3u;         // L6, L7, L9: polygon facets
// Where the force direction comes from.
FS_CONSTANT kShadingNone = 0u;
FS_CONSTANT kShadingReference = 1u; // L4: the smooth cylinder
FS_CONSTANT kShadingHeightMap = 2u; // L5: the height map's normal
// L7: interpolations of the vertex normals of the facet that the proxy lies on.
FS_CONSTANT kShadingMorgenbesser = 3u;
FS_CONSTANT kShadingBarycentric = 4u; // triangles only
FS_CONSTANT kShadingMeanValue = 5u;
FS_CONSTANT kShadingTwoPass = 6u; // mean value, and as deep along the facet's normal as unshaded
// How penetration into a facet is read (L3).
FS_CONSTANT kDepthVertical = 0u;
FS_CONSTANT kDepthNormal = 1u;
// Which direction the smooth cylinder lends (L4).
FS_CONSTANT kReferenceNormal = 0u; // the surface normal above the probe
FS_CONSTANT kReferenceRadial = 1u; // away from the axis, at the probe itself
// What tells the inside of a mesh from its outside (L6 static).
FS_CONSTANT kInsidePseudonormal = 0u; // the angle-weighted normal of the nearest feature
FS_CONSTANT kInsideWinding = 1u;      // the generalized winding number, found on the host: a bit for each voxel
// Height maps (G3), for shading and for texture.
FS_CONSTANT kMapNone = 0u;
FS_CONSTANT kMapCylinder = 1u;
FS_CONSTANT kMapDip = 2u;
FS_CONSTANT kMapSine = 3u;
FS_CONSTANT kMapGaussian = 4u;
FS_CONSTANT kMapSamples = 5u;
// Channels a field may write, as bits.
FS_CONSTANT kChannelForce = 1u;     // N, 3 reals a voxel
FS_CONSTANT kChannelDepth = 2u;     // m, 1 real a voxel
FS_CONSTANT kChannelFacet = 4u;     // id, 1 uint a voxel
FS_CONSTANT kChannelProxy = 8u;     // m, 3 reals a voxel
FS_CONSTANT kChannelUnshaded = 16u; // N, 3 reals a voxel: what shading "none" would give

FS_CONSTANT kNoFacet = 0xFFFFFFFFu; // facet id of a voxel out of contact

// Bindings of the field kernel, all storage buffers in set 0.
FS_CONSTANT kBindLaw = 0u;
FS_CONSTANT kBindAxes = 1u;
FS_CONSTANT kBindFacetVertices = 2u;
FS_CONSTANT kBindMapGradients = 3u;
FS_CONSTANT kBindTextureGradients = 4u;
FS_CONSTANT kBindStatus = 5u;
FS_CONSTANT kBindForce = 6u;
FS_CONSTANT kBindDepth = 7u;
FS_CONSTANT kBindFacet = 8u;
FS_CONSTANT kBindProxy = 9u;
FS_CONSTANT kBindUnshaded = 10u;
FS_CONSTANT kBindCount = 11u;

// Specialization constants of the field kernel.
FS_CONSTANT kSpecLocalX = 0u;
FS_CONSTANT kSpecSurface = 1u;
FS_CONSTANT kSpecShading = 2u;
FS_CONSTANT kSpecDepth = 3u;
FS_CONSTANT kSpecReference = 4u;
FS_CONSTANT kSpecMap = 5u;
FS_CONSTANT kSpecTexture = 6u;
FS_CONSTANT kSpecChannels = 7u;
FS_CONSTANT kSpecCount = 8u;

// Neighbouring x samples that an invocation of the field kernel evaluates: a vector of four words, of one real each or
// of two.
FS_CONSTANT kAbreast = 4u;
FS_CONSTANT kAbreastPacked = 8u;

// Acceleration structure of a mesh: children of a node, and how a child is written.
FS_CONSTANT kMeshChildren = 4u;
FS_CONSTANT kMeshNoChild = 0xFFFFFFFFu;
FS_CONSTANT kMeshLeaf = 0x80000000u; // bit of a child that is a run of triangles: first * 8 + count - 1
FS_CONSTANT kMeshLeafTriangles = 8u; // most triangles of a leaf
// triangle_neighbours: what lies across an edge.
FS_CONSTANT kMeshBorder = 0xFFFFFFFFu;  // nothing
FS_CONSTANT kMeshManyBit = 0x80000000u; // not exactly one triangle: the low bits index edge_pseudonormals
// What of a triangle the nearest point lies on: its face, edge i as kMeshEdge + i, corner i as kMeshCorner + i.
FS_CONSTANT kMeshFace = 0u;
FS_CONSTANT kMeshEdge = 1u;
FS_CONSTANT kMeshCorner = 4u;
// A mesh field is evaluated in blocks of so many voxels along each axis.
FS_CONSTANT kMeshBlock = 2u;

// Bindings of the mesh kernel, all storage buffers in set 0. Sixteen, as many as a plain device may have.
FS_CONSTANT kMeshBindLaw = 0u;
FS_CONSTANT kMeshBindAxes = 1u;
FS_CONSTANT kMeshBindMapGradients = 2u;
FS_CONSTANT kMeshBindTextureGradients = 3u;
FS_CONSTANT kMeshBindRecords = 4u;   // 3 vectors a triangle: corners in order of (x, y, z), and its normal
FS_CONSTANT kMeshBindTriangles = 5u; // 8 words a triangle: corners, facet, neighbours * 2 + turned; kInsideWinding: its
                                     // facet alone
FS_CONSTANT kMeshBindVertices =
    6u;                            // of each vertex position and normal, if shaded; pseudonormal, unless kInsideWinding
FS_CONSTANT kMeshBindNormals = 7u; // a vector a facet, unless neither shaded nor textured; then one an edge that has a
                                   // pseudonormal of its own, unless kInsideWinding
FS_CONSTANT kMeshBindFacets = 8u;  // if shaded: where each facet's corners begin, and the end; then the corners
FS_CONSTANT kMeshBindPlan = 9u;    // kMeshBlockWords a block; then the candidates
FS_CONSTANT kMeshBindStatus = 10u;
FS_CONSTANT kMeshBindForce = 11u;
FS_CONSTANT kMeshBindDepth = 12u;
FS_CONSTANT kMeshBindFacet = 13u;
FS_CONSTANT kMeshBindProxy = 14u;
FS_CONSTANT kMeshBindUnshaded = 15u;
FS_CONSTANT kMeshBindCount = 16u;

// Specialization constants of the mesh kernel.
FS_CONSTANT kMeshSpecLocalX = 0u;
FS_CONSTANT kMeshSpecShading = 1u;
FS_CONSTANT kMeshSpecInside = 2u;
FS_CONSTANT kMeshSpecMap = 3u;
FS_CONSTANT kMeshSpecTexture = 4u;
FS_CONSTANT kMeshSpecChannels = 5u;
FS_CONSTANT kMeshSpecFree = 6u;   // 1: only the proxies of free voxels
FS_CONSTANT kMeshSpecUnroll = 7u; // corners of a facet that an iteration takes
FS_CONSTANT kMeshSpecCount = 8u;

// A block on the device: x, y, z of its first voxel within the chunk, first candidate, their count; and 8 bits for the
// voxels inside by the winding number, 8 for those to evaluate.
FS_CONSTANT kMeshBlockWords = 6u;
// A candidate on the device: the triangle's place in the order of (facet, triangle), so that the lower word wins a tie;
// whether its sorted corners turn the other way; which sorted corner is its first; which sorted edge is its longest.
FS_CONSTANT kMeshCandidateShift = 5u;
FS_CONSTANT kMeshCandidateTurned = 1u;
FS_CONSTANT kMeshCandidateFirst = 1u;   // shift of 2 bits
FS_CONSTANT kMeshCandidateLongest = 3u; // shift of 2 bits

// Bits a kernel raises in its status word.
FS_CONSTANT kStatusUnfinished = 1u; // a loop ended before its work was done

// A height map U(x, y) in metres, seen through its gradient: no force law needs U itself (L5, L8).
FS_STRUCT MapParams {
    real half_width;     // m: a of G1, or half the sampled size along x
    real half_length;    // m: half the sampled size along y
    real radius;         // m: R of G1, or the 1/e radius of the Gaussian
    real slope;          // 1: the sine's largest gradient; the Gaussian's 2 h / radius
    real inverse_length; // 1/m: 1 / wavelength of the sine, 1 / radius of the Gaussian
    real nodes_per_x;    // 1/m: sample columns a metre
    real nodes_per_y;    // 1/m: sample rows a metre
    uint columns;        // samples along x
    uint rows;           // samples along y
};

FS_STRUCT LawParams {
    real stiffness;         // K, N/m
    real texture_stiffness; // K_t, N/m
    real half_width;        // a, m
    real radius;            // R, m
    real centre_depth;      // sqrt((R-a)(R+a)), m: the cylinder's axis lies this far below the plane
    FS_REAL_STRUCT(MapParams) map;
    FS_REAL_STRUCT(MapParams) texture;
    uint facets; // n
    uint zero;   // 0, for kernels whose compiler must not know it
};

// What one dispatch covers, as push constants. A row is the samples of one (y, z); rows are stored at x_pitch samples.
struct ChunkParams {
    uint x_pitch; // the samples of a row, rounded up to whole invocations
    uint y_first;
    uint y_count;
    uint y_axis; // where the y coordinates begin in the axis table
    uint z_first;
    uint z_count;
    uint z_axis; // where the z coordinates begin in the axis table
    uint rows;   // rows an invocation evaluates
};

// Where the mesh's own frame lies: vertices and probes are (world - centre) / scale there, scale a power of two such
// that no vertex has a coordinate beyond 1. So nothing in a mesh law is absolute, and a change of unit changes nothing.
FS_STRUCT MeshParams {
    real centre_x; // m, world
    real centre_y;
    real centre_z;
    real scale;     // m: what 1 of the mesh's frame means
    real stiffness; // K * scale, N: force for 1 of the mesh's frame
    uint facets;
    uint triangles;
    uint nodes;
    uint zero; // 0, for kernels whose compiler must not know it
};

// What a mesh kernel reads of its law: L8 and L9, and the mesh's frame.
FS_STRUCT MeshLawParams {
    FS_REAL_STRUCT(LawParams) law;
    FS_REAL_STRUCT(MeshParams) mesh;
};

// What one dispatch of the mesh kernel covers, as push constants.
struct MeshChunkParams {
    uint x_pitch; // the samples of a row, rounded up to whole blocks
    uint y_first;
    uint y_count;
    uint y_axis; // where the y coordinates begin in the axis table
    uint z_first;
    uint z_count;
    uint z_axis;     // where the z coordinates begin in the axis table
    uint blocks;     // listed
    uint candidates; // where they begin in the plan, in words
};

// Four children of the tree over the triangles: bounds in the mesh's frame, rounded outwards, the same in every
// precision.
struct MeshNode {
    float low_x[kMeshChildren];
    float low_y[kMeshChildren];
    float low_z[kMeshChildren];
    float high_x[kMeshChildren];
    float high_y[kMeshChildren];
    float high_z[kMeshChildren];
    uint child[kMeshChildren];
};

// A block of a mesh field, and the run of triangles among which the nearest one of each of its voxels is.
struct MeshBlock {
    uint x; // of its first voxel, in samples of the grid
    uint y;
    uint z;
    uint first; // of its candidates
    uint count; // 0: no voxel of the block is in contact
};

#ifdef __cplusplus
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
    bool solid = false;                  // bounds one solid, whose surface nowhere meets itself
    std::span<const MeshMoment> moments; // 1 a node
    std::span<const uint> rims;          // 3 an edge where the surface ends: its vertices, how often more one way
};

// Where a mesh's force is, on one grid. Voxels of blocks that are not listed are out of contact.
struct MeshPlan {
    std::span<const MeshBlock> blocks; // by z
    std::span<const uint> candidates;  // triangles
    std::span<const uint> inside;      // kInsideWinding: 1 word a block, bit (z * 2 + y) * 2 + x of each voxel
};

// What a scene uses; everything else is left out of the compiled kernel.
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
    std::span<const real> texture_gradients; // likewise for the texture
    MeshView<real> mesh{};                   // kSurfaceMesh only; L9: params.map and map_gradients tilt its normals
};

// A law over a grid.
template <typename real> struct FieldInput {
    Law<real> law;
    std::span<const real> x, y, z; // m, sample coordinates, each rounded once from double; of a mesh in its own frame
    MeshPlan plan{};               // of a mesh
};

// Consecutive rows of an evaluated field: z in [z_first, z_first + z_count), y likewise. Row r = (z - z_first) *
// y_count + (y - y_first) begins at sample r * x_pitch. Channels that the features lack are empty. The spans die with
// the callback that receives them.
template <typename real> struct FieldChunk {
    std::size_t x_count, x_pitch;
    std::size_t y_first, y_count;
    std::size_t z_first, z_count;
    std::span<const real> force;    // N, 3 a sample
    std::span<const real> depth;    // m
    std::span<const uint> facet;    // id
    std::span<const real> proxy;    // m, 3 a sample
    std::span<const real> unshaded; // N, 3 a sample
};
#endif

#include "mesh_path_layout.h"
#include "path_layout.h"

#ifdef __cplusplus
} // namespace forceshade::layout
#endif
#undef FS_CONSTANT
#undef FS_STRUCT
#undef FS_REAL_STRUCT
