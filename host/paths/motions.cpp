#include "host/paths/motions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/error.h"
#include "host/reference/motion.h"

namespace forceshade {

namespace {

constexpr double kBeyond = 1.2;      // a path's length, of the feature's
constexpr double kUpon = 0.5;        // the same where a hand that presses would fall off a mesh's rim
constexpr double kGaussianRadii = 4; // a Gaussian's width: at its ends it has fallen to height e^-4
constexpr double kInnerShare = 0.05; // a spiral's smallest radius, of its length
constexpr double kBoundLengths = 10; // a probe that has left, in lengths
constexpr double kLeastBound = 0.1;  // m
constexpr double kStretch = 1e-3;    // of a path's length

struct Feature {
    std::array<double, 2> middle{}; /* m */
    double top = 0;                 /* m */
    double along = 0, across = 0;   /* m: widths in x and y */
};

Feature map_feature(const HeightMapSpec& map) {
    switch (map.function) {
    case MapFunction::cylinder:
    case MapFunction::dip:
    case MapFunction::sine:
        return {{}, 0, map.width, map.width};
    case MapFunction::gaussian:
        return {{}, 0, kGaussianRadii * map.radius, kGaussianRadii * map.radius};
    case MapFunction::file:
        break;
    }
    return {{}, 0, map.size[0], map.size[1]};
}

Feature mesh_feature(const SceneMesh& mesh) {
    const MeshBox box = bounding_box(mesh.mesh.polygons);
    const auto middle = [&](int i) { return box.low[i] + (box.high[i] - box.low[i]) / 2; };
    return {{middle(0), middle(1)}, box.high[2], box.high[0] - box.low[0], box.high[1] - box.low[1]};
}

Feature feature_of(const PreparedCase& prepared) {
    const SurfaceSpec& surface = prepared.one.scene.surface;
    if (surface.kind == SurfaceKind::mesh)
        return mesh_feature(*prepared.images.mesh);
    if (surface.kind == SurfaceKind::height_map)
        return map_feature(surface.map);
    return {{}, 0, surface.width, surface.width};
}

// Without its sign.
double largest(const Spread& spread) {
    constexpr double kDeviations = 8;
    switch (spread.shape) {
    case Spread::Shape::fixed:
        return std::abs(spread.value);
    case Spread::Shape::normal:
        return std::abs(spread.value) + kDeviations * spread.sd;
    case Spread::Shape::uniform:
        break;
    }
    return std::max(std::abs(spread.low), std::abs(spread.high));
}

} // namespace

PathRegion path_region(const PathsSpec& paths, const PreparedCase& prepared) {
    const Feature feature = feature_of(prepared);
    PathRegion region;
    region.centre = paths.centre.value_or(feature.middle);
    region.height = paths.height.value_or(feature.top);
    const bool mesh = prepared.one.scene.surface.kind == SurfaceKind::mesh;
    const bool falls = paths.drive != PathDrive::depth || paths.follow == PathFollow::surface;
    const double share = mesh && falls ? kUpon : kBeyond;
    region.length = paths.length.value_or(share * feature.along);
    region.width = paths.width.value_or(paths.length ? *paths.length : share * feature.across);
    region.inner = paths.inner.value_or(kInnerShare * region.length);
    region.bound = paths.bound.value_or(std::max(kLeastBound, kBoundLengths * region.length));
    const double feature_length = kBeyond * std::max(feature.along, feature.across);
    const double over = region.length > 0 ? region.length : region.width > 0 ? region.width : feature_length;
    region.stretch = paths.stretch.value_or(kStretch * over);
    if (paths.kind == PathKind::spiral && region.inner > region.length / 2)
        throw UsageError("paths.inner, a spiral's smallest radius, is {} m, and its largest, half of length, {} m",
                         region.inner, region.length / 2);
    return region;
}

float single_stretch(const PathRegion& region) {
    constexpr double kLeast = 1e-18, kMost = 1e18;
    return static_cast<float>(std::clamp(region.stretch, kLeast, kMost));
}

double farthest_coordinate(const PathsSpec& paths, const PathRegion& region) {
    constexpr double kPeak = 6; // of a sum of harmonics, in root mean squares, and more
    const double reach = 0.5 * (region.length + region.width);
    const double shaken = kPeak * largest(paths.tremor_amplitude);
    const double depth = std::max(largest(paths.depth), paths.depth_back ? largest(*paths.depth_back) : 0);
    const double across =
        std::max(std::abs(region.centre[0]), std::abs(region.centre[1])) + reach + largest(paths.offset);
    const double up = std::abs(region.height) + depth + std::max(paths.lift.value_or(0), depth);
    const double away = paths.closed() ? region.bound + std::abs(paths.start_depth) : 0;
    return std::max(across, up) + shaken + away;
}

namespace {

constexpr std::uint32_t low(std::uint64_t word) {
    return static_cast<std::uint32_t>(word);
}
constexpr std::uint32_t high(std::uint64_t word) {
    return static_cast<std::uint32_t>(word >> 32);
}

// 53 bits, in the middle of their interval.
double between(std::uint32_t one, std::uint32_t other) {
    const std::uint64_t bits = (std::uint64_t(one) << 20) ^ (other >> 12);
    return (static_cast<double>(bits) + 0.5) * 0x1p-52;
}

} // namespace

PathDraws::PathDraws(std::uint64_t seed, std::uint64_t path) {
    const auto words = reference::philox({low(path), high(path), 0, 0}, {low(seed), high(seed)});
    key_ = {words[0], words[1]};
}

std::array<std::uint32_t, 4> PathDraws::words(Draw draw, std::uint32_t index) const {
    return reference::philox({index, static_cast<std::uint32_t>(draw), 0, 0}, key_);
}

std::uint32_t PathDraws::word(Draw draw, std::uint32_t index) const {
    return words(draw, index)[0];
}

double PathDraws::uniform(Draw draw, std::uint32_t index) const {
    const auto drawn = words(draw, index);
    return between(drawn[0], drawn[1]);
}

double PathDraws::value(const Spread& spread, Draw draw, bool positive) const {
    constexpr std::uint32_t kTries = 1000;
    for (std::uint32_t i = 0; i < kTries; ++i) {
        const auto drawn = words(draw, i);
        const double share = between(drawn[0], drawn[1]);
        double value = spread.value;
        if (spread.shape == Spread::Shape::uniform)
            value = spread.low + share * (spread.high - spread.low);
        if (spread.shape == Spread::Shape::normal) // Box & Muller 1958
            value += spread.sd * std::sqrt(-2 * std::log(share)) *
                     std::cos(2 * std::numbers::pi * between(drawn[2], drawn[3]));
        if (!positive || value > 0)
            return value;
    }
    return 0;
}

namespace {

constexpr std::uint32_t kWalk = 16, kTremor = 4;
constexpr double kSpread = 0.2; // of the tremor's frequency, either way

bool trembles(const Spread& amplitude) {
    if (amplitude.shape == Spread::Shape::uniform)
        return amplitude.high > 0;
    return amplitude.value > 0 || amplitude.sd > 0;
}

// A random walk's band: root mean squares, m, frequencies as shares of the edge, and the edge.
struct Band {
    std::array<double, 2> sizes{};
    std::array<std::array<double, kWalk>, 2> shares{};
    double edge = 0; /* turns a sample */
};

// The shares are drawn first; the edge is where the speed comes out.
Band walk_band(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    Band band;
    band.sizes = {region.length / std::sqrt(8.0), region.width / std::sqrt(8.0)};
    const double speed = draws.value(paths.speed, Draw::speed, true);
    double square = 0; /* m^2: of the speed over the edge's angular frequency */
    for (std::uint32_t i = 0; i < kWalk; ++i)
        for (std::uint32_t axis = 0; axis < 2; ++axis) {
            band.shares[axis][i] = (i + draws.uniform(Draw::walk_frequency, 2 * i + axis)) / kWalk;
            square += std::pow(band.sizes[axis] * band.shares[axis][i], 2) / kWalk;
        }
    band.edge = square > 0 ? speed / (2 * std::numbers::pi * std::sqrt(square) * paths.rate) : 0;
    return band;
}

Harmonics random_walk(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    const Band band = walk_band(paths, region, draws);
    Harmonics harmonics(kWalk);
    for (std::uint32_t i = 0; i < kWalk; ++i)
        for (std::uint32_t axis = 0; axis < 2; ++axis)
            harmonics[i][axis] = {band.sizes[axis] * std::sqrt(2.0 / kWalk), draws.word(Draw::walk_phase, 2 * i + axis),
                                  phase_of_turns(band.edge * band.shares[axis][i])};
    return harmonics;
}

Harmonics tremor(const PathsSpec& paths, const PathDraws& draws) {
    const double size = draws.value(paths.tremor_amplitude, Draw::tremor_amplitude, true); /* m, rms */
    Harmonics harmonics(kTremor);
    for (std::uint32_t i = 0; i < kTremor; ++i)
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            const double share = (i + draws.uniform(Draw::tremor_frequency, 3 * i + axis)) / kTremor;
            const double frequency = paths.tremor_frequency * (1 + kSpread * (2 * share - 1));
            harmonics[i][axis] = {size * std::sqrt(2.0 / kTremor), draws.word(Draw::tremor_phase, 3 * i + axis),
                                  phase_of_turns(frequency / paths.rate)};
        }
    return harmonics;
}

} // namespace

