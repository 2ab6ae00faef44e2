#include "host/paths/recorded.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/program.h"

namespace forceshade {

namespace {

constexpr std::size_t kAhead = 4096; // samples read at once
constexpr std::size_t kMostSteps = 1000000000;
constexpr std::uint64_t kSteps = 4;                         // most that a batch takes for each of its samples
constexpr std::uint64_t kFewSteps = std::uint64_t(1) << 18; // of a batch: computed in no time anyway

} // namespace

RecordedFile::RecordedFile(const std::filesystem::path& file, const RecordedOptions& options)
    : path_(file), largest_coordinate_(options.largest_coordinate) {
    PathReader reader(file, options.largest_coordinate);
    stamp_ = reader.csv().file().stamp();
    PathCensus census(reader.csv().source(), options.period, options.origin);
    std::vector<PathSample> samples;
    for (reader.read(samples, kAhead); !samples.empty(); reader.read(samples, kAhead)) {
        check_interrupt();
        count(samples, census);
        if (census.first_return() && samples_ > options.most_interleaved)
            fail(reader.csv().source(), {*census.first_return(), 1},
                 fmt::format("a path goes on here after samples of another; in a file of more than {} samples each "
                             "path's stand together: sort it by path",
                             options.most_interleaved));
        if (samples_ <= options.most_kept)
            kept_.insert(kept_.end(), samples.begin(), samples.end());
        else
            std::vector<PathSample>().swap(kept_);
        if (options.progress)
            options.progress(reader.csv().bytes_read(), reader.csv().bytes());
    }
    ids_ = census.ids();
    scale_ = census.scale();
    if (reader.csv().ends_open())
        warnings_.push_back(location_prefix(reader.csv().source(), reader.csv().end()) +
                            "the last line has no line feed: if the file was cut off, its last number may be too");
    if (census.first_return())
        keep_interleaved();
}

RecordedFile::RecordedFile(std::string source, std::vector<std::vector<glm::dvec3>> paths,
                           const RecordedOptions& options)
    : path_(std::move(source)), largest_coordinate_(options.largest_coordinate), scale_(options.origin) {
    if (paths.empty())
        throw UsageError("{}: there is no path", path_.string());
    for (std::size_t path = 0; path < paths.size(); ++path) {
        if (paths[path].empty() || paths[path].size() > kMostSteps)
            throw UsageError("{}[{}]: {} samples; a path has 1 to {}", path_.string(), path, paths[path].size(),
                             kMostSteps);
        for (std::size_t i = 0; i < paths[path].size(); ++i) {
            const glm::dvec3& probe = paths[path][i];
            const double farthest = std::max({std::abs(probe.x), std::abs(probe.y), std::abs(probe.z)});
            if (!(farthest <= largest_coordinate_) || std::isnan(probe.x + probe.y + probe.z))
                throw UsageError("{}[{}][{}]: ({}, {}, {}) m: coordinates are numbers of up to {:.3g} m",
                                 path_.string(), path, i, probe.x, probe.y, probe.z, largest_coordinate_);
            i == 0 ? scale_.begin(probe) : scale_.add(probe, paths[path][i - 1]);
            kept_.push_back({path, options.period * static_cast<double>(i), probe, 0});
        }
        ids_.push_back(path);
        steps_.push_back(static_cast<layout::uint>(paths[path].size()));
        longest_ = std::max(longest_, paths[path].size());
        samples_ += paths[path].size();
    }
}

void RecordedFile::count(const std::vector<PathSample>& samples, PathCensus& census) {
    for (const PathSample& sample : samples) {
        const std::size_t path = census.add(sample);
        if (path == kRecordedPaths)
            fail(path_.string(), {sample.line, 1}, fmt::format("more than {} paths; split the file", kRecordedPaths));
        if (path == steps_.size())
            steps_.push_back(0);
        if (++steps_[path] > kMostSteps)
            fail(path_.string(), {sample.line, 1},
                 fmt::format("path {} has more than {} samples; split it", sample.path, kMostSteps));
        longest_ = std::max<std::size_t>(longest_, steps_[path]);
    }
    samples_ += samples.size();
}

// Samples in the order of the file become samples path by path.
void RecordedFile::keep_interleaved() {
    std::vector<std::size_t> ends(paths(), 0); // of what is there of each path
    for (std::size_t path = 1; path < paths(); ++path)
        ends[path] = ends[path - 1] + steps_[path - 1];
    kept_.assign(samples_, PathSample{});
    PathCensus census(path_.string());
    std::vector<PathSample> samples;
    const std::unique_ptr<PathReader> reader = open();
    std::uint64_t read = 0;
    for (reader->read(samples, kAhead); !samples.empty(); reader->read(samples, kAhead)) {
        check_interrupt();
        read += samples.size();
        for (const PathSample& sample : samples) {
            const std::size_t path = census.add(sample);
            if (path >= paths() || ends[path] == kept_.size())
                refuse_change();
            kept_[ends[path]++] = sample;
        }
    }
    if (read != samples_)
        refuse_change();
    require_unchanged();
}

std::unique_ptr<PathReader> RecordedFile::open() const {
    auto reader = std::make_unique<PathReader>(path_, largest_coordinate_);
    if (reader->csv().file().stamp() != stamp_)
        refuse_change();
    return reader;
}

void RecordedFile::require_unchanged() const {
    if (stamp_ && stamp_of(path_) != *stamp_)
        refuse_change();
}

void RecordedFile::refuse_change() const {
    throw IoError("{} was changed while it was read; no file was written", path_.string());
}

void RecordedCursor::restart() {
    at_ = 0;
    path_ = 0;
    path_end_ = file_.steps().front();
    begun_ = true;
    used_ = 0;
    ahead_.clear();
    if (file_.kept().empty())
        reader_ = file_.open();
}

const PathSample& RecordedCursor::next() {
    if (!begun_)
        restart();
    if (at_ == file_.samples())
        throw std::logic_error("a sample behind the last of a recorded file was asked for");
    while (at_ == path_end_)
        path_end_ += file_.steps()[++path_];
    if (!file_.kept().empty())
        return file_.kept()[at_++];
    if (used_ == ahead_.size())
        read_ahead();
    if (ahead_.empty() || ahead_[used_].path != file_.ids()[path_])
        file_.refuse_change();
    ++at_;
    return ahead_[used_++];
}

// All of it was right when the file was read first.
void RecordedCursor::read_ahead() {
    check_interrupt();
    used_ = 0;
    try {
        reader_->read(ahead_, kAhead);
    } catch (const UsageError&) {
        file_.refuse_change();
    }
}

void RecordedCursor::go_to(std::uint64_t sample) {
    if (!begun_ || sample < at_)
        restart();
    if (file_.kept().empty()) {
        while (at_ < sample)
            next();
        return;
    }
    at_ = sample;
    while (at_ > path_end_)
        path_end_ += file_.steps()[++path_];
}

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
        const std::uint64_t all = (count_ + 1) * std::max(longest, own);
        if (count_ > 0 && all > std::min<std::uint64_t>(most_, std::max(kFewSteps, kSteps * (samples + own))))
            break;
        samples += own;
        longest = std::max(longest, own);
    }
    places_.clear();
    kept_from_ = begin_;
    return count_;
}

