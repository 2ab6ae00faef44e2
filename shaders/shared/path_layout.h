// The nouns of exploration paths: how a probe moves, what holds it, what of a path is remembered. Included by layout.h,
// under its rules.

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
// What a path may write, as bits beside kChannelForce, kChannelDepth, kChannelFacet and kChannelProxy.
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
FS_CONSTANT kPathBindMotions = 4u;   // a MotionParams a path; recorded: one that says nothing
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

// Specialization constants of the kernel of paths.
FS_CONSTANT kPathSpecLocalX = 0u;
FS_CONSTANT kPathSpecSurface = 1u;
FS_CONSTANT kPathSpecShading = 2u;
FS_CONSTANT kPathSpecDepth = 3u;
FS_CONSTANT kPathSpecReference = 4u;
FS_CONSTANT kPathSpecMap = 5u;
FS_CONSTANT kPathSpecTexture = 6u;
FS_CONSTANT kPathSpecChannels = 7u;
FS_CONSTANT kPathSpecMotion = 8u;
FS_CONSTANT kPathSpecLoop = 9u;
FS_CONSTANT kPathSpecFollow = 10u;
FS_CONSTANT kPathSpecHarmonics = 11u; // of each axis
FS_CONSTANT kPathSpecFriction = 12u;  // 1: some hand's device has friction
FS_CONSTANT kPathSpecQuantised = 13u; // 1: some hand's device rounds positions
FS_CONSTANT kPathSpecCount = 14u;

// What one dispatch of a kernel of paths covers, as push constants.
struct PathChunkParams {
    uint paths;       // of the batch
    uint step_first;  // of the dispatch
    uint step_end;    // where it ends
    uint row_first;   // the step at which results and recorded positions begin
    uint steps;       // of a path, where it has no length of its own
    uint own_lengths; // 1: each path has one
    uint own_hands;   // 1: each path has a hand of its own
    float stretch;    // m: the least way that a turn of the force is counted over
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
    uint delay;       // samples from measurement to force, 0 or 1
    uint zero;        // 0
};

// What is remembered of a path, however long it is. Sums have a second term that keeps what rounding takes from the
// first.
FS_STRUCT PathMetrics {
    real largest_force;     // N
    real force_square;      // N^2: sum over the samples
    real force_square_rest; // N^2
    real largest_turn;      // 1: square of the difference of the unit forces of two samples in a row, both in contact
    real steepest_turn;     // 1: square of the chord of the force's steepest turn since an anchor
    real steepest_way;      // m^2: square of the way that it took, no less than the stretch
    real least_depth;       // m: in contact
    real largest_depth;     // m
    real depth;             // m: sum over the samples in contact
    real depth_rest;        // m
    real depth_square;      // m^2: likewise
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
    uint zero;          // 0
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

#ifdef __cplusplus
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
    float stretch = 1e-3f; // m: the least way that a turn of the force is counted over
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
#endif
