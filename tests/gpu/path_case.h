// Exploration paths drawn at random over a scene's law, analytic or a mesh's.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/mesh/structure.h"
#include "host/paths/scene_paths.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade::test {

inline constexpr layout::uint kAllPathChannels = layout::kChannelPosition | layout::kChannelForce |
                                                 layout::kChannelDepth | layout::kChannelFacet | layout::kChannelProxy;

/// Where recorded paths go: along wavy lines; about a mesh; at its corners and edges.
enum class Probes { lines, wandering, aimed };

/// What paths are drawn.
struct PathShape {
    layout::PathFeatures features;
    std::size_t paths = 100, steps = 200;
    std::uint64_t seed = 1;
    double reach = 0.016;    /* m: half of a stroke */
    double depth = 1e-3;     /* m */
    double quantum = 0;      /* m */
    double coulomb = 0;      /* N */
    double max_force = 8.5;  /* N */
    double gain = 1;         /* 1 */
    double grip = 500;       /* N/m */
    double bound = 0.5;      /* m */
    layout::uint delay = 0;  /* samples */
    bool coupled = false;    /* virtual couplings */
    bool own_hands = false;  /* each path its own, every other one without friction, rounding and coupling */
    bool own_lengths = true; /* of recorded paths */
    Probes probes = Probes::lines;
    std::optional<glm::dvec3> focus = {}; /* m: about which they wander, if not everywhere */
    std::vector<glm::dvec3> places = {};  /* m: those of the one recorded path there is, if given */
};

template <typename T> class PathCase final : public layout::PathSource<T> {
public:
    /// `tables` and `mesh`, which is null for an analytic surface, must outlive it.
    PathCase(const FieldTables<T>& tables, const MeshStructure* mesh, const PathShape& wanted)
        : law_(tables.law()), mesh_(mesh), shape_(with_places(wanted)), random_(wanted.seed) {
        const PathShape& shape = shape_;
        for (std::size_t i = 0; i < shape.paths; ++i)
            motions_.push_back(draw_motion());
        for (std::size_t i = 0; i < 3 * shape.paths * shape.features.harmonics; ++i) {
            amplitudes_.push_back(T(uniform(0, 1e-4)));
            phases_.push_back(bits());
            phase_steps_.push_back(bits() >> 5);
        }
        if (shape.features.loop == layout::kLoopClosed)
            for (std::size_t i = 0; i < (shape.own_hands ? shape.paths : 1); ++i)
                hands_.push_back(draw_hand(i));
        if (shape.features.motion == layout::kMotionRecorded)
            record();
    }

    layout::PathInput<T> input() {
        const float stretch = shape_.seed % 2 ? 5e-4f : 5e-5f; // longer than most steps, and shorter
        return {law_, shape_.features, hands_, shape_.paths, shape_.steps, this, stretch};
    }

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        batch_first_ = first;
        batch_count_ = count;
        layout::PathBatch<T> batch{};
        batch.first = first;
        batch.count = count;
        if (!recorded_.empty()) {
            if (shape_.own_lengths)
                batch.steps = std::span(lengths_).subspan(first, count);
        } else {
            batch.motions = std::span(motions_).subspan(first, count);
            batch.amplitudes = part(amplitudes_, batch_amplitudes_);
            batch.phases = part(phases_, batch_phases_);
            batch.phase_steps = part(phase_steps_, batch_phase_steps_);
        }
        if (mesh_)
            batch.proxies = start_proxies(batch);
        return batch;
    }

    std::span<const T> positions(std::size_t step, std::size_t steps) override {
        window_.clear();
        for (std::size_t s = step; s < step + steps; ++s)
            for (std::size_t i = 0; i < 3 * batch_count_; ++i)
                window_.push_back(recorded_[3 * (s * shape_.paths + batch_first_) + i]);
        return window_;
    }

    std::size_t length(std::size_t path) const {
        return recorded_.empty() || !shape_.own_lengths ? shape_.steps : lengths_[path];
    }

