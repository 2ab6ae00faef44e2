// Paths recorded in a CSV file, a batch at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/explore/path_reader.h"
#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade {

struct PreparedCase;

/// Samples that are held in memory at once, at most.
inline constexpr std::size_t kRecordedSamples = std::size_t(1) << 22;
/// Paths of a file, at most.
inline constexpr std::size_t kRecordedPaths = std::size_t(1) << 24;

/// How a file of recorded paths is read.
struct RecordedOptions {
    double largest_coordinate = 0; /* m: as for PathReader */
    double period = 0; /* s: of a closed loop, to which times must keep to 1 %; 0: they need only increase */
    std::size_t most = kRecordedSamples;
};

/// Reads the file once to check it and to count. A file of up to `most` samples is kept then, and its paths may be
/// interleaved; of a longer one each path's samples stand together, and it is read again as an engine asks for batches.
/// Positions are rounded once to T.
template <typename T> class RecordedPaths {
public:
    /// \throws IoError, UsageError `file:line:column: ...` for what is wrong in the file, for times of a path that do
    /// not increase or do not keep to the period, and for a path that goes on after another in a long file.
    RecordedPaths(const std::filesystem::path& file, const RecordedOptions& options);

    std::size_t paths() const { return steps_.size(); }
    std::size_t longest() const { return longest_; } /* samples */
    std::span<const std::uint64_t> ids() const { return ids_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

    /// Goes to the path `first`; how many paths from there on, at most `count`, are taken together.
    std::size_t select(std::size_t first, std::size_t count);
    /// Samples of each selected path.
    std::span<const layout::uint> steps() const { return {steps_.data() + first_, count_}; }
    /// As layout::PathSource::positions; windows of a selection come in the order of steps.
    std::span<const T> positions(std::size_t step, std::size_t steps);

private:
    using Place = reference::Vector<T>;
    struct Census;

    void read_all();
    void add(const PathSample& sample, Census& census);
    std::uint32_t number_of(const PathSample& sample, Census& census);
    void check_time(const PathSample& sample, double before, const std::string& source) const;
    void keep(const PathSample& sample, std::uint32_t number, Census& census);
    void group(const std::vector<std::uint32_t>& owners);
    bool next(PathSample& sample);
    void go_to(std::uint64_t sample);
    void hold(std::size_t begin, std::size_t end);

    std::filesystem::path file_;
    RecordedOptions options_;
    std::vector<std::uint64_t> ids_;
    std::vector<layout::uint> steps_;
    std::size_t longest_ = 0;
    std::vector<std::string> warnings_;

    bool kept_ = true;                  // all samples are in places_
    std::size_t first_ = 0, count_ = 0; // selected paths
    std::uint64_t begin_ = 0;           // the first selected sample of the file
    std::vector<Place> places_;         // path by path, from sample held_ on
    std::uint64_t held_ = 0;

    std::unique_ptr<PathReader> reader_; // of a long file, before sample read_
    std::vector<PathSample> ahead_;
    std::size_t taken_ = 0; // of ahead_
    std::uint64_t read_ = 0;
    std::vector<T> window_;
};

/// Puts the SHA-256 of the file of recorded paths into the case and its resolved text. \throws IoError, UsageError if
/// the scene states another one. Does nothing where the paths are generated.
void add_recorded_digest(PreparedCase& prepared);

extern template class RecordedPaths<float>;
extern template class RecordedPaths<double>;

} // namespace forceshade
