// The newest value that one thread has to tell another, neither of them ever waiting.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace forceshade::device {

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

} // namespace forceshade::device
