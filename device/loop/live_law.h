// The force law of a scene as the live loop asks for it: one probe, one sample after the other.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include <glm/vec3.hpp>

namespace forceshade {
struct PreparedCase;
}

namespace forceshade::device {

/// The law at a probe; numbers of the run's precision, so that each float is exact here.
struct LiveContact {
    glm::dvec3 proxy; /* m, in the world: the scene's origin and a number of that precision; out of contact the probe */
    glm::dvec3 force; /* N: perhaps not finite */
    double depth;     /* m */
    std::uint32_t facet; // layout::kNoFacet out of contact
    bool finished;       // the proxy reached its rest position
};

/// Same numbers as `explore` (host/paths), bit for bit. Neither allocates, locks, throws nor logs.
class LiveLaw {
public:
    virtual ~LiveLaw() = default;

    /// The first 64 bits of the SHA-256 of its scene's resolved TOML: of which scene a sample is.
    std::uint64_t scene = 0;

    /// Whether the law has a meaning there: finite, and within the reach of the precision.
    virtual bool reaches(const glm::dvec3& probe) const noexcept = 0;

    /// Forgets the history: the next probe begins a path.
    virtual void begin_path() noexcept = 0;

    /// At a probe in the world, m, that the law reaches; each coordinate, from the scene's origin, is rounded once to
    /// the run's precision.
    virtual LiveContact at(const glm::dvec3& probe) noexcept = 0;
};

/// In the scene's precision; owns what it needs. \throws UsageError if a value leaves the precision's range.
std::unique_ptr<LiveLaw> make_live_law(PreparedCase prepared);

/// A new law for a loop that runs: handed over without a lock, the old one handed back to be freed elsewhere.
class LawExchange {
public:
    explicit LawExchange(std::unique_ptr<LiveLaw> first) : present_(first.release()) {}
    ~LawExchange() {
        delete present_;
        delete next_.load();
        delete former_.load();
    }
    LawExchange(const LawExchange&) = delete;
    LawExchange& operator=(const LawExchange&) = delete;

    /// From any one thread that is not the loop: `law` is used from the next sample on. One that was offered before and
    /// is not yet used is dropped.
    void offer(std::unique_ptr<LiveLaw> law) {
        delete next_.exchange(law.release(), std::memory_order_acq_rel);
        delete former_.exchange(nullptr, std::memory_order_acq_rel);
    }

    /// From the thread that offers: false if the law that was offered last is used already.
    bool withdraw() {
        const std::unique_ptr<LiveLaw> law(next_.exchange(nullptr, std::memory_order_acq_rel));
        return law != nullptr;
    }

    /// From the loop: true if there is a new law. It waits until offer() has freed the former one.
    bool update() noexcept {
        if (next_.load(std::memory_order_relaxed) == nullptr || former_.load(std::memory_order_acquire) != nullptr)
            return false;
        LiveLaw* const next = next_.exchange(nullptr, std::memory_order_acq_rel);
        if (next == nullptr)
            return false;
        former_.store(present_, std::memory_order_release);
        present_ = next;
        return true;
    }

    LiveLaw& present() noexcept { return *present_; } // the loop's

private:
    LiveLaw* present_;
    std::atomic<LiveLaw*> next_ = nullptr, former_ = nullptr;
};

} // namespace forceshade::device
