// The times that a recorded file gives its samples, as its paths go by.
#pragma once

#include <memory>
#include <vector>

#include "host/io/path_rows.h"
#include "host/path_output/contact_time.h"
#include "host/paths/recorded_file.h"

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

} // namespace forceshade
