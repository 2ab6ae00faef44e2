// One step of an exploration path, open or closed loop: the hand and the device over a sample (mass, damping and
// spring, stepped exactly), the state of a path, and where the probe is, the force on it and where it goes next.
// Step for step as shaders/laws/path_step.glsl.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "host/reference/elementary.h"
#include "host/reference/motion.h"
#include "host/reference/surfaces.h"
#include "shaders/shared/law.h"

namespace forceshade::reference {

/// What acts on one axis during a sample.
template <typename T> struct AxisPush {
    T error;  /* m: from the target */
    T speed;  /* m/s: at the sample's begin */
    T force;  /* N: all that is constant over the sample, friction excepted */
    T spring; /* N/m: that pulls to the target */
};

/// How an axis moves in one sample.
template <typename T> struct AxisMotion {
    T shift; /* m */
    T speed; /* m/s: at the sample's end */
};

template <typename T>
AxisMotion<T> advance_axis(const layout::AxisMap<T>& map, const AxisPush<T>& push, T force) noexcept {
    return {map.x_error * push.error + map.x_speed * push.speed + map.x_force * force,
            map.v_error * push.error + map.v_speed * push.speed + map.v_force * force};
}

/// Coulomb friction opposes the motion with a constant force. What would reverse within the sample stays
/// where it stops, as if it slowed down evenly; what rests moves only if it is pushed harder than the friction.
template <typename T>
AxisMotion<T> advance_axis_with_friction(const layout::AxisMap<T>& map, const AxisPush<T>& push, T coulomb,
                                         T period) noexcept {
    const T pull = push.force - push.spring * push.error;
    const T direction = push.speed != T(0) ? push.speed : pull;
    const bool sticks = push.speed == T(0) && !(std::abs(pull) > coulomb);
    const T friction = direction > T(0) ? coulomb : -coulomb;
    const AxisMotion<T> motion = advance_axis(map, push, push.force - friction);
    const bool turns = push.speed * motion.speed < T(0);
    const T stop = T(0.5) * period * push.speed * (push.speed / (push.speed - motion.speed));
    return {sticks ? T(0) : turns ? stop : motion.shift, sticks || turns ? T(0) : motion.speed};
}

/// The position that the device reports, m.
template <typename T> Vector<T> measured(const layout::HandParams<T>& hand, const Vector<T>& place) noexcept {
    if (!(hand.quantum > T(0)))
        return place;
    return {std::floor(place.x / hand.quantum + T(0.5)) * hand.quantum,
            std::floor(place.y / hand.quantum + T(0.5)) * hand.quantum,
            std::floor(place.z / hand.quantum + T(0.5)) * hand.quantum};
}

/// The force, N, that the device displays of the one that the law gives: no larger than it can; none if that is no
/// finite number.
template <typename T> Vector<T> commanded(const layout::HandParams<T>& hand, const Vector<T>& law_force) noexcept {
    const Vector<T> force = hand.gain * law_force;
    const T size = std::sqrt(dot(force, force));
    if (size <= hand.max_force)
        return force;
    if (!(size <= std::numeric_limits<T>::max()))
        return Vector<T>(T(0));
    const T share = hand.max_force / size;
    return share * force;
}

/// The force, N, through a virtual coupling: a spring and a damper between the device and a tool without mass, on which
/// the law acts (Colgate, Stanley & Brown 1995; Adams & Hannaford 1999). The tool is at the depth, m, where both forces
/// balance. `lag`, m: how much less deep than the probe it was at the last sample, then is now; below 0 where a path
/// begins, at rest; as the filter of the damper's speed has it, where there is one.
template <typename T>
Vector<T> through_coupling(const layout::Coupling<T>& coupling, const Vector<T>& law_force, T depth, T& lag) noexcept {
    if (!(coupling.depth > T(0)))
        return law_force;
    constexpr T kGone = T(1e-30); // m: less only makes denormal numbers
    const bool finite = depth <= std::numeric_limits<T>::max();
    const T before = lag < T(0) ? (finite ? coupling.rest * depth : T(0)) : lag;
    const T tool = coupling.depth * depth - coupling.lag * before;
    const bool touches = tool > T(0) && finite;
    const T left = coupling.free * before;
    const T filtered = coupling.kept * before + (T(1) - coupling.kept) * (depth - tool);
    lag = touches ? filtered : left > kGone ? left : T(0);
    const T share = tool / depth;
    return touches ? share * law_force : Vector<T>(T(0));
}

/// Where a probe is, and how fast.
template <typename T> struct ProbeState {
    Vector<T> place; /* m */
    Vector<T> speed; /* m/s */
};

/// Over one sample: `target` and its speed, m and m/s, and the device's force, N, stay the same.
template <typename T>
ProbeState<T> advance_hand(const layout::HandParams<T>& hand, const ProbeState<T>& now, const Vector<T>& target,
                           const Vector<T>& target_speed, const Vector<T>& force) noexcept {
    const Vector<T> push{hand.push_x, hand.push_y, hand.push_z};
    ProbeState<T> next = now;
    for (int i = 0; i < 3; ++i) {
        const layout::AxisMap<T>& map = i == 2 ? hand.vertical : hand.lateral;
        const AxisPush<T> axis{now.place[i] - target[i], now.speed[i],
                               (hand.damping * target_speed[i] + push[i]) + force[i],
                               i == 2 ? hand.stiffness_z : hand.stiffness};
        const AxisMotion<T> motion = hand.coulomb > T(0)
                                         ? advance_axis_with_friction(map, axis, hand.coulomb, hand.period)
                                         : advance_axis(map, axis, axis.force);
        next.place[i] = now.place[i] + motion.shift;
        next.speed[i] = motion.speed;
    }
    return next;
}

// The state of a path.

/// Adds to a sum that keeps what rounding takes from it (Kahan).
template <typename T> void add_to(T& sum, T& rest, T value) noexcept {
    const T corrected = value - rest;
    const T next = sum + corrected;
    rest = (next - sum) - corrected;
    sum = next;
}

template <typename T> layout::PathMetrics<T> no_metrics() noexcept {
    layout::PathMetrics<T> metrics{};
    metrics.steepest_distance = T(1);
    metrics.largest_round = -std::numeric_limits<T>::max();
    metrics.least_round = std::numeric_limits<T>::max();
    metrics.unstable_step = layout::kNever;
    return metrics;
}

/// A sample: what the law gave, and the force that is commanded, N.
template <typename T>
void add_sample(layout::PathMetrics<T>& metrics, const Contact<T>& contact, const Vector<T>& force) noexcept {
    const T square = dot(force, force);
    const T size = std::sqrt(square);
    metrics.largest_force = size > metrics.largest_force ? size : metrics.largest_force;
    add_to(metrics.force_square, metrics.force_square_rest, square);
    if (contact.facet == layout::kNoFacet)
        return;
    const bool first = metrics.contact_samples == 0;
    metrics.least_depth = first || contact.depth < metrics.least_depth ? contact.depth : metrics.least_depth;
    metrics.largest_depth = contact.depth > metrics.largest_depth ? contact.depth : metrics.largest_depth;
    metrics.first_depth = first ? contact.depth : metrics.first_depth;
    const T deeper = contact.depth - metrics.first_depth;
    add_to(metrics.depth, metrics.depth_rest, deeper);
    add_to(metrics.depth_square, metrics.depth_square_rest, deeper * deeper);
    ++metrics.contact_samples;
}

/// About the square of an angle from that of its chord, to find the steeper of two turns over different
/// distances: the angle is within 4e-4 of itself up to 45 degrees, 4e-3 up to 90, 0.05 up to 180. A chord of a few
/// roundings, as an unshaded facet has from sample to sample, is its own angle to the last bit; its powers would be
/// denormal, which many processors are slow with.
template <typename T> T angle_square(T chord_square) noexcept {
    constexpr T kLeast = std::numeric_limits<T>::epsilon();
    const bool counts = chord_square > kLeast;
    const T base = counts ? chord_square : kLeast;
    const T square = base * base;
    const T more = T(0.0890539) + T(0.00343149) * (square * base);
    return counts ? base + square * more : chord_square;
}

/// Writes a vector to where its numbers are kept.
template <typename T> void put(const Vector<T>& vector, T& x, T& y, T& z) noexcept {
    x = vector.x;
    y = vector.y;
    z = vector.z;
}

/// A sample's place, m, and the force's direction there and at the sample before. Its turn is counted from an anchor,
/// over the distance from there but no less than a stretch; then the anchor moves on. So no distance of a few roundings
/// is divided by. `directed`: in contact, and there is a force.
template <typename T>
void add_turn(layout::PathState<T>& state, const Vector<T>& place, const Vector<T>& before, const Vector<T>& direction,
              bool directed, T stretch) noexcept {
    layout::PathMetrics<T>& metrics = state.metrics;
    const bool both = state.directed != 0 && directed;
    const Vector<T> turn = direction - before;
    const T square = dot(turn, turn);
    metrics.largest_turn = both && square > metrics.largest_turn ? square : metrics.largest_turn;
    const Vector<T> anchor{state.anchor_x, state.anchor_y, state.anchor_z};
    const Vector<T> from{state.anchor_force_x, state.anchor_force_y, state.anchor_force_z};
    const Vector<T> displacement = place - anchor;
    const T reach = dot(displacement, displacement), least = stretch * stretch, over = reach > least ? reach : least;
    const Vector<T> swing = direction - from;
    const T chord = dot(swing, swing), angle = angle_square(chord);
    if (both && angle * metrics.steepest_distance > state.steepest * over) {
        metrics.steepest_turn = chord;
        metrics.steepest_distance = over;
        state.steepest = angle;
    }
    if (!both || reach >= least) {
        put(place, state.anchor_x, state.anchor_y, state.anchor_z);
        put(direction, state.anchor_force_x, state.anchor_force_y, state.anchor_force_z);
    }
    state.directed = directed ? 1 : 0;
}

/// Work, J, that the device did on the hand between two samples.
template <typename T> void add_work(layout::PathMetrics<T>& metrics, T work) noexcept {
    add_to(metrics.work, metrics.work_rest, work);
    add_to(metrics.effort, metrics.effort_rest, std::abs(work));
}

/// A round ends within a step: `late`, J, of the step's work belongs to the next one.
template <typename T> void end_round(layout::PathMetrics<T>& metrics, T late) noexcept {
    const T rest = metrics.work_rest + late;
    const T round = (metrics.work - metrics.round_begin) - (rest - metrics.round_begin_rest);
    metrics.largest_round = round > metrics.largest_round ? round : metrics.largest_round;
    metrics.least_round = round < metrics.least_round ? round : metrics.least_round;
    metrics.round_begin = metrics.work;
    metrics.round_begin_rest = rest;
    ++metrics.rounds;
}

/// The speed, m/s, at a step of a path of `steps` steps: growing oscillations show late.
template <typename T>
void add_speed(layout::PathMetrics<T>& metrics, const Vector<T>& speed, layout::uint step,
               layout::uint steps) noexcept {
    const layout::uint quarter = steps / 4;
    const T size = std::sqrt(dot(speed, speed));
    if (step >= quarter && step < 2 * quarter)
        metrics.early_speed = size > metrics.early_speed ? size : metrics.early_speed;
    if (step >= 3 * quarter)
        metrics.late_speed = size > metrics.late_speed ? size : metrics.late_speed;
}

// The step.

/// The values of a sample that are written.
template <typename T> struct PathSampled {
    Vector<T> position; /* m: where the law was evaluated */
    Vector<T> force;    /* N: commanded */
    Contact<T> contact;
};

/// A path before its first step, with the probe at a place, m.
template <typename T> layout::PathState<T> state_at(const Vector<T>& place) noexcept {
    layout::PathState<T> state{};
    state.lag = T(-1);
    put(place, state.x, state.y, state.z);
    put(place, state.measured_x, state.measured_y, state.measured_z);
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
    const Vector<T> displacement = sampled.position - Vector<T>{state.measured_x, state.measured_y, state.measured_z};
    const T work = T(0.5) * dot(Vector<T>(last + sampled.force), displacement);
    add_work(state.metrics, work);
    return work;
}

/// Closed loop: over the sample the hand takes the probe to where the next one begins. Adds the work, J.
template <typename T>
T advance_probe(layout::PathState<T>& state, const layout::HandParams<T>& hand, const PathSampled<T>& sampled,
                const Vector<T>& target, const Vector<T>& next, layout::uint steps) noexcept {
    const ProbeState<T> now{{state.x, state.y, state.z}, {state.speed_x, state.speed_y, state.speed_z}};
    const Vector<T> late{state.force_x, state.force_y, state.force_z};
    const Vector<T> applied = hand.delay != 0 ? late : sampled.force;
    const Vector<T> target_speed = (next - target) * hand.rate;
    const ProbeState<T> after = advance_hand(hand, now, target, target_speed, applied);
    const T work = dot(applied, Vector<T>(after.place - now.place));
    add_work(state.metrics, work);
    add_speed(state.metrics, after.speed, state.step, steps);
    put(after.place, state.x, state.y, state.z);
    put(after.speed, state.speed_x, state.speed_y, state.speed_z);
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

/// State for the next sample.
template <typename T> void keep_sample(layout::PathState<T>& state, const PathSampled<T>& sampled) noexcept {
    put(sampled.position, state.measured_x, state.measured_y, state.measured_z);
    put(sampled.force, state.force_x, state.force_y, state.force_z);
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

/// A path of a batch: its motion, step by step, and the hand that follows it.
template <typename T> class BatchPath {
public:
    /// `path`: within the batch; a recorded one as in follow(). Both inputs must outlive it.
    BatchPath(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch, std::size_t path,
              std::span<const T> positions = {}, std::size_t first = 0) noexcept
        : input_(input), batch_(batch), path_(path), steps_(batch.steps.empty() ? input.steps : batch.steps[path]),
          recorded_(input.features.motion == layout::kMotionRecorded), open_(input.features.loop == layout::kLoopOpen),
          positions_(positions), first_(first) {}

    /// Where a recorded one is: the places of the batch from a step on, m.
    void follow(std::span<const T> positions, std::size_t first) noexcept {
        positions_ = positions;
        first_ = first;
    }
    bool recorded() const noexcept { return recorded_; }
    std::size_t steps() const noexcept { return steps_; }
    layout::HandParams<T> hand() const noexcept {
        const std::size_t hands = input_.hands.size();
        return hands == 0 ? layout::HandParams<T>{} : input_.hands[hands == 1 ? 0 : batch_.first + path_];
    }
    layout::MotionParams<T> motion() const noexcept {
        return recorded_ ? layout::MotionParams<T>{} : batch_.motions[path_];
    }
    /// The motion's place at a step, m; a recorded path rests where it ends.
    Vector<T> at(std::size_t step) const noexcept {
        if (!recorded_)
            return motion_at(input_.law, input_.features, batch_, path_, static_cast<layout::uint>(step));
        return vector_at(positions_, (std::min(step, steps_ - 1) - first_) * batch_.count + path_);
    }
    /// Its place at the step after, when it is `here`: of the last one in open loop there is none.
    Vector<T> after(std::size_t step, const Vector<T>& here) const noexcept {
        return open_ && step + 1 == steps_ ? here : at(step + 1);
    }

private:
    const layout::PathInput<T>& input_;
    const layout::PathBatch<T>& batch_;
    std::size_t path_, steps_;
    bool recorded_, open_;
    std::span<const T> positions_;
    std::size_t first_;
};

/// Takes a path one step on. `target` and `next` are the motion's places at this step and the next, m; `feel(probe)`
/// evaluates the law.
template <typename T, typename Feel>
PathSampled<T> take_step(const layout::PathInput<T>& input, const layout::HandParams<T>& hand,
                         const layout::MotionParams<T>& motion, layout::PathState<T>& state, const Vector<T>& target,
                         const Vector<T>& next, layout::uint steps, Feel&& evaluate_law) noexcept {
    const bool closed = input.features.loop == layout::kLoopClosed;
    if (closed && leaves(state, hand, target)) {
        ++state.step;
        return left_sample(state);
    }
    PathSampled<T> sampled;
    sampled.position = closed ? measured(hand, Vector<T>{state.x, state.y, state.z}) : target;
    const LawContact<T> evaluated = evaluate_law(sampled.position);
    sampled.contact = evaluated.contact;
    sampled.force = evaluated.contact.force;
    if (closed)
        sampled.force =
            commanded(hand, through_coupling(hand.coupling, sampled.force, sampled.contact.depth, state.lag));
    add_sample(state.metrics, sampled.contact, sampled.force);
    state.metrics.unfinished += evaluated.finished ? 0 : 1;
    state.metrics.trail = hashed(state.metrics.trail, evaluated.trail);
    add_turn_at(state, sampled, T(input.stretch));
    const T work = closed ? advance_probe(state, hand, sampled, target, next, steps) : add_between(state, sampled);
    if (completes_round(input.features, motion, state.step))
        end_round(state.metrics, late_work(input, motion, state, sampled, work));
    keep_sample(state, sampled);
    return sampled;
}

} // namespace forceshade::reference
