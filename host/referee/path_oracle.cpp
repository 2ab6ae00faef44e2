// Of paths.
#include "host/referee/oracle_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "host/norm.h"
#include "host/program.h"
#include "host/reference/contact.h"
#include "host/reference/field.h"
#include "host/reference/motion.h"
#include "host/reference/path_step.h"

namespace forceshade {

namespace {

template <typename T> constexpr double kRoundoff = double(std::numeric_limits<T>::epsilon()) / 2;

// How far rounding may take a sample of a path on hardware from the oracle's, derived a priori, on an analytic surface.
// What is computed is compared with the law at the very place where it was computed (RoundingBound, both sides round,
// edges excused as by is_on_edge()); what the device can display of it adds 16 u of its largest force.
//
// Where an open loop's probe is follows from numbers without rounding (phases, random words, steps) in one chain. With
// u the unit roundoff and S the sum of all lengths that a motion is made of (middle, half sides, depths, lift, every
// harmonic's amplitude), a coordinate is off by at most (128 + 2 harmonics) u S: the longest chain is that of a
// minimum-jerk stretch, 40 u for the share of the distance (its division 2.5 ULP, its derivative below 2, the
// polynomial's terms up to 15), twice that for points two half sides apart, and the turn into the world; a sum of
// harmonics rounds twice for each. One that follows the surface is off by what the surface's height changes over that,
// and by the height's own error. Recorded places are copied and must be the very same.

// m: the sum of lengths S of one path's motion, the only one of the batch.
template <typename T> double sum_of_lengths(const layout::PathBatch<T>& one) {
    double sum = 0;
    for (const layout::MotionParams<T>& motion : one.motions)
        for (const T length : {motion.centre_x, motion.centre_y, motion.centre_z, motion.reach, motion.across,
                               motion.depth, motion.depth_back, motion.lift})
            sum += std::abs(double(length));
    for (const T amplitude : one.amplitudes)
        sum += std::abs(double(amplitude));
    return sum;
}

template <typename T> glm::dvec3 vector_of(std::span<const T> values, std::size_t at) {
    return glm::dvec3(reference::vector_at(values, at));
}

template <typename Value>
bool same(std::span<const Value> computed, std::size_t at, std::span<const Value> oracle, std::size_t other,
          std::size_t components) {
    return computed.empty() ||
           std::memcmp(&computed[components * at], &oracle[components * other], components * sizeof(Value)) == 0;
}

// Copies the tables of the chosen paths, of several recorded ones all positions.
template <typename T> class ChosenPaths final : public layout::PathSource<T> {
public:
    // `steps` of the longest path. `from` must outlive this.
    ChosenPaths(const layout::PathInput<T>& from, std::vector<std::size_t> chosen)
        : from_(from), chosen_(std::move(chosen)) {}

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        count_ = count;
        if (count == 1) {
            layout::PathBatch<T> one = from_.source->batch(chosen_[first], 1);
            one.first = first;
            return one;
        }
        const std::size_t harmonics = from_.features.harmonics;
        motions_.clear();
        steps_.clear();
        proxies_.clear();
        amplitudes_.assign(3 * harmonics * count, T(0));
        phases_.assign(3 * harmonics * count, 0);
        phase_steps_ = phases_;
        positions_.clear();
        for (std::size_t i = 0; i < count; ++i)
            add(from_.source->batch(chosen_[first + i], 1), i);
        return {first, count, motions_, amplitudes_, phases_, phase_steps_, steps_, proxies_};
    }

    std::span<const T> positions(std::size_t step, std::size_t steps) override {
        if (count_ == 1)
            return from_.source->positions(step, steps);
        return std::span<const T>(positions_).subspan(3 * step * count_);
    }

private:
    bool is_recorded() const { return from_.features.motion == layout::kMotionRecorded; }

    void add(const layout::PathBatch<T>& one, std::size_t i) {
        motions_.insert(motions_.end(), one.motions.begin(), one.motions.end());
        steps_.insert(steps_.end(), one.steps.begin(), one.steps.end());
        proxies_.insert(proxies_.end(), one.proxies.begin(), one.proxies.end());
        for (std::size_t h = 0; h < one.amplitudes.size(); ++h) {
            amplitudes_[h * count_ + i] = one.amplitudes[h];
            phases_[h * count_ + i] = one.phases[h];
            phase_steps_[h * count_ + i] = one.phase_steps[h];
        }
        if (!is_recorded())
            return;
        const std::size_t steps = one.steps.empty() ? from_.steps : std::size_t(one.steps.front());
        const std::span<const T> places = from_.source->positions(0, steps);
        positions_.resize(std::max(positions_.size(), 3 * steps * count_), T(0));
        for (std::size_t step = 0; step < steps; ++step)
            for (std::size_t c = 0; c < 3; ++c)
                positions_[3 * (step * count_ + i) + c] = places[3 * step + c];
    }

    const layout::PathInput<T>& from_;
    std::vector<std::size_t> chosen_;
    std::size_t count_ = 0;
    std::vector<layout::MotionParams<T>> motions_;
    std::vector<T> amplitudes_, positions_;
    std::vector<layout::uint> phases_, phase_steps_, steps_;
    std::vector<layout::ProxyStart<T>> proxies_;
};

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
            walk->begin(0, chosen.size());
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
        hands.reserve(chosen.size());
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
    std::unique_ptr<reference::PathWalk<T>> walk = reference::make_path_walk(input, options);
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
        bound_.emplace(prepared, kPrecisionOf<T>);
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
        batch_->sizes.push_back(recorded ? 0 : sum_of_lengths(input_.source->batch(path, 1)));
}

