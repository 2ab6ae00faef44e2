// The nouns that kernels and CPU oracle share: structs, enums, binding and constant numbers; of fields, of paths, of
// paths on meshes. No functions. Read by C++ and by GLSL. Structs hold scalars only, largest first,
// so that std430 offsets equal C++'s (a test compares them). `real` is float or double: a template parameter in C++, a
// macro in GLSL. Laws G1 to L8: shaders/README.md.
#ifdef __cplusplus
#pragma once
#include <cstddef>
#include <cstdint>
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
// What decides between the inside of a mesh and its outside (L6 static).
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

// Specialization constants, the same of all kernels; each has those that it needs.
FS_CONSTANT kSpecLocalX = 0u;
FS_CONSTANT kSpecSurface = 1u;
FS_CONSTANT kSpecShading = 2u;
FS_CONSTANT kSpecDepth = 3u;
FS_CONSTANT kSpecReference = 4u;
FS_CONSTANT kSpecInside = 5u;
FS_CONSTANT kSpecMap = 6u;
FS_CONSTANT kSpecTexture = 7u;
FS_CONSTANT kSpecChannels = 8u;
FS_CONSTANT kSpecMotion = 9u;
FS_CONSTANT kSpecLoop = 10u;
FS_CONSTANT kSpecFollow = 11u;
FS_CONSTANT kSpecHarmonics = 12u; // of each axis
FS_CONSTANT kSpecFriction = 13u;  // 1: some hand's device has friction
FS_CONSTANT kSpecQuantised = 14u; // 1: some hand's device rounds positions
FS_CONSTANT kSpecFree = 15u;      // of the mesh kernel, 1: only the proxies of free voxels
FS_CONSTANT kSpecUnroll = 16u;    // corners of a facet that an iteration takes
FS_CONSTANT kSpecCoupled = 17u;   // 1: some hand has a virtual coupling
FS_CONSTANT kSpecCount = 18u;

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

// Neighbouring x samples that an invocation of the field kernel evaluates: a vector of four words, of one real each or
// of two.
FS_CONSTANT kLanes = 4u;
FS_CONSTANT kLanesPacked = 8u;

// Acceleration structure of a mesh: children of a node, and how a child is written.
FS_CONSTANT kMeshChildren = 4u;
FS_CONSTANT kMeshNoChild = 0xFFFFFFFFu;
FS_CONSTANT kMeshLeaf = 0x80000000u; // bit of a child that is a run of triangles: first * 8 + count - 1
FS_CONSTANT kMeshLeafTriangles = 8u; // most triangles of a leaf
// triangle_neighbours: what lies across an edge.
FS_CONSTANT kMeshBorder = 0xFFFFFFFFu;      // no triangle
FS_CONSTANT kMeshAnyObstacle = 0xFFFFFFFFu; // more than a list takes
FS_CONSTANT kMeshManyBit = 0x80000000u;     // not exactly one triangle: the low bits index edge_pseudonormals
// What of a triangle the nearest point lies on: its face, edge i as kMeshEdge + i, corner i as kMeshCorner + i.
FS_CONSTANT kMeshFace = 0u;
FS_CONSTANT kMeshEdge = 1u;
FS_CONSTANT kMeshCorner = 4u;
// A mesh field is evaluated in blocks of this many voxels along each axis.
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

// Where the mesh's own frame lies: vertices and probes are (place - centre) / scale there, scale a power of two such
// that no vertex has a coordinate beyond 1. So a mesh law has no absolute length, and a change of unit has no effect.
// Places are measured from the scene's origin, which is near the mesh (host/mesh/structure.h), so that they round alike
// wherever in the world the mesh lies.
FS_STRUCT MeshParams {
    real centre_x; // m, from the scene's origin
    real centre_y;
    real centre_z;
    real map_x; // m: the centre as height maps see it: in the world, of a sine but for whole wavelengths
    real map_y;
    real scale;     // m: what 1 of the mesh's frame means
    real stiffness; // K * scale, N: force for 1 of the mesh's frame
    uint facets;
    uint triangles;
    uint nodes;
    uint zero; // 0, for kernels whose compiler must not know it
};

// A mesh kernel's input of its law: L8 and L9, and the mesh's frame.
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

