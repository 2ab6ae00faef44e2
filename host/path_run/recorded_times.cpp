#include "host/path_run/recorded_times.h"

#include <limits>

namespace forceshade {
namespace {

constexpr std::size_t kBatch = 4096; // samples
constexpr double kAnywhere = std::numeric_limits<double>::max();

} // namespace

RecordedTimes::RecordedTimes(const std::filesystem::path& path, std::size_t most) : file_(path) {
    if (keep(most))
        return;
    times_.clear();
    reader_ = std::make_unique<PathReader>(file_, kAnywhere);
    samples_.clear();
}

bool RecordedTimes::keep(std::size_t most) {
    PathReader reader(file_, kAnywhere);
    std::unordered_map<std::uint64_t, std::size_t> numbers;
    std::size_t kept = 0;
    for (reader.read(samples_, kBatch); !samples_.empty(); reader.read(samples_, kBatch)) {
        kept += samples_.size();
        if (kept > most)
            return false;
        for (const PathSample& sample : samples_) {
            const std::size_t number = numbers.try_emplace(sample.path, numbers.size()).first->second;
            times_.resize(numbers.size());
            times_[number].push_back(sample.time);
        }
    }
    return true;
}

double RecordedTimes::at(std::uint64_t path, std::uint64_t step) {
    if (!reader_)
        return times_[path][step];
    if (next_ == samples_.size()) {
        reader_->read(samples_, kBatch);
        next_ = 0;
    }
    return samples_[next_++].time;
}

} // namespace forceshade
