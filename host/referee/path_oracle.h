// Some paths of a source as a source of their own.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/output/rows.h"
#include "host/referee/reading.h"
#include "host/referee/rounding_bound.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Copies the tables of the chosen paths, of several recorded ones all positions.
template <typename T> class ChosenPaths final : public layout::PathSource<T> {
public:
    /// `steps` of the longest path. `from` must outlive this.
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

// How far rounding may take a sample of a path on hardware from the oracle's: derived a priori.

/// Of an analytic surface. What is felt is held against the law at the very place where it was felt (RoundingBound,
/// both sides round, edges excused as by is_on_edge()); what the device can display of it adds 16 u of its largest
/// force.
///
/// Where an open loop's probe is follows from numbers without rounding (phases, random words, steps) in one chain. With
/// u the unit roundoff and S the sum of all lengths that a motion is made of (middle, half sides, depths, lift, every
/// harmonic's amplitude), a coordinate is off by at most (128 + 2 harmonics) u S: the longest chain is that of a
/// minimum-jerk stretch, 40 u for the share of the way (its division 2.5 ULP, its derivative below 2, the polynomial's
/// terms up to 15), twice that for points two half sides apart, and the turn into the world; a sum of harmonics rounds
/// twice for each. One that follows the surface is off by what the surface's height changes over that, and by the
/// height's own error. Recorded places are copied and must be the very same.
template <typename T> class PathBound {
public:
    /// The case must outlive the bound.
    explicit PathBound(const PreparedCase& prepared);

    /// m: the sum of lengths S of one path's motion, the only one of the batch.
    static double size(const layout::PathBatch<T>& one);

    /// m: how far apart two roundings of an open loop's place may be.
    double place(const layout::PathFeatures& features, double size, const Triple& at) const;

    /// Whether that is what the law gives at the probe, or may be taken for it. `hand`: of a closed loop, else null.
    bool allows(const layout::Law<T>& law, const layout::HandParams<T>* hand, const Reading& computed,
                const Triple& probe, layout::uint channels) const;

private:
    RoundingBound bound_;
};

extern template class PathBound<float>;
extern template class PathBound<double>;

// Explored paths held against the oracle in the same precision: some of them, evenly chosen, or all.

/// Most samples that are compared where not all are asked for: about a second's work.
inline constexpr std::uint64_t kComparedSamples = std::uint64_t(1) << 20;

/// Evaluates the chosen paths of each batch once more, by reference::evaluate_paths on all cores. On hardware, whose
/// divisions and square roots may round otherwise, what is felt is held against the law at the very position where it
/// was felt, and an open loop's positions against the oracle's, within derived bounds (PathBound). On a mesh, where
/// a force follows from all before it, an open loop's may be off by 1e-3 of the largest in one sample of a hundred,
/// since a probe on an edge may be given to either facet; and of an open loop's metrics the work may be off by 1e-3 of
/// the effort: these two are chosen. A closed loop's course is not compared there: it follows from what it felt.
template <typename T> class PathOracle {
public:
    /// Of a case, which must outlive this. `input` is the oracle's own, its source is asked for other batches than the
    /// engine's. `exact_bits` as in OracleCheck. `most`: samples compared, evenly chosen paths; 0: all.
    PathOracle(const PreparedCase& prepared, const layout::PathInput<T>& input, bool exact_bits,
               std::uint64_t most = kComparedSamples);
    ~PathOracle();

    /// The engine's rows of a batch as they come, unless metrics alone were asked for; then its metrics. Of each sample
    /// no more than a window is held.
    void compare(const PathRows<T>& rows);
    void compare(std::size_t first, std::span<const layout::PathMetrics<T>> metrics);

    const PathError& error() const { return error_; }

private:
    struct Batch;
    struct Sample;
    void begin(std::size_t first, std::size_t count);
    void compare(const PathRows<T>& rows, const layout::PathChunk<T>& oracle);
    void compare_sample(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample);
    bool differs_beyond(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample, double off);
    void end_mesh_paths();
    bool is_beyond(const PathRows<T>& rows, const Sample& sample);
    bool has_left(const PathRows<T>& rows, const Sample& sample) const;
    bool metrics_differ(const layout::PathMetrics<T>& computed, const layout::PathMetrics<T>& oracle) const;
    void note(const std::string& text);

    layout::PathInput<T> input_;
    bool exact_bits_;
    std::optional<PathBound<T>> bound_; // on hardware, unless the surface is a mesh
    std::uint64_t every_;
    std::unique_ptr<Batch> batch_; // the oracle's, of the engine's present batch
    PathError error_;
};

extern template class PathOracle<float>;
extern template class PathOracle<double>;

} // namespace forceshade
