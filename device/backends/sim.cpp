#include "device/backends/devices.h"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "host/paths/scene_paths.h"
#include "host/reference/path_step.h"

namespace forceshade::device {

namespace {

using reference::Vector;

// As the hand follows them: in a closed loop.
PreparedCase with_hand(PreparedCase prepared, double rate) {
    Scene& scene = prepared.one.scene;
    if (!scene.paths) {
        scene.paths.emplace();
        scene.paths->drive = PathDrive::press;
    }
    scene.paths->loop = PathLoop::closed;
    scene.paths->rate = rate;
    scene.precision = Precision::f64; // of the world; the law has its own
    return prepared;
}

class Sim final : public BackEnd {
public:
    Sim(PreparedCase prepared, double rate, std::uint64_t still)
        : prepared_(with_hand(std::move(prepared), rate)), still_(still), paths_(prepared_), input_(paths_.input()),
          hand_(input_.hands[0]), batch_(paths_.batch(0, 1)) {
        if (input_.features.motion == layout::kMotionRecorded)
            record();
        begin();
        facts_.name = "simulated hand and device";
        facts_.software = "exact zero-order hold";
        facts_.max_force = hand_.max_force;
        facts_.rate = rate;
        facts_.simulated = true;
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }

    Reading read() noexcept override {
        const Vector<double> position(state_.x, state_.y, state_.z), offset = position - target(state_.step);
        const bool left = !(reference::dot(offset, offset) <= hand_.bound * hand_.bound);
        if (left)
            begin();
        return {Answer::fresh, reference::measured(hand_, Vector<double>(state_.x, state_.y, state_.z)), left};
    }

    bool write(const glm::dvec3& force) noexcept override {
        if (waits_ > 0) {
            --waits_;
            return true;
        }
        const Vector<double> displayed(halted_.load(std::memory_order_relaxed) ? glm::dvec3(0) : force);
        const reference::PathSampled<double> sampled{{}, displayed, {}};
        reference::advance_probe(state_, hand_, sampled, target(state_.step), target(state_.step + 1), 0U);
        reference::keep_sample(state_, sampled);
        return true;
    }

    void halt() noexcept override { halted_.store(true, std::memory_order_relaxed); }

private:
    void begin() noexcept {
        state_ = reference::begin_state(input_.features, hand_, target(0));
        waits_ = still_;
    }

    // The file gives positions in windows; the loop wants them without waiting.
    void record() {
        constexpr std::size_t kWindow = std::size_t(1) << 16;
        const std::size_t steps = batch_.steps.front();
        recorded_.reserve(steps);
        for (std::size_t step = 0; step < steps; step += kWindow) {
            const auto window = paths_.positions(step, std::min(kWindow, steps - step));
            for (std::size_t i = 0; i < std::min(kWindow, steps - step); ++i)
                recorded_.push_back(reference::vector_at(window, i));
        }
    }

    Vector<double> target(layout::uint step) const noexcept {
        if (!recorded_.empty())
            return recorded_[std::min<std::size_t>(step, recorded_.size() - 1)];
        return reference::motion_at(input_.law, input_.features, batch_, 0, step);
    }

    const PreparedCase prepared_;
    const std::uint64_t still_;
    std::uint64_t waits_ = 0; // samples for which the hand still holds still
    ScenePaths<double> paths_;
    const layout::PathInput<double> input_;
    const layout::HandParams<double> hand_;
    const layout::PathBatch<double> batch_; // points into paths_
    std::vector<Vector<double>> recorded_;  /* m; empty: generated */
    layout::PathState<double> state_{};
    DeviceFacts facts_;
    std::atomic<bool> halted_ = false;
};

} // namespace

std::unique_ptr<BackEnd> make_sim(PreparedCase prepared, double rate, std::uint64_t still) {
    return std::make_unique<Sim>(std::move(prepared), rate, still);
}

} // namespace forceshade::device
