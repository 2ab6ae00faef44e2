// The nouns of paths on meshes: bindings of their two kernels, and what they hand each other. Included by layout.h,
// under its rules.

// Bindings, all storage buffers in set 0. Sixteen, as many as a plain device may have.
FS_CONSTANT kMeshPathBindLaw = 0u;
FS_CONSTANT kMeshPathBindMapGradients = 1u;
FS_CONSTANT kMeshPathBindTextureGradients = 2u;
FS_CONSTANT kMeshPathBindVectors = 3u;   // 3 a triangle: its corners, and beside them the normal's x, y and z; then the
                                         // normal of each facet, if shaded or textured; then, if shaded, of each
                                         // vertex position and normal
FS_CONSTANT kMeshPathBindTriangles = 4u; // 8 words a triangle: facet, neighbours (with kMeshManyBit: none to hand over
                                         // to); obstacles in front, behind, end, bits
FS_CONSTANT kMeshPathBindIndices = 5u;   // if shaded: where each facet's corners begin, and the end; the corners; then
                                         // the obstacles
FS_CONSTANT kMeshPathBindNodes = 6u;     // MeshNode
FS_CONSTANT kMeshPathBindMotions = 7u;   // as kPathBindMotions, and so on
FS_CONSTANT kMeshPathBindHarmonics = 8u;
FS_CONSTANT kMeshPathBindHands = 9u;
FS_CONSTANT kMeshPathBindRecorded = 10u;
FS_CONSTANT kMeshPathBindStates = 11u;
FS_CONSTANT kMeshPathBindWalkWords = 12u; // kWalkWord... of each path, the path fastest; the status; the list of paths
FS_CONSTANT kMeshPathBindWalkReals = 13u; // kWalkReal... of each path, the path fastest
FS_CONSTANT kMeshPathBindSamples = 14u;   // channel after channel: position, force, depth, proxy
FS_CONSTANT kMeshPathBindFacet = 15u;
FS_CONSTANT kMeshPathBindCount = 16u;

// Specialization constants.
FS_CONSTANT kMeshPathSpecLocalX = 0u;
FS_CONSTANT kMeshPathSpecShading = 1u;
FS_CONSTANT kMeshPathSpecMap = 2u;
FS_CONSTANT kMeshPathSpecTexture = 3u;
FS_CONSTANT kMeshPathSpecChannels = 4u;
FS_CONSTANT kMeshPathSpecMotion = 5u;
FS_CONSTANT kMeshPathSpecLoop = 6u;
FS_CONSTANT kMeshPathSpecHarmonics = 7u;
FS_CONSTANT kMeshPathSpecFriction = 8u;
FS_CONSTANT kMeshPathSpecQuantised = 9u;
FS_CONSTANT kMeshPathSpecUnroll = 10u; // corners of a facet that an iteration takes
FS_CONSTANT kMeshPathSpecCount = 11u;

FS_CONSTANT kNoPath = 0xFFFFFFFFu; // in the list: nothing to do

// Bits of a triangle: those that stand above its plane were too many to list.
FS_CONSTANT kTriangleCrowded = 1u;

// What is to be done with a path.
FS_CONSTANT kPhaseStep = 0u;  // its next step begins
FS_CONSTANT kPhaseRare = 1u;  // the rare kernel does its god-object's update
FS_CONSTANT kPhaseAlone = 2u; // likewise, with the loops of several invocations
FS_CONSTANT kPhaseHost = 3u;  // the host does its god-object's update
FS_CONSTANT kPhaseFelt = 4u;  // the contact of its step is found

// A path's words.
FS_CONSTANT kWalkWordPhase = 0u;
FS_CONSTANT kWalkWordStep = 1u;      // the next
FS_CONSTANT kWalkWordSteps = 2u;     // of the path
FS_CONSTANT kWalkWordHeld = 3u;      // triangles that held the proxy at the last update; and bits
FS_CONSTANT kWalkWordTriangles = 4u; // the three of them
FS_CONSTANT kWalkWordFelt = 7u;      // of a contact: the first triangle that holds it
// Of an update that a kernel has begun and not ended:
FS_CONSTANT kWalkWordStage = 8u;
FS_CONSTANT kWalkWordSubsteps = 9u;
FS_CONSTANT kWalkWordTread = 10u;  // substeps when the proxy was last asked whether it moves
FS_CONSTANT kWalkWordPool = 11u;   // triangles in the pool; 1 bit each for those whose planes led nowhere
FS_CONSTANT kWalkWordPooled = 12u; // the eight of them
FS_CONSTANT kWalkWordCount = 20u;

FS_CONSTANT kHeldCount = 3u;
FS_CONSTANT kHeldCornered = 4u; // rested at a corner or an edge
// Of a contact that was found for a step:
FS_CONSTANT kHeldTouching = 8u;
FS_CONSTANT kHeldBack = 16u; // the first triangle is touched from behind
FS_CONSTANT kHeldUnfinished = 32u;

FS_CONSTANT kMeshPool = 8u; // most triangles that are minded at once
FS_CONSTANT kPoolCount = 15u;
FS_CONSTANT kPoolFaceless = 4u; // shift

FS_CONSTANT kStageBegin = 0u;
FS_CONSTANT kStageWalk = 1u;

// A path's reals, in the mesh's frame; three each.
FS_CONSTANT kWalkRealProxy = 0u;
FS_CONSTANT kWalkRealProbe = 3u;
FS_CONSTANT kWalkRealRest = 6u;   // the contact's proxy
FS_CONSTANT kWalkRealAt = 9u;     // where the walk is
FS_CONSTANT kWalkRealTread = 12u; // where it was last asked whether it moves
FS_CONSTANT kWalkRealFree = 15u;  // nothing is nearer to here than
FS_CONSTANT kWalkRealReach = 18u; // 1: this; 0: not known
FS_CONSTANT kWalkRealCount = 19u;

// What one dispatch covers, as push constants.
struct MeshPathChunkParams {
    uint first;     // in the list
    uint listed;    // paths
    uint paths;     // of the batch
    uint row_first; // the step at which results and recorded positions begin
    uint rows;      // steps of the results
    uint step_end;  // where the dispatch ends
    uint own_hands; // 1: each path has a hand of its own
    uint pause;     // loops after which an invocation begins nothing new
    uint limit;     // loops that an invocation may run
    float stretch;  // m: as in PathChunkParams
    uint vertices;  // where they begin in the vectors
};

#ifdef __cplusplus
// One update of a path's god-object that kernels leave to the host. In the mesh's frame.
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
};
#endif
