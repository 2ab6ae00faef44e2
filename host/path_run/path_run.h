// The paths of a scene, or recorded ones, through an engine and into files.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/engine/engine.h"
#include "host/field/prepared_case.h"
#include "host/io/chunk_sink.h"
#include "host/io/file_record.h"
#include "host/validate/path_oracle.h"

namespace forceshade {

struct PathRunOptions {
    std::filesystem::path samples;                 /* .exr or .csv; empty: metrics alone */
    std::filesystem::path stem;                    /* STEM.paths.csv and what else is asked for */
    std::string label;                             /* between stem and kind of further files: "" or ".paths" */
    std::optional<std::filesystem::path> recorded; /* in place of the scene's paths */
    bool npy = false, png = false;                 /* not with metrics alone */
    int threads = 0;                               /* that compress */
    std::function<void(std::uint64_t done, std::uint64_t total)> reading;  /* bytes of the recorded file, checked */
    std::function<void(std::uint64_t done, std::uint64_t total)> progress; /* samples; both may be empty */
};

/// What became of paths.
struct PathRecord {
    std::uint64_t paths = 0;
    std::uint64_t steps = 0; /* of the longest */
    std::uint64_t samples = 0, in_contact = 0;
    double stretch = 0;                           /* m: the way that turns of the force are counted over */
    std::uint64_t unstable = 0, began_inside = 0; /* paths */
    std::uint64_t fell = 0;                       /* of the unstable ones */
    std::uint64_t unfinished = 0;                 /* samples */
    double largest_force = 0;                     /* N */
    double work = 0, effort = 0;                  /* J: sums over the paths */
    double depth_deviation = 0;                   /* m: root mean square of depth about its mean, in contact */
    double mean_depth = 0;                        /* m */
    PathError error;
    std::vector<FileRecord> files; /* the samples first, if there are any */
    EngineTimes engine_times;
    VolumeTimings volume_times;
    std::vector<std::string> warnings;

    double steps_per_second() const; /* of the engine */
};

/// The names of the files of a run, the samples first.
std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels);

/// Memory is bounded by row_gatherer.h, recorded_file.h and the engine, whatever paths there are, but for the rows of
/// an EXR. A recorded file that is not kept is read once to check it, once for the engine, once for its times, once for
/// the oracle, and once for when paths left their bound, if any did; it must not change meanwhile. Of recorded paths
/// facets are computed always: contact time follows from them. Nothing stands under a final name unless all of it was
/// computed. \throws UsageError for what is wrong in the scene or the recorded file, IoError, Interrupted,
/// compute::DeviceError, Error (exit 1) for forces that are no finite numbers.
PathRecord run_paths(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options);

/// What is wrong with a run whose paths are further from the oracle than rounding allows, or hold samples whose proxy
/// never rested; empty where nothing is.
std::string complaint(const PathRecord& record, const std::string& name, const std::string& device);

} // namespace forceshade
