#include "host/paths/scene_paths.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/case_law.h"
#include "host/reference/chunks.h"
#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"
#include "host/threads.h"

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

// The middle of a quantity that may differ from path to path.
double typical(const Spread& spread) {
    return spread.shape == Spread::Shape::uniform ? 0.5 * (spread.low + spread.high) : spread.value;
}

} // namespace

template <typename T>
ScenePaths<T>::ScenePaths(const PreparedCase& prepared, std::shared_ptr<const RecordedFile> recorded)
    : spec_(recorded ? prepared.one.scene.paths.value_or(PathsSpec{}) : paths_of(prepared)),
      origin_(scene_origin(prepared)) {
    if (recorded) {
        spec_.kind = PathKind::recorded;
        spec_.follow = PathFollow::plane;
    }
    const Scene& scene = prepared.one.scene;
    region_ = path_region(spec_, prepared);
    tables_ = make_tables<T>(scene, prepared.images, Extent::nothing);
    law_ = tables_.law();
    features_ = generated_ = features_of(spec_, scene.output.channels);
    if (prepared.images.mesh && spec_.follow == PathFollow::surface) {
        below_ = &prepared.images.mesh->structure;
        generated_.follow = features_.follow = layout::kFollowPlane;
        features_.motion = layout::kMotionRecorded;
        features_.harmonics = 0;
        limit_batches(kRecordedSamples);
    }
    if (spec_.closed())
        hand_ = hand_params<T>(scene.hand, spec_, region_.bound, scene.force.stiffness);
    surface_ = surface_forces<T>(prepared, 1 / spec_.rate);
    const double farthest = farthest_coordinate(spec_, region_);
    region_.centre = {region_.centre[0] - origin_.x, region_.centre[1] - origin_.y};
    region_.height -= origin_.z;
    if (prepared.images.mesh && spec_.kind != PathKind::recorded && !(farthest <= largest_coordinate<T>(prepared)))
        throw UsageError("the paths reach {:.3g} m from the origin, further from the mesh than {} can follow: at most "
                         "{:.3g} m; are the units right?",
                         farthest, name_of(kPrecisionOf<T>), largest_coordinate<T>(prepared));
    if (spec_.kind == PathKind::recorded) {
        if (!recorded)
            recorded = read_recorded<T>(prepared, spec_.path);
        spec_.count = recorded->paths();
        spec_.steps = recorded->longest();
        recorded_ = std::make_unique<RecordedPaths<T>>(std::move(recorded), kRecordedSamples, origin_);
    }
    constexpr std::uint64_t kWorthIt = 4; // samples a triangle
    if (tables_.mesh && spec_.count * spec_.steps >= kWorthIt * tables_.mesh->params.triangles) {
        find_obstacles(tables_);
        law_ = tables_.law();
    }
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
    input.surface = surface_ ? &*surface_ : nullptr;
    return input;
}

template <typename T> std::vector<std::string> ScenePaths<T>::warnings() const {
    std::vector<std::string> warnings = recorded_ ? recorded_->file()->warnings() : pace_warnings(spec_, region_);
    if (const std::optional<std::string> warning = coarse())
        warnings.push_back(*warning);
    if (!recorded_ && spec_.count > 1 && generated_.harmonics == 0 && !paths_differ(spec_))
        warnings.push_back(
            fmt::format("[paths]: all {} paths are the same one; spread speed, depth, heading or offset, as in speed = "
                        "{{ mean = \"100 mm/s\", sd = \"20 mm/s\" }}, or say count = 1",
                        spec_.count));
    return warnings;
}

template <typename T> std::optional<std::string> ScenePaths<T>::coarse() const {
    if (recorded_) {
        const StepScale& scale = recorded_->file()->scale();
        return coarse_warning(kPrecisionOf<T>, scale.farthest(), kMedianStep, scale.median_step());
    }
    PathsSpec open = spec_;
    open.loop = PathLoop::open;
    open.drive = PathDrive::depth;
    const double farthest = farthest_coordinate(open, region_), step = typical(spec_.speed) / spec_.rate; /* m */
    if (spec_.steps > 1)
        if (auto warning = coarse_warning(kPrecisionOf<T>, farthest, "the step from sample to sample", step))
            return warning;
    return spec_.drive == PathDrive::depth
               ? coarse_warning(kPrecisionOf<T>, farthest, "the depth", std::abs(typical(spec_.depth)))
               : std::nullopt;
}

