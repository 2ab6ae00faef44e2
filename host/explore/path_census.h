// The paths of a recorded file as its samples come by: which path a sample belongs to, and whether it may follow.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "host/explore/path_reader.h"

namespace forceshade {

class PathCensus {
public:
    /// `source`: the file's name, for errors. `period`, s: what the times of a path keep to within 1 %; 0: they need
    /// only increase.
    explicit PathCensus(std::string source, double period = 0) : source_(std::move(source)), period_(period) {}

    /// Paths are numbered by their first samples: the number of the sample's.
    /// \throws UsageError `file:line:column: t: ...` if its time does not come after that of its path's sample before,
    /// or not by a period.
    std::size_t add(const PathSample& sample);

    /// The file's own numbers of the paths.
    const std::vector<std::uint64_t>& ids() const { return ids_; }
    std::size_t paths() const { return ids_.size(); }
    /// The line at which a path first goes on after samples of another.
    std::optional<std::uint32_t> first_return() const { return first_return_; }

private:
    void check_time(const PathSample& sample, double before) const;

    std::string source_;
    double period_; /* s */
    std::unordered_map<std::uint64_t, std::size_t> numbers_;
    std::vector<std::uint64_t> ids_;
    std::vector<double> times_; /* s: of each path's last sample */
    std::size_t last_ = 0;      // the path of the sample before
    std::optional<std::uint32_t> first_return_;
};

} // namespace forceshade
