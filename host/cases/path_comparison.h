// An engine's paths compared with the oracle in the same precision, every sample of a scene's; and on a mesh the
// contacts judged without either.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/output/rows.h"
#include "host/paths/scene_paths.h"
#include "host/referee/contact_surface.h"
#include "host/referee/oracle_check.h"
#include "host/referee/validate.h"

namespace forceshade {

/// The channels that the oracle compares.
inline constexpr layout::uint kSampled = layout::kChannelForce | layout::kChannelPosition | layout::kChannelDepth |
                                         layout::kChannelFacet | layout::kChannelProxy;

/// An engine's paths, and the oracle with paths of its own.
template <typename T> struct EngineAndOracle {
    /// `most` as for PathOracle.
    EngineAndOracle(const PreparedCase& prepared, const std::shared_ptr<const RecordedFile>& file,
                    layout::uint channels, bool exact_bits, std::uint64_t most)
        : paths(prepared, file), same(prepared, file), input(input_of(paths, channels)),
          source(paths, input.steps, paths_that_fit(input)),
          oracle(prepared, input_of(same, channels), exact_bits, most) {
        input.source = &source;
        for (ScenePaths<T>* each : {&paths, &same})
            each->limit_batches(samples_that_fit(input));
    }

    static layout::PathInput<T> input_of(ScenePaths<T>& from, layout::uint channels) {
        layout::PathInput<T> made = from.input();
        made.features.channels = channels;
        return made;
    }

    ScenePaths<T> paths, same; // the engine's, and the oracle's
    layout::PathInput<T> input;
    BatchedSource<T> source;
    PathOracle<T> oracle;
};

struct PathComparison {
    std::string name;
    Precision precision = Precision::f32;
    PathError error;
    ContactCount contacts;
    bool passed = false;

    Totals totals() const { return {error.samples, error.differing, passed}; }
};

/// Moves the engine along every path of a case that has some, with all channels. \throws compute::DeviceError,
/// UsageError, IoError, Interrupted.
PathComparison compare_paths(Engine& engine, const PreparedCase& prepared, Precision precision);

/// The comparisons as a table for people.
std::string path_comparison_table(const std::vector<PathComparison>& comparisons);

/// The same as a JSON array.
std::string path_comparison_json(const std::vector<PathComparison>& comparisons);

} // namespace forceshade
