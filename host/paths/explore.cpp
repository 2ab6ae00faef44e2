#include "host/paths/explore.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/field/case_law.h"
#include "host/norm.h"
#include "host/paths/path_files.h"
#include "host/paths/path_reader.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/reference/path_step.h"

namespace forceshade {

namespace {

constexpr std::size_t kBatch = 4096; // samples between looks at the clock and for interrupts

// What is remembered of a path while its samples pass by, in open loop.
template <typename T> struct PathTrack {
    std::uint64_t id;
    bool inside; /* it began behind the surface */
    std::uint64_t steps = 0;
    layout::PathState<T> state{};
    ContactTime contact;

    PathTrack(std::uint64_t number, bool began_inside) : id(number), inside(began_inside) {}

    // The next sample: when, s, where the probe is, m, and its contact. As reference::take_step in open loop.
    void add(double time, const reference::Vector<T>& probe, const reference::Contact<T>& touch, bool finished,
             T stretch) {
        if (steps == 0)
            state = reference::state_at(probe);
        const reference::PathSampled<T> sampled{probe, touch.force, touch};
        reference::add_sample(state.metrics, touch, touch.force);
        state.metrics.unfinished += finished ? 0 : 1;
        contact.add(time, touch.facet != layout::kNoFacet);
        reference::add_turn_at(state, sampled, stretch);
        reference::add_between(state, sampled);
        reference::keep_sample(state, sampled);
        ++steps;
    }
};

template <typename T> class Exploration {
public:
    Exploration(const PreparedCase& prepared, const std::filesystem::path& paths, const std::filesystem::path& out,
                float stretch)
        : stretch_(stretch), law_(prepared), reader_(paths, largest_coordinate<T>(prepared)),
          census_(reader_.csv().source(), 0, law_.origin()), writer_(out, law_.origin()),
          summary_(out.parent_path() / (out.stem().string() + ".paths.csv"), prepared.one.scene.precision) {}

    ExploreResult run(const ExploreProgress& progress) {
        for (reader_.read(samples_, kBatch); !samples_.empty(); reader_.read(samples_, kBatch)) {
            check_interrupt();
            evaluate();
            for (std::size_t i = 0; i < samples_.size(); ++i)
                add(samples_[i], numbers_[i], contacts_[i]);
            progress(reader_.csv().bytes_read(), reader_.csv().bytes());
        }
        add_warnings();
        add_coarse_warning();
        summarise();
        writer_.publish();
        summary_.finish();
        result_.paths = census_.paths();
        return result_;
    }

private:
    void add_warnings() {
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

    void add_coarse_warning() {
        const StepScale& scale = census_.scale();
        if (const auto warning = coarse_warning(kPrecisionOf<T>, scale.farthest(), kMedianStep, scale.median_step()))
            result_.warnings.push_back(*warning);
    }

    void summarise() {
        for (const PathTrack<T>& track : tracks_)
            summary_.add(track.id,
                         figures_of(track.state.metrics, {.steps = track.steps,
                                                          .began_inside = track.inside,
                                                          .times = PathTimes{.contact = track.contact.total()}}));
    }

    void evaluate() {
        const Clock::time_point start = Clock::now();
        numbers_.clear();
        contacts_.clear();
        for (const PathSample& sample : samples_) {
            numbers_.push_back(census_.add(sample));
            if (!law_.reaches(sample.probe))
                fail(reader_.csv().source(), {sample.line, 1}, beyond_reach<T>(sample.probe));
            if (numbers_.back() == paths_.size())
                paths_.emplace_back();
            contacts_.push_back(law_.follow(paths_[numbers_.back()], around_, sample.probe));
        }
        result_.law_seconds += seconds_since(start);
    }

    void add(const PathSample& sample, std::size_t number, const PathContact<T>& found) {
        const reference::Vector<T>& force = found.contact.force;
        const double size = norm(double(force.x), double(force.y), double(force.z));
        if (!std::isfinite(size))
            fail(reader_.csv().source(), {sample.line, 1},
                 fmt::format("the force at ({}, {}, {}) m is not finite in this precision", sample.probe.x,
                             sample.probe.y, sample.probe.z));
        ++result_.samples;
        result_.in_contact += found.contact.facet != layout::kNoFacet;
        result_.unfinished += !found.finished;
        if (found.begins_inside && inside_++ == 0)
            first_inside_ = sample.line;
        result_.largest_force = std::max(result_.largest_force, size);
        const reference::Vector<T> probe(sample.probe - law_.origin()); // where the law was evaluated
        if (number == tracks_.size())
            tracks_.push_back(PathTrack<T>(sample.path, found.begins_inside));
        tracks_[number].add(sample.time, probe, found.contact, found.finished, T(stretch_));
        writer_.add(sample.path, sample.time, probe, found.contact);
    }

    const float stretch_; // m
    CaseLaw<T> law_;
    std::vector<typename CaseLaw<T>::Path> paths_; // by their numbers
    reference::Neighbourhood<T> around_;
    PathReader reader_;
    PathCensus census_;
    PathWriter writer_;
    PathSummary summary_;
    std::vector<PathTrack<T>> tracks_; // by path
    std::vector<PathSample> samples_;
    std::vector<std::size_t> numbers_; // of their paths
    std::vector<PathContact<T>> contacts_;
    std::uint64_t inside_ = 0; // paths that begin there
    std::uint32_t first_inside_ = 0;
    ExploreResult result_;
};

} // namespace

ExploreResult explore(const PreparedCase& prepared, const std::filesystem::path& paths,
                      const std::filesystem::path& out, float stretch, const ExploreProgress& progress) {
    return in_precision(prepared.one.scene.precision, [&]<typename T>(std::type_identity<T>) {
        return Exploration<T>(prepared, paths, out, stretch).run(progress);
    });
}

} // namespace forceshade
