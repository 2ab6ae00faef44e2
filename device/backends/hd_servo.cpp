#include "device/backends/hd_servo.h"

#include <chrono>
#include <poll.h>

namespace forceshade::device {

namespace {

constexpr double kMillimetre = 1e-3; /* m */

std::int64_t clock_now() noexcept {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

} // namespace

bool Servo::runs() noexcept {
    if (clock_now() - called_ <= kSilence)
        return true;
    complaint_ = "the OpenHaptics scheduler does not run any more";
    return false;
}

bool Servo::put(const glm::dvec3& force) noexcept {
    commands_.put({force, clock_now()});
    return runs() && displayed_;
}

bool Servo::wait_for(const std::atomic<bool>& happened, int most) const noexcept {
    if (thread_.load() == ::pthread_self()) // interrupted in a frame, which cannot come to its end meanwhile
        return happened;
    for (int waited = 0; !happened && waited < most; ++waited)
        ::poll(nullptr, 0, 1);
    return happened;
}

void Servo::rest() noexcept {
    rested_ = clock_now();
}

bool Servo::halt(int most) noexcept {
    halted_ = true;
    return wait_for(silent_, most);
}

bool Servo::end(int most) noexcept {
    halted_ = true;
    ending_ = true;
    return wait_for(ended_, most);
}

// True if the calls since the last question did what they should.
bool Servo::succeeded() noexcept {
    const unsigned code = drain_errors(calls_);
    if (code != HdValue::success)
        complaint_ = calls_.get_error_string(code);
    return code == HdValue::success;
}

Servo::Frame Servo::position() noexcept {
    double at[3]{};
    calls_.get_doublev(HdValue::current_position, at);
    return {kMillimetre * glm::dvec3(at[0], -at[2], at[1]), succeeded()};
}

glm::dvec3 Servo::newest_force(std::int64_t now) noexcept {
    commands_.take(command_);
    return now - command_.time > kSilence || command_.time <= rested_ ? glm::dvec3(0) : command_.force;
}

void Servo::display(const glm::dvec3& force) noexcept {
    const double axes[3]{force.x, force.z, -force.y};
    calls_.set_doublev(HdValue::current_force, axes);
}

unsigned Servo::frame() noexcept {
    const std::int64_t now = clock_now();
    thread_ = ::pthread_self();
    const bool last = ending_;
    calls_.begin_frame(device_);
    const Frame frame = position();
    const glm::dvec3 force = newest_force(now);
    const bool silent = halted_; // asked as late as can be
    display(silent || !frame.told ? glm::dvec3(0) : force);
    calls_.end_frame(device_);
    displayed_ = succeeded();
    called_ = now;
    frames_.put(frame);
    silent_ = silent;
    thread_ = pthread_t{};
    ended_ = last;
    return last ? HdValue::callback_done : HdValue::callback_continue;
}

} // namespace forceshade::device