template <typename T> void ScenePaths<T>::limit_batches(std::size_t samples) {
    if (recorded_)
        recorded_->limit(samples);
    most_paths_ = std::max<std::size_t>(1, samples / spec_.steps);
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
    if (recorded_) {
        batch.count = recorded_->select(first, count);
        batch.steps = recorded_->steps();
    } else if (below_) {
        batch_ = generate(first, std::min(count, most_paths_));
        batch.count = batch_.count;
        lengths_.assign(batch.count, static_cast<layout::uint>(spec_.steps));
        batch.steps = lengths_;
    } else {
        batch = generate(first, count);
    }
    if (law_.features.surface == layout::kSurfaceMesh) {
        start_proxies(batch);
        batch.proxies = proxies_;
    }
    return batch;
}

template <typename T> layout::PathBatch<T> ScenePaths<T>::generate(std::size_t first, std::size_t count) {
    layout::PathBatch<T> batch;
    batch.first = first;
    batch.count = count;
    const std::size_t table = std::size_t(generated_.harmonics) * 3 * batch.count;
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
    return batch;
}

// Where the law is evaluated first decides on which side of the surface a path begins.
template <typename T> void ScenePaths<T>::start_proxies(const layout::PathBatch<T>& batch) {
    constexpr std::size_t kShare = 64; // paths that a thread takes at once
    proxies_.resize(batch.count);
    const bool given = features_.motion == layout::kMotionRecorded;
    const std::span<const T> begun = given ? positions(0, 1) : std::span<const T>{};
    const std::size_t shares = (batch.count + kShare - 1) / kShare;
    const std::size_t threads = std::min<std::size_t>(shares, most_threads());
    std::vector<reference::Neighbourhood<T>> around(threads);
    reference::share_out(threads, shares, [&](std::size_t thread, std::size_t share) {
        for (std::size_t path = kShare * share; path < std::min(kShare * (share + 1), batch.count); ++path) {
            const auto target =
                given ? reference::vector_at(begun, path) : reference::motion_at(law_, features_, batch, path, 0);
            const auto state = reference::begin_state(features_, hand_, target);
            const reference::Vector<T> place{state.x, state.y, state.z};
            const bool closed = features_.loop == layout::kLoopClosed;
            const auto probe = closed ? reference::measured(hand_, place) : place;
            proxies_[path] =
                reference::proxy_start(law_, around[thread], reference::to_mesh_frame(law_.mesh.params, probe));
        }
    });
    for (std::size_t path = 0; path < batch.count; ++path)
        if (batch.first + path >= counted_)
            inside_ += proxies_[path].inside;
    counted_ = std::max(counted_, batch.first + batch.count);
}

template <typename T> std::span<const T> ScenePaths<T>::positions(std::size_t step, std::size_t steps) {
    if (recorded_)
        return recorded_->positions(step, steps);
    if (!below_)
        return {};
    window_.resize(3 * steps * batch_.count);
    reference::share_out(reference::threads_for(0), batch_.count, [&](std::size_t, std::size_t path) {
        for (std::size_t i = 0; i < steps; ++i) {
            const std::size_t at = std::min<std::size_t>(step + i, spec_.steps - 1);
            reference::Vector<T> place =
                reference::motion_at(law_, generated_, batch_, path, static_cast<layout::uint>(at));
            if (const auto height = height_at(*below_, origin_.x + double(place.x), origin_.y + double(place.y)))
                place.z = static_cast<T>((*height - origin_.z) + (double(place.z) - region_.height));
            for (int axis = 0; axis < 3; ++axis)
                window_[3 * (i * batch_.count + path) + std::size_t(axis)] = place[axis];
        }
    });
    return window_;
}

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
    PathPace fastest;
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
        if (pace.turns > paces.fastest.turns)
            paces.fastest = pace;
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
    return fmt::format("[paths]: speed: on {} less than {:.2g} of a round lies between two samples, which phases of "
                       "2^-32 rounds cannot say to a hundredth: the motion stands still, or is faster; right is a "
                       "speed above {:.3g} m/s, or a rate below {:.3g} Hz",
                       who(paces.slow.paths, paces, paths), slowest(paths), paces.slow.speed / paces.slow.factor,
                       paths.rate * paces.slow.factor);
}

