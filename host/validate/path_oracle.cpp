#include "host/validate/path_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "host/norm.h"
#include "host/reference/contact.h"
#include "host/reference/hand.h"
#include "host/reference/paths.h"
#include "host/validate/chosen_paths.h"

namespace forceshade {
namespace {

using Places = std::array<double, 3>;

template <typename T> Places vector_of(std::span<const T> values, std::size_t at) {
    return {double(values[3 * at]), double(values[3 * at + 1]), double(values[3 * at + 2])};
}

double apart(const Places& a, const Places& b) {
    return norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

template <typename Value>
bool same(std::span<const Value> computed, std::size_t at, std::span<const Value> alike, std::size_t other,
          std::size_t components) {
    return computed.empty() ||
           std::memcmp(&computed[components * at], &alike[components * other], components * sizeof(Value)) == 0;
}

} // namespace

// The rows are copies: the oracle's chunks die with their callback.
template <typename T> struct PathOracle<T>::Batch {
    std::size_t first = 0, count = 0;
    std::vector<std::size_t> chosen; // paths
    std::vector<layout::uint> steps;
    std::vector<T> position, force, depth, proxy;
    std::vector<layout::uint> facet;
    std::vector<layout::PathMetrics<T>> metrics;

    PathRows<T> rows(std::size_t pitch) const {
        return {first, chosen.size(), pitch, steps, position, force, depth, facet, proxy};
    }
};

template <typename T>
PathOracle<T>::PathOracle(const layout::PathInput<T>& input, bool exact_bits, std::uint64_t most)
    : input_(input), exact_bits_(exact_bits) {
    const std::uint64_t samples = std::uint64_t(input.paths) * input.steps;
    every_ = most == 0 ? 1 : std::max<std::uint64_t>(1, (samples + most - 1) / most);
}

template <typename T> PathOracle<T>::~PathOracle() = default;

template <typename T> void PathOracle<T>::note(const std::string& text) {
    if (error_.first.empty())
        error_.first = text;
}

template <typename T> void PathOracle<T>::evaluate(std::size_t first, std::size_t count) {
    batch_ = std::make_unique<Batch>();
    batch_->first = first;
    batch_->count = count;
    for (std::size_t path = (first + every_ - 1) / every_ * every_; path < first + count; path += every_)
        batch_->chosen.push_back(path);
    if (batch_->chosen.empty())
        return;
    ChosenPaths<T> paths(input_, batch_->chosen);
    std::vector<layout::HandParams<T>> hands(input_.hands.begin(), input_.hands.end());
    if (hands.size() > 1) {
        hands.clear();
        for (const std::size_t path : batch_->chosen)
            hands.push_back(input_.hands[path]);
    }
    BatchedSource<T> source(paths, input_.steps, batch_->chosen.size());
    layout::PathInput<T> some = input_;
    some.paths = batch_->chosen.size();
    some.hands = hands;
    some.source = &source;
    RowGatherer<T> gatherer(source, some.steps, [&](const PathRows<T>& rows) {
        batch_->position.assign(rows.position.begin(), rows.position.end());
        batch_->force.assign(rows.force.begin(), rows.force.end());
        batch_->depth.assign(rows.depth.begin(), rows.depth.end());
        batch_->facet.assign(rows.facet.begin(), rows.facet.end());
        batch_->proxy.assign(rows.proxy.begin(), rows.proxy.end());
    });
    reference::evaluate_paths<T>(
        some, {}, [&](const layout::PathChunk<T>& chunk) { gatherer.add(chunk); },
        [&](std::size_t, std::span<const layout::PathMetrics<T>> metrics) {
            batch_->metrics.assign(metrics.begin(), metrics.end());
            batch_->steps.assign(source.lengths().begin(), source.lengths().end());
        });
}

template <typename T> void PathOracle<T>::compare(const PathRows<T>& rows) {
    evaluate(rows.path_first, rows.path_count);
    const PathRows<T> alike = batch_->rows(rows.pitch);
    for (std::size_t i = 0; i < batch_->chosen.size(); ++i) {
        mesh_off_ = 0;
        const std::size_t path = batch_->chosen[i] - rows.path_first;
        for (std::size_t step = 0; step < rows.steps[path]; ++step)
            compare_sample(rows, path, step, alike, i);
        if (100 * mesh_off_ > rows.steps[path]) {
            error_.beyond += mesh_off_;
            note(fmt::format("path {}: {} of {} forces differ", batch_->chosen[i], mesh_off_, rows.steps[path]));
        }
    }
}

template <typename T>
void PathOracle<T>::compare_sample(const PathRows<T>& rows, std::size_t path, std::size_t step,
                                   const PathRows<T>& alike, std::size_t chosen) {
    const std::size_t at = path * rows.pitch + step, other = chosen * rows.pitch + step;
    ++error_.samples;
    const Places force = vector_of(rows.force, at), expected = vector_of(alike.force, other);
    const double off = apart(force, expected);
    error_.largest = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(error_.largest, off);
    error_.largest_force = std::max(error_.largest_force, norm(expected[0], expected[1], expected[2]));
    if (same(rows.force, at, alike.force, other, 3) && same(rows.position, at, alike.position, other, 3) &&
        same(rows.proxy, at, alike.proxy, other, 3) && same(rows.depth, at, alike.depth, other, 1) &&
        same(rows.facet, at, alike.facet, other, 1))
        return;
    ++error_.differing;
    bool beyond = exact_bits_;
    if (!exact_bits_) {
        const Places place = vector_of(rows.position, at), meant = vector_of(alike.position, other);
        const bool open = input_.features.loop == layout::kLoopOpen;
        beyond = open && apart(place, meant) > 1e-5 * (norm(meant[0], meant[1], meant[2]) + 1e-3);
        if (input_.law.features.surface == layout::kSurfaceMesh)
            mesh_off_ += open && !(off <= 1e-3 * error_.largest_force);
        else
            beyond = beyond || is_beyond(rows, at);
    }
    if (!beyond)
        return;
    ++error_.beyond;
    note(fmt::format("path {}, step {}: force ({:.9g}, {:.9g}, {:.9g}) N, the oracle says ({:.9g}, {:.9g}, {:.9g}) N",
                     rows.path_first + path, step, force[0], force[1], force[2], expected[0], expected[1],
                     expected[2]));
}

// What was felt at the very position where it was felt: 1e-4 of it, or of what 1 um of stiffness gives, is more than
// any chain of roundings, and less than any error of a law.
template <typename T> bool PathOracle<T>::is_beyond(const PathRows<T>& rows, std::size_t at) const {
    const reference::Vector<T> probe{rows.position[3 * at], rows.position[3 * at + 1], rows.position[3 * at + 2]};
    reference::Vector<T> force = reference::evaluate(input_.law, probe).force;
    if (input_.features.loop == layout::kLoopClosed)
        force = reference::commanded(input_.hands.front(), force);
    const Places expected{double(force.x), double(force.y), double(force.z)}, felt = vector_of(rows.force, at);
    const double size = norm(expected[0], expected[1], expected[2]);
    return !(apart(felt, expected) <= 1e-4 * size + 1e-6 * double(input_.law.params.stiffness)) &&
           norm(felt[0], felt[1], felt[2]) > 0; // a probe that left feels nothing
}

template <typename T>
bool PathOracle<T>::metrics_differ(const layout::PathMetrics<T>& computed, const layout::PathMetrics<T>& alike) const {
    if (std::memcmp(&computed, &alike, sizeof computed) == 0)
        return false;
    if (exact_bits_)
        return true;
    return input_.features.loop == layout::kLoopOpen &&
           std::abs(double(computed.work) - double(alike.work)) > 1e-3 * double(alike.effort);
}

template <typename T> void PathOracle<T>::compare(std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
    if (!batch_ || batch_->first != first || batch_->count != metrics.size())
        evaluate(first, metrics.size());
    for (std::size_t i = 0; i < batch_->chosen.size(); ++i) {
        ++error_.paths;
        if (input_.features.channels == 0)
            error_.samples += batch_->steps[i];
        if (!metrics_differ(metrics[batch_->chosen[i] - first], batch_->metrics[i]))
            continue;
        ++error_.metrics;
        note(fmt::format("path {}: its metrics differ", batch_->chosen[i]));
    }
    batch_.reset();
}

template class PathOracle<float>;
template class PathOracle<double>;

} // namespace forceshade
