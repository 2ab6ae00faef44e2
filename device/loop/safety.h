// What the live loop may do to a person and a device.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "device/backends/back_end.h"
#include "device/loop/sample.h"
#include "host/reference/elementary.h"

namespace forceshade::device {

/// On by default; an infinite limit is none. What is chosen where the user and the device say nothing.
struct SafetyLimits {
    double max_force = kUnknown;     /* N: larger forces keep their direction */
    double lasting_force = kUnknown; /* N: likewise what is displayed for longer, the root of its mean square */
    double slew = 2000;              /* N/s: how fast the force may come up; what it falls, it falls at once */
    double ramp = 0.2;               /* s: that the force takes to come up after the start and after a fault */
    double contact_ramp = 0.005;     /* s: likewise after contact is made again */
    double free_time = 0.05;         /* s: without contact, after which it is made again */
    double max_speed = 2;            /* m/s: of the probe */
    double stale = 0.02;             /* s: without a new position */
    double late = 20;                // periods that a sample may be late
    glm::dvec3 low{-kUnknown};       /* m: the workspace */
    glm::dvec3 high{kUnknown};       /* m */
    bool passivity = false;          // whether the passivity controller is on
    double damping = 10;             /* N s/m: the most that it may add */
};

/// Where neither the device nor the user says how much it may display, N.
inline constexpr double kCautiousForce = 3;

/// N: of a device without a watchdog of its own, which keeps the last force of a process that is killed.
inline constexpr double kUnwatchedForce = 0.5;

/// s: over which the mean square of a force is taken. No vendor states it; motors warm up in minutes.
inline constexpr double kLastingTime = 10;

// How large a force is, as the oracle's hand says it (reference::commanded).

inline double magnitude(const glm::dvec3& v) noexcept {
    return std::sqrt(reference::dot(v, v));
}

// Time-domain passivity (Hannaford & Ryu 2002): the energy that the hand was given is counted, and what it should not
// have got is taken back by damping.

/// J: more than a device's largest force stores in a soft wall (8.5 N, 0.4 N/mm), which a hand may have back. What
/// damping and friction took beyond that pays for no instability later.
inline constexpr double kReserve = 0.1;

/// The observer. A force is held from one sample to the next, so that its work over that way is known exactly, as far
/// as positions are: nothing is estimated from speeds. A conservative law sampled at a rate gives energy, too. Between
/// positions that come more seldom than samples the way counts with the mean of the forces.
class EnergyObserver {
public:
    /// A sample has passed, and the probe is found at a place, m.
    void find(const glm::dvec3& probe) noexcept {
        stay();
        way_ = begun_ ? probe - probe_ : glm::dvec3(0);
        const double work = glm::dot(pushed_ / static_cast<double>(since_), way_);
        energy_ += work;
        surplus_ = std::max(surplus_ + work, -kReserve);
        samples_ = since_;
        begin_at(probe);
    }
    /// A sample has passed, and where the probe is now is not known.
    void stay() noexcept {
        pushed_ += shown_;
        ++since_;
    }
    /// The probe is somewhere else, and was not taken there.
    void leap(const glm::dvec3& probe) noexcept {
        way_ = glm::dvec3(0);
        begin_at(probe);
    }
    /// The force shown from now on, N.
    void show(const glm::dvec3& force) noexcept { shown_ = force; }

    double energy() const noexcept { return energy_; } /* J: given to the hand since the start */
    double surplus() const noexcept {
        return surplus_;
    }                                                           /* J: the same, but what the hand has put in counts only
                                                                   up to kReserve: no more of it can come back */
    const glm::dvec3& way() const noexcept { return way_; }     /* m: between the last two places */
    std::uint64_t samples() const noexcept { return samples_; } // that it took
    std::uint64_t since() const noexcept { return since_; }     // samples since the last place

private:
    void begin_at(const glm::dvec3& probe) noexcept {
        probe_ = probe;
        pushed_ = glm::dvec3(0);
        since_ = 0;
        begun_ = true;
    }

