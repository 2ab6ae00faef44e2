#include "host/path_run/recorded_times.h"

namespace forceshade {

template <typename T> void RecordedTimes::take(const PathRows<T>& rows) {
    first_ = rows.path_first;
    step_first_ = rows.step_first;
    if (rows.step_first == 0)
        contact_.assign(rows.path_count, ContactTime{});
    begins_.clear();
    times_.clear();
    for (std::size_t path = 0; path < rows.path_count; ++path) {
        begins_.push_back(times_.size());
        for (std::size_t i = 0; i < rows.samples(path); ++i) {
            times_.push_back(cursor_.next().time);
            contact_[path].add(times_.back(), rows.facet[path * rows.pitch + i] != layout::kNoFacet);
        }
    }
}
template void RecordedTimes::take<float>(const PathRows<float>&);
template void RecordedTimes::take<double>(const PathRows<double>&);

double RecordedTimes::at(std::uint64_t path, std::uint64_t step) const {
    return times_[begins_[path - first_] + (step - step_first_)];
}

double RecordedTimes::later(std::uint64_t path, std::uint64_t step) {
    for (; later_path_ < path; ++later_path_)
        later_begin_ += file_->steps()[later_path_];
    later_.go_to(later_begin_ + step);
    return later_.next().time;
}

} // namespace forceshade
