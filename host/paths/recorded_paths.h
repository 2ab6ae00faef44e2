// The positions of recorded paths, a batch at a time.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "host/paths/recorded_file.h"
#include "host/reference/vector.h"

namespace forceshade {

struct PreparedCase;

/// Samples of a batch of several recorded paths, at most, each counted as long as the longest.
inline constexpr std::size_t kRecordedSamples = std::size_t(1) << 20;

/// Paths as an engine asks for them. Of a file that is not kept a batch of several paths is held in memory; one path
/// that is longer than a batch may be goes by in windows. Positions are rounded once to T.
template <typename T> class RecordedPaths {
public:
    /// `most`: samples of a batch, as kRecordedSamples.
    explicit RecordedPaths(std::shared_ptr<const RecordedFile> file, std::size_t most = kRecordedSamples)
        : file_(std::move(file)), cursor_(*file_), most_(most) {}

    const std::shared_ptr<const RecordedFile>& file() const { return file_; }
    /// Further batches have at most so many samples.
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

    void hold(std::uint64_t begin, std::uint64_t end);

    std::shared_ptr<const RecordedFile> file_;
    RecordedCursor cursor_;
    std::size_t most_;
    std::size_t first_ = 0, count_ = 0; // selected paths
    std::uint64_t begin_ = 0;           // the first selected sample of the file
    std::vector<Place> places_;         // path by path, from sample held_ on
    std::uint64_t held_ = 0;
    std::vector<T> window_;
};

/// Puts the SHA-256 of the file of recorded paths into the case and its resolved text. \throws IoError, UsageError if
/// the scene states another one. Does nothing where the paths are generated.
void add_recorded_digest(PreparedCase& prepared);

extern template class RecordedPaths<float>;
extern template class RecordedPaths<double>;

} // namespace forceshade
