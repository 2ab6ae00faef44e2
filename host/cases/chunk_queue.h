// Chunks of a field on their way from the engine to the thread that encodes their case, bounded in bytes over all
// cases.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
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

    explicit OwnedChunk(const layout::FieldChunk<T>& from)
        : view(from), force(from.force.begin(), from.force.end()), depth(from.depth.begin(), from.depth.end()),
          proxy(from.proxy.begin(), from.proxy.end()), unshaded(from.unshaded.begin(), from.unshaded.end()),
          facet(from.facet.begin(), from.facet.end()) {
        view.force = force;
        view.depth = depth;
        view.proxy = proxy;
        view.unshaded = unshaded;
        view.facet = facet;
    }
    OwnedChunk(OwnedChunk&&) noexcept = default; // the vectors' memory stays where it is
    OwnedChunk& operator=(OwnedChunk&&) noexcept = default;

    std::size_t bytes() const {
        return (force.size() + depth.size() + proxy.size() + unshaded.size()) * sizeof(T) +
               facet.size() * sizeof(layout::uint);
    }
};

using AnyChunk = std::variant<OwnedChunk<float>, OwnedChunk<double>>;

/// Bytes that may wait between engine and encoders; one chunk always may.
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

private:
    void give(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        free_ += bytes;
        changed_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t free_, all_;
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
        OwnedChunk<T> owned(chunk);
        ChunkBudget::Share share = budget_.take(owned.bytes());
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