std::uint32_t harmonic_count(const PathsSpec& paths) {
    if (paths.kind == PathKind::random_walk)
        return kWalk;
    return paths.kind != PathKind::recorded && trembles(paths.tremor_amplitude) ? kTremor : 0;
}

double highest_tremor(const PathsSpec& paths) {
    return (1 + kSpread) * paths.tremor_frequency;
}

double walk_edge(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    return walk_band(paths, region, draws).edge;
}

Harmonics path_harmonics(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    if (paths.kind == PathKind::random_walk)
        return random_walk(paths, region, draws);
    return harmonic_count(paths) > 0 ? tremor(paths, draws) : Harmonics{};
}

namespace {

constexpr double kMostRun = 1e9; // samples: as a whole number it is still one in 32 bits

using Motion = layout::MotionParams<double>;

std::uint32_t samples_of(double count) {
    return count > 0 ? static_cast<std::uint32_t>(std::clamp(std::round(count), 1.0, kMostRun)) : 1u;
}

// A unit vector; along an axis it has no part of the other.
void set_heading(double angle, Motion& motion) {
    constexpr double kNothing = 1e-15;
    const double x = std::cos(angle), y = std::sin(angle);
    motion.heading_x = std::abs(x) < kNothing ? 0 : x;
    motion.heading_y = std::abs(y) < kNothing ? 0 : y;
}

// The lift of a path of taps, m.
double lift_of(const PathsSpec& paths, double depth) {
    return paths.lift.value_or(std::abs(depth));
}

// The length of a round, there and back or once about, m; 0 for what has none.
double round_length(const PathsSpec& paths, const PathRegion& region, double depth) {
    switch (paths.kind) {
    case PathKind::strokes:
    case PathKind::raster:
        return 2 * region.length;
    case PathKind::circle:
    case PathKind::spiral:
        return std::numbers::pi * region.length;
    case PathKind::taps:
        return 2 * std::abs(depth + lift_of(paths, depth));
    case PathKind::minimum_jerk:
        return 2 * mean_distance(region.length, region.width);
    case PathKind::random_walk:
    case PathKind::recorded:
        break;
    }
    return 0;
}

void set_kind(const PathsSpec& paths, const PathRegion& region, const PathPace& pace, Motion& motion) {
    const double lines = static_cast<double>(paths.lines);
    switch (paths.kind) {
    case PathKind::raster:
        motion.lines = static_cast<std::uint32_t>(paths.lines);
        motion.run = samples_of(region.length / pace.speed * paths.rate);
        motion.turn = samples_of((lines > 1 ? region.width / (lines - 1) : 0) / pace.speed * paths.rate);
        return;
    case PathKind::minimum_jerk:
        motion.run = samples_of(mean_distance(region.length, region.width) / pace.speed * paths.rate);
        return;
    case PathKind::spiral:
        motion.across = region.inner;
        motion.radius_step = phase_of_turns(pace.turns / (2 * lines));
        break;
    case PathKind::taps:
        motion.lift = lift_of(paths, motion.depth);
        break;
    case PathKind::strokes:
    case PathKind::circle:
    case PathKind::random_walk:
    case PathKind::recorded:
        break;
    }
    motion.phase_step = phase_of_turns(pace.turns);
}

} // namespace

