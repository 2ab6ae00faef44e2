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

/// A path before its first step; `target` is the motion's first place, m.
template <typename T>
layout::PathState<T> begin_state(const layout::PathFeatures& features, const layout::HandParams<T>& hand,
                                 const Vector<T>& target) noexcept {
    layout::PathState<T> state{};
    const T sunk = features.loop == layout::kLoopClosed ? hand.start_depth : T(0);
    state.x = state.measured_x = target.x;
    state.y = state.measured_y = target.y;
    state.z = state.measured_z = target.z - sunk;
    state.metrics = no_metrics<T>();
    return state;
}

/// A probe that left its bound stays where it was last, free of force.
template <typename T> PathSampled<T> left_sample(const layout::PathState<T>& state) noexcept {
    const Vector<T> place{state.measured_x, state.measured_y, state.measured_z};
    return {place, Vector<T>(T(0)), {T(0), Vector<T>(T(0)), Vector<T>(T(0)), place, layout::kNoFacet}};
}

/// Adds what lies between the last sample and this one.
template <typename T>
void add_between(const layout::PathState<T>& state, const PathSampled<T>& sampled, bool closed,
                 layout::PathMetrics<T>& metrics) noexcept {
    if (state.step == 0)
        return;
    const Vector<T> last{state.force_x, state.force_y, state.force_z};
    const Vector<T> way{sampled.position.x - state.measured_x, sampled.position.y - state.measured_y,
                        sampled.position.z - state.measured_z};
    if (state.touching != 0 && sampled.contact.facet != layout::kNoFacet)
        add_turn(metrics, last, sampled.force, way);
    if (!closed)
        add_work(metrics, T(0.5) * dot(Vector<T>(last + sampled.force), way));
}

/// Takes a path one step on. `target` and `next` are the motion's places at this step and the next, m; `feel(probe)`
/// evaluates the law. `ends_round`: with the work that this step adds a round of the motion is complete.
template <typename T, typename Feel>
PathSampled<T> take_step(const layout::PathFeatures& features, const layout::HandParams<T>& hand,
                         layout::PathState<T>& state, const Vector<T>& target, const Vector<T>& next, bool ends_round,
                         layout::uint steps, Feel&& feel) noexcept {
    layout::PathMetrics<T>& metrics = state.metrics;
    const bool closed = features.loop == layout::kLoopClosed;
    const Carried<T> now{{state.x, state.y, state.z}, {state.speed_x, state.speed_y, state.speed_z}};
    const Vector<T> away = now.place - target;
    if (closed && metrics.unstable_step == layout::kNever && !(dot(away, away) <= hand.bound * hand.bound))
        metrics.unstable_step = state.step;
    if (closed && metrics.unstable_step != layout::kNever) {
        ++state.step;
        return left_sample(state);
    }
    PathSampled<T> sampled;
    sampled.position = closed ? measured(hand, now.place) : target;
    const Felt<T> felt = feel(sampled.position);
    sampled.contact = felt.contact;
    sampled.force = closed ? commanded(hand, felt.contact.force) : felt.contact.force;
    add_sample(metrics, sampled.contact, sampled.force);
    metrics.unfinished += felt.finished ? 0 : 1;
    add_between(state, sampled, closed, metrics);
    if (closed) {
        const Vector<T> late{state.force_x, state.force_y, state.force_z};
        const Vector<T> applied = hand.delay != 0 ? late : sampled.force;
        const Vector<T> target_speed = (next - target) * hand.rate;
        const Carried<T> after = carried(hand, now, target, target_speed, applied);
        add_work(metrics, dot(applied, Vector<T>(after.place - now.place)));
        add_speed(metrics, after.speed, state.step, steps);
        state.x = after.place.x;
        state.y = after.place.y;
        state.z = after.place.z;
        state.speed_x = after.speed.x;
        state.speed_y = after.speed.y;
        state.speed_z = after.speed.z;
    }
    if (ends_round)
        end_round(metrics);
    state.measured_x = sampled.position.x;
    state.measured_y = sampled.position.y;
    state.measured_z = sampled.position.z;
    state.force_x = sampled.force.x;
    state.force_y = sampled.force.y;
    state.force_z = sampled.force.z;
    state.touching = sampled.contact.facet != layout::kNoFacet ? 1 : 0;
    ++state.step;
    return sampled;
}

} // namespace forceshade::reference
