// Steps of a hand that presses a probe along the surface in a closed loop.
#include <algorithm>
#include <type_traits>

#include "host/paths/scene_paths.h"
#include "host/reference/elementary.h"
#include "host/reference/paths.h"
#include "host/study/error_time/contender.h"

namespace forceshade::study::error_time {
namespace {

/// Takes all paths through their law; returns the seconds that it took.
template <typename T>
using Explore = std::function<double(const layout::PathInput<T>&, const reference::TakePaths<T>&)>;

// The paths of a law, and how many samples they have.
template <typename T> struct Walk {
    std::unique_ptr<ScenePaths<T>> source;
    layout::PathInput<T> input;

    std::size_t samples() const { return input.paths * input.steps; }
};

template <typename T> Walk<T> walk_of(const PreparedCase& prepared, layout::uint channels) {
    Walk<T> walk;
    walk.source = std::make_unique<ScenePaths<T>>(prepared);
    walk.input = walk.source->input();
    walk.input.features.channels = channels;
    return walk;
}

// Where the probes were and what they felt: sample (step, path) at step * paths + path.
template <typename T> Evaluated walked(const PreparedCase& prepared, const Explore<T>& explore) {
    const Walk<T> walk = walk_of<T>(prepared, layout::kChannelForce | layout::kChannelPosition);
    Evaluated evaluated;
    evaluated.at.resize(walk.samples());
    evaluated.force.resize(walk.samples());
    explore(walk.input, [&](const layout::PathChunk<T>& chunk) {
        for (std::size_t step = 0; step < chunk.step_count; ++step)
            for (std::size_t path = 0; path < chunk.path_count; ++path) {
                const std::size_t from = step * chunk.pitch + path;
                const std::size_t to = (chunk.step_first + step) * walk.input.paths + chunk.path_first + path;
                evaluated.at[to] = reference::vector_at(chunk.position, from);
                evaluated.force[to] = reference::vector_at(chunk.force, from);
            }
    });
    return evaluated;
}

template <typename T> double on_one_thread(const layout::PathInput<T>& input, const reference::TakePaths<T>& take) {
    using Clock = std::chrono::steady_clock;
    reference::PathOptions options;
    options.threads = 1;
    const Clock::time_point start = Clock::now();
    reference::evaluate_paths<T>(input, options, take, [](std::size_t, std::span<const layout::PathMetrics<T>>) {});
    return std::chrono::duration<double>(Clock::now() - start).count();
}

template <typename T>
Contender closed_loop(const Subject& subject, const Variant& variant, const std::string& family,
                      const Explore<T>& explore) {
    Contender contender = contender_of(subject, variant, family, kPrecision<T>);
    contender.evaluate = [prepared = variant.prepared, explore] { return walked<T>(*prepared, explore); };
    // The same step of the same path in double: by then the probe may be elsewhere.
    contender.exact = [prepared = variant.prepared](const std::vector<glm::dvec3>&) {
        return walked<double>(*prepared, on_one_thread<double>).force;
    };
    const auto walk = lazily([prepared = variant.prepared] { return walk_of<T>(*prepared, 0); });
    contender.seconds = [walk, explore] {
        const double seconds = explore(walk().input, [](const layout::PathChunk<T>&) {});
        return seconds / static_cast<double>(walk().samples());
    };
    return contender;
}

template <typename T> Explore<T> on_engine(Engine& engine) {
    return [&engine](const layout::PathInput<T>& input, const reference::TakePaths<T>& take) {
        return engine.explore(input, take, [](std::size_t, std::span<const layout::PathMetrics<T>>) {}).kernel;
    };
}

} // namespace

void add_loops(Contenders& contenders, const Subject& subject, const Variant& variant, Engine& engine) {
    const std::string alone = "closed loop, CPU on one thread";
    contenders.push_back(closed_loop<double>(subject, variant, alone, on_one_thread<double>));
    contenders.push_back(closed_loop<float>(subject, variant, alone, on_one_thread<float>));
    const EngineReport report = engine.report();
    const std::string family = report.engine == "gpu" ? "closed loop, kernel" : "closed loop, CPU on all cores";
    contenders.push_back(closed_loop<float>(subject, variant, family, on_engine<float>(engine)));
    if (report.f64)
        contenders.push_back(closed_loop<double>(subject, variant, family, on_engine<double>(engine)));
}

} // namespace forceshade::study::error_time
