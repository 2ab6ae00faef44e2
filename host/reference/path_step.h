// One step of an exploration path, open or closed loop: where the probe is, what it feels, where it goes next. Step for
// step as shaders/laws/path_step.glsl.
#pragma once

#include "host/reference/hand.h"
#include "host/reference/motion.h"
#include "host/reference/path_metrics.h"

namespace forceshade::reference {

/// What a law made of a sample.
template <typename T> struct Felt {
    Contact<T> contact;
    bool finished = true; /* the proxy came to rest */
};

/// What of a sample is written.
template <typename T> struct PathSampled {
    Vector<T> position; /* m: where the law was evaluated */
    Vector<T> force;    /* N: commanded */
    Contact<T> contact;
};

template <typename T> bool all_finite(const Vector<T>& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A path before its first step, with the probe at a place, m.
template <typename T> layout::PathState<T> state_at(const Vector<T>& place) noexcept {
    layout::PathState<T> state{};
    state.x = state.measured_x = place.x;
    state.y = state.measured_y = place.y;
    state.z = state.measured_z = place.z;
    state.metrics = no_metrics<T>();
    return state;
}

/// A path before its first step; `target` is the motion's first place, m.
template <typename T>
layout::PathState<T> begin_state(const layout::PathFeatures& features, const layout::HandParams<T>& hand,
                                 const Vector<T>& target) noexcept {
    const T sunk = features.loop == layout::kLoopClosed ? hand.start_depth : T(0);
    return state_at(Vector<T>{target.x, target.y, target.z - sunk});
}

/// A probe that left its bound stays where it was last, free of force.
template <typename T> PathSampled<T> left_sample(const layout::PathState<T>& state) noexcept {
    const Vector<T> place{state.measured_x, state.measured_y, state.measured_z};
    return {place, Vector<T>(T(0)), {T(0), Vector<T>(T(0)), Vector<T>(T(0)), place, layout::kNoFacet}};
}

/// The turn of the force up to this sample.
template <typename T> void add_turn_at(layout::PathState<T>& state, const PathSampled<T>& sampled, T stretch) noexcept {
    const Vector<T> before = normalised(Vector<T>{state.force_x, state.force_y, state.force_z});
    const Vector<T> direction = normalised(sampled.force);
    const bool directed = sampled.contact.facet != layout::kNoFacet && dot(direction, direction) > T(0);
    add_turn(state, sampled.position, before, direction, directed, stretch);
}

/// Open loop: adds the work, J, since the last sample; the first is where the path begins, and adds none.
template <typename T> T add_between(layout::PathState<T>& state, const PathSampled<T>& sampled) noexcept {
    const Vector<T> last{state.force_x, state.force_y, state.force_z};
    const Vector<T> way{sampled.position.x - state.measured_x, sampled.position.y - state.measured_y,
                        sampled.position.z - state.measured_z};
    const T work = T(0.5) * dot(Vector<T>(last + sampled.force), way);
    add_work(state.metrics, work);
    return work;
}

/// Closed loop: over the sample the hand takes the probe to where the next one begins. Adds the work, J.
template <typename T>
T carry(layout::PathState<T>& state, const layout::HandParams<T>& hand, const PathSampled<T>& sampled,
        const Vector<T>& target, const Vector<T>& next, layout::uint steps) noexcept {
    const Carried<T> now{{state.x, state.y, state.z}, {state.speed_x, state.speed_y, state.speed_z}};
    const Vector<T> late{state.force_x, state.force_y, state.force_z};
    const Vector<T> applied = hand.delay != 0 ? late : sampled.force;
    const Vector<T> target_speed = (next - target) * hand.rate;
    const Carried<T> after = carried(hand, now, target, target_speed, applied);
    const T work = dot(applied, Vector<T>(after.place - now.place));
    add_work(state.metrics, work);
    add_speed(state.metrics, after.speed, state.step, steps);
    state.x = after.place.x;
    state.y = after.place.y;
    state.z = after.place.z;
    state.speed_x = after.speed.x;
    state.speed_y = after.speed.y;
    state.speed_z = after.speed.z;
    return work;
}

/// Of the work of a step, J, within which a round of the motion ends, what comes after that. In open loop the round
/// ends where it began, so that it is closed, even where strokes turn there and change their depth; else the work is
/// linear in time.
template <typename T>
T late_work(const layout::PathInput<T>& input, const layout::MotionParams<T>& motion, const layout::PathState<T>& state,
            const PathSampled<T>& sampled, T work) noexcept {
    if (!ends_at_a_place(input.features))
        return work * late_share(input.features, motion, state.step);
    const Vector<T> forces = Vector<T>{state.force_x, state.force_y, state.force_z} + sampled.force;
    return T(0.5) * dot(forces, Vector<T>(sampled.position - round_end(input.law, input.features, motion)));
}

/// What the next sample needs of this one.
template <typename T> void keep_sample(layout::PathState<T>& state, const PathSampled<T>& sampled) noexcept {
    state.measured_x = sampled.position.x;
    state.measured_y = sampled.position.y;
    state.measured_z = sampled.position.z;
    state.force_x = sampled.force.x;
    state.force_y = sampled.force.y;
    state.force_z = sampled.force.z;
    ++state.step;
}

/// Whether the probe is beyond its bound, now or before. Then it stays where it was last, free of force.
template <typename T>
bool leaves(layout::PathState<T>& state, const layout::HandParams<T>& hand, const Vector<T>& target) noexcept {
    const Vector<T> away = Vector<T>{state.x, state.y, state.z} - target;
    if (state.metrics.unstable_step == layout::kNever && !(dot(away, away) <= hand.bound * hand.bound)) {
        state.metrics.unstable_step = state.step;
        const bool pushed = dot(Vector<T>{hand.push_x, hand.push_y, hand.push_z}, away) > T(0);
        state.metrics.fell = pushed && state.directed == 0 && state.step > 0 ? 1 : 0;
    }
    return state.metrics.unstable_step != layout::kNever;
}

/// Takes a path one step on. `target` and `next` are the motion's places at this step and the next, m; `feel(probe)`
/// evaluates the law.
template <typename T, typename Feel>
PathSampled<T> take_step(const layout::PathInput<T>& input, const layout::HandParams<T>& hand,
                         const layout::MotionParams<T>& motion, layout::PathState<T>& state, const Vector<T>& target,
                         const Vector<T>& next, layout::uint steps, Feel&& feel) noexcept {
    const bool closed = input.features.loop == layout::kLoopClosed;
    if (closed && leaves(state, hand, target)) {
        ++state.step;
        return left_sample(state);
    }
    PathSampled<T> sampled;
    sampled.position = closed ? measured(hand, Vector<T>{state.x, state.y, state.z}) : target;
    const Felt<T> felt = feel(sampled.position);
    sampled.contact = felt.contact;
    sampled.force = closed ? commanded(hand, felt.contact.force) : felt.contact.force;
    add_sample(state.metrics, sampled.contact, sampled.force);
    state.metrics.unfinished += felt.finished ? 0 : 1;
    add_turn_at(state, sampled, T(input.stretch));
    const T work = closed ? carry(state, hand, sampled, target, next, steps) : add_between(state, sampled);
    if (completes_round(input.features, motion, state.step))
        end_round(state.metrics, late_work(input, motion, state, sampled, work));
    keep_sample(state, sampled);
    return sampled;
}

} // namespace forceshade::reference
