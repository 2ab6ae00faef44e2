// What runs in the vendor's scheduler: takes the position and displays the newest force, once a millisecond.
#pragma once

#include <atomic>
#include <cstdint>
#include <pthread.h>

#include <glm/vec3.hpp>

#include "device/backends/back_end.h"
#include "device/backends/hd_library.h"

namespace forceshade::device {

/// If no force was put for this long, none is displayed: three samples of the slowest loop, 100 Hz, and then some.
inline constexpr std::int64_t kSilence = 50'000'000; /* ns */

class Servo {
public:
    struct Frame {
        glm::dvec3 position{0}; /* m, in the world */
        bool told = false;      // the device gave one
    };

    Servo(const HdCalls& calls, unsigned device) noexcept : calls_(calls), device_(device) {}

    /// The callback, `servo` a Servo. Neither waits nor throws.
    static unsigned tick(void* servo) noexcept { return static_cast<Servo*>(servo)->frame(); }

    /// By the live thread: true and the newest frame, if there is one since the last.
    bool take(Frame& frame) noexcept { return frames_.take(frame); }

    /// By the live thread: false, with a complaint, if the scheduler has not called for as long as kSilence.
    bool runs() noexcept;

    /// By the live thread: displays a force (N, in the world) from the next frame on. False if the scheduler does not
    /// call any more, or the device refused the last one.
    bool put(const glm::dvec3& force) noexcept;

    /// No force from the next frame on until the next put(). From any thread.
    void rest() noexcept;

    /// No force from the next frame on. Waits for that frame up to `most` ms unless called from the scheduler's thread;
    /// from a signal's handler too. True once it is displayed.
    bool halt(int most) noexcept;

    /// Likewise, and that frame is the last. True once it has passed.
    bool end(int most) noexcept;

    const char* complaint() const noexcept { return complaint_.load(); }

private:
    struct Command {
        glm::dvec3 force{0};   /* N */
        std::int64_t time = 0; /* ns: when it was put */
    };

    unsigned frame() noexcept;
    Frame position() noexcept;
    void display(const glm::dvec3& force) noexcept;
    glm::dvec3 newest_force(std::int64_t now) noexcept;
    bool succeeded() noexcept;
    bool wait_for(const std::atomic<bool>& happened, int most) const noexcept;

    const HdCalls& calls_;
    const unsigned device_;
    Newest<Frame> frames_;
    Newest<Command> commands_;
    Command command_;                      // the scheduler's
    std::atomic<std::int64_t> called_ = 0; // ns: when the last frame began
    std::atomic<std::int64_t> rested_ = 0; // ns: when rest() was called last
    std::atomic<pthread_t> thread_{};      // the scheduler's
    std::atomic<bool> displayed_ = true;   // the last frame's force
    std::atomic<bool> halted_ = false, ending_ = false, silent_ = false, ended_ = false;
    std::atomic<const char*> complaint_ = nullptr;
};

} // namespace forceshade::device
