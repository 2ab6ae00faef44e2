// Takes a probe along recorded paths and writes what it feels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/output/files.h"
#include "host/paths/path_reader.h"
#include "host/prepare/prepared_case.h"
#include "host/prepare/probe.h"
#include "host/reference/path_step.h"

namespace forceshade {

/// By the times that the file gives the samples: a sample counts the time until the next one, the last one as much as
/// the one before it. A path of one sample has no time.
class ContactTime {
public:
    /// The next sample, at `time`, s.
    void add(double time, bool touches) {
        if (begun_) {
            share_ = time - time_;
            total_ += touched_ ? share_ : 0;
        }
        begun_ = true;
        time_ = time;
        touched_ = touches;
    }
    /// s.
    double total() const { return total_ + (touched_ ? share_ : 0); }

private:
    bool begun_ = false, touched_ = false;
    double time_ = 0;  /* s: of the last sample */
    double share_ = 0; /* s: of the sample before the last */
    double total_ = 0; /* s: of the samples before the last */
};

// What is remembered of a recorded path while its samples pass by, in open loop.

template <typename T> struct PathTrack {
    std::uint64_t id;
    bool inside; /* it began behind the surface */
    std::uint64_t steps = 0;
    layout::PathState<T> state{};
    ContactTime contact;

    PathTrack(std::uint64_t number, bool began_inside) : id(number), inside(began_inside) {}

    /// The next sample: when, s, where the probe is, m, and what it feels. As reference::take_step in open loop.
    void add(double time, const reference::Vector<T>& probe, const reference::Contact<T>& felt, bool finished,
             T stretch) {
        if (steps == 0)
            state = reference::state_at(probe);
        const reference::PathSampled<T> sampled{probe, felt.force, felt};
        reference::add_sample(state.metrics, felt, felt.force);
        state.metrics.unfinished += finished ? 0 : 1;
        contact.add(time, felt.facet != layout::kNoFacet);
        reference::add_turn_at(state, sampled, stretch);
        reference::add_between(state, sampled);
        reference::keep_sample(state, sampled);
        ++steps;
    }
};

// Explored paths as a CSV file: where the probe was, and what it felt there.

/// Columns path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet (s, m, N); g is the proxy, facet -1 out of contact. Every number
/// is the shortest that reads back as the same double (t) or T; x, y, z are where the law was evaluated. Nothing stands
/// under the final name until publish().
class PathWriter {
public:
    /// \throws IoError, as do the others.
    explicit PathWriter(const std::filesystem::path& path);

    template <typename T> void add(const PathSample& sample, const reference::Contact<T>& contact);
    void publish();

private:
    template <typename T> void number(T value, char after);
    void flush();

    TemporaryFile file_;
    std::string text_;
};

extern template void PathWriter::add<float>(const PathSample&, const reference::Contact<float>&);
extern template void PathWriter::add<double>(const PathSample&, const reference::Contact<double>&);

struct ExploreResult {
    std::uint64_t samples = 0, paths = 0;
    std::uint64_t in_contact = 0;      /* samples */
    std::uint64_t unfinished = 0;      /* samples at which the proxy could not come to rest */
    double largest_force = 0;          /* N */
    double law_seconds = 0;            /* s spent in the law, without reading and writing */
    std::vector<std::string> warnings; /* `file:line:column: ...` */
};

/// Called now and then with the bytes of the input that are done, and with all of them.
using ExploreProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Reads `paths` (PathReader), evaluates the scene's law at every sample in the scene's precision on the calling
/// thread, and writes `out` (PathWriter), rows in the order of the input, and STEM.paths.csv beside it (PathSummary);
/// `stretch`, m, as in layout::PathInput. Memory does not grow with the number of samples, only with that of paths.
/// Nothing is written unless all is well.
/// \throws UsageError for what is wrong in the paths (PathReader, PathCensus), IoError, Interrupted.
ExploreResult explore(const PreparedCase& prepared, const std::filesystem::path& paths,
                      const std::filesystem::path& out, float stretch, const ExploreProgress& progress);

} // namespace forceshade
