// What evaluating many samples takes: threads that share the work out, and the buffers of a chunk's results.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "host/reference/surfaces.h"
#include "host/threads.h"

namespace forceshade::reference {

/// The threads to use where `asked` are asked for; 0: most_threads().
inline unsigned threads_for(unsigned asked) {
    return asked > 0 ? asked : most_threads();
}

using forceshade::share_out;

/// Threads that stay and share out one piece of work after another. No thread waits for one that has not begun: on a
/// busy machine that may take long.
class Crew {
public:
    explicit Crew(std::size_t threads) {
        for (std::size_t i = 1; i < threads; ++i)
            helpers_.emplace_back([this, i](const std::stop_token& stop) { help(stop, i); });
    }

    /// work(thread, index) for every index below count.
    template <typename Work> void share_out(std::size_t count, const Work& work) {
        next_ = 0;
        const std::function<void(std::size_t)> all = [&](std::size_t thread) {
            for (std::size_t i; (i = next_++) < count;)
                work(thread, i);
        };
        const Posted posted(*this, all);
        all(0);
    }

private:
    // Work that helpers may take up as long as this lives; its end waits for those that did.
    struct Posted {
        Crew& crew;
        Posted(Crew& crew_, const std::function<void(std::size_t)>& work) : crew(crew_) {
            const std::lock_guard lock(crew.mutex_);
            crew.work_ = &work;
            ++crew.posted_;
            crew.changed_.notify_all();
        }
        ~Posted() {
            std::unique_lock lock(crew.mutex_);
            crew.work_ = nullptr;
            crew.changed_.wait(lock, [&] { return crew.busy_ == 0; });
        }
    };

    void help(const std::stop_token& stop, std::size_t thread) {
        std::uint64_t seen = 0;
        std::unique_lock lock(mutex_);
        while (changed_.wait(lock, stop, [&] { return work_ && posted_ != seen; })) {
            seen = posted_;
            ++busy_;
            const auto& work = *work_;
            lock.unlock();
            work(thread);
            lock.lock();
            --busy_;
            changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    const std::function<void(std::size_t)>* work_ = nullptr;
    std::uint64_t posted_ = 0;
    std::size_t busy_ = 0; // helpers
    std::atomic<std::size_t> next_{0};
    std::vector<std::jthread> helpers_; // last: they end first
};

/// A chunk's results by channel, layout::kChannel... bits; those not asked for are empty.
template <typename T> struct SampleBuffers {
    std::vector<T> position, force, depth, proxy, unshaded;
    std::vector<layout::uint> facet;

    void resize(layout::uint channels, std::size_t samples) {
        const auto reals = [&](layout::uint channel, std::size_t count) { return channels & channel ? count : 0; };
        position.resize(reals(layout::kChannelPosition, 3 * samples));
        force.resize(reals(layout::kChannelForce, 3 * samples));
        depth.resize(reals(layout::kChannelDepth, samples));
        proxy.resize(reals(layout::kChannelProxy, 3 * samples));
        unshaded.resize(reals(layout::kChannelUnshaded, 3 * samples));
        facet.resize(reals(layout::kChannelFacet, samples));
    }
    static std::size_t bytes_per_sample(layout::uint channels) {
        SampleBuffers one;
        one.resize(channels, 1);
        return sizeof(T) * (one.position.size() + one.force.size() + one.depth.size() + one.proxy.size() +
                            one.unshaded.size()) +
               sizeof(layout::uint) * one.facet.size();
    }

    /// What fields and paths have in common.
    void set_spans(auto& chunk) const {
        chunk.force = force;
        chunk.depth = depth;
        chunk.facet = facet;
        chunk.proxy = proxy;
    }
    void store(std::size_t sample, const Contact<T>& contact, const Vector<T>& applied) {
        put(force, sample, applied);
        put(proxy, sample, contact.proxy);
        if (!depth.empty())
            depth[sample] = contact.depth;
        if (!facet.empty())
            facet[sample] = contact.facet;
    }
    static void put(std::vector<T>& buffer, std::size_t sample, const Vector<T>& value) {
        for (std::size_t i = 0; i < 3 && !buffer.empty(); ++i)
            buffer[3 * sample + i] = value[static_cast<int>(i)];
    }
};

} // namespace forceshade::reference