// How the intended motion of a path goes.
FS_CONSTANT kMotionStrokes = 0u;     // straight, there and back
FS_CONSTANT kMotionRaster = 1u;      // line after line, there and back
FS_CONSTANT kMotionCircle = 2u;      // round and round
FS_CONSTANT kMotionSpiral = 3u;      // round, in and out
FS_CONSTANT kMotionTaps = 4u;        // down and up
FS_CONSTANT kMotionRandomWalk = 5u;  // a sum of harmonics
FS_CONSTANT kMotionMinimumJerk = 6u; // from point to point (Flash & Hogan 1985)
FS_CONSTANT kMotionRecorded = 7u;    // positions that the host gives
// Whether the probe is where the motion is, or a hand and a device take it there.
FS_CONSTANT kLoopOpen = 0u;
FS_CONSTANT kLoopClosed = 1u;
// From where a motion's depth is measured.
FS_CONSTANT kFollowPlane = 0u;   // the plane z = centre_z
FS_CONSTANT kFollowSurface = 1u; // the nominal surface above or below the motion, and centre_z more
// The channels of a path, as bits besides kChannelForce, kChannelDepth, kChannelFacet and kChannelProxy.
FS_CONSTANT kChannelPosition = 32u; // m, 3 reals a sample: where the law was evaluated

// A phase is counted in 2^-32 turns, so that it is exact however long a path is.
FS_CONSTANT kQuarterTurn = 0x40000000u;
FS_CONSTANT kHalfTurn = 0x80000000u;
FS_CONSTANT kNever = 0xFFFFFFFFu; // a step that did not come

// Bindings of the kernel of paths over analytic surfaces, all storage buffers in set 0.
FS_CONSTANT kPathBindLaw = 0u;
FS_CONSTANT kPathBindFacetVertices = 1u;
FS_CONSTANT kPathBindMapGradients = 2u;
FS_CONSTANT kPathBindTextureGradients = 3u;
FS_CONSTANT kPathBindMotions = 4u;   // a MotionParams a path; recorded: an empty one
FS_CONSTANT kPathBindHarmonics = 5u; // component, axis, path, the last fastest
FS_CONSTANT kPathBindHands = 6u;     // a HandParams for all, or one a path
FS_CONSTANT kPathBindLengths = 7u;   // recorded: samples of each path
FS_CONSTANT kPathBindRecorded = 8u;  // recorded: positions, step by step, path fastest
FS_CONSTANT kPathBindStates = 9u;    // a PathState a path
FS_CONSTANT kPathBindStatus = 10u;
FS_CONSTANT kPathBindPosition = 11u;
FS_CONSTANT kPathBindForce = 12u;
FS_CONSTANT kPathBindDepth = 13u;
FS_CONSTANT kPathBindFacet = 14u;
FS_CONSTANT kPathBindProxy = 15u;
FS_CONSTANT kPathBindCount = 16u;

// What one dispatch of a kernel of paths covers, as push constants.
struct PathChunkParams {
    uint paths;       // of the batch
    uint step_first;  // of the dispatch; results and recorded positions begin there
    uint step_end;    // where it ends
    uint steps;       // of a path, where it has no length of its own
    uint own_lengths; // 1: each path has one
    uint own_hands;   // 1: each path has a hand of its own
    float stretch;    // m: the least distance that a turn of the force is counted over
};

// A harmonic motion added along one axis of one path.
FS_STRUCT Harmonic {
    real amplitude;  // m
    uint phase;      // at step 0
    uint phase_step; // a sample
};

// One path's intended motion. The stroke's direction is (heading_x, heading_y), across is a quarter turn to its left.
FS_STRUCT MotionParams {
    real centre_x; // m: the middle of the motion
    real centre_y;
    real centre_z;
    real heading_x; // 1: unit
    real heading_y;
    real reach;        // m: half of a stroke or line, the largest radius, half of the region along the heading
    real across;       // m: half of the region across; of a spiral the smallest radius
    real depth;        // m: below the surface; of strokes on the way there
    real depth_back;   // m: of strokes on the way back
    real lift;         // m: of taps, above the surface at the top
    uint phase;        // at step 0
    uint phase_step;   // a sample
    uint radius_phase; // of a spiral's radius
    uint radius_step;
    uint run;     // samples of a line of a raster, or from point to point
    uint turn;    // samples from a raster's line to the next
    uint lines;   // of a raster
    uint key_low; // of the path's random numbers
    uint key_high;
    uint zero; // 0
};

// One axis of mass, damping and spring over one sample, exactly (zero-order hold): with e the distance from the target,
// v the speed and f the constant force, x += x_error e + x_speed v + x_force f and v becomes v_error e + v_speed v +
// v_force f.
FS_STRUCT AxisMap {
    real x_error; // 1
    real x_speed; // s
    real x_force; // m/N
    real v_error; // 1/s
    real v_speed; // 1
    real v_force; // m/s/N
};

