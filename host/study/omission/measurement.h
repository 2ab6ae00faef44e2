// A comparison measured: both sides in turn, again and again, and what they gave held against each other.
#pragma once

#include <filesystem>

#include "host/study/omission/side.h"

namespace forceshade::study {

struct Rounds {
    unsigned count = 0; /* most; each evaluates both sides in turn and takes the least times */
    double seconds = 0; /* about what a round is given; it evaluates at least once */
    double budget = 0;  /* s: for all rounds; there are five at least */
};

struct MeasuredSide {
    std::vector<double> kernel, whole; /* s: a round each, the least of its evaluations */
    Cost cost;                         /* of the last */
    std::size_t samples = 0;           /* of the grid, or of all paths */
    std::uint64_t file = 0;            /* bytes of the volume that a sweep would write; of paths 0 */
};

/// What both sides gave, sample by sample.
struct Agreement {
    std::uint64_t compared = 0, in_contact = 0, differing = 0; /* samples; of paths that write none: paths */
};

struct Measurement {
    MeasuredSide with, without;
    Agreement agreement;
};

/// A volume is written in `folder` for its size, and removed.
Measurement measure(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                    const std::filesystem::path& folder);

template <typename T>
Agreement compare(const Comparison& comparison, const Captured<T>& with, const Captured<T>& without);

/// Samples with a force of the scene's grid, and of its paths: where nothing is touched, leaving things out changes
/// nothing and saves nothing real.
struct Touched {
    std::uint64_t field = 0, paths = 0;
};
Touched touched(Engine& engine, const BaseScene& base);

} // namespace forceshade::study