// A path that goes there and back, round or down and up, and ends before it has done so once.
std::string open_round_warning(const PathsSpec& paths, const PathPace& fastest) {
    const double steps = 1 / fastest.turns; // of a round
    return fmt::format("[paths]: steps: a round takes {:.4g} s at {:.3g} m/s, and the paths end after {:.4g} s: no "
                       "round is complete, and none is reported; set steps = {:.0f} or more, or a higher speed",
                       steps / paths.rate, fastest.speed, static_cast<double>(paths.steps) / paths.rate,
                       std::ceil(steps) + 1);
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
    const bool rounds =
        paths.kind == PathKind::strokes || paths.kind == PathKind::circle || paths.kind == PathKind::taps;
    if (rounds && paths.steps > 1 && paces.slow.paths == 0 && paces.fastest.turns > 0 &&
        paces.fastest.turns * static_cast<double>(paths.steps) < 1)
        warnings.push_back(open_round_warning(paths, paces.fastest));
    const bool trembles = paths.kind != PathKind::random_walk && harmonic_count(paths) > 0;
    if (const double highest = highest_tremor(paths); trembles && highest >= paths.rate / 2)
        warnings.push_back(fmt::format("[paths]: tremor.frequency: a tremor of {:.4g} Hz has harmonics up to {:.4g} "
                                       "Hz, and those of half the rate, {:.4g} Hz, or more seem to be lower ones; "
                                       "right is a frequency below {:.4g} Hz, or a rate above {:.4g} Hz",
                                       paths.tremor_frequency, highest, paths.rate / 2,
                                       paths.tremor_frequency * paths.rate / (2 * highest), 2 * highest));
    return warnings;
}

namespace {

template <typename T> layout::AxisMap<T> rounded_map(const layout::AxisMap<double>& map) {
    return {rounded<T>(map.x_error, "the hand's map of error to place"),
            rounded<T>(map.x_speed, "the hand's map of speed to place"),
            rounded<T>(map.x_force, "the hand's map of force to place, about period^2 / (2 mass),"),
            rounded<T>(map.v_error, "the hand's map of error to speed, about stiffness period / mass,"),
            rounded<T>(map.v_speed, "the hand's map of speed to speed"),
            rounded<T>(map.v_force, "the hand's map of force to speed, about period / mass,")};
}

} // namespace

template <typename T>
layout::HandParams<T> hand_params(const HandSpec& hand, const PathsSpec& paths, double bound, double stiffness) {
    const double period = 1 / paths.rate;
    Axis axis{hand.mass, hand.damping + hand.grip_damping, hand.grip_stiffness};
    layout::HandParams<T> params{};
    params.lateral = rounded_map<T>(axis_map(axis, period));
    axis.stiffness =
        paths.drive == PathDrive::depth ? hand.grip_stiffness : 0; // a hand that presses has no spring there
    params.vertical = rounded_map<T>(axis_map(axis, period));
    params.rate = rounded<T>(paths.rate, "paths.rate");
    params.period = rounded<T>(period, "1 / paths.rate");
    params.stiffness = rounded<T>(hand.grip_stiffness, "hand.grip_stiffness");
    params.stiffness_z = rounded<T>(axis.stiffness, "hand.grip_stiffness");
    params.damping = rounded<T>(hand.grip_damping, "hand.grip_damping");
    if (paths.drive == PathDrive::press)
        params.push_z = rounded<T>(-paths.press, "paths.press");
    if (paths.drive == PathDrive::push) {
        params.push_x = rounded<T>(paths.push[0], "paths.push");
        params.push_y = rounded<T>(paths.push[1], "paths.push");
        params.push_z = rounded<T>(paths.push[2], "paths.push");
    }
    params.quantum = rounded<T>(hand.quantisation, "hand.quantisation");
    params.coulomb = rounded<T>(hand.coulomb, "hand.coulomb");
    params.max_force = rounded<T>(hand.max_force, "hand.max_force");
    params.gain = T(1);
    params.bound = rounded<T>(bound, "paths.bound");
    params.start_depth = rounded<T>(paths.start_depth, "paths.start_depth");
    params.coupling = coupling_of<T>(hand, stiffness, period);
    params.delay = static_cast<layout::uint>(hand.delay_samples);
    return params;
}

