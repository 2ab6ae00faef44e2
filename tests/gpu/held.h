// What a kernel makes of a field or of paths, held against reference<T>: the same bits in every channel, every sample
// written, and nothing written behind them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/device_limits.h"
#include "host/reference/field.h"

namespace forceshade::test {

struct Held {
    std::uint64_t samples = 0;     // voxels, or places of paths
    std::uint64_t differing = 0;   // samples any of whose channels has other bits
    std::uint64_t not_finite = 0;  // NaN or infinite numbers of a field, padding included; paths with a metric of NaN
    std::uint64_t bad_padding = 0; // padding samples that are no copy of their row's last
    std::uint64_t paths = 0, differing_metrics = 0;
    std::uint64_t touching = 0, rounds = 0, unstable = 0; // of the oracle's metrics
    std::uint64_t host_updates = 0;                       // that the kernel left to the host
    bool in_order = true;                                 // chunks came in order and without gaps
    bool within = true;                                   // nothing was written behind a chunk's samples
    std::string first;                                    // where the first difference is

    bool equal() const {
        return differing == 0 && bad_padding == 0 && differing_metrics == 0 && in_order && within &&
               (paths != 0 || not_finite == 0);
    }
};

/// For gtest: says what differs.
inline ::testing::AssertionResult is_equal(const Held& held) {
    if (held.equal())
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << fmt::format(
               "{} of {} samples and the metrics of {} of {} paths differ, {} numbers are not finite, {} of padding "
               "are wrong{}{}; {}",
               held.differing, held.samples, held.differing_metrics, held.paths, held.not_finite, held.bad_padding,
               held.in_order ? "" : ", chunks out of order", held.within ? "" : ", written behind the samples",
               held.first);
}

/// Every channel of two chunks and how many values a sample has of it.
template <typename Chunk, typename Take> void each_channel(const Chunk& a, const Chunk& b, const Take& take) {
    take(a.force, b.force, 3);
    take(a.depth, b.depth, 1);
    take(a.facet, b.facet, 1);
    take(a.proxy, b.proxy, 3);
    if constexpr (requires { a.unshaded; })
        take(a.unshaded, b.unshaded, 3);
    else
        take(a.position, b.position, 3);
}

/// `count` samples of a from `at` on have the bits of those of b from `from` on, in every channel.
template <typename Chunk>
bool same(const Chunk& a, std::size_t at, const Chunk& b, std::size_t from, std::size_t count) {
    bool alike = true;
    each_channel(a, b, [&](auto ours, auto theirs, std::size_t width) {
        if (ours.empty() || theirs.empty())
            alike = alike && ours.empty() && theirs.empty();
        else
            alike =
                alike && std::memcmp(&ours[width * at], &theirs[width * from], width * count * sizeof(ours[0])) == 0;
    });
    return alike;
}

/// Words that no kernel writes, put into a kernel's results once they were read. On the software device a chunk is the
/// buffer itself, and buffers are kept from run to run: what the next chunk does not write has still these words, and
/// what it writes behind its samples has not. Not where memory is taken for incoherent: invalidating takes them away.
class Sentinels {
public:
    /// `only_samples`: what lies behind a channel's samples belongs to another channel.
    explicit Sentinels(bool only_samples = false) : only_samples_(only_samples) {}

    /// Gives whether all that lies behind the chunk's samples is as it was left.
    template <typename Chunk> bool put(const Chunk& chunk) {
        if (incoherent_)
            return true;
        const auto each_result = [&](const auto& take) {
            each_channel(chunk, chunk, [&](auto results, auto, std::size_t) {
                if (!results.empty())
                    take(reinterpret_cast<const std::byte*>(results.data()), results.size_bytes());
            });
        };
        each_result([&](const std::byte* results, std::size_t size) { // perhaps within what was another's
            for (auto& [at, other] : places_)
                if (at < results)
                    other.left = std::min(other.left, static_cast<std::size_t>(results - at));
                else if (at > results && at < results + size)
                    other.left = 0;
        });
        bool intact = true;
        each_result([&](const std::byte* results, std::size_t size) {
            Place& place = places_[results];
            if (size > place.largest) { // a buffer has grown: others may lie where one lay
                for (auto& [at, other] : places_)
                    other.left = 0;
                place.largest = size;
            }
            const std::size_t end = only_samples_ ? size : std::max(size, place.left);
            intact = intact && std::all_of(results + size, results + end, [](std::byte one) { return one == kLeft; });
            std::fill_n(const_cast<std::byte*>(results), end, kLeft); // mapped memory of the device's
            place.left = end;
        });
        return intact;
    }

private:
    static constexpr std::byte kLeft{0xA5};