std::uint32_t phase_of_turns(double turns) {
    if (!std::isfinite(turns))
        return 0;
    constexpr double kRounding = 0x1p-17; // of a share in 2^-32 turns
    const double share = (turns - std::floor(turns)) * 0x1p32, nearest = std::round(share);
    return static_cast<std::uint32_t>(
        static_cast<std::uint64_t>(std::abs(share - nearest) <= kRounding ? nearest : std::ceil(share)));
}

double mean_distance(double side, double other) {
    constexpr double kThin = 1e-4; // below it the formula cancels, and the rectangle is a line
    const double a = std::max(side, other), b = std::min(side, other);
    if (!(b > kThin * a))
        return a / 3;
    const double r = b / a, d = std::sqrt(1 + r * r); // in units of the longer side
    return a / 15 *
           (1 / (r * r) + r * r * r + d * (3 - r * r - 1 / (r * r)) +
            2.5 * (r * r * std::log((1 + d) / r) + std::log((r + d) / 1) / r));
}

PathPace path_pace(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    const double speed = draws.value(paths.speed, Draw::speed, true);
    const double depth = paths.drive == PathDrive::depth ? draws.value(paths.depth, Draw::depth) : 0;
    const double length = round_length(paths, region, depth);
    return {speed, length > 0 ? speed / (length * paths.rate) : 0};
}

