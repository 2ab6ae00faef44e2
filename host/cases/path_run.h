// The paths of a scene, or recorded ones, through an engine and into files.
#pragma once

#include "host/cases/path_output.h"
#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/output/record.h"

namespace forceshade {

/// Memory is bounded by RowGatherer, RecordedFile and the engine, whatever paths there are, but for the rows of
/// an EXR. A recorded file that is not kept is read once to check it, once for the engine, once for its times, once for
/// the oracle, and once for when paths left their bound, if any did; it must not change meanwhile. Of recorded paths
/// facets are computed always: contact time follows from them. Nothing stands under a final name unless all of it was
/// computed. \throws UsageError for what is wrong in the scene or the recorded file, IoError, Interrupted,
/// compute::DeviceError, Error (exit 1) for forces that are no finite numbers.
PathRecord run_paths(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options);

} // namespace forceshade