    bool only_samples_, incoherent_ = compute::device_limits().incoherent;
    struct Place {
        std::size_t largest = 0, left = 0; // bytes that a chunk had here; that are full of sentinels
    };
    std::map<const std::byte*, Place> places_;
};

/// Takes a field's chunks, and evaluates each on the oracle.
template <typename T> class HeldField {
public:
    /// `sentinels` are for a kernel's chunks. Both must outlive this.
    explicit HeldField(const layout::FieldInput<T>& input, Sentinels* sentinels = nullptr)
        : input_(input), sentinels_(sentinels) {}

    void add(const layout::FieldChunk<T>& chunk) {
        const std::uint64_t row = std::uint64_t(chunk.z_first) * input_.y.size() + chunk.y_first;
        held_.in_order = held_.in_order && row == rows_ && chunk.x_count == input_.x.size();
        rows_ += std::uint64_t(chunk.y_count) * chunk.z_count;
        layout::FieldInput<T> part = input_;
        part.y = input_.y.subspan(chunk.y_first, chunk.y_count);
        part.z = input_.z.subspan(chunk.z_first, chunk.z_count);
        reference::evaluate_field<T>(part, {}, [&](const layout::FieldChunk<T>& oracle) { compare(chunk, oracle); });
        for (const auto channel : {chunk.force, chunk.depth, chunk.proxy, chunk.unshaded})
            for (const T value : channel)
                held_.not_finite += !std::isfinite(value);
        if (sentinels_)
            held_.within = sentinels_->put(chunk) && held_.within;
    }

    Held result() const {
        Held held = held_;
        held.in_order = held.in_order && rows_ == std::uint64_t(input_.y.size()) * input_.z.size();
        return held;
    }

private:
    void compare(const layout::FieldChunk<T>& chunk, const layout::FieldChunk<T>& oracle) {
        held_.samples += std::uint64_t(oracle.x_count) * oracle.y_count * oracle.z_count;
        for (std::size_t z = 0; z < oracle.z_count; ++z)
            for (std::size_t y = 0; y < oracle.y_count; ++y) {
                const std::size_t ours = (oracle.z_first + z) * chunk.y_count + oracle.y_first + y;
                const std::size_t theirs = z * oracle.y_count + y;
                if (!same(chunk, ours * chunk.x_pitch, oracle, theirs * oracle.x_pitch, oracle.x_count))
                    count_row(chunk, ours, oracle, theirs);
                const std::size_t last = ours * chunk.x_pitch + chunk.x_count - 1;
                for (std::size_t pad = chunk.x_count; pad < chunk.x_pitch; ++pad)
                    held_.bad_padding += !same(chunk, last, chunk, ours * chunk.x_pitch + pad, 1);
            }
    }

    void count_row(const layout::FieldChunk<T>& chunk, std::size_t ours, const layout::FieldChunk<T>& oracle,
                   std::size_t theirs) {
        for (std::size_t x = 0; x < oracle.x_count; ++x) {
            const std::size_t a = ours * chunk.x_pitch + x, b = theirs * oracle.x_pitch + x;
            if (!same(chunk, a, oracle, b, 1) && held_.differing++ == 0)
                held_.first = fmt::format("x {} y {} z {}: force ({}, {}, {}), the oracle's is ({}, {}, {})", x,
                                          chunk.y_first + ours % chunk.y_count, chunk.z_first + ours / chunk.y_count,
                                          chunk.force[3 * a], chunk.force[3 * a + 1], chunk.force[3 * a + 2],
                                          oracle.force[3 * b], oracle.force[3 * b + 1], oracle.force[3 * b + 2]);
        }
    }

    const layout::FieldInput<T>& input_;
    Sentinels* sentinels_;
    std::uint64_t rows_ = 0;
    Held held_;
};

/// A field of a kernel or an engine.
template <typename Kernel, typename T> Held hold_field(Kernel& kernel, const layout::FieldInput<T>& input) {
    HeldField<T> held(input);
    kernel.evaluate(input, std::function([&](const layout::FieldChunk<T>& chunk) { held.add(chunk); }));
    return held.result();
}

/// Takes the chunks and metrics of paths; the oracle's are in memory.
template <typename T> class HeldPaths {
public:
    HeldPaths(const layout::PathInput<T>& input, Sentinels& sentinels)
        : paths_(input.paths), steps_(input.steps), sentinels_(sentinels) {
        reference::evaluate_paths<T>(
            input, {}, [&](const layout::PathChunk<T>& chunk) { keep(chunk); },
            [&](std::size_t, std::span<const layout::PathMetrics<T>> some) {
                metrics_.insert(metrics_.end(), some.begin(), some.end());
            });
        oracle_.position = position_, oracle_.force = force_, oracle_.depth = depth_, oracle_.facet = facet_,
        oracle_.proxy = proxy_;
        for (const layout::PathMetrics<T>& one : metrics_) {
            held_.touching += one.contact_samples;
            held_.rounds += one.rounds;
            held_.unstable += one.unstable_step != layout::kNever;
            held_.not_finite += std::isnan(one.work) || std::isnan(one.force_square) || std::isnan(one.depth);
        }
    }

    /// `length(path)` samples of each are held.
    template <typename Length> void add(const layout::PathChunk<T>& chunk, const Length& length) {
        held_.in_order = held_.in_order && chunk.path_first == held_.paths && chunk.step_first == next_step_;
        next_step_ = (chunk.step_first + chunk.step_count) % steps_;
        for (std::size_t step = chunk.step_first; step < chunk.step_first + chunk.step_count; ++step)
            for (std::size_t path = chunk.path_first; path < chunk.path_first + chunk.path_count; ++path) {
                if (step >= length(path))
                    continue;
                ++held_.samples;
                const std::size_t at = (step - chunk.step_first) * chunk.pitch + path - chunk.path_first;
                if (!same(chunk, at, oracle_, step * paths_ + path, 1) && held_.differing++ == 0)
                    held_.first = fmt::format("path {} at step {} ", path, step);
            }
        held_.within = sentinels_.put(chunk) && held_.within;
    }

    void add(std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
        held_.in_order = held_.in_order && first == held_.paths && next_step_ == 0;
        for (const layout::PathMetrics<T>& one : metrics) {
            const bool alike = held_.paths < paths_ && std::memcmp(&one, &metrics_[held_.paths], sizeof(one)) == 0;
            if (!alike && held_.differing_metrics++ == 0)
                held_.first += fmt::format("metrics of path {}: work {}", held_.paths, one.work);
            ++held_.paths;
        }
    }

    Held result() const {
        Held held = held_;
        held.in_order = held.in_order && held.paths == paths_;
        return held;
    }

private:
    void keep(const layout::PathChunk<T>& chunk) {
        const auto put = [&](auto& into, auto from, std::size_t width) {
            if (from.empty())
                return;
            into.resize(width * paths_ * steps_);
            for (std::size_t step = 0; step < chunk.step_count; ++step)
                std::copy_n(&from[width * step * chunk.pitch], width * chunk.path_count,
                            &into[width * ((chunk.step_first + step) * paths_ + chunk.path_first)]);
        };
        put(position_, chunk.position, 3);
        put(force_, chunk.force, 3);
        put(depth_, chunk.depth, 1);
        put(facet_, chunk.facet, 1);
        put(proxy_, chunk.proxy, 3);
    }

    std::size_t paths_, steps_;
    Sentinels& sentinels_;
    std::vector<T> position_, force_, depth_, proxy_;
    std::vector<layout::uint> facet_;
    std::vector<layout::PathMetrics<T>> metrics_;
    layout::PathChunk<T> oracle_{};
    std::size_t next_step_ = 0;
    Held held_;
};

} // namespace forceshade::test
