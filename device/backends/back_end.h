// The live loop's interface to a haptic device, simulated or real: read a position, display a force. Also what its
// threads share: the clock, priorities, and a wait-free hand-over of values.
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
#include <utility>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "host/error.h"
#include "host/reference/elementary.h"

namespace forceshade::device {

inline constexpr double kUnknown = std::numeric_limits<double>::infinity();
inline constexpr double kSlowestRate = 100, kFastestRate = 10000; /* Hz: of the live loop */

/// What a device is and can do. In the world of every back end x points to the user's right, y away from the user and
/// z up, whatever the vendor's axes are.
struct DeviceFacts {
    std::string name;                   // "Inverse3 04BA": distinguishes it from another device
    std::string software;               // "Inverse Service 3.5.1": its driver, with the version
    double max_force = kUnknown;        /* N: the largest force that it displays */
    double continuous_force = kUnknown; /* N: the largest force that it can display without time limit */
    glm::dvec3 low{-kUnknown};          /* m: the workspace */
    glm::dvec3 high{kUnknown};          /* m */
    double rate = 1000;                 /* Hz: of the loop unless the user says another: a recording's own */
    bool simulated = false;             // each read() is one sample later than the one before, whatever the clock says
    double silence = kUnknown;          /* s: after such a pause between forces it may have dropped the last one */
    bool has_watchdog = true;           // a process that is killed leaves no force
    unsigned buttons = 0;               // how many it can report
    std::string remark;                 // a note for the user; empty: none
};

/// How a device answered a question for its position.
enum class Answer {
    fresh,    // measured since the last one
    repeated, // no newer one: the last one again
    failed,   // no answer, or one without a position
    ended,    // there are no more (a recording is over)
};

struct Reading {
    Answer answer = Answer::failed;
    glm::dvec3 position{0};    /* m; undefined for `failed` and `ended`; may be not finite for `fresh` */
    bool begins_path = false;  // the probe did not move here from the position before
    std::uint32_t buttons = 0; // pressed ones, button N as bit N - 1; undefined for `failed` and `ended`
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

    /// Whether the device's motors give less than the force written last. By the loop's thread.
    virtual bool saturated() const noexcept { return false; }

    /// Why a connected device displays no force (not calibrated, switched off by the user); null: it displays forces.
    /// Lives as long as the program; from any thread.
    virtual const char* withheld() const noexcept { return nullptr; }

    /// No force from now on, whatever is written. From any thread while others are at work, from a signal's handler
    /// too; more than once. Best effort: what the device allows.
    virtual void halt() noexcept = 0;

    /// No force until the next write(). Called from another thread while the loop's is stuck. Not needed for devices
    /// whose driver drops the force by itself when none is written.
    virtual void rest() noexcept {}

    /// The device's last error in words; null: none. Lives as long as the program; from any thread.
    virtual const char* error_text() const noexcept { return nullptr; }
};

/// A device, its service or its library is not there: exit 3. The message says how to get it.
class DeviceAbsent : public Error {
public:
    template <typename... Arguments>
    explicit DeviceAbsent(fmt::format_string<Arguments...> message, Arguments&&... arguments)
        : Error(ExitCode::no_device, fmt::format(message, std::forward<Arguments>(arguments)...)) {}
};

/// Hands the newest value from one thread to another. Both are wait-free: neither sees a value half written, and a
/// value that was not taken before the next one came is gone. A triple buffer: the writer fills one place, the reader
/// reads another, the third holds the newest, and each thread swaps its own for that one.
template <typename T> class Newest {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    /// By the writing thread only.
    void put(const T& value) noexcept {
        places_[writing_] = value;
        writing_ = between_.exchange(writing_ | kFresh, std::memory_order_acq_rel) & ~kFresh;
    }

    /// By the reading thread only: false, and `value` as it was, if no newer one was put.
    bool take(T& value) noexcept {
        if ((between_.load(std::memory_order_relaxed) & kFresh) == 0)
            return false;
        reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & ~kFresh;
        value = places_[reading_];
        return true;
    }

private:
    static constexpr std::uint32_t kFresh = 4; // added to the place's index: not taken yet

    std::array<T, 3> places_{};
    std::uint32_t writing_ = 0, reading_ = 1;
    std::atomic<std::uint32_t> between_ = 2;
};

using reference::is_finite;

inline constexpr std::int64_t kSecond = 1'000'000'000; /* ns */

inline std::int64_t read_clock(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return std::int64_t(time.tv_sec) * kSecond + time.tv_nsec;
}

/// ns of the monotonic clock, which is never set, from an arbitrary beginning.
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
