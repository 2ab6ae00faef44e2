// What a device makes of exploration paths held against the oracle bit for bit.
#pragma once

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/kernels.h"
#include "host/reference/paths.h"

namespace forceshade::test {

/// What came of holding paths against reference<T>.
struct PathComparison {
    std::uint64_t samples = 0, differing = 0;
    std::uint64_t paths = 0, differing_metrics = 0;
    std::uint64_t not_finite = 0;                         // paths with a metric that is NaN
    std::uint64_t unstable = 0, rounds = 0, touching = 0; // of the oracle's metrics
    bool in_order = true;
    std::string first; // where the first difference is

    bool equal() const { return differing == 0 && differing_metrics == 0 && in_order; }
};

/// One side's results, in memory: sample (step, path) at step * paths + path.
template <typename T> struct PathResults {
    std::size_t paths, steps;
    std::vector<T> position, force, depth, proxy;
    std::vector<layout::uint> facet;
    std::vector<layout::PathMetrics<T>> metrics;
    std::size_t next_path = 0, next_step = 0;
    bool in_order = true;

    PathResults(std::size_t path_count, std::size_t step_count) : paths(path_count), steps(step_count) {}

    void add(const layout::PathChunk<T>& chunk) {
        in_order = in_order && chunk.path_first == metrics.size() && chunk.step_first == next_step;
        next_step = (chunk.step_first + chunk.step_count) % steps;
        put(position, chunk, chunk.position, 3);
        put(force, chunk, chunk.force, 3);
        put(depth, chunk, chunk.depth, 1);
        put(facet, chunk, chunk.facet, 1);
        put(proxy, chunk, chunk.proxy, 3);
    }

    void add(std::size_t first, std::span<const layout::PathMetrics<T>> some) {
        in_order = in_order && first == metrics.size() && next_step == 0;
        metrics.insert(metrics.end(), some.begin(), some.end());
    }

    /// A sample of every channel has the same bits.
    bool same(const PathResults& other, std::size_t at) const {
        const auto alike = [&](const auto& ours, const auto& theirs, std::size_t width) {
            if (ours.empty() || theirs.empty())
                return ours.empty() && theirs.empty();
            return std::memcmp(&ours[width * at], &theirs[width * at], width * sizeof(ours[0])) == 0;
        };
        return alike(position, other.position, 3) && alike(force, other.force, 3) && alike(depth, other.depth, 1) &&
               alike(facet, other.facet, 1) && alike(proxy, other.proxy, 3);
    }

private:
    template <typename Value>
    void put(std::vector<Value>& into, const layout::PathChunk<T>& chunk, std::span<const Value> from,
             std::size_t width) {
        if (from.empty())
            return;
        into.resize(width * paths * steps);
        for (std::size_t step = 0; step < chunk.step_count; ++step)
            std::memcpy(&into[width * ((chunk.step_first + step) * paths + chunk.path_first)],
                        &from[width * step * chunk.pitch], width * chunk.path_count * sizeof(Value));
    }
};

/// Takes the paths through device and oracle; any difference in a bit counts. `length(path)` samples of each are held.
template <typename Kernel, typename T, typename Length>
PathComparison hold_input(Kernel& kernel, const layout::PathInput<T>& input, const Length& length) {
    PathResults<T> device(input.paths, input.steps), oracle(input.paths, input.steps);
    kernel.template explore<T>(
        input, [&](const layout::PathChunk<T>& chunk) { device.add(chunk); },
        [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { device.add(first, metrics); });
    reference::evaluate_paths<T>(
        input, {}, [&](const layout::PathChunk<T>& chunk) { oracle.add(chunk); },
        [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { oracle.add(first, metrics); });
    PathComparison result;
    result.in_order = device.in_order && device.metrics.size() == input.paths;
    for (std::size_t path = 0; path < input.paths; ++path) {
        ++result.paths;
        result.unstable += oracle.metrics[path].unstable_step != layout::kNever;
        result.rounds += oracle.metrics[path].rounds;
        result.touching += oracle.metrics[path].contact_samples;
        for (std::size_t step = 0; step < length(path); ++step) {
            ++result.samples;
            if (device.same(oracle, step * input.paths + path))
                continue;
            if (result.differing++ == 0)
                result.first = fmt::format("sample of path {} at step {}", path, step);
        }
        const bool same = path < device.metrics.size() &&
                          std::memcmp(&device.metrics[path], &oracle.metrics[path], sizeof(oracle.metrics[path])) == 0;
        if (!same && result.differing_metrics++ == 0)
            result.first += fmt::format(" metrics of path {}: work {} and {}", path, device.metrics[path].work,
                                        oracle.metrics[path].work);
    }
    return result;
}

/// For gtest: says what differs.
inline ::testing::AssertionResult is_equal(const PathComparison& comparison) {
    if (comparison.equal())
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << fmt::format(
               "{} of {} samples and the metrics of {} of {} paths differ{}; {}", comparison.differing,
               comparison.samples, comparison.differing_metrics, comparison.paths,
               comparison.in_order ? "" : ", chunks out of order", comparison.first);
}

} // namespace forceshade::test
