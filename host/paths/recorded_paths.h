// Paths recorded in a CSV file, a batch at a time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/explore/path_reader.h"
#include "shaders/shared/layout.h"

namespace forceshade {

/// Samples that are held in memory at once, at most; a file with more must have each path's samples together.
inline constexpr std::size_t kRecordedSamples = std::size_t(1) << 22;

/// Reads the file twice: to check it and count, then batch by batch as an engine asks. A file of up to
/// kRecordedSamples is kept from the first reading, and its paths may be interleaved.
template <typename T> class RecordedPaths {
public:
    /// `largest_coordinate`, m, as for PathReader. `period`, s: of a closed loop, to which the samples' times must keep
    /// to 1 %; 0: they need only increase. `most`: as kRecordedSamples.
    /// \throws IoError, UsageError `file:line:column: ...` for what is wrong in the file, for times of a path that do
    /// not increase, and for a path that goes on after another in a file of more than `most` samples.
    RecordedPaths(const std::filesystem::path& path, double largest_coordinate, double period,
                  std::size_t most = kRecordedSamples);

    std::size_t paths() const { return steps_.size(); }
    std::size_t longest() const { return longest_; } /* samples */
    std::span<const std::uint64_t> ids() const { return ids_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

    /// Goes to the path `first`; how many paths from there on are read together, at most `count`.
    std::size_t select(std::size_t first, std::size_t count);
    /// Samples of the selected paths.
    std::span<const layout::uint> steps() const { return {steps_.data() + first_, count_}; }
    /// As layout::PathSource::positions; windows of a selection come in the order of steps.
    std::span<const T> positions(std::size_t step, std::size_t steps);

private:
    void read_all(double period, std::size_t most);
    void load();
    void put(std::size_t step, std::size_t steps);

    std::filesystem::path file_;
    double largest_coordinate_; /* m */
    std::size_t most_;
    std::vector<std::uint64_t> ids_;
    std::vector<layout::uint> steps_;
    std::size_t longest_ = 0;
    std::vector<std::string> warnings_;
    std::size_t first_ = 0, count_ = 0;            // selected paths
    std::vector<std::vector<glm::dvec3>> samples_; // of all paths, if they fit; else of the selected
    std::vector<T> window_;
};

} // namespace forceshade
