// Moves a probe along recorded paths and writes its contacts, row by row in the order of the file, on the oracle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"

namespace forceshade {

struct ExploreResult {
    std::uint64_t samples = 0, paths = 0;
    std::uint64_t in_contact = 0;      /* samples */
    std::uint64_t unfinished = 0;      /* samples at which the proxy could not come to rest */
    double largest_force = 0;          /* N */
    double law_seconds = 0;            /* s spent in the law, without reading and writing */
    std::vector<std::string> warnings; /* `file:line:column: ...` */
};

/// Called now and then with the bytes of the input that are done, and with all of them.
using ExploreProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Reads `paths` (PathReader), evaluates the scene's law at every sample in the scene's precision on the calling
/// thread, and writes `out` (PathWriter), rows in the order of the input, and STEM.paths.csv next to it (PathSummary);
/// `stretch`, m, as in layout::PathInput. Memory does not grow with the number of samples, only with that of paths.
/// After an error no file is written.
/// \throws UsageError for what is wrong in the paths (PathReader, PathCensus), IoError, Interrupted.
ExploreResult explore(const PreparedCase& prepared, const std::filesystem::path& paths,
                      const std::filesystem::path& out, float stretch, const ExploreProgress& progress);

} // namespace forceshade