layout::MotionParams<double> path_motion(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    Motion motion{};
    const double offset = draws.value(paths.offset, Draw::offset);
    set_heading(draws.value(paths.heading, Draw::heading), motion);
    motion.centre_x = region.centre[0] - offset * motion.heading_y;
    motion.centre_y = region.centre[1] + offset * motion.heading_x;
    motion.centre_z = region.height;
    motion.reach = region.length / 2;
    motion.across = region.width / 2;
    if (paths.drive == PathDrive::depth) {
        motion.depth = draws.value(paths.depth, Draw::depth);
        motion.depth_back = paths.depth_back ? draws.value(*paths.depth_back, Draw::depth_back) : motion.depth;
    }
    motion.run = motion.turn = motion.lines = 1;
    motion.key_low = draws.key()[0];
    motion.key_high = draws.key()[1];
    set_kind(paths, region, path_pace(paths, region, draws), motion);
    return motion;
}

bool paths_differ(const PathsSpec& paths) {
    const auto varies = [](const Spread& spread) {
        return spread.shape == Spread::Shape::normal ? spread.sd > 0 : spread.low < spread.high;
    };
    const bool drawn = paths.kind == PathKind::random_walk || paths.kind == PathKind::minimum_jerk;
    const bool deep =
        paths.drive == PathDrive::depth && (varies(paths.depth) || (paths.depth_back && varies(*paths.depth_back)));
    return drawn || deep || varies(paths.speed) || varies(paths.heading) || varies(paths.offset);
}

template <typename T> layout::MotionParams<T> rounded_motion(const layout::MotionParams<double>& motion) {
    const auto real = [](double value) { return static_cast<T>(value); };
    return {real(motion.centre_x),
            real(motion.centre_y),
            real(motion.centre_z),
            real(motion.heading_x),
            real(motion.heading_y),
            real(motion.reach),
            real(motion.across),
            real(motion.depth),
            real(motion.depth_back),
            real(motion.lift),
            motion.phase,
            motion.phase_step,
            motion.radius_phase,
            motion.radius_step,
            motion.run,
            motion.turn,
            motion.lines,
            motion.key_low,
            motion.key_high,
            0};
}

template layout::MotionParams<float> rounded_motion<float>(const layout::MotionParams<double>&);
template layout::MotionParams<double> rounded_motion<double>(const layout::MotionParams<double>&);

} // namespace forceshade
