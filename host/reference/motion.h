// The intended motion of a path: random numbers by counter, where it is at a step, and where its rounds end. Step for
// step as shaders/laws/motion.glsl.
#pragma once

#include <array>

#include "host/reference/elementary.h"
#include "host/reference/surfaces.h"
#include "shaders/shared/law.h"

namespace forceshade::reference {

/// Four random words for a key and a counter, the same wherever they are drawn (Philox 4x32-10: Salmon, Moraes, Dror &
/// Shaw 2011).
inline std::array<layout::uint, 4> philox(std::array<layout::uint, 4> counter,
                                          std::array<layout::uint, 2> key) noexcept {
    constexpr int kRounds = 10;
    for (int i = 0; i < kRounds; ++i) {
        const std::uint64_t one = std::uint64_t(0xD2511F53U) * counter[0];
        const std::uint64_t other = std::uint64_t(0xCD9E8D57U) * counter[2];
        counter = {static_cast<layout::uint>(other >> 32) ^ counter[1] ^ key[0], static_cast<layout::uint>(other),
                   static_cast<layout::uint>(one >> 32) ^ counter[3] ^ key[1], static_cast<layout::uint>(one)};
        key[0] += 0x9E3779B9U;
        key[1] += 0xBB67AE85U;
    }
    return counter;
}

// Where the motion is at a step. Phases are whole numbers: they do not drift, and a step needs none before it.

/// A place in the motion's own frame, m: along the heading, to its left, and above the surface.
template <typename T> struct Place { T along = T(0), across = T(0), above = T(0); };

/// -1 at phase 0, 1 half a turn later, straight in between.
template <typename T> T triangle_wave(layout::uint phase) noexcept {
    const layout::uint folded = phase < layout::kHalfTurn ? phase : 0U - phase;
    return T(static_cast<std::int32_t>(folded - layout::kQuarterTurn)) * T(0x1p-30);
}

template <typename T> T cosine_of_phase(layout::uint phase) noexcept {
    return cosine_of_turns(T(static_cast<std::int32_t>(phase)) * T(0x1p-32));
}

/// The share of the distance from point to point after a share of the time: 10 t^3 - 15 t^4 + 6 t^5.
template <typename T> T minimum_jerk(T t) noexcept {
    return t * t * t * (T(10) + t * (t * T(6) - T(15)));
}

template <typename T> Place<T> stroke_place(const layout::MotionParams<T>& motion, layout::uint phase) noexcept {
    const T depth = phase < layout::kHalfTurn ? motion.depth : motion.depth_back;
    return {motion.reach * triangle_wave<T>(phase), T(0), -depth};
}

/// The lines of a raster are walked there and back: 0, 1, ... lines - 1, ... 1, 0, 1, ...
template <typename T> Place<T> raster_place(const layout::MotionParams<T>& motion, layout::uint step) noexcept {
    const layout::uint pitch = motion.run + motion.turn;
    const layout::uint index = step / pitch, within = step - index * pitch;
    const layout::uint last = motion.lines - 1;
    const auto line = [&](layout::uint i) {
        const layout::uint folded = last > 0 ? i % (2 * last) : 0;
        const layout::uint one = folded > last ? 2 * last - folded : folded;
        return last > 0 ? T(static_cast<std::int32_t>(2 * one)) / T(static_cast<std::int32_t>(last)) - T(1) : T(0);
    };
    const bool running = within < motion.run;
    const T share = running ? T(static_cast<std::int32_t>(within)) / T(static_cast<std::int32_t>(motion.run)) : T(1);
    const T turned =
        running ? T(0) : T(static_cast<std::int32_t>(within - motion.run)) / T(static_cast<std::int32_t>(motion.turn));
    const T along = share * T(2) - T(1);
    const T here = line(index), next = line(index + 1);
    return {motion.reach * ((index & 1) == 0 ? along : -along), motion.across * (here + turned * (next - here)),
            -motion.depth};
}

template <typename T>
Place<T> round_place(const layout::MotionParams<T>& motion, T radius, layout::uint phase) noexcept {
    return {radius * cosine_of_phase<T>(phase), radius * cosine_of_phase<T>(phase - layout::kQuarterTurn),
            -motion.depth};
}

template <typename T> Place<T> tap_place(const layout::MotionParams<T>& motion, layout::uint phase) noexcept {
    const T share = T(0.5) * (T(1) + cosine_of_phase<T>(phase));
    return {T(0), T(0), (motion.depth + motion.lift) * share - motion.depth};
}

/// The point number `index` of a path, anywhere within the region, in shares of its half sides.
template <typename T> Place<T> via_point(const layout::MotionParams<T>& motion, layout::uint index) noexcept {
    const std::array<layout::uint, 4> words = philox({index, 1U, 0U, 0U}, {motion.key_low, motion.key_high});
    return {T(static_cast<std::int32_t>(words[0])) * T(0x1p-31), T(static_cast<std::int32_t>(words[1])) * T(0x1p-31),
            T(0)};
}

template <typename T> Place<T> minimum_jerk_place(const layout::MotionParams<T>& motion, layout::uint step) noexcept {
    const layout::uint index = step / motion.run, within = step - index * motion.run;
    const T share = minimum_jerk(T(static_cast<std::int32_t>(within)) / T(static_cast<std::int32_t>(motion.run)));
    const Place<T> from = via_point(motion, index), to = via_point(motion, index + 1);
    return {motion.reach * (from.along + share * (to.along - from.along)),
            motion.across * (from.across + share * (to.across - from.across)), -motion.depth};
}

template <typename T>
Place<T> place_at(layout::uint kind, const layout::MotionParams<T>& motion, layout::uint step) noexcept {
    const layout::uint phase = motion.phase + step * motion.phase_step;
    switch (kind) {
    case layout::kMotionStrokes:
        return stroke_place(motion, phase);
    case layout::kMotionRaster:
        return raster_place(motion, step);
    case layout::kMotionCircle:
        return round_place(motion, motion.reach, phase);
    case layout::kMotionSpiral: {
        const T share = T(0.5) * (T(1) + triangle_wave<T>(motion.radius_phase + step * motion.radius_step));
        return round_place(motion, motion.across + share * (motion.reach - motion.across), phase);
    }
    case layout::kMotionTaps:
        return tap_place(motion, phase);
    case layout::kMotionMinimumJerk:
        return minimum_jerk_place(motion, step);
    default:
        return {T(0), T(0), -motion.depth};
    }
}

/// Harmonic motions added to path number `path` of a batch: the whole of a random walk, the tremor of others.
template <typename T>
Vector<T> harmonics_at(const layout::PathBatch<T>& batch, std::size_t path, layout::uint harmonics,
                       layout::uint step) noexcept {
    Vector<T> sum(T(0));
    for (layout::uint i = 0; i < harmonics; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t at = (std::size_t(i) * 3 + std::size_t(axis)) * batch.count + path;
            sum[axis] += batch.amplitudes[at] * cosine_of_phase<T>(batch.phases[at] + step * batch.phase_steps[at]);
        }
    return sum;
}

/// A random walk turns round where it reaches the edge of its region, half a side, m, from the middle: its harmonics
/// reach 4 half sides at most.
template <typename T> T reflected(T place, T half) noexcept {
    for (int i = 0; i < 2; ++i)
        place = place > half ? T(2) * half - place : place < -half ? T(-2) * half - place : place;
    return place;
}

/// The nominal surface, m, from which a motion that follows it measures its depth.
template <typename T> T nominal_height(const layout::Law<T>& law, T x) noexcept {
    if (law.features.surface == layout::kSurfaceBump)
        return facet_at(law, x).height;
    if (law.features.surface == layout::kSurfaceCylinderBump && std::abs(x) < law.params.half_width)
        return cylinder_height(law.params.half_width, law.params.radius, law.params.centre_depth, x);
    return T(0);
}

/// A place in the world, m, plus the displacement `more`; one that follows the surface lies the nominal height above
/// it.
template <typename T>
Vector<T> in_world(const layout::Law<T>& law, const layout::PathFeatures& features,
                   const layout::MotionParams<T>& motion, const Place<T>& place, const Vector<T>& more) noexcept {
    Vector<T> point{motion.centre_x + (place.along * motion.heading_x - place.across * motion.heading_y) + more.x,
                    motion.centre_y + (place.along * motion.heading_y + place.across * motion.heading_x) + more.y,
                    motion.centre_z + place.above + more.z};
    if (features.follow == layout::kFollowSurface)
        point.z += nominal_height(law, point.x);
    return point;
}

/// The intended place of the probe at a step, m.
template <typename T>
Vector<T> motion_at(const layout::Law<T>& law, const layout::PathFeatures& features, const layout::PathBatch<T>& batch,
                    std::size_t path, layout::uint step) noexcept {
    const layout::MotionParams<T>& motion = batch.motions[path];
    Vector<T> more = harmonics_at(batch, path, features.harmonics, step);
    if (features.motion == layout::kMotionRandomWalk) {
        more.x = reflected(more.x, motion.reach);
        more.y = reflected(more.y, motion.across);
    }
    return in_world(law, features, motion, place_at(features.motion, motion, step), more);
}

/// Where rounds begin and end, tremor left out, m.
template <typename T>
Vector<T> round_end(const layout::Law<T>& law, const layout::PathFeatures& features,
                    const layout::MotionParams<T>& motion) noexcept {
    return in_world(law, features, motion, place_at(features.motion, motion, 0U), Vector<T>(T(0)));
}

/// Since the beginning of the path, when the work that a step adds begins.
template <typename T>
layout::uint phase_of_work(const layout::PathFeatures& features, const layout::MotionParams<T>& motion,
                           layout::uint step) noexcept {
    return (features.loop == layout::kLoopOpen ? step - 1 : step) * motion.phase_step;
}

/// Whether the work that a step adds completes a round of the motion (there and back, once about, a tap): in open loop
/// the work since the step before, in closed loop that until the next.
template <typename T>
bool completes_round(const layout::PathFeatures& features, const layout::MotionParams<T>& motion,
                     layout::uint step) noexcept {
    const layout::uint kind = features.motion;
    const bool never = kind == layout::kMotionRaster || kind == layout::kMotionRandomWalk ||
                       kind == layout::kMotionMinimumJerk || kind == layout::kMotionRecorded;
    const bool goes = motion.phase_step != 0 && motion.phase_step < layout::kHalfTurn; // beyond, it seems to go back
    if (never || !goes || (features.loop == layout::kLoopOpen && step == 0))
        return false;
    const layout::uint phase = phase_of_work(features, motion, step);
    return layout::uint(phase + motion.phase_step) < phase;
}

/// Of the step whose work completes a round, the share of time after the round is complete.
template <typename T>
T late_share(const layout::PathFeatures& features, const layout::MotionParams<T>& motion, layout::uint step) noexcept {
    const layout::uint late = phase_of_work(features, motion, step) + motion.phase_step;
    const T per_phase_step = T(1) / T(static_cast<std::int32_t>(motion.phase_step));
    return T(static_cast<std::int32_t>(late)) * per_phase_step;
}

/// Whether a round ends at round_end(); a spiral does not come back to where it was, nor a probe that a
/// hand moves.
inline bool ends_at_a_place(const layout::PathFeatures& features) noexcept {
    return features.loop == layout::kLoopOpen &&
           (features.motion == layout::kMotionStrokes || features.motion == layout::kMotionCircle ||
            features.motion == layout::kMotionTaps);
}

} // namespace forceshade::reference
