// Cases one after the other: computed on the engine while earlier ones are encoded on other threads.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/cases/case_files.h"
#include "host/field/engine.h"
#include "host/picture/values.h"

namespace forceshade {

/// What the pictures of a case show and how.
struct PictureChoice {
    picture::Look look; /* without a title: the case in words */
    picture::SliceChoice slice;
    std::array<double, 3> view = picture::kView; /* of a mesh: from where, a vector towards us */
};

struct CaseJob {
    PreparedCase prepared;
    std::filesystem::path volume; /* .exr path */
    std::string fingerprint;
    AlsoFormats also{};       /* in the folder of the volume */
    PictureChoice pictures{}; /* of the field */
};

struct CaseOutcome {
    const CaseJob* job = nullptr;
    CaseRecord record; // where error is null
    std::exception_ptr error;
};

struct PipelineOptions {
    unsigned encoders = 0;                             /* threads; 0: one a core, at most one a case */
    std::size_t waiting_bytes = std::size_t(32) << 20; /* between engine and encoders */
};

/// Runs every job; `next` yields them one by one (null at the end), so that only those under way are in memory. `done`
/// is called for each as it ends, from encoder threads but never from two at once. An error of one case does not stop
/// the others; an I/O or device error and an interrupt do. \throws the error that stopped the run.
void run_cases(Engine& engine, const std::function<std::unique_ptr<CaseJob>()>& next, std::size_t cases,
               const PipelineOptions& options, const std::function<void(const CaseOutcome&)>& done);
/// A single case. \throws as above, and what ends the case.
CaseRecord run_case(Engine& engine, CaseJob job);

// The paths of a scene, or recorded ones, through an engine and into files: the samples, a line for each path, what
// `--also` asks for, the record.

struct PathRunOptions {
    std::filesystem::path samples; /* .exr or .csv; .npy: arrays alone, as of also.npy; empty: metrics alone */
    std::filesystem::path stem;    /* STEM.paths.csv and what else is asked for */
    std::string label;             /* between stem and kind of further files: "" or ".paths" */
    std::optional<std::filesystem::path> recorded; /* in place of the scene's paths */
    AlsoFormats also;   /* not with metrics alone, and no VTI; VTP are polylines for ParaView */
    picture::Look look; /* of the picture; without a title: the case in words */
    int threads = 0;    /* that compress */
    std::function<void(std::uint64_t done, std::uint64_t total)> progress; /* samples; may be empty */
};

/// What the files of a run hold; `asked`: the scene's channels.
layout::uint path_channels(const PathRunOptions& options, layout::uint asked);

/// Those of them that are computed, with what polylines for ParaView hold besides. 0: metrics alone.
layout::uint computed_channels(const PathRunOptions& options, layout::uint asked);

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

// What cases will take, before they are computed: voxels, bytes on the disk, time.

struct Forecast {
    Forecast& operator+=(const Forecast& other); /* of what is not measured */

    double voxels = 0;             /* of fields */
    double samples = 0;            /* of paths */
    double most_bytes = 0;         /* nothing can be compressed */
    double surface_bytes = 0;      /* of them, those of surfaces, which hardly grow with the grid */
    double least_bytes = 0;        /* everything is compressed as far as its format can */
    std::optional<double> bytes;   /* as small copies of the cases came out */
    std::optional<double> seconds; /* as small copies of the cases took, with pictures */
};

/// Of a scene whose grid is known: a mesh's is when it was read.
Forecast forecast(const Scene& scene, AlsoFormats also);

/// Fills in bytes and seconds by computing up to six of the jobs, at most 200 thousand voxels and samples of each, into
/// a scratch folder: a second or so.
void measure(Engine& engine, const std::vector<const Case*>& cases, const std::function<CaseJob(const Case&)>& job_of,
             Forecast& forecast);

/// Bytes that a user may still write where a folder is or will be.
double free_bytes(const std::filesystem::path& folder);

/// \throws IoError if not even the best compression makes the files fit there.
void require_space(const std::filesystem::path& folder, const Forecast& forecast);
/// True if it depends on the compression whether they fit: measure then.
bool is_space_doubtful(const std::filesystem::path& folder, const Forecast& forecast);
/// The warning where they probably do not fit, else empty.
std::string space_warning(const std::filesystem::path& folder, const Forecast& forecast);

} // namespace forceshade