// Reads on until the samples [begin, end) of the file are in memory, and forgets those before.
template <typename T> void RecordedPaths<T>::keep(std::uint64_t begin, std::uint64_t end) {
    const std::uint64_t gone = std::min<std::uint64_t>(std::max(begin, kept_from_) - kept_from_, places_.size());
    places_.erase(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(gone));
    kept_from_ += gone;
    if (places_.empty())
        kept_from_ = begin;
    if (kept_from_ + places_.size() < end)
        cursor_.go_to(kept_from_ + places_.size());
    while (kept_from_ + places_.size() < end)
        places_.emplace_back(cursor_.next().probe - origin_);
}

template <typename T> std::span<const T> RecordedPaths<T>::positions(std::size_t step, std::size_t steps) {
    window_.assign(3 * steps * count_, T(0));
    const bool kept = !file_->kept().empty();
    std::uint64_t begin = begin_; // the path's first sample
    for (std::size_t path = 0; path < count_; begin += file_->steps()[first_ + path++]) {
        const std::size_t end = std::min<std::size_t>(step + steps, file_->steps()[first_ + path]);
        if (!kept && step < end)
            keep(count_ == 1 ? begin + step : begin_, begin + end);
        for (std::size_t i = step; i < end; ++i) {
            const Place place =
                kept ? Place(file_->kept()[begin + i].probe - origin_) : places_[begin + i - kept_from_];
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
    require_file(*paths);
    const std::string found = sha256_of_file(paths->path);
    check_digest(paths->file, paths->sha256, found);
    paths->sha256 = found;
    prepared.scene = resolved_toml(prepared.one);
}

template class RecordedPaths<float>;
template class RecordedPaths<double>;

} // namespace forceshade
