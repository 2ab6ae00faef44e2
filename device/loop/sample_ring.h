// Samples on their way from the live loop to whoever writes them down: one thread puts, one takes, none waits.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <span>
#include <vector>

#include "device/loop/sample.h"

namespace forceshade::device {

class SampleRing {
public:
    /// Room for so many samples at least; the memory is touched here, so that the loop never waits for a page.
    explicit SampleRing(std::size_t samples) : slots_(std::bit_ceil(samples)), mask_(slots_.size() - 1) {}

    std::size_t capacity() const noexcept { return slots_.size(); }

    /// False if there is no room: the sample is lost.
    bool put(const LiveSample& sample) noexcept {
        const std::size_t at = put_.load(std::memory_order_relaxed);
        if (at - taken_.load(std::memory_order_acquire) == slots_.size())
            return false;
        slots_[at & mask_] = sample;
        put_.store(at + 1, std::memory_order_release);
        return true;
    }

    /// The oldest samples that lie in a row; leave() gives their room back.
    std::span<const LiveSample> look() const noexcept {
        const std::size_t from = taken_.load(std::memory_order_relaxed);
        const std::size_t count = put_.load(std::memory_order_acquire) - from;
        const std::size_t first = from & mask_;
        return {slots_.data() + first, std::min(count, slots_.size() - first)};
    }
    void leave(std::size_t count) noexcept {
        taken_.store(taken_.load(std::memory_order_relaxed) + count, std::memory_order_release);
    }

private:
    std::vector<LiveSample> slots_;
    const std::size_t mask_;
    alignas(64) std::atomic<std::size_t> put_ = 0;
    alignas(64) std::atomic<std::size_t> taken_ = 0;
};

} // namespace forceshade::device
