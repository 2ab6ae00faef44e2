#include "host/paths/pace_warnings.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/paths/harmonics.h"
#include "host/paths/motions.h"

namespace forceshade {
namespace {

constexpr std::uint64_t kLooked = 65536; // paths
constexpr double kFastest = 0.5;         // turns a sample
constexpr double kSlowest = 100 * 0x1p-32;

// Fewest turns a sample that come out to a hundredth; of a spiral the way out and back is a phase as well. Lines, and
// ways from point to point, take whole samples and no phase.
double slowest(const PathsSpec& paths) {
    if (paths.kind == PathKind::raster || paths.kind == PathKind::minimum_jerk)
        return 0;
    return paths.kind == PathKind::spiral ? kSlowest * 2 * static_cast<double>(paths.lines) : kSlowest;
}

// Paths beyond a limit, and the factor by which the worst of them is.
struct Beyond {
    std::uint64_t paths = 0;
    double factor = 1; /* of turns to the limit */
    double speed = 0;  /* m/s: of the worst */
};

struct Paces {
    std::uint64_t looked = 0;
    Beyond fast, slow;
};

void count(Beyond& beyond, const PathPace& pace, double factor, bool worse) {
    ++beyond.paths;
    if (beyond.paths > 1 && !worse)
        return;
    beyond.factor = factor;
    beyond.speed = pace.speed;
}

Paces look_at(const PathsSpec& paths, const PathRegion& region) {
    Paces paces;
    const double least = slowest(paths);
    paces.looked = std::min(paths.count, kLooked);
    for (std::uint64_t path = 0; path < paces.looked; ++path) {
        const PathDraws draws(paths.seed, path);
        PathPace pace = path_pace(paths, region, draws);
        if (paths.kind == PathKind::random_walk)
            pace.turns = walk_edge(paths, region, draws);
        const double fast = pace.turns / kFastest;
        if (fast >= 1)
            count(paces.fast, pace, fast, fast > paces.fast.factor);
        if (pace.turns > 0 && pace.turns < least)
            count(paces.slow, pace, pace.turns / least, pace.turns / least < paces.slow.factor);
    }
    return paces;
}

std::string who(std::uint64_t some, const Paces& paces, const PathsSpec& paths) {
    if (paces.looked < paths.count)
        return fmt::format("{} of the first {} paths", some, paces.looked);
    return some == 1 && paths.count == 1 ? "the path" : fmt::format("{} of {} paths", some, paths.count);
}

std::string fast_warning(const PathsSpec& paths, const Paces& paces) {
    const char* what = "half a round or more lies between two samples, so that the motion seems slower, or to go back";
    if (paths.kind == PathKind::raster || paths.kind == PathKind::minimum_jerk)
        what =
            "a line, or the way to the next point, takes a sample or less, so that the motion may be slower than that";
    if (paths.kind == PathKind::random_walk)
        what = "there are frequencies of half the rate or more, which seem to be lower ones";
    return fmt::format("[paths]: speed: on {} {}; right is a speed below {:.3g} m/s, or a rate above {:.3g} Hz",
                       who(paces.fast.paths, paces, paths), what, paces.fast.speed / paces.fast.factor,
                       paths.rate * paces.fast.factor);
}

std::string slow_warning(const PathsSpec& paths, const Paces& paces) {
    return fmt::format(
        "[paths]: speed: on {} less than {:.2g} of a round lies between two samples, which phases of "
        "2^-32 rounds cannot say to a hundredth: the motion stands still, or is faster; right is a speed "
        "above {:.3g} m/s, or a rate below {:.3g} Hz",
        who(paces.slow.paths, paces, paths), slowest(paths), paces.slow.speed / paces.slow.factor,
        paths.rate * paces.slow.factor);
}

} // namespace

std::vector<std::string> pace_warnings(const PathsSpec& paths, const PathRegion& region) {
    std::vector<std::string> warnings;
    if (paths.kind == PathKind::recorded)
        return warnings;
    const Paces paces = look_at(paths, region);
    if (paces.fast.paths > 0)
        warnings.push_back(fast_warning(paths, paces));
    if (paces.slow.paths > 0)
        warnings.push_back(slow_warning(paths, paces));
    const bool trembles = paths.kind != PathKind::random_walk && harmonic_count(paths) > 0;
    if (const double highest = highest_tremor(paths); trembles && highest >= paths.rate / 2)
        warnings.push_back(
            fmt::format("[paths]: tremor.frequency: a tremor of {:.4g} Hz has harmonics up to {:.4g} Hz, "
                        "and those of half the rate, {:.4g} Hz, or more seem to be lower ones; right is "
                        "a frequency below {:.4g} Hz, or a rate above {:.4g} Hz",
                        paths.tremor_frequency, highest, paths.rate / 2,
                        paths.tremor_frequency * paths.rate / (2 * highest), 2 * highest));
    return warnings;
}

} // namespace forceshade
