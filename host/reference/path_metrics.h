// What is remembered of a path, step for step as shaders/laws/path_metrics.glsl.
#pragma once

#include <limits>

#include "host/reference/contact_result.h"

namespace forceshade::reference {

/// Adds to a sum that keeps what rounding takes from it (Kahan).
template <typename T> void add_to(T& sum, T& rest, T value) noexcept {
    const T corrected = value - rest;
    const T next = sum + corrected;
    rest = (next - sum) - corrected;
    sum = next;
}

template <typename T> layout::PathMetrics<T> no_metrics() noexcept {
    layout::PathMetrics<T> metrics{};
    metrics.steepest_way = T(1);
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
    add_to(metrics.depth, metrics.depth_rest, contact.depth);
    add_to(metrics.depth_square, metrics.depth_square_rest, contact.depth * contact.depth);
    ++metrics.contact_samples;
}

/// About the square of an angle from that of its chord, to tell which of two turns over ways of different length is the
/// steeper: the angle is within 4e-4 of itself up to 45 degrees, 4e-3 up to 90, 0.05 up to 180. A chord of a few
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

/// A sample's place, m, and the force's direction there and at the sample before. Its turn is counted from an anchor,
/// over the way from there but no less than a stretch; then the anchor moves on. So no way of a few roundings is
/// divided by. `directed`: in contact, and there is a force.
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
    const Vector<T> way = place - anchor;
    const T reach = dot(way, way), least = stretch * stretch, over = reach > least ? reach : least;
    const Vector<T> swing = direction - from;
    const T chord = dot(swing, swing), angle = angle_square(chord);
    if (both && angle * metrics.steepest_way > state.steepest * over) {
        metrics.steepest_turn = chord;
        metrics.steepest_way = over;
        state.steepest = angle;
    }
    if (!both || reach >= least) {
        state.anchor_x = place.x;
        state.anchor_y = place.y;
        state.anchor_z = place.z;
        state.anchor_force_x = direction.x;
        state.anchor_force_y = direction.y;
        state.anchor_force_z = direction.z;
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

/// The speed, m/s, at a step of a path of so many steps: growing oscillations show late.
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

} // namespace forceshade::reference
