// Between the law and the device: whether a force may be displayed, and how much of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "device/backends/back_end.h"
#include "device/loop/sample.h"
#include "host/reference/elementary.h"

namespace forceshade::device {

/// On by default; an infinite limit is off. The defaults hold unless the user or the device states a limit.
struct SafetyLimits {
    double max_force = kUnknown;        /* N: larger forces keep their direction */
    double continuous_force = kUnknown; /* N: RMS limit over kContinuousForceTime */
    double slew = 2000;                 /* N/s: how fast the force may rise; it falls at once */
    double ramp = 0.2;                  /* s: to the full force after the start and after a fault */
    double contact_ramp = 0.005;        /* s: the same when contact is made again */
    double free_time = 0.05;            /* s: without contact, after which the next is made again */
    double max_speed = 2;               /* m/s: of the probe */
    double stale = 0.02;                /* s: without a new position */
    double late = 0.02;                 /* s: that a sample may be late */
    glm::dvec3 low{-kUnknown};          /* m: the workspace, for the hand's position */
    glm::dvec3 high{kUnknown};          /* m */
    bool fade = false;                  // whether a force that drives an oscillation is faded out
    double passivity = 0;               /* N s/m: the most that the passivity controller may damp; 0: it is off */
};

/// N: the limit if neither the device nor the user states one.
inline constexpr double kCautiousForce = 3;

/// N: the limit for a device without a watchdog of its own, which keeps the last force of a killed process.
inline constexpr double kUnwatchedForce = 0.5;

/// N s/m: the most that the passivity controller may damp, unless the user or the scene states another.
inline constexpr double kPassiveDamping = 10;

/// s: over which the mean square of a force is taken. No vendor states it; motors warm up in minutes.
inline constexpr double kContinuousForceTime = 10;

/// Computed as in the oracle's hand (reference::commanded).
inline double magnitude(const glm::dvec3& v) noexcept {
    return std::sqrt(reference::dot(v, v));
}

/// J: more than a device's largest force stores in a soft wall (8.5 N, 0.4 N/mm), which a hand may have back. Energy
/// that damping and friction took beyond that cannot offset a later instability.
inline constexpr double kReserve = 0.1;

/// The energy that the hand is given, for time-domain passivity (Hannaford & Ryu 2002). A force acts from one sample to
/// the next, so that its work over the displacement is as exact as the positions: no speed estimate is involved. A
/// conservative law sampled at a rate gives energy, too. If positions come more seldom than samples, the displacement
/// counts with the mean of the forces.
class EnergyObserver {
public:
    /// A sample has passed, and the probe is at this position, m.
    void move_to(const glm::dvec3& probe) noexcept {
        wait();
        const glm::dvec3 displacement = begun_ ? probe - probe_ : glm::dvec3(0);
        const double work = glm::dot(sum_ / static_cast<double>(since_), displacement);
        energy_ += work;
        surplus_ = std::max(surplus_ + work, -kReserve);
        samples_ = since_;
        start_at(probe);
    }
    /// A sample has passed without a new position.
    void wait() noexcept {
        sum_ += force_;
        ++since_;
    }
    /// The probe is at this position, m, but did not move there.
    void start_at(const glm::dvec3& probe) noexcept {
        probe_ = probe;
        sum_ = glm::dvec3(0);
        since_ = 0;
        begun_ = true;
    }
    /// The force displayed from now on, N.
    void display(const glm::dvec3& force) noexcept { force_ = force; }

    double energy() const noexcept { return energy_; } /* J: given to the hand since the start */
    /* J: the same, but energy that the hand has put in counts only up to kReserve: no more can come back */
    double surplus() const noexcept { return surplus_; }
    std::uint64_t samples() const noexcept { return samples_; } // between the last two positions
    std::uint64_t since() const noexcept { return since_; }     // samples since the last position

private:
    glm::dvec3 probe_{0}, force_{0};
    glm::dvec3 sum_{0}; /* N: of the forces since the last position, one a sample */
    std::uint64_t samples_ = 1, since_ = 0;
    double energy_ = 0, surplus_ = 0;
    bool begun_ = false;
};

/// Whether the device drives an oscillation: for six periods the energy that the hand is given swings to and fro faster
/// than hands move (tremor has up to 12 Hz), each swing is of the size of the others, and the later half is not smaller
/// than the earlier one. A wall that holds rings, too, but its ringing dies; strokes over edges and textures swing at
/// random.
class OscillationObserver {
public:
    /// The hand was given `work`, J, in a sample of `step`, s.
    void add(double work, double step) noexcept {
        time_ += step;
        energy_ += work;
        if (rises_ ? energy_ > extreme_ : energy_ < extreme_)
            extreme_ = energy_;
        else if (std::fabs(energy_ - extreme_) > kLeastTurn)
            turn();
    }
    bool drives() const noexcept { return drives_; }

private:
    static constexpr double kLeastTurn = 20e-6;        /* J: turns of less are noise */
    static constexpr double kLeastSwing = 100e-6;      /* J: weaker oscillations harm nothing */
    static constexpr double kLongestPeriod = 1.0 / 12; /* s */
    static constexpr double kKept = 0.93;              // by the later half, of the earlier one's swings
    static constexpr double kAlike = 0.2;              // of the largest swing
    static constexpr std::size_t kHalf = 6;            // turns: three periods

