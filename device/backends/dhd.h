// Who is in the vendor's library: one thread at a time, and no handler of a signal that interrupted it there.
#pragma once

#include <atomic>
#include <memory>
#include <poll.h>
#include <pthread.h>
#include <string>
#include <string_view>
#include <vector>

#include "device/backends/back_end.h"

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

// Force Dimension's devices (omega, delta, sigma, lambda; Novint's Falcon), through the vendor's DHD SDK.

/// Opens a device: the one of this index, or with an empty text the first that is free. Its watchdog, where the device
/// has one, takes the force away when none was written for 32 ms. A position that is none in metres is refused.
/// \throws UsageError for what is no index, DeviceAbsent without library or device.
std::unique_ptr<BackEnd> open_dhd(std::string_view index);

/// What there is to be opened; nothing is moved.
struct DhdFound {
    std::string file;     // of the library
    std::string software; // "DHD SDK 3.17.6.0"
    int devices = 0;
    std::string complaint; // of the library, where there is no device
};

/// \throws DeviceAbsent without the library.
DhdFound find_dhd();

} // namespace forceshade::device
