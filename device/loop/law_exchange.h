// The force law of a live loop, exchanged while it runs.
#pragma once

#include <atomic>
#include <memory>

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

} // namespace forceshade::device