template <typename T> void PathOracle<T>::compare(const PathRows<T>& rows) {
    if (rows.step_first == 0)
        begin(rows.path_first, rows.path_count);
    if (batch_->chosen.empty())
        return;
    const std::size_t end = std::min(rows.step_first + rows.pitch, batch_->walk->steps());
    while (batch_->step < end) {
        const layout::PathChunk<T> oracle = batch_->walk->walk(end - batch_->step);
        compare(rows, oracle);
        batch_->step += oracle.step_count;
    }
    if (end == batch_->walk->steps())
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
    const bool has_force = !rows.force.empty(); // else the engine only returned where it has contact
    const glm::dvec3 force = has_force ? vector_of(rows.force, at) : glm::dvec3(0);
    const glm::dvec3 expected = has_force ? vector_of(oracle.force, other) : glm::dvec3(0);
    const double off = norm(force - expected);
    error_.largest = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(error_.largest, off);
    error_.largest_force = std::max(error_.largest_force, norm(expected));
    if (same(rows.force, at, oracle.force, other, 3) && same(rows.position, at, oracle.position, other, 3) &&
        same(rows.proxy, at, oracle.proxy, other, 3) && same(rows.depth, at, oracle.depth, other, 1) &&
        same(rows.facet, at, oracle.facet, other, 1))
        return;
    ++error_.differing;
    if (!exact_bits_ && !(has_force && differs_beyond(rows, oracle, sample, off)))
        return;
    ++error_.beyond;
    note(fmt::format("path {}, step {}: force ({:.9g}, {:.9g}, {:.9g}) N, the oracle says ({:.9g}, {:.9g}, {:.9g}) N",
                     path, step, force.x, force.y, force.z, expected.x, expected.y, expected.z));
}

// On hardware. `off`, N: |F - F_oracle|.
template <typename T>
bool PathOracle<T>::differs_beyond(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample,
                                   double off) {
    const glm::dvec3 meant = vector_of(oracle.position, sample.other);
    const bool open = input_.features.loop == layout::kLoopOpen;
    const bool elsewhere = open && !(norm(vector_of(rows.position, sample.at) - meant) <=
                                     place_error(batch_->sizes[sample.chosen], meant));
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

// m: how far apart two roundings of an open loop's place may be.
template <typename T> double PathOracle<T>::place_error(double size, const glm::dvec3& at) const {
    const layout::PathFeatures& features = input_.features;
    if (features.motion == layout::kMotionRecorded && features.harmonics == 0)
        return 0;
    const double off = (128.0 + 2.0 * features.harmonics) * kRoundoff<T> * size; // m
    double above = 0;
    if (features.follow == layout::kFollowSurface) {
        const layout::Law<double> law = bound_->law();
        const double height = reference::nominal_height(law, at.x);
        for (const double x : {at.x - off, at.x + off})
            above = std::max(above, std::abs(reference::nominal_height(law, x) - height));
        above += bound_->at(at.x, at.y, at.z).depth;
    }
    return 2 * (std::sqrt(3.0) * off + above);
}

// Whether that is what the law gives at the probe, or rounding may have made of it. `hand`: of a closed loop, else
// null.
template <typename T>
bool PathOracle<T>::is_allowed(const layout::HandParams<T>* hand, const Reading& computed, const glm::dvec3& probe,
                               layout::uint channels) const {
    const OracleReferee<T> referee{input_.law, hand};
    const double x = probe.x, y = probe.y, z = probe.z;
    const Reading truth = referee.at(referee.column(x, y), z);
    Bound displayed;
    if (hand)
        displayed.force = displayed.magnitude = 16 * kRoundoff<T> * norm(truth.force);
    return !first_misfit(computed, truth, 2 * bound_->at(x, y, z) + displayed, channels) ||
           is_on_edge<T>(computed, probe, referee, *bound_, 2, channels);
}

// What was computed, compared with the law at the very position where it was computed.
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
    if (hand && hand->coupling.depth > T(0))
        channels &= ~layout::kChannelForce; // it depends on the samples before
    return !is_allowed(hand, computed, vector_of(rows.position, sample.at), channels) &&
           !(closed && has_left(rows, sample));
}

// A probe that left its bound stays where it was, without force.
template <typename T> bool PathOracle<T>::has_left(const PathRows<T>& rows, const Sample& sample) const {
    if (sample.step == 0)
        return false;
    const T* const here = &rows.position[3 * sample.at];
    const T* const before = sample.step > rows.step_first ? here - 3 : &batch_->positions[3 * sample.chosen];
    return std::memcmp(here, before, 3 * sizeof(T)) == 0 && vector_of(rows.force, sample.at) == glm::dvec3(0);
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
    for (; batch_->step < batch_->walk->steps(); check_interrupt())
        batch_->step += batch_->walk->walk(batch_->walk->steps()).step_count;
    const std::vector<layout::PathMetrics<T>> oracle = batch_->walk->metrics();
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