    void turn() noexcept {
        const double swing = std::fabs(extreme_ - turned_at_);
        const bool goes_on = time_ - turns_[0] < kLongestPeriod && swing > kLeastSwing; // a period has two turns
        turns_ = {turns_[1], time_};
        std::rotate(swings_.begin(), swings_.begin() + 1, swings_.end());
        swings_.back() = swing;
        count_ = goes_on ? count_ + 1 : 0;
        const auto middle = swings_.begin() + kHalf;
        const auto [least, largest] = std::minmax_element(swings_.begin(), swings_.end());
        drives_ = count_ >= swings_.size() && *least > kAlike * *largest &&
                  std::accumulate(middle, swings_.end(), 0.0) >= kKept * std::accumulate(swings_.begin(), middle, 0.0);
        turned_at_ = extreme_;
        extreme_ = energy_;
        rises_ = !rises_;
    }

    double time_ = 0, energy_ = 0, extreme_ = 0, turned_at_ = 0;
    std::array<double, 2> turns_{-kUnknown, -kUnknown}; /* s: the last ones */
    std::array<double, 2 * kHalf> swings_{};            /* J: the last ones */
    std::size_t count_ = 0;                             // of them without a pause
    bool rises_ = true, drives_ = false;
};

/// s: in which a force that drives an oscillation fades out.
inline constexpr double kFadeTime = 0.02;

/// The controller's addition to a force.
struct Damping {
    glm::dvec3 force{0}; /* N */
    double energy = 0;   /* J: that it dissipates in a sample if the probe keeps its speed */
};

/// Against the motion: dissipates the surplus energy within `period`, s, with at most `most`, N s/m. `speed`, m/s, must
/// be smooth: quantised positions make the speed over a sample a train of pulses, which damping would turn into a buzz.
/// None once the probe's next position is overdue: the motion is unknown then.
inline Damping passive_damping(const EnergyObserver& observer, const glm::dvec3& speed, double period,
                               double most) noexcept {
    const double square = glm::dot(speed, speed);
    if (!(observer.surplus() > 0) || !(square > 0) || observer.since() >= observer.samples())
        return {};
    const double damping = std::min(observer.surplus() / (square * period), most);
    return {-damping * speed, damping * square * period};
}

/// The state of a sample before its law is evaluated.
struct Situation {
    Answer answer = Answer::failed;
    glm::dvec3 probe{0};         /* m: the hand's last valid position (Mapping), this sample's if valid */
    bool is_position = false;    // the device gave one, finite and within the law's reach
    bool begins_path = false;    // the probe did not move here from the position before
    bool withheld = false;       // the device displays no force
    std::uint32_t held_back = 0; // kDeadMan, kClutched
    double time = 0;             /* s: when it was read */
    double late = 0;             /* s: this sample is */
};

/// Keeps the state of safety between samples, in the device's axes and metres for any mapping of the scene: speed,
/// workspace and energy are the hand's. Neither allocates nor throws.
class Safety {
public:
    /// `period`, s.
    Safety(const SafetyLimits& limits, double period) noexcept : limits_(limits), period_(period) {}

    /// The force, N, to display for the law's force at a sample; its flags are added to `flags`.
    glm::dvec3 limit(const Situation& now, const glm::dvec3& force, bool contact, std::uint32_t& flags) noexcept;

    /// The force ramps up as after the start.
    void restart_ramp() noexcept { gain_ = 0; }
    /// The last force is dropped, and the next one ramps up as after the start.
    void drop_force() noexcept;

    double energy() const noexcept { return observer_.energy(); } /* J: given to the hand */
    double damped() const noexcept { return damped_; }            /* J: dissipated by the controller */
    double speed() const noexcept { return speed_size_; }         /* m/s: of the probe, over the last milliseconds */

private:
    std::uint32_t find_faults(const Situation& now) const noexcept;
    void follow(const Situation& now) noexcept;
    glm::dvec3 clamped(const glm::dvec3& force, std::uint32_t& flags) const noexcept;
    glm::dvec3 slewed(const glm::dvec3& wanted, std::uint32_t& flags) const noexcept;
    double thermal_limit() const noexcept;
    double gain(bool contact) noexcept;
    double fade(bool contact) noexcept;

    const SafetyLimits limits_;
    const double period_; /* s */
    EnergyObserver observer_;
    OscillationObserver oscillation_;
    glm::dvec3 displayed_{0};      /* N: last */
    glm::dvec3 last_probe_{0};     /* m: the last fresh one */
    glm::dvec3 speed_{0};          /* m/s */
    double speed_size_ = 0;        /* m/s */
    double last_fresh_ = 0;        /* s: when */
    double last_time_ = 0;         /* s: of the last sample */
    double step_ = 0;              /* s: since then, at most a period */
    double gain_ = 0;              // 0 to 1, since the start or a fault
    double contact_gain_ = 1;      // 0 to 1, since contact was made again
    double free_ = 0;              /* s: without contact */
    double fade_ = 1;              // 1 to 0, since the force drove an oscillation
    bool fades_ = false;           // until contact is broken
    double damped_ = 0;            /* J */
    double mean_square_force_ = 0; /* N^2: of the displayed force, over kContinuousForceTime */
    bool begun_ = false;
};

} // namespace forceshade::device
