// Time-domain passivity (Hannaford & Ryu 2002): the energy that the hand was given is counted, and what it should not
// have got is taken back by damping.
#pragma once

#include <algorithm>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace forceshade::device {

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

} // namespace forceshade::device
