// One sample of the live loop: its measurements, its flags, its counts, and the ring that carries it to its readers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <glm/vec3.hpp>

#include "device/backends/back_end.h"

namespace forceshade::device {

/// ns that this thread has computed.
inline std::int64_t computed_so_far() noexcept {
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

/// Returns at a time of now(), or at once if it has passed.
inline void sleep_until(std::int64_t time) noexcept {
    const timespec until{time / kSecond, static_cast<long>(time % kSecond)};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

/// Histogram of times, in ns from 0 on, in bins at most a thirty-second of their own value wide. Adding
/// neither allocates nor fails; 15 KiB.
class Histogram {
public:
    static constexpr unsigned kFine = 5; // bits below the leading one that select a bin
    static constexpr std::size_t kBins = (64 - kFine + 1) << kFine;

    void add(std::int64_t time) noexcept {
        const std::uint64_t value = time > 0 ? static_cast<std::uint64_t>(time) : 0;
        ++bins_[bin_of(value)];
        ++count_;
        sum_ += static_cast<double>(value);
        largest_ = value > largest_ ? value : largest_;
    }

    std::uint64_t count() const noexcept { return count_; }
    std::uint64_t largest() const noexcept { return largest_; }                                  /* ns */
    double mean() const noexcept { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; } /* ns */

    /// The least upper end of a bin, ns, that this share of the times does not exceed; never more than the largest.
    double quantile(double share) const noexcept {
        const double wanted = share * static_cast<double>(count_);
        std::uint64_t seen = 0;
        for (std::size_t bin = 0; bin < kBins; ++bin) {
            seen += bins_[bin];
            if (bins_[bin] > 0 && static_cast<double>(seen) >= wanted) {
                return static_cast<double>(std::min(begin_of(bin + 1), largest_));
            }
        }
        return 0;
    }

    std::uint64_t bin(std::size_t index) const noexcept { return bins_[index]; }

    /// The least value, ns, of a bin, of which the last one's end is 2^64.
    static constexpr std::uint64_t begin_of(std::size_t bin) noexcept {
        if (bin < (std::size_t(2) << kFine))
            return bin;
        const std::size_t power = (bin >> kFine) - 1;
        if (power >= 64 - kFine)
            return ~std::uint64_t(0);
        return ((std::uint64_t(1) << kFine) + (bin & ((std::size_t(1) << kFine) - 1))) << power;
    }

    static constexpr std::size_t bin_of(std::uint64_t value) noexcept {
        if (value < (std::uint64_t(1) << kFine))
            return static_cast<std::size_t>(value);
        const auto power = static_cast<unsigned>(std::bit_width(value)) - 1 - kFine;
        return (std::size_t(power + 1) << kFine) + ((value >> power) & ((std::uint64_t(1) << kFine) - 1));
    }

private:
    std::array<std::uint64_t, kBins> bins_{};
    std::uint64_t count_ = 0, largest_ = 0;
    double sum_ = 0;
};

/// Events and faults of a sample, as bits.
enum SampleFlag : std::uint32_t {
    kClamped = 1u << 0,     // the force was larger than allowed
    kSlewed = 1u << 1,      // it changed faster than allowed
    kRamping = 1u << 2,     // it ramps up after the start, a fault, or a while without contact
    kDamped = 1u << 3,      // the passivity controller took energy out
    kNoNumber = 1u << 4,    // the law's force was not finite: none was displayed
    kBadPosition = 1u << 5, // no valid position: no force was displayed
    kStale = 1u << 6,       // no new position for too long: no force was displayed
    kOutside = 1u << 7,     // the position lay outside of the workspace: no force was displayed
    kTooFast = 1u << 8,     // the probe moved faster than allowed: no force was displayed
    kTooLate = 1u << 9,     // the sample came later than the watchdog allows, or the pause was so long that the
                            // device dropped the force: no force was displayed, the next one starts from zero
    kFailed = 1u << 10,     // the device gave no position or did not accept the force
    kUnfinished = 1u << 11, // the proxy could not come to rest
    kOverrun = 1u << 12,    // the sample ended after the next one was due
    kOwnOverrun = 1u << 13, // and would have, had it begun in time and never been interrupted
    kWithheld = 1u << 14,   // the device is not calibrated, switched off, ...: no force was displayed
    kLasting = 1u << 15,    // the force exceeded the limit of the continuous force
    kNewPath = 1u << 16,    // a path begins in mid-run: the force of the one before was dropped
    kDeadMan = 1u << 17,    // the dead-man switch was released: no force was displayed
    kClutched = 1u << 18,   // the clutch was held: no force was displayed, and the probe stayed in place
    kUnstable = 1u << 19,   // the force drove an oscillation: it fades out until the probe has left the surface
    kSaturated = 1u << 20,  // the device's motors give less than the force displayed
};

inline constexpr std::array<std::string_view, 21> kSampleFlagNames{
    "clamped",  "slewed",   "ramping",  "damped",   "no_number",  "bad_position", "stale",
    "outside",  "too_fast", "too_late", "failed",   "unfinished", "overrun",      "own_overrun",
    "withheld", "lasting",  "new_path", "dead_man", "clutched",   "unstable",     "saturated"};

inline std::string flag_names(std::uint32_t flags, std::string_view between) {
    std::string names;
    for (std::size_t bit = 0; bit < kSampleFlagNames.size(); ++bit)
        if (flags >> bit & 1u)
            names.append(names.empty() ? "" : between).append(kSampleFlagNames[bit]);
    return names;
}

/// Flags with which no force is displayed.
inline constexpr std::uint32_t kZeroForceFlags =
    kNoNumber | kBadPosition | kStale | kOutside | kTooFast | kTooLate | kFailed | kWithheld | kDeadMan | kClutched;

struct LiveSample {
    std::uint64_t tick = 0;     // from 0 on, none left out
    std::uint32_t path = 0;     // one more with each change of the scene or beginning of a recorded path
    std::uint32_t flags = 0;    // SampleFlag
    double time = 0;            /* s since the start: when the position had been read */
    glm::dvec3 probe{0};        /* m: where the law was evaluated: the last valid position */
    glm::dvec3 proxy{0};        /* m */
    glm::dvec3 force{0};        /* N: the law's */
    glm::dvec3 commanded{0};    /* N: sent to the device, in the scene's axes; zero where it did not accept it */
    double depth = 0;           /* m */
    double energy = 0;          /* J: given to the hand since the start */
    std::int64_t late = 0;      /* ns: from when the sample was due until the loop woke */
    std::int32_t reading = 0;   /* ns */
    std::int32_t computing = 0; /* ns: law and safety */
    std::int32_t writing = 0;   /* ns */
    std::uint32_t facet = 0;    // layout::kNoFacet out of contact
    std::uint32_t buttons = 0;  // pressed: Reading::buttons
    std::uint64_t scene = 0;    // ProbeLaw::scene
};

/// Counted by the loop as it runs.
struct LoopCounts {
    std::uint64_t samples = 0;                                  // at which the law was evaluated
    std::uint64_t waiting = 0;                                  // before the device gave its first position; not logged
    std::uint64_t in_contact = 0;                               // of the samples
    std::uint64_t paths = 0;                                    // begun: scenes, and paths of a recording
    std::array<std::uint64_t, kSampleFlagNames.size()> flags{}; // samples, by bit of SampleFlag
    std::uint64_t with(SampleFlag what) const noexcept { return flags[unsigned(std::countr_zero(unsigned(what)))]; }
    std::uint64_t lost = 0;                // samples that the log had no room for
    double largest_force = 0;              /* N: the law's */
    double largest_commanded = 0;          /* N */
    double largest_depth = 0;              /* m */
    double largest_speed = 0;              /* m/s */
    double energy = 0;                     /* J: given to the hand, at the end */
    double largest_energy = 0;             /* J: the most at any time */
    double damped = 0;                     /* J: dissipated by the passivity controller */
    Histogram reading, computing, writing; /* ns */
    Histogram late;                        /* ns: after the sample was due; empty as fast as possible */
    Histogram jitter;      /* ns: deviation of the time between samples from the period; empty as fast as possible */
    double standstill = 0; /* s: of `seconds`: pauses of the process so long that
                              samples did not become due */
    double seconds = 0;    /* s: by the clock */
};

/// Samples on their way from the live loop to one reader: one thread puts, another reads, neither waits.
class SampleRing {
public:
    /// Room for at least `samples`; the memory is touched here, so that the loop never waits for a page.
    explicit SampleRing(std::size_t samples) : slots_(std::bit_ceil(samples)), mask_(slots_.size() - 1) {}

    /// False if there is no room: the sample is lost.
    bool put(const LiveSample& sample) noexcept {
        const std::size_t at = put_.load(std::memory_order_relaxed);
        if (at - read_.load(std::memory_order_acquire) == slots_.size())
            return false;
        slots_[at & mask_] = sample;
        put_.store(at + 1, std::memory_order_release);
        return true;
    }

    /// The oldest samples that lie in a row; release() frees their room.
    std::span<const LiveSample> look() const noexcept {
        const std::size_t from = read_.load(std::memory_order_relaxed);
        const std::size_t count = put_.load(std::memory_order_acquire) - from;
        const std::size_t first = from & mask_;
        return {slots_.data() + first, std::min(count, slots_.size() - first)};
    }
    void release(std::size_t count) noexcept {
        read_.store(read_.load(std::memory_order_relaxed) + count, std::memory_order_release);
    }

private:
    std::vector<LiveSample> slots_;
    const std::size_t mask_;
    alignas(64) std::atomic<std::size_t> put_ = 0;
    alignas(64) std::atomic<std::size_t> read_ = 0;
};

/// For a reader's thread: calls `take` with batches of up to 1024 samples in order, and with an empty span before each
/// pause; until a stop is requested and the ring is empty.
template <typename Take>
void drain(SampleRing& ring, const std::stop_token& stop, std::chrono::milliseconds pause, Take&& take) {
    constexpr std::size_t kAtOnce = 1024; // before their room is freed
    while (true) {
        const bool last = stop.stop_requested(); // read first: no sample is put after it
        const std::span<const LiveSample> all = ring.look(), samples = all.first(std::min(all.size(), kAtOnce));
        take(samples);
        ring.release(samples.size());
        if (!samples.empty())
            continue;
        if (last)
            return;
        std::this_thread::sleep_for(pause);
    }
}

} // namespace forceshade::device
