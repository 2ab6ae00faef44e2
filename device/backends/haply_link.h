// The thread that talks to the Inverse Service, and the data that it exchanges with the live loop's thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include <glm/vec3.hpp>

#include "device/backends/back_end.h"
#include "device/backends/haply.h"

namespace forceshade::device {

/// The device's last answer.
struct Measurement {
    bool good = false;      // it has a position; false: it has none, came too late, or the service is gone
    std::int64_t time = 0;  /* ns, of the steady clock: when it arrived */
    glm::dvec3 position{0}; /* m, in the world's axes, finite */
    std::uint32_t buttons = 0;
};

/// Forces one way, positions the other, without either thread waiting for the other.
class Exchange {
public:
    /// `zero_frame`: a command without force, as sent. Throws Error if the system has no more descriptors.
    explicit Exchange(std::string zero_frame);
    ~Exchange();
    Exchange(const Exchange&) = delete;
    Exchange& operator=(const Exchange&) = delete;

    Newest<glm::dvec3> force;          /* N: from the live loop */
    Newest<Measurement> measurement;   // for the live loop
    std::atomic<bool> there{false};    // the service answers and lists the device
    std::atomic<bool> stopping{false}; // no force any more; set once
    std::atomic<bool> resting{false};  // no force until the next one
    std::atomic<const char*> error_text{nullptr};
    std::atomic<const char*> withheld{nullptr};        // why the device is not ready for a force; null: it is
    std::atomic<const char*> lately_withheld{nullptr}; // the same until the live loop has asked for no force

    /// Wakes the other thread. Safe in a signal's handler, like stop().
    void wake() const noexcept;

    /// Sets `stopping` and sends the command without force at once, past the thread that owns the line, because this
    /// process may end before that thread runs. A frame is one system call, so that the two do not mix; if the line is
    /// so full that they could, this one is not sent, and the service gets no command and applies no force.
    void stop() noexcept;

    /// Readable after wake().
    int wake_descriptor() const noexcept { return wake_; }

    /// The socket over which stop() may send from now on; -1: none. Its number never changes, so that stop() cannot
    /// write to a file that got the number of a socket just closed.
    void lend_line(int socket) noexcept;

private:
    std::string zero_frame_;
    int wake_ = -1, null_device_ = -1, line_ = -1;
};

/// Main function of that thread: connects, keeps commands and answers in lock-step, reconnects, until
/// `exchange.stopping`; then ends within 200 ms, with a last command without force. `options` name a device and a
/// dialect. Does not throw.
void run_link(Exchange& exchange, const HaplyOptions& options) noexcept;

} // namespace forceshade::device
