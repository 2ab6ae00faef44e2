// What the live loop asks of a haptic device, simulated or real: its position, and to display a force. With what its
// threads share: the clock, priorities, and a hand-over of values without waiting.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <limits>
#include <pthread.h>
#include <sched.h>
#include <string>
#include <type_traits>

#include <glm/vec3.hpp>

#include "host/error.h"

namespace forceshade::device {

inline constexpr double kUnknown = std::numeric_limits<double>::infinity();
inline constexpr double kSlowestRate = 100, kFastestRate = 10000; /* Hz: of the live loop */

/// What a device is and can do. In the world of every back end x points to the user's right, y away from the user and
/// z up, whatever the vendor's axes are.
struct DeviceFacts {
    std::string name;                // "Inverse3 04BA": as the user would tell it from another
    std::string software;            // "Inverse Service 3.5.1": through what it is driven, with its version
    double max_force = kUnknown;     /* N: the largest force that it displays */
    double lasting_force = kUnknown; /* N: the largest force that its motors bear for any time */
    glm::dvec3 low{-kUnknown};       /* m: the workspace */
    glm::dvec3 high{kUnknown};       /* m */
    double rate = 1000;              /* Hz: of the loop unless the user says another: a recording's own */
    bool simulated = false;          // each read() is one sample later than the one before, whatever the clock says
    double silence = kUnknown;       /* s: after such a pause between forces it may have dropped the last one */
    bool has_watchdog = true;        // a process that is killed leaves no force
    unsigned buttons = 0;            // that it tells of, at most
    std::string remark;              // what else the user should know; empty: nothing
};

/// How a device answered a question for its position.
enum class Answer {
    fresh,    // measured since the last one
    repeated, // nothing newer than the last one, which is returned again
    failed,   // no answer, or one without a position
    ended,    // there are no more (a recording is over)
};

struct Reading {
    Answer answer = Answer::failed;
    glm::dvec3 position{0};    /* m; of `failed` and `ended` without a meaning, of `fresh` perhaps not finite */
    bool begins_path = false;  // the probe did not move here from the position before
    std::uint32_t buttons = 0; // pressed ones, button N as bit N - 1; of `failed` and `ended` without a meaning
};

/// The bit of a button, which people count from 1 to 32; none for 0.
constexpr std::uint32_t button_bit(unsigned button) noexcept {
    return button == 0 ? 0 : 1u << (button - 1);
}

/// A device that is open. Constructing one may take its time and throws DeviceAbsent or UsageError; destroying one
/// leaves the device without force. In between, read() and write() are called in turn by the live loop's thread: they
/// neither allocate, lock, throw nor log, and come back within a fraction of a sample.
class BackEnd {
public:
    virtual ~BackEnd() = default;

    virtual const DeviceFacts& facts() const noexcept = 0;

    /// The newest position.
    virtual Reading read() noexcept = 0;

    /// Displays a force, N, finite, until the next one; false: this force is not displayed.
    virtual bool write(const glm::dvec3& force) noexcept = 0;

    /// Why the device, which is there, displays no force: not calibrated, switched off by the user. Null: it does.
    /// Lives as long as the program; from any thread.
    virtual const char* withheld() const noexcept { return nullptr; }

    /// No force from now on, whatever is written. From any thread while others are at work, from a signal's handler
    /// too; more than once. Best effort: what the device allows.
    virtual void halt() noexcept = 0;

    /// No force until the next write(), from another thread than the loop's, which does not come round. Devices whose
    /// driver does so by itself when nothing is written need nothing here.
    virtual void rest() noexcept {}

    /// In words, what the device complained of last; null: nothing. Lives as long as the program; from any thread.
    virtual const char* complaint() const noexcept { return nullptr; }
};

/// A device, its service or its library is not there: exit 3. The message says how to get it.
class DeviceAbsent : public Error {
public:
    explicit DeviceAbsent(const std::string& message) : Error(ExitCode::no_device, message) {}
};

/// Hands the newest value from one thread to another. Both are wait-free: neither sees a value half written, and a
/// value that was not taken before the next one came is gone. Of three places the writer fills one, the reader reads
/// another, and the third, which they exchange for theirs, holds the newest.
template <typename T> class Newest {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    /// By the writing thread only.
    void put(const T& value) noexcept {
        places_[writing_] = value;
        writing_ = between_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & ~kFresh;
    }

    /// By the reading thread only: false, and `value` as it was, if nothing was put since the last one was taken.
    bool take(T& value) noexcept {
        if ((between_.load(std::memory_order_relaxed) & kFresh) == 0)
            return false;
        reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & ~kFresh;
        value = places_[reading_];
        return true;
    }

private:
    static constexpr std::uint32_t kFresh = 4; // beside the place's index: not taken yet

    std::array<T, 3> places_{};
    std::uint32_t writing_ = 0, reading_ = 1;
    std::atomic<std::uint32_t> between_ = 2;
};

inline bool is_finite(const glm::dvec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline constexpr std::int64_t kSecond = 1'000'000'000; /* ns */

inline std::int64_t read_clock(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return std::int64_t(time.tv_sec) * kSecond + time.tv_nsec;
}

/// ns of the monotonic clock, which nobody sets, from an arbitrary beginning.
inline std::int64_t now() noexcept {
    return read_clock(CLOCK_MONOTONIC);
}

/// Priorities of SCHED_FIFO, where the system permits them: of the thread that carries forces to a device, of the
/// loop's, and of the watchdog's, which neither may delay.
inline constexpr int kCarrierPriority = 75, kLoopPriority = 80, kWatchdogPriority = 85;

/// For the calling thread; 0, or the reason why not (errno).
inline int raise_priority(int priority) noexcept {
    sched_param parameters{};
    parameters.sched_priority = priority;
    return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

} // namespace forceshade::device
