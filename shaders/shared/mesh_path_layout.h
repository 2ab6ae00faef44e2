// The nouns of paths on meshes: bindings of their three kernels, and what they hand each other. Included by layout.h,
// under its rules.

// Bindings, all storage buffers in set 0. Sixteen, as many as a plain device may have.
FS_CONSTANT kMeshPathBindLaw = 0u;
FS_CONSTANT kMeshPathBindMapGradients = 1u;
FS_CONSTANT kMeshPathBindTextureGradients = 2u;
FS_CONSTANT kMeshPathBindVectors = 3u;   // 3 a triangle: its corners, and beside them the normal's x, y and z; then the
                                         // normal of each facet, if shaded or textured; then of each vertex position,
                                         // normal (if shaded) and pseudonormal (if rests settle here), or nothing; then
                                         // pseudonormals of edges that have one of their own
FS_CONSTANT kMeshPathBindTriangles = 4u; // 8 words a triangle: facet, neighbours (with kMeshManyBit: where in the
                                         // vectors the edge's pseudonormal is); obstacles in front, behind, end, bits;
                                         // then 4 a triangle: its corners, if rests settle here
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
FS_CONSTANT kPhaseStep = 0u;   // its next step begins
FS_CONSTANT kPhaseRare = 1u;   // the rare kernel does its god-object's update
FS_CONSTANT kPhaseAlone = 2u;  // likewise, with the loops of several invocations
FS_CONSTANT kPhaseFelt = 3u;   // the rare kernel has found the contact of its step
FS_CONSTANT kPhaseSettle = 4u; // the settling kernel does its god-object's update, or goes on with it
FS_CONSTANT kPhaseSettleAlone = 5u;
FS_CONSTANT kPhaseHost = 6u; // the host does its god-object's update

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
// Of settling: the last rest, its contact, and the way that is tried.
FS_CONSTANT kWalkWordBefore = 20u;   // its three triangles
FS_CONSTANT kWalkWordContact = 23u;  // its three triangles
FS_CONSTANT kWalkWordSettling = 26u; // kSettling...
FS_CONSTANT kWalkWordRounds = 27u;
FS_CONSTANT kWalkWordVertex = 28u; // that ways begin from
FS_CONSTANT kWalkWordWay = 29u;    // the way's triangle
FS_CONSTANT kWalkWordTried = 30u;  // kTried...
FS_CONSTANT kWalkWordCount = 31u;

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
FS_CONSTANT kStageRest = 2u;   // the walk has come to a rest that may not be one
FS_CONSTANT kStageSettle = 3u; // a way is tried

// Shifts of what kWalkWordSettling holds, 2 bits each or 1.
FS_CONSTANT kSettlingCount = 0u;   // triangles of the last rest
FS_CONSTANT kSettlingContact = 2u; // triangles of its contact
FS_CONSTANT kSettlingBack = 4u;    // whose first is touched from behind
FS_CONSTANT kSettlingFront = 5u;   // the last rest is in front of the surface
FS_CONSTANT kSettlingHalted = 6u;  // where a line between two faces ended
FS_CONSTANT kSettlingCorner = 7u;  // ways begin from a corner
FS_CONSTANT kSettlingTrying = 8u;  // kTry...
FS_CONSTANT kSettlingJump = 10u;   // before the walk, one is left
FS_CONSTANT kSettlingOver = 11u;   // and it is the first of two

// Shifts of what kWalkWordTried holds, 4 bits each.
FS_CONSTANT kTriedWays = 0u;
FS_CONSTANT kTriedStrides = 4u;
FS_CONSTANT kTriedLifted = 8u;
FS_CONSTANT kTriedEdge = 12u; // that the way leads along

// A path's reals, in the mesh's frame; three each.
FS_CONSTANT kWalkRealProxy = 0u;
FS_CONSTANT kWalkRealProbe = 3u;
FS_CONSTANT kWalkRealRest = 6u;   // the contact's proxy
FS_CONSTANT kWalkRealAt = 9u;     // where the walk is
FS_CONSTANT kWalkRealTread = 12u; // where it was last asked whether it moves
FS_CONSTANT kWalkRealFree = 15u;  // nothing is nearer to here than
FS_CONSTANT kWalkRealReach = 18u; // 1: this; 0: not known
// Of settling:
FS_CONSTANT kWalkRealBefore = 19u;  // the last rest
FS_CONSTANT kWalkRealContact = 22u; // its contact's proxy
FS_CONSTANT kWalkRealFrom = 25u;    // where ways begin
FS_CONSTANT kWalkRealOut = 28u;     // away from the surface there
FS_CONSTANT kWalkRealThere = 31u;   // a place along the way
FS_CONSTANT kWalkRealTo = 34u;      // where the next jump leads
FS_CONSTANT kWalkRealGain = 37u;    // 1: of the way
FS_CONSTANT kWalkRealCount = 38u;

// What one dispatch covers, as push constants.
struct MeshPathChunkParams {
    uint first;          // in the list
    uint listed;         // paths
    uint paths;          // of the batch
    uint row_first;      // the step at which results and recorded positions begin
    uint rows;           // steps of the results
    uint step_end;       // where the dispatch ends
    uint own_hands;      // 1: each path has a hand of its own
    uint pause;          // loops after which an invocation begins nothing new
    uint limit;          // loops that an invocation may run
    float stretch;       // m: as in PathChunkParams
    uint vertices;       // where they begin in the vectors
    uint vertex_vectors; // vectors of each: position, normal, pseudonormal, as far as they are read
};

#ifdef __cplusplus
// One update of a path's god-object that kernels leave to the host: L6 at a corner or an edge. In the mesh's frame.
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
