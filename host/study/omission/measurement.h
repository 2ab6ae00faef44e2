// A comparison measured: both sides in turn, again and again, and what they gave held against each other.
#pragma once

#include <filesystem>
#include <vector>

#include "host/engine/engine.h"
#include "host/study/data/study_data.h"
#include "host/study/omission/comparison.h"
#include "host/study/run/sampling.h"

namespace forceshade::study {

struct Cost {
    double kernel = 0;           /* s: on the device; of the CPU oracle all of it */
    double whole = 0;            /* s: planning, tables, kernel and reading back, by the clock */
    std::uint64_t uploaded = 0;  /* bytes: tables, plans, positions */
    std::uint64_t received = 0;  /* bytes of results */
    std::uint64_t evaluated = 0; /* samples */
};

/// All samples of a grid, by z, then y, then x; or of paths, by path, then step. Channels that were not asked for are
/// empty. Where one y stood for all, it stands for all here too.
template <typename T> struct Captured {
    std::vector<T> force, depth, proxy, unshaded, position;
    std::vector<layout::uint> facet;
    std::vector<layout::PathMetrics<T>> metrics; /* of paths */
};

/// One side of a comparison, evaluated once: with more channels than the setup has.
template <typename T> Captured<T> capture(Engine& engine, const Setup& setup, bool paths, std::uint32_t channels);

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

template <typename T>
Agreement compare(const Comparison& comparison, const Captured<T>& with, const Captured<T>& without);

struct Measurement {
    Comparison comparison;
    MeasuredSide with, without;
    Agreement agreement;

    /// Time with it over the time without it, in the same rounds.
    Interval kernel_ratio() const;
    Interval whole_ratio() const;
    /// Whether every force was the same on both sides.
    bool same_forces() const {
        return comparison.same != Same::metrics && agreement.compared > 0 && agreement.differing == 0;
    }
};

/// A volume is written in `folder` for its size, and removed.
Measurement measure(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                    const std::filesystem::path& folder);

/// Samples with a force of the scene's grid, and of its paths: where nothing is touched, leaving things out changes
/// nothing and saves nothing real.
struct Touched {
    std::uint64_t field = 0, paths = 0;
};
Touched touched(Engine& engine, const BaseScene& base);

/// Adds tables, figures and findings.
void add_omissions(StudyData& data, const std::vector<BaseScene>& scenes, const std::vector<Measurement>& rows);

} // namespace forceshade::study
