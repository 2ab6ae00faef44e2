// What is remembered of a path, step for step as shaders/laws/path_metrics.glsl.
#pragma once

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

/// Two samples in a row, both in contact: how far the force turned between them.
template <typename T>
void add_turn(layout::PathMetrics<T>& metrics, const Vector<T>& from, const Vector<T>& to,
              const Vector<T>& way) noexcept {
    const Vector<T> one = normalised(from), other = normalised(to);
    if (!(dot(one, one) > T(0)) || !(dot(other, other) > T(0)))
        return;
    const Vector<T> turn = other - one;
    const T square = dot(turn, turn), length = dot(way, way);
    metrics.largest_turn = square > metrics.largest_turn ? square : metrics.largest_turn;
    const T steepness = length > T(0) ? square / length : T(0);
    metrics.steepest_turn = steepness > metrics.steepest_turn ? steepness : metrics.steepest_turn;
}

/// Work, J, that the device did on the hand between two samples.
template <typename T> void add_work(layout::PathMetrics<T>& metrics, T work) noexcept {
    add_to(metrics.work, metrics.work_rest, work);
    add_to(metrics.effort, metrics.effort_rest, std::abs(work));
}

template <typename T> void end_round(layout::PathMetrics<T>& metrics) noexcept {
    const T round = metrics.work - metrics.round_begin;
    if (metrics.rounds == 0 || std::abs(round) > std::abs(metrics.largest_round))
        metrics.largest_round = round;
    metrics.round_begin = metrics.work;
    metrics.rounds_end = metrics.work;
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
