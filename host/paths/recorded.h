// A CSV file of recorded paths: what is in it, found by reading it once, and its paths for an engine.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/output/files.h"
#include "host/paths/path_reader.h"
#include "host/reference/elementary.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Samples of a file whose paths are interleaved, at most: they are kept in memory.
inline constexpr std::size_t kInterleavedSamples = std::size_t(1) << 22;
/// Samples of a file that is kept in memory although it need not be, at most.
inline constexpr std::size_t kKeptSamples = std::size_t(1) << 16;
/// Paths of a file, at most.
inline constexpr std::size_t kRecordedPaths = std::size_t(1) << 24;

/// What StepScale::median_step() is, in a warning.
inline constexpr const char* kMedianStep = "the median step from sample to sample";

/// How a file of recorded paths is read.
struct RecordedOptions {
    double largest_coordinate = 0; /* m: as for PathReader */
    double period = 0; /* s: of a closed loop, to which times must keep to 1 %; 0: they need only increase */
    std::size_t most_interleaved = kInterleavedSamples;
    std::size_t most_kept = kKeptSamples;
    std::function<void(std::uint64_t done, std::uint64_t total)> progress{}; /* bytes; may be empty */
    glm::dvec3 origin{0};                                                    /* m: as for StepScale */
};

/// Reads the file once to check it and to count; RecordedCursor reads it again. A file in which each path's samples
/// stand together takes no memory for them, however long it is, but for short ones, which are kept; one whose paths are
/// interleaved is read once more and kept, path by path.
class RecordedFile {
public:
    /// \throws IoError, UsageError `file:line:column: ...` for what is wrong in the file, for times of a path that do
    /// not increase or do not keep to the period, and for a path that goes on after another in a long file.
    RecordedFile(const std::filesystem::path& file, const RecordedOptions& options);
    /// Samples that are in memory, path by path, paths numbered from 0 on; `source` is what messages call them.
    /// \throws UsageError for a path without samples or with positions that are not finite or too far.
    RecordedFile(std::string source, std::vector<std::vector<glm::dvec3>> paths, const RecordedOptions& options);

    std::size_t paths() const { return steps_.size(); }
    std::size_t longest() const { return longest_; } /* samples */
    std::uint64_t samples() const { return samples_; }
    /// The file's own numbers of the paths, in the order of their first samples, and how many samples each has.
    std::span<const std::uint64_t> ids() const { return ids_; }
    std::span<const layout::uint> steps() const { return steps_; }
    const std::vector<std::string>& warnings() const { return warnings_; }
    const StepScale& scale() const { return scale_; }

    /// All samples, path by path; empty if they are not kept.
    std::span<const PathSample> kept() const { return kept_; }
    /// The file from its beginning. \throws IoError if it is not what it was.
    std::unique_ptr<PathReader> open() const;
    /// \throws IoError if the file was changed or replaced since it was read first.
    void require_unchanged() const;
    [[noreturn]] void refuse_change() const;

private:
    void count(const std::vector<PathSample>& samples, PathCensus& census);
    void keep_interleaved();

    std::filesystem::path path_;
    double largest_coordinate_;      /* m */
    std::optional<FileStamp> stamp_; // none: there is no file
    std::vector<std::uint64_t> ids_;
    std::vector<layout::uint> steps_;
    std::size_t longest_ = 0;
    std::uint64_t samples_ = 0;
    StepScale scale_;
    std::vector<std::string> warnings_;
    std::vector<PathSample> kept_;
};

/// Goes through the samples of a file path by path.
class RecordedCursor {
public:
    /// Before the first sample. `file` must outlive it.
    explicit RecordedCursor(const RecordedFile& file) : file_(file) {}

    /// The next sample. \throws IoError if the file is not what it was when it was read first, std::logic_error behind
    /// the last.
    const PathSample& next();
    /// Goes to before a sample, counted from the first path's first.
    void go_to(std::uint64_t sample);

private:
    void restart();
    void read_ahead();

    const RecordedFile& file_;
    std::unique_ptr<PathReader> reader_; // of a file that is not kept
    std::vector<PathSample> ahead_;
    std::size_t used_ = 0;       // of ahead_
    std::uint64_t at_ = 0;       // the next sample
    std::size_t path_ = 0;       // whose it is
    std::uint64_t path_end_ = 0; // where it ends
    bool begun_ = false;
};

// The positions of recorded paths, a batch at a time.

/// Samples of a batch of several recorded paths, at most, each counted as long as the longest.
inline constexpr std::size_t kRecordedSamples = std::size_t(1) << 20;

/// Paths as an engine asks for them. Of a file that is not kept a batch of several paths is in memory; one path
/// that is longer than a batch may be goes by in windows. Positions are measured from `origin`, m, in the world, and
/// rounded once to T.
template <typename T> class RecordedPaths {
public:
    /// `most`: samples of a batch, as kRecordedSamples.
    explicit RecordedPaths(std::shared_ptr<const RecordedFile> file, std::size_t most = kRecordedSamples,
                           const glm::dvec3& origin = glm::dvec3(0))
        : file_(std::move(file)), cursor_(*file_), most_(most), origin_(origin) {}

    const std::shared_ptr<const RecordedFile>& file() const { return file_; }
    /// The most samples of further batches.
    void limit(std::size_t most) { most_ = std::min(most_, most); }

    /// Goes to the path `first`; how many paths from there on, at most `count`, are taken together. A batch ends before
    /// a path that is so much longer or shorter that most of its steps would be those of paths that have ended.
    std::size_t select(std::size_t first, std::size_t count);
    /// Samples of each selected path.
    std::span<const layout::uint> steps() const { return file_->steps().subspan(first_, count_); }
    /// As layout::PathSource::positions; windows of a selection come in the order of steps. \throws IoError if the file
    /// is not what it was when it was read first.
    std::span<const T> positions(std::size_t step, std::size_t steps);

private:
    using Place = reference::Vector<T>;

    void keep(std::uint64_t begin, std::uint64_t end);

    std::shared_ptr<const RecordedFile> file_;
    RecordedCursor cursor_;
    std::size_t most_;
    glm::dvec3 origin_;                 /* m */
    std::size_t first_ = 0, count_ = 0; // selected paths
    std::uint64_t begin_ = 0;           // the first selected sample of the file
    std::vector<Place> places_;         // path by path, from sample kept_from_ on
    std::uint64_t kept_from_ = 0;
    std::vector<T> window_;
};

/// Puts the SHA-256 of the file of recorded paths into the case and its resolved text. \throws IoError, UsageError if
/// the scene states another one. No effect where the paths are generated.
void add_recorded_digest(PreparedCase& prepared);

extern template class RecordedPaths<float>;
extern template class RecordedPaths<double>;

} // namespace forceshade
