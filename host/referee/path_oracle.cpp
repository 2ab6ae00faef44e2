#include "host/referee/path_oracle.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "host/norm.h"
#include "host/program.h"
#include "host/referee/reading.h"
#include "host/reference/contact.h"
#include "host/reference/motion.h"
#include "host/reference/path_step.h"
#include "host/reference/paths.h"

namespace forceshade {

namespace {

template <typename T> constexpr double kRoundoff = double(std::numeric_limits<T>::epsilon()) / 2;

/// The law, and what the device displays of it.
template <typename T> struct DisplayedReferee {
    OracleReferee<T> oracle;
    const layout::HandParams<T>* hand;

    reference::Column<T> column(double x, double y) const { return oracle.column(x, y); }
    Reading at(const reference::Column<T>& column, double z) const {
        reference::Contact<T> contact = reference::contact_at(oracle.law, column, static_cast<T>(z));
        if (hand)
            contact.force = reference::commanded(*hand, contact.force);
        return reading_of(contact);
    }
    static layout::uint facet(const reference::Column<T>& column) { return OracleReferee<T>::facet(column); }
};

} // namespace

template <typename T>
PathBound<T>::PathBound(const PreparedCase& prepared)
    : bound_(prepared, std::is_same_v<T, float> ? Precision::f32 : Precision::f64) {}

template <typename T> double PathBound<T>::size(const layout::PathBatch<T>& one) {
    double sum = 0;
    for (const layout::MotionParams<T>& motion : one.motions)
        for (const T length : {motion.centre_x, motion.centre_y, motion.centre_z, motion.reach, motion.across,
                               motion.depth, motion.depth_back, motion.lift})
            sum += std::abs(double(length));
    for (const T amplitude : one.amplitudes)
        sum += std::abs(double(amplitude));
    return sum;
}

template <typename T>
double PathBound<T>::place(const layout::PathFeatures& features, double size, const Triple& at) const {
    if (features.motion == layout::kMotionRecorded && features.harmonics == 0)
        return 0;
    const double off = (128.0 + 2.0 * features.harmonics) * kRoundoff<T> * size; // m
    double above = 0;
    if (features.follow == layout::kFollowSurface) {
        const layout::Law<double> law = bound_.law();
        const double height = reference::nominal_height(law, at[0]);
        for (const double x : {at[0] - off, at[0] + off})
            above = std::max(above, std::abs(reference::nominal_height(law, x) - height));
        above += bound_.at(at[0], at[1], at[2]).depth;
    }
    return 2 * (std::sqrt(3.0) * off + above);
}

template <typename T>
bool PathBound<T>::allows(const layout::Law<T>& law, const layout::HandParams<T>* hand, const Reading& computed,
                          const Triple& probe, layout::uint channels) const {
    const DisplayedReferee<T> referee{{law}, hand};
    const auto [x, y, z] = probe;
    const Reading truth = referee.at(referee.column(x, y), z);
    Bound displayed;
    if (hand)
        displayed.force = displayed.magnitude =
            16 * kRoundoff<T> * norm(truth.force[0], truth.force[1], truth.force[2]);
    return !first_misfit(computed, truth, 2 * bound_.at(x, y, z) + displayed, channels) ||
           is_on_edge<T>(computed, probe, referee, bound_, 2, channels);
}

template class PathBound<float>;
template class PathBound<double>;

namespace {

template <typename T> Triple vector_of(std::span<const T> values, std::size_t at) {
    return {double(values[3 * at]), double(values[3 * at + 1]), double(values[3 * at + 2])};
}

double apart(const Triple& a, const Triple& b) {
    return norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

template <typename Value>
bool same(std::span<const Value> computed, std::size_t at, std::span<const Value> oracle, std::size_t other,
          std::size_t components) {
    return computed.empty() ||
           std::memcmp(&computed[components * at], &oracle[components * other], components * sizeof(Value)) == 0;
}

} // namespace

// Some paths of the engine's present batch, where the engine is with them.
template <typename T> struct PathOracle<T>::Batch {
    Batch(const layout::PathInput<T>& from, std::size_t first_path, std::size_t paths, std::size_t every)
        : first(first_path), count(paths), chosen(choose(first, count, every)), paths_chosen(from, chosen),
          source(paths_chosen, from.steps, chosen.size()), hands(hands_of(from, chosen)), input(from),
          mesh_off(chosen.size(), 0), positions(3 * chosen.size()) {
        input.paths = chosen.size();
        input.hands = hands;
        input.source = &source;
        if (!chosen.empty())
            walk.begin(0, chosen.size());
    }

    static std::vector<std::size_t> choose(std::size_t first, std::size_t count, std::size_t every) {
        std::vector<std::size_t> chosen;
        for (std::size_t path = (first + every - 1) / every * every; path < first + count; path += every)
            chosen.push_back(path);
        return chosen;
    }

    static std::vector<layout::HandParams<T>> hands_of(const layout::PathInput<T>& from,
                                                       const std::vector<std::size_t>& chosen) {
        if (from.hands.size() <= 1)
            return {from.hands.begin(), from.hands.end()};
        std::vector<layout::HandParams<T>> hands;
        for (const std::size_t path : chosen)
            hands.push_back(from.hands[path]);
        return hands;
    }

    std::size_t first, count;
    std::vector<std::size_t> chosen; // paths
    ChosenPaths<T> paths_chosen;
    BatchedSource<T> source;
    std::vector<layout::HandParams<T>> hands;
    layout::PathInput<T> input;
    reference::PathOptions options{};
    reference::PathWalk<T> walk{input, options};
    std::size_t step = 0;                // the next
    std::vector<std::uint64_t> mesh_off; // of each chosen path
    std::vector<double> sizes;           // m: of each chosen path's motion, where its places are held against bounds
    std::vector<T> positions;            // of each chosen path's last sample, the engine's
};

// A chosen path's sample.
template <typename T> struct PathOracle<T>::Sample {
    std::size_t chosen, path, step; // among the chosen, of all, of the path
    std::size_t at, other;          // in the engine's rows, in the oracle's chunk
};

template <typename T>
PathOracle<T>::PathOracle(const PreparedCase& prepared, const layout::PathInput<T>& input, bool exact_bits,
                          std::uint64_t most)
    : input_(input), exact_bits_(exact_bits) {
    if (!exact_bits)
        bound_.emplace(prepared);
    const std::uint64_t samples = std::uint64_t(input.paths) * input.steps;
    every_ = most == 0 ? 1 : std::max<std::uint64_t>(1, (samples + most - 1) / most);
}

template <typename T> PathOracle<T>::~PathOracle() = default;

template <typename T> void PathOracle<T>::note(const std::string& text) {
    if (error_.first.empty())
        error_.first = text;
}

template <typename T> void PathOracle<T>::begin(std::size_t first, std::size_t count) {
    batch_.reset();
    batch_ = std::make_unique<Batch>(input_, first, count, every_);
    if (exact_bits_)
        return;
    const bool recorded = input_.features.motion == layout::kMotionRecorded && input_.features.harmonics == 0;
    for (const std::size_t path : batch_->chosen)
        batch_->sizes.push_back(recorded ? 0 : PathBound<T>::size(input_.source->batch(path, 1)));
}

template <typename T> void PathOracle<T>::compare(const PathRows<T>& rows) {
    if (rows.step_first == 0)
        begin(rows.path_first, rows.path_count);
    if (batch_->chosen.empty())
        return;
    const std::size_t end = std::min(rows.step_first + rows.pitch, batch_->walk.steps());
    while (batch_->step < end) {
        const layout::PathChunk<T> oracle = batch_->walk.walk(end - batch_->step);
        compare(rows, oracle);
        batch_->step += oracle.step_count;
    }
    if (end == batch_->walk.steps())
        end_mesh_paths();
    else if (!exact_bits_ && !rows.position.empty())
        for (std::size_t i = 0; i < batch_->chosen.size(); ++i)
            std::copy_n(&rows.position[3 * ((batch_->chosen[i] - rows.path_first + 1) * rows.pitch - 1)], 3,
                        &batch_->positions[3 * i]);
}

template <typename T> void PathOracle<T>::compare(const PathRows<T>& rows, const layout::PathChunk<T>& oracle) {
    for (std::size_t i = 0; i < batch_->chosen.size(); ++i) {
        const std::size_t path = batch_->chosen[i] - rows.path_first;
        const std::size_t end = std::min<std::size_t>(oracle.step_first + oracle.step_count, rows.steps[path]);
        for (std::size_t step = oracle.step_first; step < end; ++step)
            compare_sample(rows, oracle,
                           {i, batch_->chosen[i], step, path * rows.pitch + step - rows.step_first,
                            (step - oracle.step_first) * oracle.pitch + i});
    }
}

template <typename T>
void PathOracle<T>::compare_sample(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample) {
    const auto [chosen, path, step, at, other] = sample;
    ++error_.samples;
    const bool has_force = !rows.force.empty(); // else the engine only told where there is contact
    const Triple force = has_force ? vector_of(rows.force, at) : Triple{};
    const Triple expected = has_force ? vector_of(oracle.force, other) : Triple{};
    const double off = apart(force, expected);
    error_.largest = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(error_.largest, off);
    error_.largest_force = std::max(error_.largest_force, norm(expected[0], expected[1], expected[2]));
    if (same(rows.force, at, oracle.force, other, 3) && same(rows.position, at, oracle.position, other, 3) &&
        same(rows.proxy, at, oracle.proxy, other, 3) && same(rows.depth, at, oracle.depth, other, 1) &&
        same(rows.facet, at, oracle.facet, other, 1))
        return;
    ++error_.differing;
    if (!exact_bits_ && !(has_force && differs_beyond(rows, oracle, sample, off)))
        return;
    ++error_.beyond;
    note(fmt::format("path {}, step {}: force ({:.9g}, {:.9g}, {:.9g}) N, the oracle says ({:.9g}, {:.9g}, {:.9g}) N",
                     path, step, force[0], force[1], force[2], expected[0], expected[1], expected[2]));
}

// On hardware. `off`, N: |F - F_oracle|.
template <typename T>
bool PathOracle<T>::differs_beyond(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample,
                                   double off) {
    const Triple meant = vector_of(oracle.position, sample.other);
    const bool open = input_.features.loop == layout::kLoopOpen;
    const bool elsewhere = open && !(apart(vector_of(rows.position, sample.at), meant) <=
                                     bound_->place(input_.features, batch_->sizes[sample.chosen], meant));
    if (input_.law.features.surface != layout::kSurfaceMesh)
        return elsewhere || is_beyond(rows, sample);
    batch_->mesh_off[sample.chosen] += open && !(off <= 1e-3 * error_.largest_force);
    return elsewhere;
}

template <typename T> void PathOracle<T>::end_mesh_paths() {
    for (std::size_t i = 0; i < batch_->chosen.size(); ++i) {
        const std::uint64_t off = batch_->mesh_off[i], steps = batch_->source.lengths()[i];
        if (100 * off <= steps)
            continue;
        error_.beyond += off;
        note(fmt::format("path {}: {} of {} forces differ", batch_->chosen[i], off, steps));
    }
}

// What was felt, held against the law at the very position where it was felt.
template <typename T> bool PathOracle<T>::is_beyond(const PathRows<T>& rows, const Sample& sample) {
    const bool closed = input_.features.loop == layout::kLoopClosed;
    Reading computed;
    computed.force = vector_of(rows.force, sample.at);
    layout::uint channels = layout::kChannelForce;
    if (!rows.proxy.empty()) {
        computed.proxy = vector_of(rows.proxy, sample.at);
        channels |= layout::kChannelProxy;
    }
    if (!rows.depth.empty()) {
        computed.depth = double(rows.depth[sample.at]);
        channels |= layout::kChannelDepth;
    }
    if (!rows.facet.empty()) {
        computed.facet = rows.facet[sample.at];
        channels |= layout::kChannelFacet;
    }
    const std::vector<layout::HandParams<T>>& hands = batch_->hands;
    const layout::HandParams<T>* const hand = closed ? &hands[hands.size() > 1 ? sample.chosen : 0] : nullptr;
    return !bound_->allows(input_.law, hand, computed, vector_of(rows.position, sample.at), channels) &&
           !(closed && has_left(rows, sample));
}

// A probe that left its bound stays where it was and feels nothing.
template <typename T> bool PathOracle<T>::has_left(const PathRows<T>& rows, const Sample& sample) const {
    if (sample.step == 0)
        return false;
    const T* const here = &rows.position[3 * sample.at];
    const T* const before = sample.step > rows.step_first ? here - 3 : &batch_->positions[3 * sample.chosen];
    return std::memcmp(here, before, 3 * sizeof(T)) == 0 && vector_of(rows.force, sample.at) == Triple{};
}

template <typename T>
bool PathOracle<T>::metrics_differ(const layout::PathMetrics<T>& computed, const layout::PathMetrics<T>& oracle) const {
    if (std::memcmp(&computed, &oracle, sizeof computed) == 0)
        return false;
    if (exact_bits_)
        return true;
    return input_.features.loop == layout::kLoopOpen &&
           std::abs(double(computed.work) - double(oracle.work)) > 1e-3 * double(oracle.effort);
}

template <typename T> void PathOracle<T>::compare(std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
    if (input_.features.channels == 0)
        begin(first, metrics.size());
    if (!batch_ || batch_->first != first || batch_->count != metrics.size())
        throw std::logic_error(fmt::format("the metrics of {} paths from {} are of other paths than the samples before",
                                           metrics.size(), first));
    if (batch_->chosen.empty())
        return;
    for (; batch_->step < batch_->walk.steps(); check_interrupt())
        batch_->step += batch_->walk.walk(batch_->walk.steps()).step_count;
    const std::vector<layout::PathMetrics<T>> oracle = batch_->walk.metrics();
    for (std::size_t i = 0; i < batch_->chosen.size(); ++i) {
        ++error_.paths;
        if (input_.features.channels == 0)
            error_.samples += batch_->source.lengths()[i];
        if (!metrics_differ(metrics[batch_->chosen[i] - first], oracle[i]))
            continue;
        ++error_.metrics;
        note(fmt::format("path {}: its metrics differ", batch_->chosen[i]));
    }
}

template class PathOracle<float>;
template class PathOracle<double>;

} // namespace forceshade