// A virtual coupling of k, N/m, and b, N s/m, between the device and a tool in a scene of K, N/m, over a sample T: of a
// probe's depth d the tool's is depth * d - lag * s, where s is their distance in the sample before. The damper takes
// its speed through a filter of the time constant t: then b / T is b / (T + t), and s becomes kept * s + (1 - kept) *
// the distance. Where the tool's depth is not above 0, `free` of s is left. All 0: no coupling.
FS_STRUCT Coupling {
    real depth; // 1: (k + b / T) / (K + k + b / T)
    real lag;   // 1: (b / T) / (K + k + b / T)
    real free;  // 1: kept + (1 - kept) * (b / T) / (k + b / T)
    real kept;  // 1: t / (T + t)
    real rest;  // 1: K / (K + k): of a depth at rest, as where a path begins, the distance to the tool's
};

// The hand and the device that it holds.
FS_STRUCT HandParams {
    FS_REAL_STRUCT(AxisMap) lateral;  // x and y
    FS_REAL_STRUCT(AxisMap) vertical; // z
    real rate;                        // 1/s: samples a second
    real period;                      // s: 1 / rate
    real stiffness;                   // N/m: of the grip along x and y
    real stiffness_z;                 // N/m: along z, 0 where the hand presses with a given force
    real damping;                     // N s/m: of the grip
    real push_x;                      // N: the hand's constant force
    real push_y;
    real push_z;
    real quantum;     // m: of measured positions, 0: none
    real coulomb;     // N: friction on each axis
    real max_force;   // N: what the device can display
    real gain;        // 1: the law's force times this is commanded
    real bound;       // m: a probe further than this from its target has left: the loop is unstable
    real start_depth; // m: below the target, where the probe begins
    FS_REAL_STRUCT(Coupling) coupling;
    uint delay; // samples from measurement to force, 0 or 1
    uint zero;  // 0
};

// The state of a path, however long it is. Sums have a second term that keeps what rounding takes from the
// first.
FS_STRUCT PathMetrics {
    real largest_force;     // N
    real force_square;      // N^2: sum over the samples
    real force_square_rest; // N^2
    real largest_turn;      // 1: square of the difference of the unit forces of two samples in a row, both in contact
    real steepest_turn;     // 1: square of the chord of the force's steepest turn since an anchor
    real steepest_distance; // m^2: square of the distance it took, no less than the stretch
    real least_depth;       // m: in contact
    real largest_depth;     // m
    real first_depth;       // m: of the first sample in contact
    real depth;             // m: sum of the depths in contact, each less the first: small where they hardly differ
    real depth_rest;        // m
    real depth_square;      // m^2: of the same
    real depth_square_rest; // m^2
    real work;              // J: done on the hand
    real work_rest;         // J
    real effort;            // J: sum of |F . dx|
    real effort_rest;       // J
    real round_begin;       // J: the work when the round began, all rounds before it together
    real round_begin_rest;  // J
    real largest_round;     // J: the most work of a round that has ended
    real least_round;       // J: the least
    real early_speed;       // m/s: the largest in the second quarter of the steps
    real late_speed;        // m/s: in the last quarter
    uint contact_samples;
    uint rounds;        // ended
    uint unstable_step; // at which the probe left its bound; kNever
    uint fell;          // 1: it left free of contact, the way the hand pushes
    uint unfinished;    // samples at which a proxy did not come to rest
    uint trail;         // hash of every place a mesh's proxy walked through, and of what held it there; else 0
};

// A path between two steps.
FS_STRUCT PathState {
    real x; // m: where the probe is
    real y;
    real z;
    real speed_x; // m/s
    real speed_y;
    real speed_z;
    real measured_x; // m: where the law was evaluated last
    real measured_y;
    real measured_z;
    real force_x; // N: commanded last
    real force_y;
    real force_z;
    real anchor_x; // m: from where the turn of the force is counted
    real anchor_y;
    real anchor_z;
    real anchor_force_x; // 1: the force's direction there
    real anchor_force_y;
    real anchor_force_z;
    real steepest; // 1: about the square of the steepest turn's angle
    real lag; // m: by how much less deep the tool of a virtual coupling was than the probe; below 0 before the first
              // step
    FS_REAL_STRUCT(PathMetrics) metrics;
    uint step;     // the next
    uint directed; // 1: at the last sample there was contact and a force, so that there is an anchor
};

// The proxy with which a path on a mesh begins, in the mesh's frame.
FS_STRUCT ProxyStart {
    real x;
    real y;
    real z;
    uint inside; // 1: the probe was behind the surface, the proxy is on the nearest place of it
};

