#include "device/loop/safety.h"

#include <algorithm>
#include <cmath>

namespace forceshade::device {

namespace {

constexpr double kSpeedTime = 0.005; /* s: over which the speed is averaged, so that neither the jitter of a clock nor
                                        the resolution of positions looks fast */
constexpr double kThermalHorizon = 0.5; /* s: look-ahead, so that the limit approaches the continuous force smoothly */
const double kKept = std::exp(-kThermalHorizon / kContinuousForceTime); // share of a mean square left after that time

bool is_within(const glm::dvec3& v, const glm::dvec3& low, const glm::dvec3& high) noexcept {
    return v.x >= low.x && v.y >= low.y && v.z >= low.z && v.x <= high.x && v.y <= high.y && v.z <= high.z;
}

} // namespace

void Safety::follow(const Situation& now) noexcept {
    const double passed = begun_ ? std::max(now.time - last_time_, 0.0) : period_; // all of it warms the motors
    step_ = std::min(passed, period_);
    last_time_ = now.time;
    mean_square_force_ +=
        (1 - std::exp(-passed / kContinuousForceTime)) * (reference::dot(displayed_, displayed_) - mean_square_force_);
    if (!now.is_position || now.answer != Answer::fresh) {
        observer_.wait();
        return;
    }
    const double given = observer_.energy(), waited = static_cast<double>(observer_.since() + 1) * period_;
    if (now.begins_path) {
        drop_force(); // it belongs to another place
        observer_.start_at(now.probe);
        speed_ = glm::dvec3(0);
        speed_size_ = 0;
    } else {
        observer_.move_to(now.probe);
        oscillation_.add(observer_.energy() - given, waited);
    }
    if (begun_ && !now.begins_path) {
        const double since = std::max(now.time - last_fresh_, 0.5 * period_);
        const glm::dvec3 speed = (now.probe - last_probe_) / since;
        speed_ += (since / (since + kSpeedTime)) * (speed - speed_);
        speed_size_ = magnitude(speed_);
    }
    last_probe_ = now.probe;
    last_fresh_ = now.time;
    begun_ = true;
}

std::uint32_t Safety::find_faults(const Situation& now) const noexcept {
    std::uint32_t found = now.held_back;
    if (now.answer == Answer::failed)
        found |= kFailed;
    else if (!now.is_position)
        found |= kBadPosition;
    if (!(now.time - last_fresh_ <= limits_.stale))
        found |= kStale;
    if (!is_within(now.probe, limits_.low, limits_.high))
        found |= kOutside;
    if (!(speed_size_ <= limits_.max_speed))
        found |= kTooFast;
    if (!(now.late <= limits_.late))
        found |= kTooLate;
    if (now.withheld)
        found |= kWithheld;
    return found;
}

double Safety::gain(bool contact) noexcept {
    gain_ = limits_.ramp > 0 ? std::min(1.0, gain_ + step_ / limits_.ramp) : 1;
    if (!contact) {
        free_ += step_;
        return gain_;
    }
    if (free_ >= limits_.free_time)
        contact_gain_ = 0;
    free_ = 0;
    contact_gain_ = limits_.contact_ramp > 0 ? std::min(1.0, contact_gain_ + step_ / limits_.contact_ramp) : 1;
    return gain_ * contact_gain_;
}

// The force comes back as after a fault once the probe has been without contact.
double Safety::fade(bool contact) noexcept {
    fades_ = fades_ || (contact && oscillation_.drives());
    if (!fades_)
        return 1;
    fade_ = std::max(0.0, fade_ - step_ / kFadeTime);
    if (!contact && free_ >= limits_.free_time) {
        fades_ = false;
        fade_ = 1;
        oscillation_ = {};
        restart_ramp();
    }
    return fades_ ? fade_ : 1;
}

void Safety::drop_force() noexcept {
    restart_ramp();
    displayed_ = glm::dvec3(0);
    observer_.display(displayed_);
}

// N: the force that, displayed for kThermalHorizon, brings the mean square to that of the continuous force.
double Safety::thermal_limit() const noexcept {
    const double continuous = limits_.continuous_force;
    return std::isinf(continuous)
               ? continuous
               : std::sqrt(std::max(0.0, continuous * continuous - kKept * mean_square_force_) / (1 - kKept));
}

glm::dvec3 Safety::clamped(const glm::dvec3& force, std::uint32_t& flags) const noexcept {
    const double size = magnitude(force), thermal_limit = this->thermal_limit();
    const double most = std::min(limits_.max_force, thermal_limit);
    if (size <= most)
        return force;
    flags |= thermal_limit < limits_.max_force ? kLasting : kClamped;
    return (most / size) * force;
}

// A force falls at once and rises slowly. The displayed force is first scaled to its share nearest to the wanted one;
// from there it moves at most by the slew limit. So it is never larger than the wanted one, nor against it.
glm::dvec3 Safety::slewed(const glm::dvec3& wanted, std::uint32_t& flags) const noexcept {
    const double square = reference::dot(displayed_, displayed_);
    const double share = square > 0 ? std::clamp(reference::dot(displayed_, wanted) / square, 0.0, 1.0) : 0;
    const glm::dvec3 kept = share * displayed_;
    const glm::dvec3 rise = wanted - kept;
    const double most = std::isinf(limits_.slew) ? kUnknown : limits_.slew * step_, size = magnitude(rise);
    if (size <= most)
        return wanted;
    flags |= kSlewed;
    return kept + (most / size) * rise;
}

glm::dvec3 Safety::limit(const Situation& now, const glm::dvec3& law, bool contact, std::uint32_t& flags) noexcept {
    follow(now);
    flags |= find_faults(now);
    if (!is_finite(law))
        flags |= kNoNumber;
    if (flags & kZeroForceFlags) {
        drop_force();
        return displayed_;
    }
    glm::dvec3 force = clamped(law, flags);
    const double share = gain(contact);
    if (share < 1) { // of the limited force: a probe deep in the surface does not reach the limit sooner
        force = share * force;
        flags |= contact ? kRamping : 0u;
    }
    if (limits_.fade) {
        const double left = fade(contact);
        force = left * force;
        flags |= left < 1 && contact ? kUnstable : 0u;
    }
    if (limits_.passivity > 0) {
        const Damping damping = passive_damping(observer_, speed_, period_, limits_.passivity);
        force += damping.force;
        damped_ += damping.energy;
        flags |= damping.energy > 0 ? kDamped : 0u;
        force = clamped(force, flags);
    }
    force = slewed(force, flags);
    if (!is_finite(force)) { // squares of the largest numbers overflow
        flags |= kNoNumber;
        force = glm::dvec3(0);
        gain_ = 0;
    }
    displayed_ = force;
    observer_.display(displayed_);
    return displayed_;
}

} // namespace forceshade::device
