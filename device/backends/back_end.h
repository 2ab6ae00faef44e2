// What the live loop asks of a haptic device, simulated or real: where is the probe, and push it so hard.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <pthread.h>
#include <sched.h>
#include <string>
#include <type_traits>

#include <glm/vec3.hpp>

#include "host/error.h"

namespace forceshade::device {

inline constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// What a device is and can do. In the world of every back end x points to the user's right, y away from the user and
/// z up, whatever the vendor's axes are.
struct DeviceFacts {
    std::string name;                // "Inverse3 04BA": as the user would tell it from another
    std::string software;            // "Inverse Service 3.5.1": through what it is driven, with its version
    double max_force = kUnknown;     /* N: the largest force that it displays */
    double lasting_force = kUnknown; /* N: the largest force that its motors bear for any time */
    glm::dvec3 low{-kUnknown};       /* m: the workspace */
    glm::dvec3 high{kUnknown};       /* m */
    bool simulated = false;          // each read() is one sample later than the one before, whatever the clock says
    double silence = kUnknown;       /* s: after such a pause between forces it may have taken the last one away */
    bool has_watchdog = true;        // a process that is killed leaves no force
    std::string remark;              // what else the user should know; empty: nothing
};

/// What became of a question for the position.
enum class Answer {
    fresh,  // measured since the last one
    held,   // nothing newer than the last one, which is returned again
    failed, // the device did not answer, or with what is no position
    ended,  // there are no more (a recording is over)
};

struct Reading {
    Answer answer = Answer::failed;
    glm::dvec3 position{0};   /* m; of `failed` and `ended` without a meaning, of `fresh` perhaps not finite */
    bool begins_path = false; // what was felt before does not matter any more
};

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
    virtual const char* complaint() const noexcept = 0;
};

/// A device, its service or its library is not there: exit 3. The message says how to get it.
class DeviceAbsent : public Error {
public:
    explicit DeviceAbsent(const std::string& message) : Error(ExitCode::no_device, message) {}
};

// The newest value that one thread has to tell another, neither of them ever waiting.

/// Hand-over of values from one thread that puts them to one that takes them. Both are wait-free: neither sees a value
/// half written, and values that were not taken before the next one came are gone. Of three places the writer fills
/// one, the reader reads another, and the third, which they exchange for theirs, holds the newest.
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

// Which thread of a live run goes before which, where the system permits it.

/// Of SCHED_FIFO: the loop's, one that carries its forces to a device, the watchdog's, which both must not hold up.
inline constexpr int kCarrierPriority = 75, kLoopPriority = 80, kWatchdogPriority = 85;

/// For the calling thread; 0, or the reason why not (errno).
inline int raise_priority(int priority) noexcept {
    sched_param parameters{};
    parameters.sched_priority = priority;
    return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

} // namespace forceshade::device