// Bindings of the kernel of paths on meshes, all storage buffers in set 0. A plain device may have sixteen.
FS_CONSTANT kMeshPathBindLaw = 0u;
FS_CONSTANT kMeshPathBindMapGradients = 1u;
FS_CONSTANT kMeshPathBindTextureGradients = 2u;
FS_CONSTANT kMeshPathBindVectors = 3u;   // 3 a triangle: its corners, each with the normal's x, y or z; then the
                                         // normal of each facet, if shaded or textured; then, if shaded, of each
                                         // vertex position and normal
FS_CONSTANT kMeshPathBindTriangles = 4u; // 8 words a triangle: facet, neighbours (with kMeshManyBit: none to hand over
                                         // to); obstacles in front, behind, end, bits
FS_CONSTANT kMeshPathBindIndices = 5u;   // if shaded: where each facet's corners begin, and the end; the corners; then
                                         // the obstacles
FS_CONSTANT kMeshPathBindMotions = 6u;   // as kPathBindMotions, and so on
FS_CONSTANT kMeshPathBindHarmonics = 7u;
FS_CONSTANT kMeshPathBindHands = 8u;
FS_CONSTANT kMeshPathBindRecorded = 9u;
FS_CONSTANT kMeshPathBindStates = 10u;
FS_CONSTANT kMeshPathBindWalkWords = 11u; // kWalkWord... of each path, the path fastest; the status; the list of paths
FS_CONSTANT kMeshPathBindWalkReals = 12u; // kWalkReal... of each path, the path fastest
FS_CONSTANT kMeshPathBindSamples = 13u;   // channel after channel: position, force, depth, proxy
FS_CONSTANT kMeshPathBindFacet = 14u;
FS_CONSTANT kMeshPathBindCount = 15u;

FS_CONSTANT kNoPath = 0xFFFFFFFFu; // in the list: no path

// Bits of a triangle: those that stand above its plane were too many to list.
FS_CONSTANT kTriangleCrowded = 1u;

// The next task of a path.
FS_CONSTANT kPhaseStep = 0u;    // its next step begins
FS_CONSTANT kPhaseHost = 1u;    // the host finds the contact of its step
FS_CONSTANT kPhaseContact = 2u; // the contact of its step is found

// A path's words.
FS_CONSTANT kWalkWordPhase = 0u;
FS_CONSTANT kWalkWordStep = 1u;        // the next
FS_CONSTANT kWalkWordSteps = 2u;       // of the path
FS_CONSTANT kWalkWordConstraints = 3u; // triangles that constrained the proxy at the last update; and bits
FS_CONSTANT kWalkWordTriangles = 4u;   // the three of them
FS_CONSTANT kWalkWordContact = 7u;     // of a contact that the host found: the first triangle that constrains it
FS_CONSTANT kWalkWordTrail = 8u;       // and the hash of its walk
FS_CONSTANT kWalkWordCount = 9u;

FS_CONSTANT kConstraintCount = 3u;
FS_CONSTANT kConstraintCornered = 4u; // rested at a corner or an edge
// Of a contact that the host found:
FS_CONSTANT kContactTouching = 8u;
FS_CONSTANT kContactBack = 16u; // the first triangle is touched from behind
FS_CONSTANT kContactUnfinished = 32u;

// A path's reals, in the mesh's frame; three each.
FS_CONSTANT kWalkRealProxy = 0u;
FS_CONSTANT kWalkRealProbe = 3u;
FS_CONSTANT kWalkRealContact = 6u; // the contact's proxy
FS_CONSTANT kWalkRealFree = 9u;    // no triangle is nearer to here than
FS_CONSTANT kWalkRealReach = 12u;  // 1: this; 0: not known
FS_CONSTANT kWalkRealCount = 13u;

// What one dispatch of the kernel of paths on meshes covers, as push constants.
struct MeshPathChunkParams {
    uint first;     // in the list
    uint listed;    // paths
    uint paths;     // of the batch
    uint row_first; // the step at which results and recorded positions begin
    uint rows;      // steps of the results
    uint step_end;  // where the dispatch ends
    uint own_hands; // 1: each path has a hand of its own
    uint pause;     // loops after which an invocation begins no new step
    uint limit;     // loops that an invocation may run
    float stretch;  // m: as in PathChunkParams
    uint vertices;  // where they begin in the vectors
};

#ifdef __cplusplus
} // namespace forceshade::layout
#endif
#undef FS_CONSTANT
#undef FS_STRUCT
#undef FS_REAL_STRUCT
