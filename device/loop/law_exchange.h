// A new law for a loop that runs: handed over without a lock, the old one handed back to be freed elsewhere.
#pragma once

#include <atomic>
#include <memory>

#include "device/law/live_law.h"

namespace forceshade::device {

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

    /// From any one thread that is not the loop: `law` holds from the next sample on. One that was offered before and
    /// has not been taken is dropped.
    void offer(std::unique_ptr<LiveLaw> law) {
        delete next_.exchange(law.release(), std::memory_order_acq_rel);
        delete former_.exchange(nullptr, std::memory_order_acq_rel);
    }

    /// From the thread that offers: false if the law that was offered last has been taken.
    bool withdraw() {
        const std::unique_ptr<LiveLaw> law(next_.exchange(nullptr, std::memory_order_acq_rel));
        return law != nullptr;
    }

    /// From the loop: true if there is a new law. It waits while the former one has not been taken away; offer() does.
    bool take() noexcept {
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
