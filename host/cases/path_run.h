// The paths of a scene, or recorded ones, through an engine and into files: the samples, a line for each path, what
// `--also` asks for, the record.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cases/case_files.h"
#include "host/field/engine.h"

namespace forceshade {

struct PathRunOptions {
    std::filesystem::path samples;                 /* .exr or .csv; empty: metrics alone */
    std::filesystem::path stem;                    /* STEM.paths.csv and what else is asked for */
    std::string label;                             /* between stem and kind of further files: "" or ".paths" */
    std::optional<std::filesystem::path> recorded; /* in place of the scene's paths */
    AlsoFormats also;   /* not with metrics alone, and no VTI; VTP are polylines for ParaView */
    picture::Look look; /* of the picture; without a title: the case in words */
    int threads = 0;    /* that compress */
    std::function<void(std::uint64_t done, std::uint64_t total)> progress; /* samples; may be empty */
};

/// What the files of a run hold; `asked`: the scene's channels.
layout::uint path_channels(const PathRunOptions& options, layout::uint asked);

/// The names of the files of a run, the samples first.
std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels);

/// Where the paths of such a case go: STEM.paths.exr, STEM.paths.csv and what else is asked for.
PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads);

/// Memory is bounded by RowGatherer, RecordedFile and the engine, whatever paths there are, but for the rows of
/// an EXR. A recorded file that is not kept is read once to check it, once for the engine, once for its times, once for
/// the oracle, and once for when paths left their bound, if any did; it must not change meanwhile. Of recorded paths
/// facets are computed always: contact time follows from them. Nothing stands under a final name unless all of it was
/// computed. \throws UsageError for what is wrong in the scene or the recorded file, IoError, Interrupted,
/// compute::DeviceError, Error (exit 1) for forces that are no finite numbers.
PathRecord run_paths(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options);

} // namespace forceshade
