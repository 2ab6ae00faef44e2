// A recording in place of a device: one sample of it for each of the loop's.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "device/backends/back_end.h"

namespace forceshade::device {

/// Positions of a CSV file (PathReader: path, t, x, y, z in any order, as a live log has them), each once, path after
/// path in the order of their first rows, a row a sample however far its times are apart. Forces go nowhere. It is
/// read whole, 32 bytes a sample. \throws IoError, UsageError as PathReader and PathCensus: times of a path increase.
std::unique_ptr<BackEnd> make_replay(const std::filesystem::path& file);

/// Hz: of the recording's first path, from its first time to its last; 0 for a single sample or times that do not
/// increase.
double rate_of(const BackEnd& replay);

/// `file:line:column: ...` if the file may have been cut off; else empty.
std::string warning_of(const BackEnd& replay);

} // namespace forceshade::device
