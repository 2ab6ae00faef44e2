// The paths of a scene, or recorded ones, through an engine and into files.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/engine/engine.h"
#include "host/output/path_rows.h"
#include "host/output/record.h"
#include "host/paths/explore.h"
#include "host/paths/recorded.h"
#include "host/prepare/prepared_case.h"

namespace forceshade {

/// Reads the file alongside of an engine's rows, and sums up of each path how long it was in contact.
class RecordedTimes {
public:
    explicit RecordedTimes(std::shared_ptr<const RecordedFile> file)
        : file_(std::move(file)), cursor_(*file_), later_(*file_) {}

    /// The times of these rows, which come in order; they need the channel of facets.
    template <typename T> void take(const PathRows<T>& rows);

    /// s: of a sample of the rows taken last.
    double at(std::uint64_t path, std::uint64_t step) const;
    /// s: how long a path of the rows taken last was in contact, once they end it.
    double contact_time(std::uint64_t path) const { return contact_[path - first_].total(); }
    /// s: of a sample of a path, wherever it is; paths come in order.
    double later(std::uint64_t path, std::uint64_t step);

private:
    std::shared_ptr<const RecordedFile> file_;
    RecordedCursor cursor_, later_;
    std::uint64_t first_ = 0;                        // path
    std::uint64_t step_first_ = 0;                   // of the rows
    std::vector<std::size_t> begins_;                // in times_, by path
    std::vector<double> times_;                      /* s */
    std::vector<ContactTime> contact_;               // by path
    std::uint64_t later_path_ = 0, later_begin_ = 0; // a path, and its first sample in the file
};

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

// Which channels and files a run of paths has.

/// What samples may hold, in the order of their files.
inline constexpr std::array kPathChannels{layout::kChannelForce, layout::kChannelPosition, layout::kChannelDepth,
                                          layout::kChannelFacet, layout::kChannelProxy};

bool is_csv(const std::filesystem::path& path);

/// What must be computed for the files; `asked`: the scene's channels.
layout::uint channels_for(const PathRunOptions& options, layout::uint asked);

/// Of positions; empty: the paths are generated.
std::filesystem::path recorded_file(const Scene& scene, const PathRunOptions& options);

/// The names of the files of a run, the samples first.
std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels);

/// Memory is bounded by row_gatherer.h, recorded_file.h and the engine, whatever paths there are, but for the rows of
/// an EXR. A recorded file that is not kept is read once to check it, once for the engine, once for its times, once for
/// the oracle, and once for when paths left their bound, if any did; it must not change meanwhile. Of recorded paths
/// facets are computed always: contact time follows from them. Nothing stands under a final name unless all of it was
/// computed. \throws UsageError for what is wrong in the scene or the recorded file, IoError, Interrupted,
/// compute::DeviceError, Error (exit 1) for forces that are no finite numbers.
PathRecord run_paths(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options);

} // namespace forceshade
