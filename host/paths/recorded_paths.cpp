#include "host/paths/recorded_paths.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/interrupt.h"
#include "host/io/hash.h"

namespace forceshade {
namespace {

constexpr std::size_t kAhead = 4096; // samples read at once
constexpr double kTolerance = 0.01;  // of the period
constexpr std::size_t kMostSteps = 1000000000;

} // namespace

// What the first reading finds: paths by their numbers in the order of their first samples.
template <typename T> struct RecordedPaths<T>::Census {
    const std::string& source;
    std::unordered_map<std::uint64_t, std::uint32_t> numbers{};
    std::vector<double> times{}; // of each path's last sample
    std::vector<std::uint32_t> owners{};
    std::uint32_t last = 0;
    std::uint32_t first_return = 0; // line at which a path goes on after another; 0: none
};

template <typename T>
RecordedPaths<T>::RecordedPaths(const std::filesystem::path& file, const RecordedOptions& options)
    : file_(file), options_(options) {
    read_all();
}

template <typename T> void RecordedPaths<T>::read_all() {
    PathReader reader(file_, options_.largest_coordinate);
    Census census{.source = reader.csv().source()};
    std::vector<PathSample> samples;
    for (reader.read(samples, kAhead); !samples.empty(); reader.read(samples, kAhead)) {
        check_interrupt();
        for (const PathSample& sample : samples)
            add(sample, census);
    }
    if (reader.csv().ends_open())
        warnings_.push_back(location_prefix(census.source, reader.csv().end()) +
                            "the last line has no line feed: if the file was cut off, its last number may be too");
    if (census.first_return != 0)
        group(census.owners);
}

template <typename T> void RecordedPaths<T>::add(const PathSample& sample, Census& census) {
    const std::uint32_t number = number_of(sample, census);
    if (number == ids_.size()) {
        if (ids_.size() == kRecordedPaths)
            fail(census.source, {sample.line, 1}, fmt::format("more than {} paths; split the file", kRecordedPaths));
        ids_.push_back(sample.path);
        steps_.push_back(0);
        census.times.push_back(sample.time);
    } else {
        check_time(sample, census.times[number], census.source);
        census.times[number] = sample.time;
    }
    if (++steps_[number] > kMostSteps)
        fail(census.source, {sample.line, 1},
             fmt::format("path {} has more than {} samples; split it", sample.path, kMostSteps));
    longest_ = std::max<std::size_t>(longest_, steps_[number]);
    census.last = number;
    keep(sample, number, census);
}

// The path's, or one more than any before.
template <typename T> std::uint32_t RecordedPaths<T>::number_of(const PathSample& sample, Census& census) {
    if (!ids_.empty() && ids_[census.last] == sample.path) // most samples go on with the same path
        return census.last;
    const auto [known, added] = census.numbers.try_emplace(sample.path, static_cast<std::uint32_t>(ids_.size()));
    if (!added && census.first_return == 0)
        census.first_return = sample.line;
    return known->second;
}

template <typename T>
void RecordedPaths<T>::check_time(const PathSample& sample, double before, const std::string& source) const {
    const double passed = sample.time - before;
    if (!(passed > 0))
        fail(source, {sample.line, 1},
             fmt::format("t: {} s comes after {} s on path {}: times of a path must increase", sample.time, before,
                         sample.path));
    if (options_.period > 0 && !(std::abs(passed - options_.period) <= kTolerance * options_.period))
        fail(source, {sample.line, 1},
             fmt::format("t: {} s is {:.4g} s after the sample before it on path {}; a hand moves the probe in steps "
                         "of {:.4g} s (paths.rate): give that rate, or resample",
                         sample.time, passed, sample.path, options_.period));
}

template <typename T> void RecordedPaths<T>::keep(const PathSample& sample, std::uint32_t number, Census& census) {
    if (kept_ && places_.size() == options_.most) {
        kept_ = false;
        std::vector<Place>().swap(places_);
        std::vector<std::uint32_t>().swap(census.owners);
    }
    if (kept_) {
        places_.emplace_back(sample.probe);
        census.owners.push_back(number);
    } else if (census.first_return != 0) {
        fail(census.source, {census.first_return, 1},
             fmt::format("a path goes on here after samples of another; in a file of more than {} samples each path's "
                         "stand together: sort it by path",
                         options_.most));
    }
}

// Samples in the order of the file become samples path by path.
template <typename T> void RecordedPaths<T>::group(const std::vector<std::uint32_t>& owners) {
    std::vector<std::size_t> places(steps_.size(), 0);
    for (std::size_t path = 1; path < steps_.size(); ++path)
        places[path] = places[path - 1] + steps_[path - 1];
    std::vector<Place> grouped(places_.size(), Place(T(0)));
    for (std::size_t i = 0; i < owners.size(); ++i)
        grouped[places[owners[i]]++] = places_[i];
    places_.swap(grouped);
}

template <typename T> bool RecordedPaths<T>::next(PathSample& sample) {
    if (taken_ == ahead_.size()) {
        reader_->read(ahead_, kAhead);
        taken_ = 0;
        check_interrupt();
    }
    if (ahead_.empty())
        return false;
    sample = ahead_[taken_++];
    ++read_;
    return true;
}

// Stands before a sample of the file, counted from its beginning.
template <typename T> void RecordedPaths<T>::go_to(std::uint64_t sample) {
    if (!reader_ || read_ > sample) {
        reader_ = std::make_unique<PathReader>(file_, options_.largest_coordinate);
        ahead_.clear();
        taken_ = 0;
        read_ = 0;
    }
    for (PathSample skipped; read_ < sample && next(skipped);) {
    }
}

template <typename T> std::size_t RecordedPaths<T>::select(std::size_t first, std::size_t count) {
    if (first < first_) {
        begin_ = 0;
        first_ = 0;
    }
    for (; first_ < first; ++first_)
        begin_ += steps_[first_];
    count_ = 0;
    for (std::uint64_t samples = 0; count_ < count && first_ + count_ < steps_.size(); ++count_) {
        samples += steps_[first_ + count_];
        if (!kept_ && count_ > 0 && samples > options_.most)
            break;
    }
    if (!kept_) {
        places_.clear();
        held_ = begin_;
        go_to(begin_);
    }
    return count_;
}

// Reads on until the samples [begin, end) of the file are held, and forgets those before.
template <typename T> void RecordedPaths<T>::hold(std::size_t begin, std::size_t end) {
    if (begin > held_) {
        const std::size_t gone = std::min<std::size_t>(begin - held_, places_.size());
        places_.erase(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(gone));
        held_ += gone;
    }
    PathSample sample{};
    while (held_ + places_.size() < end) {
        if (!next(sample))
            throw IoError(fmt::format("{} became shorter while it was read", file_.string()));
        places_.emplace_back(sample.probe);
    }
}

template <typename T> std::span<const T> RecordedPaths<T>::positions(std::size_t step, std::size_t steps) {
    window_.assign(3 * steps * count_, T(0));
    if (!kept_ && count_ == 1)
        hold(begin_ + std::min<std::size_t>(step, steps_[first_]),
             begin_ + std::min<std::size_t>(step + steps, steps_[first_]));
    std::uint64_t begin = begin_; // the path's first sample
    for (std::size_t path = 0; path < count_; begin += steps_[first_ + path++]) {
        const std::size_t end = std::min<std::size_t>(step + steps, steps_[first_ + path]);
        if (!kept_ && count_ > 1 && step < end)
            hold(begin_, begin + steps_[first_ + path]);
        for (std::size_t i = step; i < end; ++i) {
            const Place& place = places_[begin + i - held_];
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
