// An engine's paths held against the oracle in the same precision, every sample of a scene's, and on a closed mesh
// against the winding number.
#pragma once

#include <string>
#include <vector>

#include "host/engine/engine.h"
#include "host/prepare/prepared_case.h"
#include "host/referee/path_oracle.h"
#include "host/referee/proxy_sides.h"

namespace forceshade {

struct PathComparison {
    std::string name;
    Precision precision = Precision::f32;
    PathError error;
    SideCount sides;
    bool passed = false;
};

/// Takes every path of a case that has some through the engine, with all channels. \throws compute::DeviceError,
/// UsageError, IoError, Interrupted.
PathComparison compare_paths(Engine& engine, const PreparedCase& prepared, Precision precision);

struct PathTotals {
    std::uint64_t samples = 0, differing = 0;
    bool passed = true;
};
PathTotals totals_of(const std::vector<PathComparison>& comparisons);

/// The comparisons as a table for people.
std::string path_comparison_table(const std::vector<PathComparison>& comparisons);

/// The same as a JSON array.
std::string path_comparison_json(const std::vector<PathComparison>& comparisons);

} // namespace forceshade
