#include "host/paths/recorded_paths.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/io/hash.h"

namespace forceshade {
namespace {

constexpr std::uint64_t kSteps = 4;                         // most that a batch takes for each of its samples
constexpr std::uint64_t kFewSteps = std::uint64_t(1) << 18; // of a batch: taken in no time anyway

} // namespace

template <typename T> std::size_t RecordedPaths<T>::select(std::size_t first, std::size_t count) {
    const std::span<const layout::uint> steps = file_->steps();
    if (first < first_) {
        begin_ = 0;
        first_ = 0;
    }
    for (; first_ < first; ++first_)
        begin_ += steps[first_];
    std::uint64_t samples = 0, longest = 0;
    for (count_ = 0; count_ < count && first_ + count_ < steps.size(); ++count_) {
        const std::uint64_t own = steps[first_ + count_];
        const std::uint64_t taken = (count_ + 1) * std::max(longest, own);
        if (count_ > 0 && taken > std::min<std::uint64_t>(most_, std::max(kFewSteps, kSteps * (samples + own))))
            break;
        samples += own;
        longest = std::max(longest, own);
    }
    places_.clear();
    held_ = begin_;
    return count_;
}

// Reads on until the samples [begin, end) of the file are held, and forgets those before.
template <typename T> void RecordedPaths<T>::hold(std::uint64_t begin, std::uint64_t end) {
    const std::uint64_t gone = std::min<std::uint64_t>(std::max(begin, held_) - held_, places_.size());
    places_.erase(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(gone));
    held_ += gone;
    if (places_.empty())
        held_ = begin;
    if (held_ + places_.size() < end)
        cursor_.go_to(held_ + places_.size());
    while (held_ + places_.size() < end)
        places_.emplace_back(cursor_.next().probe);
}

template <typename T> std::span<const T> RecordedPaths<T>::positions(std::size_t step, std::size_t steps) {
    window_.assign(3 * steps * count_, T(0));
    const bool kept = !file_->kept().empty();
    std::uint64_t begin = begin_; // the path's first sample
    for (std::size_t path = 0; path < count_; begin += file_->steps()[first_ + path++]) {
        const std::size_t end = std::min<std::size_t>(step + steps, file_->steps()[first_ + path]);
        if (!kept && step < end)
            hold(count_ == 1 ? begin + step : begin_, begin + end);
        for (std::size_t i = step; i < end; ++i) {
            const Place place = kept ? Place(file_->kept()[begin + i].probe) : places_[begin + i - held_];
            T* const out = &window_[3 * ((i - step) * count_ + path)];
            out[0] = place.x;
            out[1] = place.y;
            out[2] = place.z;
        }
    }
    return window_;
}

void add_recorded_digest(PreparedCase& prepared) {
    std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    if (!paths || paths->kind != PathKind::recorded)
        return;
    const std::string found = sha256_of_file(paths->path);
    if (!paths->sha256.empty() && paths->sha256 != found)
        throw UsageError(fmt::format("{} is not the file that the scene means: its SHA-256 is {}, the scene says {}",
                                     paths->file, found, paths->sha256));
    paths->sha256 = found;
    prepared.scene = resolved_toml(prepared.one);
}

template class RecordedPaths<float>;
template class RecordedPaths<double>;

} // namespace forceshade
