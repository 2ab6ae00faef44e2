#include "host/paths/scene_paths.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <type_traits>

#include <fmt/format.h>

#include "host/error.h"
#include "host/paths/hand.h"
#include "host/paths/motions.h"
#include "host/paths/recorded.h"
#include "host/prepare/prepared_case.h"
#include "host/prepare/probe.h"
#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"

namespace forceshade {

namespace {

const PathsSpec& paths_of(const PreparedCase& prepared) {
    if (!prepared.one.scene.paths)
        throw UsageError("the scene has no [paths]: add that table, or give recorded paths");
    return *prepared.one.scene.paths;
}

layout::PathFeatures features_of(const PathsSpec& paths, std::uint32_t channels) {
    layout::PathFeatures features;
    features.motion = static_cast<layout::uint>(paths.kind);
    features.loop = paths.closed() ? layout::kLoopClosed : layout::kLoopOpen;
    features.follow = paths.follow == PathFollow::surface ? layout::kFollowSurface : layout::kFollowPlane;
    features.harmonics = harmonic_count(paths);
    features.channels = (channels & ~layout::kChannelUnshaded) | layout::kChannelPosition;
    return features;
}

// Of a probe: squares stay numbers of T, and a mesh can still be told from a point.
template <typename T> double largest_coordinate(const PreparedCase& prepared) {
    if (!prepared.images.mesh)
        return kLargestLength<T>;
    const MeshStructure& mesh = prepared.images.mesh->structure;
    const double middle = std::max({std::abs(mesh.centre.x), std::abs(mesh.centre.y), std::abs(mesh.centre.z)});
    return std::min(kLargestLength<T>, middle + kMeshReach<T> * mesh.scale);
}

} // namespace

template <typename T>
std::shared_ptr<const RecordedFile>
read_recorded(const PreparedCase& prepared, const std::filesystem::path& file,
              const std::function<void(std::uint64_t done, std::uint64_t total)>& progress) {
    const std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    RecordedOptions options;
    options.largest_coordinate = largest_coordinate<T>(prepared);
    options.period = paths && paths->closed() ? 1 / paths->rate : 0;
    options.progress = progress;
    return std::make_shared<const RecordedFile>(file, options);
}

template <typename T> ScenePaths<T>::ScenePaths(const PreparedCase& prepared) : spec_(paths_of(prepared)) {
    prepare(prepared);
    if (spec_.kind == PathKind::recorded)
        take_recorded(read_recorded<T>(prepared, spec_.path));
}

template <typename T>
ScenePaths<T>::ScenePaths(const PreparedCase& prepared, std::shared_ptr<const RecordedFile> recorded)
    : spec_(recorded ? prepared.one.scene.paths.value_or(PathsSpec{}) : paths_of(prepared)) {
    if (recorded) {
        spec_.kind = PathKind::recorded;
        spec_.follow = PathFollow::plane;
    }
    prepare(prepared);
    if (recorded)
        take_recorded(std::move(recorded));
}

template <typename T> void ScenePaths<T>::take_recorded(std::shared_ptr<const RecordedFile> file) {
    spec_.count = file->paths();
    spec_.steps = file->longest();
    recorded_ = std::make_unique<RecordedPaths<T>>(std::move(file));
}

template <typename T> ScenePaths<T>::~ScenePaths() = default;

template <typename T> void ScenePaths<T>::prepare(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    region_ = path_region(spec_, prepared);
    tables_ = make_tables<T>(scene, prepared.images, Extent::what_varies);
    law_ = tables_.law();
    features_ = features_of(spec_, scene.output.channels);
    if (spec_.closed())
        hand_ = hand_params<T>(scene.hand, spec_, region_.bound);
    const double farthest = farthest_coordinate(spec_, region_);
    if (prepared.images.mesh && spec_.kind != PathKind::recorded && !(farthest <= largest_coordinate<T>(prepared)))
        throw UsageError(fmt::format("the paths come to {:.3g} m from the origin, further from the mesh than {} can "
                                     "follow: at most {:.3g} m; are the units right?",
                                     farthest, std::is_same_v<T, float> ? "f32" : "f64",
                                     largest_coordinate<T>(prepared)));
}

template <typename T> layout::PathInput<T> ScenePaths<T>::input() {
    layout::PathInput<T> input;
    input.law = law_;
    input.features = features_;
    if (spec_.closed())
        input.hands = {&hand_, 1};
    input.paths = spec_.count;
    input.steps = spec_.steps;
    input.source = this;
    input.stretch = single_stretch(region_);
    return input;
}

template <typename T> std::vector<std::string> ScenePaths<T>::warnings() const {
    if (recorded_)
        return recorded_->file()->warnings();
    std::vector<std::string> warnings = pace_warnings(spec_, region_);
    if (spec_.count > 1 && features_.harmonics == 0 && !paths_differ(spec_))
        warnings.push_back(
            fmt::format("[paths]: all {} paths are the same one; spread speed, depth, heading or offset, "
                        "as in speed = {{ mean = \"100 mm/s\", sd = \"20 mm/s\" }}, or say count = 1",
                        spec_.count));
    return warnings;
}

template <typename T> std::shared_ptr<const RecordedFile> ScenePaths<T>::recorded() const {
    return recorded_ ? recorded_->file() : nullptr;
}

template <typename T> void ScenePaths<T>::limit_batches(std::size_t samples) {
    if (recorded_)
        recorded_->limit(samples);
}

template <typename T> void ScenePaths<T>::add_path(std::size_t first, std::size_t path, std::size_t count) {
    const PathDraws draws(spec_.seed, first + path);
    motions_[path] = rounded_motion<T>(path_motion(spec_, region_, draws));
    const Harmonics harmonics = path_harmonics(spec_, region_, draws);
    for (std::size_t i = 0; i < harmonics.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t at = (3 * i + axis) * count + path;
            amplitudes_[at] = static_cast<T>(harmonics[i][axis].amplitude);
            phases_[at] = harmonics[i][axis].phase;
            phase_steps_[at] = harmonics[i][axis].phase_step;
        }
}

template <typename T> layout::PathBatch<T> ScenePaths<T>::batch(std::size_t first, std::size_t count) {
    layout::PathBatch<T> batch;
    batch.first = first;
    batch.count = recorded_ ? recorded_->select(first, count) : count;
    if (recorded_)
        batch.steps = recorded_->steps();
    else
        generate(batch);
    if (law_.features.surface == layout::kSurfaceMesh) {
        start_proxies(batch);
        batch.proxies = proxies_;
    }
    return batch;
}

template <typename T> void ScenePaths<T>::generate(layout::PathBatch<T>& batch) {
    const std::size_t table = std::size_t(features_.harmonics) * 3 * batch.count;
    motions_.resize(batch.count);
    amplitudes_.resize(table);
    phases_.resize(table);
    phase_steps_.resize(table);
    for (std::size_t path = 0; path < batch.count; ++path)
        add_path(batch.first, path, batch.count);
    batch.motions = motions_;
    batch.amplitudes = amplitudes_;
    batch.phases = phases_;
    batch.phase_steps = phase_steps_;
}

// Where the law is evaluated first decides on which side of the surface a path begins.
template <typename T> void ScenePaths<T>::start_proxies(const layout::PathBatch<T>& batch) {
    constexpr std::size_t kShare = 64; // paths that a thread takes at once
    proxies_.resize(batch.count);
    const std::span<const T> begun = recorded_ ? recorded_->positions(0, 1) : std::span<const T>{};
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        reference::Neighbourhood<T> around;
        for (std::size_t begin; (begin = kShare * next++) < batch.count;)
            for (std::size_t path = begin; path < std::min(begin + kShare, batch.count); ++path) {
                const auto target = recorded_ ? reference::vector_at(begun, path)
                                              : reference::motion_at(law_, features_, batch, path, 0);
                const auto state = reference::begin_state(features_, hand_, target);
                const reference::Vector<T> place{state.x, state.y, state.z};
                const bool closed = features_.loop == layout::kLoopClosed;
                const auto probe = closed ? reference::measured(hand_, place) : place;
                proxies_[path] =
                    reference::proxy_start(law_, around, reference::to_mesh_frame(law_.mesh.params, probe));
            }
    };
    {
        std::vector<std::jthread> helpers;
        const std::size_t shares = (batch.count + kShare - 1) / kShare;
        for (std::size_t i = 1; i < std::min<std::size_t>(shares, std::thread::hardware_concurrency()); ++i)
            helpers.emplace_back(work);
        work();
    }
    for (std::size_t path = 0; path < batch.count; ++path)
        if (batch.first + path >= counted_)
            inside_ += proxies_[path].inside;
    counted_ = std::max(counted_, batch.first + batch.count);
}

