// Chunks of a field on their way from the engine to the thread that encodes their case, bounded in bytes over all
// cases.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade {

/// A chunk that owns its samples.
template <typename T> struct OwnedChunk {
    layout::FieldChunk<T> view; // its spans point into the vectors below
    std::vector<T> force, depth, proxy, unshaded;
    std::vector<layout::uint> facet;

    OwnedChunk() = default;
    explicit OwnedChunk(const layout::FieldChunk<T>& from) { assign(from); }
    OwnedChunk(OwnedChunk&&) noexcept = default; // the vectors' memory stays where it is
    OwnedChunk& operator=(OwnedChunk&&) noexcept = default;

    void assign(const layout::FieldChunk<T>& from) {
        view = from;
        const auto copy = []<typename Value>(std::vector<Value>& own, std::span<const Value>& samples) {
            own.assign(samples.begin(), samples.end());
            samples = own;
        };
        copy(force, view.force);
        copy(depth, view.depth);
        copy(proxy, view.proxy);
        copy(unshaded, view.unshaded);
        copy(facet, view.facet);
    }
};

template <typename T> std::size_t bytes_of(const layout::FieldChunk<T>& chunk) {
    return (chunk.force.size() + chunk.depth.size() + chunk.proxy.size() + chunk.unshaded.size()) * sizeof(T) +
           chunk.facet.size() * sizeof(layout::uint);
}

using AnyChunk = std::variant<OwnedChunk<float>, OwnedChunk<double>>;

/// Bytes that may wait between engine and encoders; one chunk always may. The memory of those that were encoded is
/// used again: the system would have to clear fresh memory first.
class ChunkBudget {
public:
    explicit ChunkBudget(std::size_t bytes) : free_(bytes), all_(bytes) {}

    /// A share of the budget, given back when it goes out of scope, also by an exception.
    class Share {
    public:
        Share(ChunkBudget& budget, std::size_t bytes) : budget_(&budget), bytes_(bytes) {}
        Share(Share&& from) noexcept : budget_(std::exchange(from.budget_, nullptr)), bytes_(from.bytes_) {}
        Share& operator=(Share&& from) noexcept {
            std::swap(budget_, from.budget_);
            std::swap(bytes_, from.bytes_);
            return *this;
        }
        ~Share() {
            if (budget_)
                budget_->give(bytes_);
        }

    private:
        ChunkBudget* budget_;
        std::size_t bytes_;
    };

    /// Waits until there is room.
    Share take(std::size_t bytes) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return free_ >= bytes || free_ == all_; });
        const std::size_t taken = std::min(bytes, free_);
        free_ -= taken;
        return Share(*this, taken);
    }

    /// A copy, in the memory of one that was encoded if there is one.
    template <typename T> OwnedChunk<T> copy_of(const layout::FieldChunk<T>& chunk) {
        OwnedChunk<T> copy;
        {
            const std::lock_guard lock(mutex_);
            if (!encoded_.empty()) {
                if (auto* const same = std::get_if<OwnedChunk<T>>(&encoded_.back()))
                    copy = std::move(*same);
                encoded_.pop_back();
            }
        }
        copy.assign(chunk);
        return copy;
    }
    void encoded(AnyChunk chunk) {
        constexpr std::size_t kKept = 2; // the engine takes one at a time
        const std::lock_guard lock(mutex_);
        if (encoded_.size() < kKept)
            encoded_.push_back(std::move(chunk));
    }

private:
    void give(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        free_ += bytes;
        changed_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t free_, all_;
    std::vector<AnyChunk> encoded_;
};

/// A chunk on its way; it counts against the budget as long as it lives.
struct WaitingChunk {
    AnyChunk chunk;
    ChunkBudget::Share share;
};

/// Thrown to the engine when the encoder of its case has failed: there is no use in computing on.
struct EncoderFailed : std::runtime_error {
    EncoderFailed() : std::runtime_error("the case's encoder failed") {}
};

/// The chunks of one case, in order.
class ChunkQueue {
public:
    explicit ChunkQueue(ChunkBudget& budget) : budget_(budget) {}

    /// Waits for room. \throws EncoderFailed once the consumer has abandoned the queue.
    template <typename T> void push(const layout::FieldChunk<T>& chunk) {
        ChunkBudget::Share share = budget_.take(bytes_of(chunk));
        OwnedChunk<T> owned = budget_.copy_of(chunk);
        const std::lock_guard lock(mutex_);
        if (abandoned_)
            throw EncoderFailed();
        chunks_.push_back({std::move(owned), std::move(share)});
        changed_.notify_all();
    }

    /// No more chunks: the case is complete, or (`whole` false) will never be.
    void close(bool whole) {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        whole_ = whole;
        changed_.notify_all();
    }

    /// The next chunk; nothing at the end.
    std::optional<WaitingChunk> pop() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return closed_ || !chunks_.empty(); });
        if (chunks_.empty())
            return std::nullopt;
        WaitingChunk chunk = std::move(chunks_.front());
        chunks_.pop_front();
        return chunk;
    }
    bool whole() const { return whole_; }
    /// A chunk that came from here is not needed any more.
    void encoded(WaitingChunk chunk) { budget_.encoded(std::move(chunk.chunk)); }

    /// The consumer gives up: waiting chunks are dropped, further ones refused.
    void abandon() {
        const std::lock_guard lock(mutex_);
        abandoned_ = true;
        chunks_.clear();
    }

private:
    ChunkBudget& budget_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<WaitingChunk> chunks_;
    bool closed_ = false, whole_ = false, abandoned_ = false;
};

} // namespace forceshade
