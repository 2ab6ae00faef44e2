// Time-domain passivity (Hannaford & Ryu 2002): the energy that the hand was given is counted, and what it should not
// have got is taken back by damping.
#pragma once

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace forceshade::device {

/// The observer. A force is held from one sample to the next, so that its work over that way is known exactly, as far
/// as positions are: nothing is estimated from speeds. A conservative law sampled at a rate gives energy, too.
class EnergyObserver {
public:
    /// The probe is found at a place, m, after the force shown last, N.
    void find(const glm::dvec3& probe) noexcept {
        way_ = begun_ ? probe - probe_ : glm::dvec3(0);
        energy_ += glm::dot(shown_, way_);
        probe_ = probe;
        begun_ = true;
    }
    /// The probe is somewhere else, and was not taken there.
    void leap(const glm::dvec3& probe) noexcept {
        probe_ = probe;
        way_ = glm::dvec3(0);
    }
    void show(const glm::dvec3& force) noexcept { shown_ = force; }

    double energy() const noexcept { return energy_; }      /* J: given to the hand since the start */
    const glm::dvec3& way() const noexcept { return way_; } /* m: of the last sample */

private:
    glm::dvec3 probe_{0}, way_{0}, shown_{0};
    double energy_ = 0;
    bool begun_ = false;
};

/// What the controller adds to a force.
struct Damping {
    glm::dvec3 force{0}; /* N */
    double energy = 0;   /* J: that it takes out if the probe goes on as it went */
};

/// Against the motion, as much as takes out within `period`, s, what was given too much, but at most `most`, N s/m.
inline Damping passive_damping(const EnergyObserver& observer, double period, double most) noexcept {
    const glm::dvec3 speed = observer.way() / period;
    const double square = glm::dot(speed, speed);
    if (!(observer.energy() > 0) || !(square > 0))
        return {};
    const double damping = std::min(observer.energy() / (square * period), most);
    return {-damping * speed, damping * square * period};
}

} // namespace forceshade::device
