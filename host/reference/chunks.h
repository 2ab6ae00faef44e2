// What evaluating many samples takes: threads that share the work out, and the buffers of a chunk's results.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "host/reference/surfaces.h"

namespace forceshade::reference {

/// The threads to use where `asked` are asked for; 0: as many as the machine has cores.
inline unsigned threads_for(unsigned asked) {
    return asked > 0 ? asked : std::max(1u, std::thread::hardware_concurrency());
}

/// Runs work(thread, index) for every index below count, shared out among threads.
template <typename Work> void share_out(std::size_t threads, std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{0};
    const auto run = [&](std::size_t thread) {
        for (std::size_t i; (i = next++) < count;)
            work(thread, i);
    };
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < threads; ++i)
        helpers.emplace_back(run, i);
    run(0);
}

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
