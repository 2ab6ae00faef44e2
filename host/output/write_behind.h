// Puts buffers into a file on a thread of its own, and hashes them on their way: neither the disk nor the hash is
// waited for.
#pragma once

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include "host/output/files.h"

namespace forceshade {

/// Whole buffers at multiples of their size go past the kernel's cache where the file system can: through it they would
/// take ten times the processor's time, only to be dropped from it. Used by one thread; errors are errnos.
class WriteBehind {
public:
    /// `descriptor` must outlive it. `buffers` are allocated as they are needed.
    WriteBehind(int descriptor, bool hashed, std::size_t buffers)
        : descriptor_(descriptor), buffers_(buffers), pieces_(buffers) {
        if (hashed)
            hash_.emplace();
    }

    /// One that may be filled, until it is handed over or put. Waits for one.
    std::span<std::byte> free_buffer() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return end_ - begin_ < buffers_.size(); });
        Buffer& buffer = buffers_[end_ % buffers_.size()];
        if (!buffer)
            buffer.reset(static_cast<std::byte*>(std::aligned_alloc(kAlignment, kBufferBytes)));
        return buffer ? std::span(buffer.get(), kBufferBytes) : throw std::bad_alloc();
    }
    /// Writes the free buffer's first bytes sooner or later. 0, or what an earlier one met.
    int hand_over(std::span<std::byte> bytes, std::uint64_t position) {
        const std::lock_guard lock(mutex_);
        if (error_ != 0)
            return error_;
        pieces_[end_++ % buffers_.size()] = {bytes, position};
        if (!thread_.joinable())
            thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
        changed_.notify_all();
        return 0;
    }
    /// The same now, after those handed over; the buffer stays free.
    int put(std::span<const std::byte> bytes, std::uint64_t position) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return begin_ == end_; });
        return error_ != 0 ? error_ : error_ = write({bytes, position});
    }

    /// Of a file of this size that was written from its beginning to its end, once; else empty.
    std::string sha256(std::uint64_t size) { return hash_ && hashed_ == size ? hash_->finish() : std::string(); }

private:
    static constexpr std::size_t kBufferBytes = 1 << 19, kAlignment = 4096;
    static constexpr std::uint64_t kWriteBack = 8 << 20; /* bytes */

    struct Free {
        void operator()(std::byte* buffer) const noexcept { std::free(buffer); }
    };
    using Buffer = std::unique_ptr<std::byte, Free>;
    struct Piece {
        std::span<const std::byte> bytes;
        std::uint64_t position = 0;
    };

    void work(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (changed_.wait(lock, stop, [&] { return begin_ < end_; }) && !stop.stop_requested()) {
            const Piece piece = pieces_[begin_ % buffers_.size()];
            int number = error_;
            lock.unlock();
            if (number == 0)
                number = write(piece);
            lock.lock();
            error_ = number;
            ++begin_;
            changed_.notify_all();
        }
    }

    int write(Piece piece) {
        auto [bytes, position] = piece;
        if (hash_ && position == hashed_) {
            hash_->update(bytes);
            hashed_ += bytes.size();
        } else if (!bytes.empty()) {
            hash_.reset();
        }
        set_direct(bytes.size() == kBufferBytes && position % kBufferBytes == 0);
        while (!bytes.empty()) {
            const ssize_t put = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(position));
            if (put < 0 && errno == EINTR)
                continue;
            if (put < 0 && errno == EINVAL && direct_) { // the file system cannot, or wrote a part before
                set_direct(false);
                can_direct_ = false;
                continue;
            }
            if (put <= 0)
                return put < 0 ? errno : ENOSPC;
            position += static_cast<std::uint64_t>(put);
            bytes = bytes.subspan(static_cast<std::size_t>(put));
        }
        if (position >= written_back_ + kWriteBack) { // the disk begins now, not at the end
            ::sync_file_range(descriptor_, static_cast<off_t>(written_back_), kWriteBack, SYNC_FILE_RANGE_WRITE);
            written_back_ += kWriteBack;
        }
        return 0;
    }

    void set_direct(bool direct) {
        if (direct == direct_ || !can_direct_)
            return;
        can_direct_ = ::fcntl(descriptor_, F_SETFL, direct ? O_DIRECT : 0) == 0;
        direct_ = direct && can_direct_;
    }

    const int descriptor_;
    bool can_direct_ = true, direct_ = false;
    std::uint64_t written_back_ = 0; /* bytes that the kernel was asked to put on the disk */
    std::optional<Sha256> hash_;
    std::uint64_t hashed_ = 0; /* bytes */

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::vector<Buffer> buffers_; // in turn
    std::vector<Piece> pieces_;   // of the buffers from begin_ to before end_
    std::uint64_t begin_ = 0, end_ = 0;
    int error_ = 0;
    std::jthread thread_; // last: it ends first
};

} // namespace forceshade
