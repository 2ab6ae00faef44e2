// The live loop: read the position, evaluate the law, limit the force for safety, write it, at a steady rate.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "device/backends/back_end.h"
#include "device/loop/real_time.h"
#include "device/loop/safety.h"
#include "device/loop/sample.h"
#include "host/field/case_law.h"

namespace forceshade::device {

/// A new law for a loop that runs: handed over without a lock, the old one handed back to be freed elsewhere.
class LawExchange {
public:
    explicit LawExchange(std::unique_ptr<ProbeLaw> first) : present_(first.release()) {}
    ~LawExchange() {
        delete present_;
        delete next_.load();
        delete former_.load();
    }
    LawExchange(const LawExchange&) = delete;
    LawExchange& operator=(const LawExchange&) = delete;

    /// From any one thread that is not the loop: `law` is used from the next sample on. One that was offered before and
    /// is not yet used is dropped.
    void offer(std::unique_ptr<ProbeLaw> law) {
        delete next_.exchange(law.release(), std::memory_order_acq_rel);
        delete former_.exchange(nullptr, std::memory_order_acq_rel);
    }

    /// From the thread that offers: false if the last law offered is in use already.
    bool withdraw() {
        const std::unique_ptr<ProbeLaw> law(next_.exchange(nullptr, std::memory_order_acq_rel));
        return law != nullptr;
    }

    /// From the loop: true if it took a new law. A new law waits until offer() has freed the former one.
    bool update() noexcept {
        if (next_.load(std::memory_order_relaxed) == nullptr || former_.load(std::memory_order_acquire) != nullptr)
            return false;
        ProbeLaw* const next = next_.exchange(nullptr, std::memory_order_acq_rel);
        if (next == nullptr)
            return false;
        former_.store(present_, std::memory_order_release);
        present_ = next;
        return true;
    }

    ProbeLaw& present() noexcept { return *present_; } // the loop's

private:
    ProbeLaw* present_;
    std::atomic<ProbeLaw*> next_ = nullptr, former_ = nullptr;
};

/// The scene's placement in the device's space. The hand's position is in the device's axes and metres, relative to the
/// scene's origin; the probe is that point in the scene. Positions are scaled, forces are not: a spring of the scene
/// feels `scale` times as stiff. A force that is turned back does the work on the hand that the law's force does on the
/// probe, divided by the scale.
struct Mapping {
    glm::dvec3 origin{0}; /* m: where the scene's origin lies in the device's space */
    glm::dmat3 turn{1};   // columns: the scene's x, y and z in the device's axes; a rotation
    double scale = 1;     // of a metre of the device, in metres of the scene

    bool is_plain() const noexcept { return scale == 1 && turn == glm::dmat3(1); }

    // A scene that is neither turned nor scaled gives the same bits as without a mapping.
    glm::dvec3 to_scene(const glm::dvec3& hand) const noexcept {
        return is_plain() ? hand : scale * (hand * turn); // v * M: by the transpose
    }
    glm::dvec3 to_hand(const glm::dvec3& probe) const noexcept { return is_plain() ? probe : turn * probe / scale; }
    glm::dvec3 force_to_device(const glm::dvec3& force) const noexcept { return is_plain() ? force : turn * force; }
    glm::dvec3 force_to_scene(const glm::dvec3& force) const noexcept { return is_plain() ? force : force * turn; }
};

/// One line: "origin at (0, -150, 200) mm, scene's x, y, z along the device's y, -x, z; 2 m of the scene in a
/// metre of the device: springs feel 2 times as stiff".
std::string mapping_text(const Mapping& mapping);

/// A right-handed turn by `angle`, rad, about the device's axis 0, 1 or 2; exact for quarter turns.
glm::dmat3 turn_about(int axis, double angle);

/// A thread of its own, of higher priority than the loop's if the system allows it: drops the device's force while the
/// loop is stuck.
class Watchdog {
public:
    /// `patience`, ns: the longest time between two calls of feed().
    Watchdog(BackEnd& back_end, std::int64_t patience);
    ~Watchdog();

    void feed(std::int64_t now) noexcept { fed_.store(now, std::memory_order_relaxed); }

private:
    void run(const std::stop_token& stop) noexcept;