    glm::dvec3 probe_{0}, way_{0}, shown_{0};
    glm::dvec3 pushed_{0}; /* N: sum of the forces since the last place, one a sample */
    std::uint64_t samples_ = 1, since_ = 0;
    double energy_ = 0, surplus_ = 0;
    bool begun_ = false;
};

/// What the controller adds to a force.
struct Damping {
    glm::dvec3 force{0}; /* N */
    double energy = 0;   /* J: that it takes out in a sample if the probe goes on as it went */
};

/// Against the motion, as much as takes out within `period`, s, what was given too much, but at most `most`, N s/m.
/// `speed`, m/s, is to be a smooth one: of positions with a resolution the speed over a sample is a train of pulses,
/// which damping would turn into a buzz. None once the probe's next place is overdue: then nothing is known of a
/// motion.
inline Damping passive_damping(const EnergyObserver& observer, const glm::dvec3& speed, double period,
                               double most) noexcept {
    const double square = glm::dot(speed, speed);
    if (!(observer.surplus() > 0) || !(square > 0) || observer.since() >= observer.samples())
        return {};
    const double damping = std::min(observer.surplus() / (square * period), most);
    return {-damping * speed, damping * square * period};
}

// Between the law and the device: whether a force may be displayed, and how much of it.

/// What is known of a sample before its law is evaluated.
struct Situation {
    Answer answer = Answer::failed;
    glm::dvec3 probe{0};      /* m: the last position that was one, this sample's if there is one */
    bool is_position = false; // the device gave one, finite and within the law's reach
    bool begins_path = false; // it follows from none before
    bool withheld = false;    // the device displays no force
    double time = 0;          /* s: when it was read */
    double late = 0;          // periods
};

/// Keeps what safety needs from one sample to the next. Neither allocates nor throws.
class Safety {
public:
    /// `period`, s.
    Safety(const SafetyLimits& limits, double period) noexcept : limits_(limits), period_(period) {}

    /// The force, N, to be displayed for the law's at a sample; what happened is added to `happened`.
    glm::dvec3 passed(const Situation& now, const glm::dvec3& force, bool contact, std::uint32_t& happened) noexcept;

    /// The force comes up as after the start.
    void come_up_anew() noexcept;
    /// Nothing is displayed of the last force: it comes up anew.
    void refused() noexcept;

    double energy() const noexcept { return observer_.energy(); } /* J: given to the hand */
    double damped() const noexcept { return damped_; }            /* J: taken out by the controller */
    double speed() const noexcept { return speed_size_; }         /* m/s: of the probe, over the last milliseconds */

private:
    std::uint32_t judged(const Situation& now) noexcept;
    void follow(const Situation& now) noexcept;
    glm::dvec3 clamped(const glm::dvec3& force, std::uint32_t& happened) const noexcept;
    glm::dvec3 slewed(const glm::dvec3& wanted, std::uint32_t& happened) const noexcept;
    double bearable() const noexcept;
    double gain(bool contact) noexcept;

    const SafetyLimits limits_;
    const double period_; /* s */
    EnergyObserver observer_;
    glm::dvec3 shown_{0};      /* N: last */
    glm::dvec3 last_probe_{0}; /* m: the last fresh one */
    glm::dvec3 speed_{0};      /* m/s */
    double speed_size_ = 0;    /* m/s */
    double last_fresh_ = 0;    /* s: when */
    double last_time_ = 0;     /* s: of the last sample */
    double step_ = 0;          /* s: since then, at most a period */
    double gain_ = 0;          // 0 to 1, since the start or a fault
    double contact_gain_ = 1;  // 0 to 1, since contact was made again
    double free_ = 0;          /* s: without contact */
    double damped_ = 0;        /* J */
    double heat_ = 0;          /* N^2: mean square of what is displayed, over kLastingTime */
    bool begun_ = false;
};

} // namespace forceshade::device
