// The times that a recorded file gives its samples, by path.
#pragma once

#include <filesystem>
#include <memory>
#include <unordered_map>
#include <vector>

#include "host/explore/path_reader.h"

namespace forceshade {

/// A file of up to `most` samples is kept in memory, and its paths may be interleaved; a longer one is read once more
/// as times are asked for, path after path, in which order it must then have them.
class RecordedTimes {
public:
    RecordedTimes(const std::filesystem::path& path, std::size_t most);

    /// s. Paths are numbered by their first sample.
    double at(std::uint64_t path, std::uint64_t step);

private:
    bool keep(std::size_t most);

    std::filesystem::path file_;
    std::vector<std::vector<double>> times_;
    std::unique_ptr<PathReader> reader_; // where times are not kept
    std::vector<PathSample> samples_;    // the next of them
    std::size_t next_ = 0;
};

} // namespace forceshade
