// Some paths of a source as a source of their own.
#pragma once

#include <algorithm>
#include <vector>

#include "shaders/shared/layout.h"

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

} // namespace forceshade