template <typename T> std::span<const T> ScenePaths<T>::positions(std::size_t step, std::size_t steps) {
    return recorded_ ? recorded_->positions(step, steps) : std::span<const T>{};
}

template std::shared_ptr<const RecordedFile>
read_recorded<float>(const PreparedCase&, const std::filesystem::path&,
                     const std::function<void(std::uint64_t, std::uint64_t)>&);
template std::shared_ptr<const RecordedFile>
read_recorded<double>(const PreparedCase&, const std::filesystem::path&,
                      const std::function<void(std::uint64_t, std::uint64_t)>&);
template class ScenePaths<float>;
template class ScenePaths<double>;

namespace {

constexpr std::uint64_t kLooked = 65536; // paths
constexpr double kFastest = 0.5;         // turns a sample
constexpr double kSlowest = 100 * 0x1p-32;

// Fewest turns a sample that come out to a hundredth; of a spiral the way out and back is a phase as well. Lines, and
// ways from point to point, take whole samples and no phase.
double slowest(const PathsSpec& paths) {
    if (paths.kind == PathKind::raster || paths.kind == PathKind::minimum_jerk)
        return 0;
    return paths.kind == PathKind::spiral ? kSlowest * 2 * static_cast<double>(paths.lines) : kSlowest;
}

// Paths beyond a limit, and the factor by which the worst of them is.
struct Beyond {
    std::uint64_t paths = 0;
    double factor = 1; /* of turns to the limit */
    double speed = 0;  /* m/s: of the worst */
};

struct Paces {
    std::uint64_t looked = 0;
    Beyond fast, slow;
};

void count(Beyond& beyond, const PathPace& pace, double factor, bool worse) {
    ++beyond.paths;
    if (beyond.paths > 1 && !worse)
        return;
    beyond.factor = factor;
    beyond.speed = pace.speed;
}

Paces look_at(const PathsSpec& paths, const PathRegion& region) {
    Paces paces;
    const double least = slowest(paths);
    paces.looked = std::min(paths.count, kLooked);
    for (std::uint64_t path = 0; path < paces.looked; ++path) {
        const PathDraws draws(paths.seed, path);
        PathPace pace = path_pace(paths, region, draws);
        if (paths.kind == PathKind::random_walk)
            pace.turns = walk_edge(paths, region, draws);
        const double fast = pace.turns / kFastest;
        if (fast >= 1)
            count(paces.fast, pace, fast, fast > paces.fast.factor);
        if (pace.turns > 0 && pace.turns < least)
            count(paces.slow, pace, pace.turns / least, pace.turns / least < paces.slow.factor);
    }
    return paces;
}

std::string who(std::uint64_t some, const Paces& paces, const PathsSpec& paths) {
    if (paces.looked < paths.count)
        return fmt::format("{} of the first {} paths", some, paces.looked);
    return some == 1 && paths.count == 1 ? "the path" : fmt::format("{} of {} paths", some, paths.count);
}

std::string fast_warning(const PathsSpec& paths, const Paces& paces) {
    const char* what = "half a round or more lies between two samples, so that the motion seems slower, or to go back";
    if (paths.kind == PathKind::raster || paths.kind == PathKind::minimum_jerk)
        what =
            "a line, or the way to the next point, takes a sample or less, so that the motion may be slower than that";
    if (paths.kind == PathKind::random_walk)
        what = "there are frequencies of half the rate or more, which seem to be lower ones";
    return fmt::format("[paths]: speed: on {} {}; right is a speed below {:.3g} m/s, or a rate above {:.3g} Hz",
                       who(paces.fast.paths, paces, paths), what, paces.fast.speed / paces.fast.factor,
                       paths.rate * paces.fast.factor);
}

std::string slow_warning(const PathsSpec& paths, const Paces& paces) {
    return fmt::format(
        "[paths]: speed: on {} less than {:.2g} of a round lies between two samples, which phases of "
        "2^-32 rounds cannot say to a hundredth: the motion stands still, or is faster; right is a speed "
        "above {:.3g} m/s, or a rate below {:.3g} Hz",
        who(paces.slow.paths, paces, paths), slowest(paths), paces.slow.speed / paces.slow.factor,
        paths.rate * paces.slow.factor);
}

} // namespace

std::vector<std::string> pace_warnings(const PathsSpec& paths, const PathRegion& region) {
    std::vector<std::string> warnings;
    if (paths.kind == PathKind::recorded)
        return warnings;
    const Paces paces = look_at(paths, region);
    if (paces.fast.paths > 0)
        warnings.push_back(fast_warning(paths, paces));
    if (paces.slow.paths > 0)
        warnings.push_back(slow_warning(paths, paces));
    const bool trembles = paths.kind != PathKind::random_walk && harmonic_count(paths) > 0;
    if (const double highest = highest_tremor(paths); trembles && highest >= paths.rate / 2)
        warnings.push_back(
            fmt::format("[paths]: tremor.frequency: a tremor of {:.4g} Hz has harmonics up to {:.4g} Hz, "
                        "and those of half the rate, {:.4g} Hz, or more seem to be lower ones; right is "
                        "a frequency below {:.4g} Hz, or a rate above {:.4g} Hz",
                        paths.tremor_frequency, highest, paths.rate / 2,
                        paths.tremor_frequency * paths.rate / (2 * highest), 2 * highest));
    return warnings;
}

} // namespace forceshade
