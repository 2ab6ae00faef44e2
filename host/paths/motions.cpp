#include "host/paths/motions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forceshade {
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

void set_raster(const PathsSpec& paths, const PathRegion& region, double speed, Motion& motion) {
    motion.lines = static_cast<std::uint32_t>(paths.lines);
    motion.run = samples_of(region.length / speed * paths.rate);
    const double between = paths.lines > 1 ? region.width / static_cast<double>(paths.lines - 1) : 0; /* m */
    motion.turn = samples_of(between / speed * paths.rate);
}

void set_spiral(const PathsSpec& paths, const PathRegion& region, double turns, Motion& motion) {
    motion.across = region.inner;
    motion.radius_step = phase_of_turns(turns / (2 * static_cast<double>(paths.lines)));
}

// The way there and back, or once about, m; 0 for what has none.
double round_way(const PathsSpec& paths, const PathRegion& region, double depth) {
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
    switch (paths.kind) {
    case PathKind::raster:
        return set_raster(paths, region, pace.speed, motion);
    case PathKind::minimum_jerk:
        motion.run = samples_of(mean_distance(region.length, region.width) / pace.speed * paths.rate);
        return;
    case PathKind::spiral:
        set_spiral(paths, region, pace.turns, motion);
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
    const double way = round_way(paths, region, depth);
    return {speed, way > 0 ? speed / (way * paths.rate) : 0};
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
