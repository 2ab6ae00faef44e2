#include "host/paths/explore.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "host/norm.h"
#include "host/paths/path_files.h"
#include "host/paths/path_reader.h"
#include "host/prepare/probe.h"
#include "host/program.h"

namespace forceshade {

namespace {

constexpr std::size_t kText = std::size_t(1) << 18; // bytes gathered before they are written

} // namespace

PathWriter::PathWriter(const std::filesystem::path& path)
    : file_(path), text_("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n") {}

template <typename T> void PathWriter::number(T value, char after) {
    char digits[40]; // the shortest form of a double has 24 at most
    const char* const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    text_.append(digits, static_cast<std::size_t>(end - digits));
    text_ += after;
}

template <typename T> void PathWriter::add(const PathSample& sample, const reference::Contact<T>& contact) {
    number(sample.path, ',');
    number(sample.time, ',');
    for (int i = 0; i < 3; ++i)
        number(static_cast<T>(sample.probe[i]), ','); // where the law was evaluated
    for (const reference::Vector<T>& vector : {contact.proxy, contact.force})
        for (int i = 0; i < 3; ++i)
            number(vector[i], ',');
    number(contact.depth, ',');
    if (contact.facet == layout::kNoFacet)
        text_ += "-1\n";
    else
        number(contact.facet, '\n');
    if (text_.size() >= kText)
        flush();
}

void PathWriter::flush() {
    file_.write(text_);
    text_.clear();
}

void PathWriter::publish() {
    flush();
    file_.publish();
}

template void PathWriter::add<float>(const PathSample&, const reference::Contact<float>&);
template void PathWriter::add<double>(const PathSample&, const reference::Contact<double>&);

namespace {

constexpr std::size_t kBatch = 4096; // samples between looks at the clock and for interrupts

template <typename T> class Exploration {
public:
    Exploration(const PreparedCase& prepared, const std::filesystem::path& paths, const std::filesystem::path& out,
                float stretch)
        : stretch_(stretch), law_(make_path_law<T>(prepared)), reader_(paths, law_->largest_coordinate()),
          census_(reader_.csv().source()), writer_(out),
          summary_(out.parent_path() / (out.stem().string() + ".paths.csv"), prepared.one.scene.precision) {}

    ExploreResult run(const ExploreProgress& progress) {
        for (reader_.read(samples_, kBatch); !samples_.empty(); reader_.read(samples_, kBatch)) {
            check_interrupt();
            evaluate();
            for (std::size_t i = 0; i < samples_.size(); ++i)
                add(samples_[i], numbers_[i], felt_[i]);
            progress(reader_.csv().bytes_read(), reader_.csv().bytes());
        }
        warn();
        summarise();
        writer_.publish();
        summary_.finish();
        result_.paths = census_.paths();
        return result_;
    }

private:
    void warn() {
        const std::string& source = reader_.csv().source();
        if (reader_.csv().ends_open())
            result_.warnings.push_back(
                location_prefix(source, reader_.csv().end()) +
                "the last line has no line feed: if the file was cut off, its last number may be too");
        if (inside_ > 0)
            result_.warnings.push_back(location_prefix(source, {first_inside_, 1}) +
                                       fmt::format("{} of {} paths, here the first, begin behind the mesh's surface; "
                                                   "their proxies begin at the nearest place of it",
                                                   inside_, census_.paths()));
    }

    void summarise() {
        for (const PathTrack<T>& track : tracks_)
            summary_.add(track.id,
                         figures_of(track.state.metrics, {.steps = track.steps,
                                                          .began_inside = track.inside,
                                                          .times = PathTimes{.contact = track.contact.total()}}));
    }

    // After the law has been asked, in the order of the samples.
    void follow(const PathSample& sample, std::size_t number, const PathContact<T>& felt) {
        if (number == tracks_.size())
            tracks_.push_back(PathTrack<T>(sample.path, felt.begins_inside));
        tracks_[number].add(sample.time, reference::Vector<T>(sample.probe), felt.contact, felt.finished, T(stretch_));
    }

    void evaluate() {
        const auto start = std::chrono::steady_clock::now();
        numbers_.clear();
        felt_.clear();
        for (const PathSample& sample : samples_) {
            numbers_.push_back(census_.add(sample));
            felt_.push_back(law_->at(numbers_.back(), sample.probe));
        }
        result_.law_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    void add(const PathSample& sample, std::size_t number, const PathContact<T>& felt) {
        const reference::Vector<T>& force = felt.contact.force;
        const double size = norm(double(force.x), double(force.y), double(force.z));
        if (!std::isfinite(size))
            fail(reader_.csv().source(), {sample.line, 1},
                 fmt::format("the force at ({}, {}, {}) m is no finite number of this precision", sample.probe.x,
                             sample.probe.y, sample.probe.z));
        ++result_.samples;
        result_.in_contact += felt.contact.facet != layout::kNoFacet;
        result_.unfinished += !felt.finished;
        if (felt.begins_inside && inside_++ == 0)
            first_inside_ = sample.line;
        result_.largest_force = std::max(result_.largest_force, size);
        follow(sample, number, felt);
        writer_.add(sample, felt.contact);
    }

    const float stretch_; // m
    std::unique_ptr<PathLaw<T>> law_;
    PathReader reader_;
    PathCensus census_;
    PathWriter writer_;
    PathSummary summary_;
    std::vector<PathTrack<T>> tracks_; // by path
    std::vector<PathSample> samples_;
    std::vector<std::size_t> numbers_; // of their paths
    std::vector<PathContact<T>> felt_;
    std::uint64_t inside_ = 0; // paths that begin there
    std::uint32_t first_inside_ = 0;
    ExploreResult result_;
};

} // namespace

ExploreResult explore(const PreparedCase& prepared, const std::filesystem::path& paths,
                      const std::filesystem::path& out, float stretch, const ExploreProgress& progress) {
    if (prepared.one.scene.precision == Precision::f32)
        return Exploration<float>(prepared, paths, out, stretch).run(progress);
    return Exploration<double>(prepared, paths, out, stretch).run(progress);
}

} // namespace forceshade