private:
    static PathShape with_places(PathShape shape) {
        if (shape.places.empty())
            return shape;
        shape.own_lengths = false;
        shape.paths = 1;
        shape.steps = shape.places.size();
        return shape;
    }

    layout::uint bits() { return static_cast<layout::uint>(random_()); }
    double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits()) * 0x1p-32; }

    layout::MotionParams<T> draw_motion() {
        layout::MotionParams<T> motion{};
        const double angle = uniform(-1, 1) * (bits() % 4 == 0 ? 3.14 : 0.2);
        motion.centre_x = T(uniform(-0.1, 0.1) * shape_.reach);
        motion.centre_y = T(uniform(-0.1, 0.1) * shape_.reach);
        motion.centre_z = T(bits() % 2 ? 0 : uniform(0, 2) * shape_.depth);
        motion.heading_x = T(bits() % 8 ? std::cos(angle) : 1);
        motion.heading_y = T(motion.heading_x == T(1) ? 0 : std::sin(angle));
        motion.reach = T(shape_.reach * uniform(0.5, 1.2));
        motion.across = T(shape_.reach * uniform(0.05, 0.5));
        motion.depth = T(shape_.depth * uniform(-0.2, 2));
        motion.depth_back = T(shape_.depth * uniform(0.2, 1));
        motion.lift = T(shape_.depth * uniform(0, 1));
        motion.phase = bits();
        motion.phase_step = bits() % 64 == 0 ? 0 : bits() >> 6;
        motion.radius_phase = bits();
        motion.radius_step = bits() >> 8;
        motion.run = 1 + bits() % 40;
        motion.turn = bits() % 8;
        motion.lines = 1 + bits() % 5;
        motion.key_low = bits();
        motion.key_high = bits();
        return motion;
    }

    layout::HandParams<T> draw_hand(std::size_t index) {
        layout::HandParams<T> hand{};
        const double rate = 1000, mass = uniform(0.05, 0.2), damping = uniform(0.5, 5);
        const bool plain = shape_.own_hands && index % 2 == 1;
        const auto map = [&](double spring) {
            const layout::AxisMap<double> m = axis_map({mass, damping, spring}, 1 / rate);
            return layout::AxisMap<T>{T(m.x_error), T(m.x_speed), T(m.x_force),
                                      T(m.v_error), T(m.v_speed), T(m.v_force)};
        };
        const double along_z = shape_.seed % 2 ? shape_.grip : 0;
        hand.lateral = map(shape_.grip);
        hand.vertical = map(along_z);
        hand.rate = T(rate);
        hand.period = T(1 / rate);
        hand.stiffness = T(shape_.grip);
        hand.stiffness_z = T(along_z);
        hand.damping = T(0.5 * damping);
        hand.push_z = T(-uniform(0.2, 2));
        hand.push_x = T(shape_.seed % 3 ? 0 : uniform(-0.1, 0.1));
        hand.quantum = T(plain ? 0 : shape_.quantum);
        hand.coulomb = T(plain ? 0 : shape_.coulomb);
        hand.max_force = T(shape_.max_force);
        hand.gain = T(shape_.gain);
        hand.bound = T(shape_.bound);
        hand.start_depth = T(shape_.seed % 5 ? 0 : shape_.depth);
        hand.delay = shape_.delay;
        if (shape_.coupled && !plain) {
            hand.coupling.depth = T(uniform(0.1, 0.9));
            hand.coupling.lag = T(uniform(0, 1)) * hand.coupling.depth;
            hand.coupling.free = T(uniform(0, 1));
            hand.coupling.rest = T(uniform(0, 1));
            hand.coupling.kept = uniform(0, 1) < 0.5 ? T(0) : T(uniform(0, 1));
        }
        return hand;
    }

    // Wavy lines, some of which end early.
    void record() {
        recorded_.resize(3 * shape_.paths * shape_.steps);
        for (std::size_t path = 0; path < shape_.paths; ++path) {
            lengths_.push_back(path == 0 || bits() % 2 ? static_cast<layout::uint>(shape_.steps)
                                                       : static_cast<layout::uint>(1 + bits() % shape_.steps));
            const double x = uniform(-1, 1), y = uniform(-1, 1), turn = uniform(0, 0.2);
            for (std::size_t step = 0; step < shape_.steps; ++step) {
                const double t = turn * static_cast<double>(step);
                put(step, path,
                    {shape_.reach * (x + 0.5 * std::sin(t)), shape_.reach * y, shape_.depth * (std::cos(3 * t) - 0.5)});
            }
        }
        for (std::size_t step = 0; step < shape_.places.size(); ++step)
            put(step, 0, shape_.places[step]);
        if (shape_.probes == Probes::wandering)
            wander([&](std::uint64_t seed) { return walks::Wanderer(*mesh_, seed, shape_.focus); });
        if (shape_.probes == Probes::aimed) {
            walks::Aimer aimer(*mesh_, shape_.seed);
            wander([&](std::uint64_t) -> walks::Aimer& { return aimer; });
        }
    }

    template <typename WalkerOf> void wander(const WalkerOf& walker_of) {
        for (std::size_t path = 0; path < shape_.paths; ++path) {
            auto&& walker = walker_of(shape_.seed * 1000 + path);
            glm::dvec3 at = walker.begin();
            for (std::size_t step = 0; step < shape_.steps; ++step) {
                put(step, path, mesh_->centre - origin_of(*mesh_) + mesh_->scale * at);
                at = walker.step(at);
            }
        }
    }

    void put(std::size_t step, std::size_t path, const glm::dvec3& at) {
        for (int axis = 0; axis < 3; ++axis)
            recorded_[3 * (step * shape_.paths + path) + static_cast<std::size_t>(axis)] = T(at[axis]);
    }

    // Where the god-objects of a batch begin.
    std::span<const layout::ProxyStart<T>> start_proxies(const layout::PathBatch<T>& batch) {
        const layout::PathInput<T> input = this->input();
        if (batch.motions.empty())
            positions(0, 1);
        proxies_.clear();
        for (std::size_t path = 0; path < batch.count; ++path) {
            const reference::BatchPath<T> moved{input, batch, path, window_};
            const auto state = reference::begin_state(input.features, moved.hand(), moved.at(0));
            const reference::Vector<T> begin(state.x, state.y, state.z);
            proxies_.push_back(
                reference::proxy_start(law_, around_, reference::to_mesh_frame(law_.mesh.params, begin)));
        }
        return proxies_;
    }

    template <typename Value> std::span<const Value> part(const std::vector<Value>& all, std::vector<Value>& batch) {
        batch.clear();
        for (std::size_t row = 0; row < 3 * shape_.features.harmonics; ++row)
            batch.insert(batch.end(), all.begin() + std::ptrdiff_t(row * shape_.paths + batch_first_),
                         all.begin() + std::ptrdiff_t(row * shape_.paths + batch_first_ + batch_count_));
        return batch;
    }

    layout::Law<T> law_;
    const MeshStructure* mesh_;
    PathShape shape_;
    std::mt19937_64 random_;
    std::vector<layout::MotionParams<T>> motions_;
    std::vector<T> amplitudes_, batch_amplitudes_, recorded_, window_;
    std::vector<layout::uint> phases_, phase_steps_, batch_phases_, batch_phase_steps_, lengths_;
    std::vector<layout::HandParams<T>> hands_;
    std::vector<layout::ProxyStart<T>> proxies_;
    reference::Neighbourhood<T> around_;
    std::size_t batch_first_ = 0, batch_count_ = 0;
};

} // namespace forceshade::test
