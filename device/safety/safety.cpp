#include "device/safety/safety.h"

#include <algorithm>
#include <cmath>

#include "device/safety/magnitude.h"

namespace forceshade::device {
namespace {

constexpr double kSpeedTime =
    0.005; /* s: over which the speed is averaged, so that no jitter of a clock, no resolution looks fast */

bool is_finite(const glm::dvec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_within(const glm::dvec3& v, const glm::dvec3& low, const glm::dvec3& high) noexcept {
    return v.x >= low.x && v.y >= low.y && v.z >= low.z && v.x <= high.x && v.y <= high.y && v.z <= high.z;
}

} // namespace

void Safety::follow(const Situation& now) noexcept {
    step_ = begun_ ? std::clamp(now.time - last_time_, 0.0, period_) : period_;
    last_time_ = now.time;
    if (!now.is_position || now.answer != Answer::fresh) {
        observer_.stay();
        return;
    }
    if (now.begins_path) {
        refused(); // what was displayed belongs to another place
        observer_.leap(now.probe);
        speed_ = glm::dvec3(0);
        speed_size_ = 0;
    } else
        observer_.find(now.probe);
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

std::uint32_t Safety::judged(const Situation& now) noexcept {
    std::uint32_t found = 0;
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

void Safety::come_up_anew() noexcept {
    gain_ = 0;
}

void Safety::refused() noexcept {
    come_up_anew();
    shown_ = glm::dvec3(0);
    observer_.show(shown_);
}

glm::dvec3 Safety::clamped(const glm::dvec3& force, std::uint32_t& happened) const noexcept {
    const double size = magnitude(force);
    if (size <= limits_.max_force)
        return force;
    happened |= kClamped;
    return (limits_.max_force / size) * force;
}

glm::dvec3 Safety::passed(const Situation& now, const glm::dvec3& law, bool contact, std::uint32_t& happened) noexcept {
    follow(now);
    happened |= judged(now);
    if (!is_finite(law))
        happened |= kNoNumber;
    if (happened & kForceless) {
        refused();
        return shown_;
    }
    glm::dvec3 force = clamped(law, happened);
    const double share = gain(contact);
    if (share < 1) { // of what may be displayed: a probe deep in the surface comes to it no sooner
        force = share * force;
        happened |= contact ? kRamping : 0u;
    }
    if (limits_.passivity) {
        const Damping damping = passive_damping(observer_, speed_, period_, limits_.damping);
        force += damping.force;
        damped_ += damping.energy;
        happened |= damping.energy > 0 ? kDamped : 0u;
        force = clamped(force, happened);
    }
    const glm::dvec3 change = force - shown_;
    const double most = std::isinf(limits_.slew) ? kUnknown : limits_.slew * step_, wanted = magnitude(change);
    if (!(wanted <= most)) {
        force = shown_ + (most / wanted) * change;
        happened |= kSlewed;
    }
    if (!is_finite(force)) { // squares of the largest numbers are none
        happened |= kNoNumber;
        force = glm::dvec3(0);
        gain_ = 0;
    }
    shown_ = force;
    observer_.show(shown_);
    return shown_;
}

} // namespace forceshade::device
