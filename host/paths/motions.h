// Where generated paths go and how: their region, their random numbers, which follow from the seed and the path's
// number alone, and the motion that follows from both.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

struct PathRegion {
    std::array<double, 2> centre{}; /* m */
    double height = 0;              /* m: z that depth is measured from */
    double length = 0;              /* m: along the heading */
    double width = 0;               /* m: across */
    double inner = 0;               /* m: a spiral's smallest radius */
    double bound = 0;               /* m: a probe further than this from its target has left */
    double stretch = 0;             /* m: the least distance over which a turn of the force is counted */
};

/// The region of a scene's paths. Left open: about the origin, or the middle of a mesh's box; 1.2 times as long as the
/// feature is wide along x (of a sine a wavelength, of a Gaussian 4 radii, of an image its size), as wide as long (of
/// a mesh and an image 1.2 times their width along y), but half of a mesh's box for a hand that presses and would fall
/// off its rim; height 0 or the box's top. The stretch is a thousandth of the length; where that is 0 of the width, or
/// of the length that would follow from the feature. \throws UsageError for a spiral whose smallest radius is larger
/// than its largest.
PathRegion path_region(const PathsSpec& paths, const PreparedCase& prepared);

/// The stretch, m, as kernels have it in either precision: its square is a number of single precision.
float single_stretch(const PathRegion& region);

/// The largest coordinate, m, that a path may reach: of a normal distribution 8 standard deviations are counted, and
/// of a closed loop what its bound allows.
double farthest_coordinate(const PathsSpec& paths, const PathRegion& region);

/// What a random number is for. A motion's points on the way (reference::via_point) have number 1.
enum class Draw : std::uint32_t {
    speed = 16,
    depth,
    depth_back,
    heading,
    offset,
    tremor_amplitude,
    tremor_frequency,
    tremor_phase,
    walk_frequency,
    walk_phase,
};

class PathDraws {
public:
    PathDraws(std::uint64_t seed, std::uint64_t path);

    /// The key of the path's own random numbers.
    std::array<std::uint32_t, 2> key() const { return key_; }

    std::uint32_t word(Draw draw, std::uint32_t index) const;
    /// Uniform between 0 and 1, neither of which it is.
    double uniform(Draw draw, std::uint32_t index) const;

    /// A value of a quantity that may differ from path to path; `positive`: values that are not are drawn again, and
    /// what is never positive is 0.
    double value(const Spread& spread, Draw draw, bool positive = false) const;

private:
    std::array<std::uint32_t, 4> words(Draw draw, std::uint32_t index) const;

    std::array<std::uint32_t, 2> key_;
};

// Sums of harmonics: the whole of a random walk, the tremor of other paths.

struct Harmonic {
    double amplitude = 0;         /* m */
    std::uint32_t phase = 0;      /* at step 0 */
    std::uint32_t phase_step = 0; /* a sample */
};

/// Of x, y and z.
using Harmonics = std::vector<std::array<Harmonic, 3>>;

/// How many harmonics each axis of a scene's paths has.
std::uint32_t harmonic_count(const PathsSpec& paths);

/// Those of a path. A random walk has 16 of equal size on x and y, their frequencies anywhere in 16 equal bands from 0
/// to an edge, so that its root mean square is length / sqrt(8) along x, width / sqrt(8) along y, and its speed's is
/// the path's speed; where that leaves the region, the walk turns round (reference::reflected), which leaves its
/// speed, and 0.275 of length and width. Tremor has 4 of equal size on each axis, their frequencies anywhere in 4 equal
/// bands within 20 % of its own.
Harmonics path_harmonics(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

/// Above every frequency of a scene's tremor, Hz.
double highest_tremor(const PathsSpec& paths);

/// The edge of a random walk's band, turns a sample: above every frequency of it.
double walk_edge(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

// The intended motion of a path from its number: speeds, depths and directions drawn, phases counted.

/// Turns as a phase, 2^-32 turns, whole turns left out; 0 if not finite.
std::uint32_t phase_of_turns(double turns);

/// How fast a path goes.
struct PathPace {
    double speed = 0; /* m/s */
    double turns = 0; /* a sample: of a round there and back, whole ones included; 0 without rounds or lines */
};

PathPace path_pace(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

/// The motion of a path, in double. All begin at phase 0: strokes and lines at their end, circles and spirals along the
/// heading, spirals at their smallest radius, taps at the top. A line without length is skipped.
layout::MotionParams<double> path_motion(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

/// Whether paths that do not tremble differ from each other.
bool paths_differ(const PathsSpec& paths);

/// Rounded once to T.
template <typename T> layout::MotionParams<T> rounded_motion(const layout::MotionParams<double>& motion);

/// The mean distance of two points anywhere in a rectangle with these sides, m.
double mean_distance(double side, double other);

} // namespace forceshade
