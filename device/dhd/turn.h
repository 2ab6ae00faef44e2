// Who is in the vendor's library: one thread at a time, and no handler of a signal that interrupted it there.
#pragma once

#include <atomic>

#include <poll.h>
#include <pthread.h>

namespace forceshade::device {

/// A door that one thread passes at a time, none waiting for long. Safe in a signal's handler, where a mutex is not:
/// the interrupted thread may be the one inside, and is then not waited for.
class Door {
public:
    bool enter() noexcept {
        pthread_t nobody{};
        return inside_.compare_exchange_strong(nobody, ::pthread_self());
    }

    /// Waits up to `most` ms for who is inside, unless it is the calling thread itself.
    bool enter_within(int most) noexcept {
        for (int waited = 0; !enter(); ++waited) {
            if (inside_.load() == ::pthread_self() || waited >= most)
                return false;
            ::poll(nullptr, 0, 1);
        }
        return true;
    }

    void leave() noexcept { inside_.store(pthread_t{}); }

private:
    static_assert(std::atomic<pthread_t>::is_always_lock_free);
    std::atomic<pthread_t> inside_{};
};

} // namespace forceshade::device
