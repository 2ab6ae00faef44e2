// Between the law and the device: whether a force may be displayed, and how much of it.
#pragma once

#include "device/back_end.h"
#include "device/loop/sample.h"
#include "device/safety/limits.h"
#include "device/safety/passivity.h"

namespace forceshade::device {

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