template layout::HandParams<float> hand_params<float>(const HandSpec&, const PathsSpec&, double, double);
template layout::HandParams<double> hand_params<double>(const HandSpec&, const PathsSpec&, double, double);

namespace {

using real = long double; // so that what a coefficient is made of is exact to double's last digit

// The answer h(t) to a unit of speed at the beginning, time in samples: h'' + 2 a h' + c h = 0, h(0) = 0, h'(0) = 1.
struct Answer {
    real at_end, speed, sum; // h(1), h'(1), and the integral of h from 0 to 1
};

// h is the sum over n of (-1)^n s_n t^(n+1) / (n+1)!, where s_n, the complete symmetric polynomial of the two roots,
// is 2 a s_(n-1) - c s_(n-2). For small a and c.
Answer by_series(real a, real c) {
    constexpr int kTerms = 40;
    Answer answer{0, 0, 0};
    real symmetric = 1, before = 0, factorial = 1; // s_n, s_(n-1), (-1)^n / n!
    for (int n = 0; n < kTerms; ++n) {
        answer.speed += symmetric * factorial;
        answer.at_end += symmetric * factorial / real(n + 1);
        answer.sum += symmetric * factorial / real((n + 1) * (n + 2));
        const real next = 2 * a * symmetric - c * before;
        before = symmetric;
        symmetric = next;
        factorial /= -real(n + 1);
    }
    return answer;
}

// The mean of e^-rt over a sample.
real mean_decay(real rate) {
    return rate > 0 ? -std::expm1(-rate) / rate : 1;
}

// Two real rates of decay, slow and fast: none is a difference of like numbers.
Answer overdamped(real a, real c) {
    const real half = std::sqrt(a * a - c), fast = a + half, slow = c / fast;
    const real between = mean_decay(2 * half);
    Answer answer;
    answer.at_end = std::exp(-slow) * between;
    answer.speed = std::exp(-slow) * (std::exp(-2 * half) - slow * between);
    if (fast >= 2 * slow)
        answer.sum = (mean_decay(slow) - mean_decay(fast)) / (2 * half);
    else
        answer.sum = (1 - std::exp(-slow) * (1 + slow * between)) / c;
    return answer;
}

Answer underdamped(real a, real c) {
    const real turn = std::sqrt(c - a * a), decay = std::exp(-a);
    const real swing = std::sin(turn) / turn, back = std::sin(turn / 2);
    Answer answer;
    answer.at_end = decay * swing;
    answer.speed = decay * (std::cos(turn) - a * swing);
    answer.sum = (-std::expm1(-a) + decay * (2 * back * back - a * swing)) / c;
    return answer;
}

Answer answer_of(real a, real c) {
    if (a <= real(0.5) && c <= 1)
        return by_series(a, c);
    return a * a >= c ? overdamped(a, c) : underdamped(a, c);
}

} // namespace

layout::AxisMap<double> axis_map(const Axis& axis, double period) {
    const real t = period, m = axis.mass;
    const real a = axis.damping * t / (2 * m), c = axis.stiffness * t * t / m; // 1
    const Answer answer = answer_of(a, c);
    return {static_cast<double>(-c * answer.sum),        static_cast<double>(t * answer.at_end),
            static_cast<double>(t * t / m * answer.sum), static_cast<double>(-c / t * answer.at_end),
            static_cast<double>(answer.speed),           static_cast<double>(t / m * answer.at_end)};
}

} // namespace forceshade