    BackEnd& back_end_;
    const std::int64_t patience_; /* ns */
    std::atomic<std::int64_t> fed_;
    std::jthread thread_;
};

struct LoopSettings {
    double rate = 1000;                   /* Hz: samples a second */
    bool real_time = true;                // false: as fast as possible; the time of a sample is its number / rate
    std::optional<std::uint64_t> samples; // after which it ends
    double standstill = 10; /* s: a process that stood still for longer restarts its clock where it wakes */
    double patience = 5;    /* s: without a position, or with a device that fails, after which it ends */
    std::optional<int> cpu; // to run on
    Mapping mapping;
    unsigned dead_man = 0; // the button without which no force is displayed; 0: none
    unsigned clutch = 0;   // the button with which the probe stays where it is and the hand moves alone; 0: none
    SafetyLimits limits;
};

enum class LoopEnd { running, done, stopped, recording_over, device_gone };

/// The loop's state while it runs; each number is the newest, but they need not be of one sample.
struct LoopStatus {
    std::atomic<std::uint64_t> samples = 0, waiting = 0, overruns = 0, clamped = 0, lost = 0;
    std::atomic<std::uint32_t> flags = 0;              // SampleFlags of the last sample
    std::atomic<std::uint32_t> buttons = 0;            // pressed then
    std::atomic<std::uint32_t> laws = 0, law_path = 0; // new laws in use so far, and the path that the last one began
    std::atomic<double> seconds = 0, force = 0, depth = 0, energy = 0; /* s, N commanded, m, J */
};

/// Its thread neither allocates, locks, throws nor logs from the first sample to the last. However it ends, the last
/// force written is zero.
class LiveLoop {
public:
    /// All arguments must outlive it. `log` receives the samples, if not null: as fast as possible the loop waits for
    /// room there; in real time a sample that finds none is lost, and counted. `others` receive them too, and the loop
    /// never waits for room there.
    LiveLoop(BackEnd& back_end, std::unique_ptr<ProbeLaw> law, const LoopSettings& settings, SampleRing* log,
             std::vector<SampleRing*> others = {});
    ~LiveLoop(); // stops it

    /// Its thread is not interrupted by signals from outside (host/program.h).
    void start();
    void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
    double period() const noexcept { return period_; } /* s */
    LoopEnd end() const noexcept { return end_.load(std::memory_order_acquire); }
    /// Waits for the end; call stop() first unless the loop ends by itself.
    void join();

    /// Uses another law from the next sample on, which begins a path. From one thread.
    void offer(std::unique_ptr<ProbeLaw> law) { laws_.offer(std::move(law)); }
    bool withdraw() { return laws_.withdraw(); }
    /// No force while it is suspended; from a signal's handler, too.
    void suspend(bool suspended) noexcept {
        at_rest_.store(false);
        suspended_.store(suspended);
    }
    /// Whether zero has been written since it was suspended, or the loop has ended.
    bool is_at_rest() const noexcept { return at_rest_.load() || end() != LoopEnd::running; }

    const LoopStatus& status() const noexcept { return status_; }

    /// After the end.
    const LoopCounts& counts() const noexcept { return *counts_; }
    const Permissions& permissions() const noexcept { return permissions_; }

private:
    struct Turn; // a sample in the making

    void run() noexcept;
    void ask_for_permissions() noexcept;
    void wait_until_due(Turn& turn) noexcept;
    void begin_path(Turn& turn) noexcept;
    bool read_position(Turn& turn) noexcept;
    glm::dvec3 probe_at(const glm::dvec3& hand) const noexcept;
    void look_at_buttons(Turn& turn, const Reading& reading) noexcept;
    void display_force(Turn& turn) noexcept;
    void skip(const Turn& turn) noexcept;
    void record(Turn& turn) noexcept;
    void publish(const LiveSample& sample) noexcept;
    bool is_over() noexcept;
    std::int64_t due(std::uint64_t tick) const noexcept;

    BackEnd& back_end_;
    const LoopSettings settings_;
    const double period_; /* s */
    SampleRing* const log_;
    const std::vector<SampleRing*> others_;
    LawExchange laws_;
    Safety safety_;
    std::unique_ptr<LoopCounts> counts_;
    Permissions permissions_;
    LoopStatus status_;
    std::optional<Watchdog> watchdog_;
    std::thread thread_;
    std::atomic<bool> stop_ = false, suspended_ = false, at_rest_ = false;
    std::atomic<LoopEnd> end_ = LoopEnd::running;

    // Of the loop's thread alone.
    std::int64_t first_due_ = 0; /* ns: when sample 0 was due, plus the pauses of the process */
    std::int64_t start_ = 0, woken_ = 0, computed_ = 0, written_ = 0; /* ns */
    std::uint64_t tick_ = 0;
    double last_time_ = 0;        /* s: of the last sample */
    double gone_ = 0;             /* s: since the device's last valid answer */
    glm::dvec3 hand_{0};          /* m: the last valid position of the device, counted from the scene's origin */
    glm::dvec3 probe_{0};         /* m: the same, in the scene */
    glm::dvec3 clutch_offset_{0}; /* m: how far the hand has moved alone, with the clutch held */
    bool clutched_ = false;       // the clutch was held at the last sample that had a position
    bool begun_ = false;          // a position has come
    bool path_begins_ = false;    // a path whose first position has not come yet
    bool accepted_ = true;        // the device accepted the last force
    std::uint32_t path_ = 0;
};

} // namespace forceshade::device
