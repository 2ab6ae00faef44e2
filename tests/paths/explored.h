// Scenes from text taken along their paths by the oracle.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/paths/scene_paths.h"
#include "host/reference/elementary.h"
#include "host/reference/field.h"
#include "host/scene/study.h"

namespace forceshade {

/// A cube of 2 m whose top is z = 0, as an OBJ file.
inline constexpr const char* kCubeObj = "v -1 -1 -2\nv 1 -1 -2\nv 1 1 -2\nv -1 1 -2\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\n"
                                        "v -1 1 0\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

inline PreparedCase prepared_scene(const std::string& text, const std::filesystem::path& folder = {}) {
    CasePreparation preparation;
    return preparation.prepare(parse_scene(text, "scene.toml", folder));
}

/// What an exploration gave: sample (step, path) at step * paths + path.
template <typename T> struct Explored {
    std::size_t paths = 0, steps = 0;
    std::vector<reference::Vector<T>> position, force;
    std::vector<layout::PathMetrics<T>> metrics;

    const reference::Vector<T>& place(std::size_t step, std::size_t path = 0) const {
        return position[step * paths + path];
    }
    /// Whether every sample and every metric is a number.
    bool finite() const {
        const auto number = [](const reference::Vector<T>& v) {
            return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
        };
        return std::ranges::all_of(position, number) && std::ranges::all_of(force, number) &&
               std::ranges::all_of(metrics, [](const layout::PathMetrics<T>& one) {
                   return std::isfinite(one.work) && std::isfinite(one.force_square) &&
                          std::isfinite(one.steepest_turn);
               });
    }
};

template <typename T>
Explored<T> explored(ScenePaths<T>& source, const reference::PathOptions& options = {}, bool samples = true) {
    layout::PathInput<T> input = source.input();
    input.features.channels = samples ? layout::kChannelForce | layout::kChannelPosition : 0;
    Explored<T> result;
    result.paths = input.paths;
    result.steps = input.steps;
    if (samples) {
        result.position.resize(input.paths * input.steps);
        result.force.resize(input.paths * input.steps);
    }
    result.metrics.resize(input.paths);
    reference::evaluate_paths<T>(
        input, options,
        [&](const layout::PathChunk<T>& chunk) {
            ASSERT_EQ(chunk.force.empty(), !samples);
            if (!samples)
                return;
            for (std::size_t step = 0; step < chunk.step_count; ++step)
                for (std::size_t path = 0; path < chunk.path_count; ++path) {
                    const std::size_t from = step * chunk.pitch + path;
                    const std::size_t to = (chunk.step_first + step) * result.paths + chunk.path_first + path;
                    result.position[to] = reference::vector_at(chunk.position, from);
                    result.force[to] = reference::vector_at(chunk.force, from);
                }
        },
        [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
            std::copy(metrics.begin(), metrics.end(), result.metrics.begin() + static_cast<std::ptrdiff_t>(first));
        });
    return result;
}

template <typename T>
Explored<T> explored(const std::string& text, const reference::PathOptions& options = {}, bool samples = true) {
    const PreparedCase prepared = prepared_scene(text);
    ScenePaths<T> source(prepared);
    return explored(source, options, samples);
}

} // namespace forceshade
