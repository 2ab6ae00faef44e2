// Sampled loops run by an engine, a path each, and their final states.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/field/prepared_case.h"
#include "host/paths/scene_paths.h"
#include "host/study/stability/stability.h"

namespace forceshade::study {
namespace {

// How the disturbance is shared out to x, y and z (down).
constexpr glm::dvec3 kAside(0.25, 0.15, 1);

// The place of rest of a loop that measures in quanta is the worst: midway between two of them.
double rest_height(const RestPlace& place, double quantum) {
    return quantum > 0 ? (std::floor(place.at.z / quantum) + 0.5) * quantum : place.at.z;
}

PreparedCase scene_of(const LoopSurface& surface, const RestPlace& place, std::size_t count, const LoopRun& run) {
    PreparedCase prepared = surface.prepared;
    PathsSpec paths;
    paths.count = count;
    paths.steps = run.steps;
    paths.rate = surface.rate;
    paths.loop = PathLoop::closed;
    paths.drive = run.all_sides ? PathDrive::depth : PathDrive::push;
    paths.depth = fixed_spread(0);
    paths.length = paths.width = 0;
    const double off = run.disturbance * place.depth;
    paths.centre = std::array{place.at.x + off * kAside.x, place.at.y + off * kAside.y};
    paths.height = place.at.z;
    paths.start_depth = off * kAside.z;
    paths.bound = run.bound * place.depth;
    prepared.one.scene.paths = paths;
    return prepared;
}

template <typename T>
layout::HandParams<T> hand_of(const RestPlace& place, const LoopCell& cell, const LoopRun& run, PathsSpec paths) {
    paths.rate = cell.rate;
    HandSpec hand = cell.hand;
    hand.max_force = std::numeric_limits<float>::max() / 4; // the limit of the loop is asked for, not the device's
    const double height = rest_height(place, hand.quantisation), moved = height - place.at.z;
    const double off = run.disturbance * place.depth;
    paths.start_depth = off * kAside.z - moved;
    const double swings = 2 * place.depth * std::sqrt(cell.stiffness / hand.mass) / cell.rate;
    auto params = hand_params<T>(hand, paths, *paths.bound + (hand.delay_samples > 0 ? swings : 0), cell.stiffness);
    params.gain = T(cell.stiffness);
    // Balances the force there, and the grip's spring that pulls aside.
    const glm::dvec3 force =
        coupled_share(hand, cell.stiffness) * (place.force - place.slope * glm::dvec3(0, 0, moved));
    params.push_x = T(-cell.stiffness * force.x - hand.grip_stiffness * off * kAside.x);
    params.push_y = T(-cell.stiffness * force.y - hand.grip_stiffness * off * kAside.y);
    params.push_z = T(-cell.stiffness * force.z + (run.all_sides ? hand.grip_stiffness * moved : 0));
    return params;
}

// The farthest measured positions of a path in the last quarter of the time.
struct LateSpread {
    glm::dvec3 low{INFINITY}, high{-INFINITY};
};

// `creep`, m/s: too slow to move noticeably in a quarter of the time.
LoopState state_of(const LoopOutcome& outcome, double creep, double spread, double quantum) {
    constexpr double kDecays = 0.75; // of the speed in the second quarter
    constexpr double kQuanta = 1.5;  // between one and two
    if (outcome.left)
        return LoopState::unstable;
    if (outcome.at_rest || outcome.late < kDecays * outcome.early)
        return LoopState::stable;
    const bool unmeasured = quantum > 0 && spread < 0.5 * quantum; // it creeps, unmeasured
    const bool creeps = !(quantum > 0) && outcome.late < outcome.early && outcome.late < creep;
    if (unmeasured || creeps)
        return LoopState::stable;
    return quantum > 0 && spread < kQuanta * quantum ? LoopState::quantisation_cycle : LoopState::limit_cycle;
}

template <typename T>
std::vector<LoopOutcome> run_as(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                const std::vector<LoopCell>& cells, const LoopRun& run) {
    const PreparedCase prepared = scene_of(surface, place, cells.size(), run);
    ScenePaths<T> source(prepared);
    std::vector<layout::HandParams<T>> hands;
    hands.reserve(cells.size());
    for (const LoopCell& cell : cells)
        hands.push_back(hand_of<T>(place, cell, run, *prepared.one.scene.paths));
    layout::PathInput<T> input = source.input();
    const bool swings =
        run.swings || std::ranges::any_of(cells, [](const LoopCell& cell) { return cell.hand.quantisation > 0; });
    input.features.channels = swings ? layout::kChannelPosition : 0;
    input.hands = hands;
    std::vector<LateSpread> spreads(cells.size());
    const auto take = [&](const layout::PathChunk<T>& chunk) {
        const std::size_t late = run.steps - run.steps / 4;
        for (std::size_t step = late - std::min(late, chunk.step_first); swings && step < chunk.step_count; ++step)
            for (std::size_t i = 0; i < chunk.path_count; ++i) {
                const glm::dvec3 at(reference::vector_at(chunk.position, step * chunk.pitch + i));
                auto& [low, high] = spreads[chunk.path_first + i];
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
    };
    const glm::dvec3 origin = scene_origin(prepared); /* m: of the places */
    std::vector<LoopOutcome> outcomes(cells.size());
    engine.explore<T>(input, take, [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
        constexpr double kRest = std::is_same_v<T, double> ? 1e-6 : 1e-2; // of the speed that the disturbance makes
        constexpr double kNowhere = 0.1;                                  // of the disturbance
        const auto steps = static_cast<double>(run.steps);
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            const LoopCell& cell = cells[first + i];
            LoopOutcome& outcome = outcomes[first + i];
            outcome.early = static_cast<double>(metrics[i].early_speed);
            outcome.late = static_cast<double>(metrics[i].late_speed);
            outcome.left = metrics[i].unstable_step != layout::kNever;
            const double quick =
                run.disturbance * place.depth * std::min(std::sqrt(cell.stiffness / cell.hand.mass), cell.rate);
            outcome.at_rest = outcome.late <= kRest * quick;
            const double creep = kNowhere * run.disturbance * place.depth * cell.rate / (0.25 * steps);
            if (swings && !outcome.left) {
                const auto& [low, high] = spreads[first + i];
                outcome.swing = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
                outcome.moved = reference::length(origin + 0.5 * (low + high) - place.at);
            }
            outcome.state = state_of(outcome, creep, outcome.swing, cell.hand.quantisation);
        }
    });
    return outcomes;
}

} // namespace

const char* word_of(LoopState state) {
    constexpr const char* kWords[] = {"stable", "quantisation limit cycle", "limit cycle", "unstable"};
    return kWords[static_cast<std::size_t>(state)];
}

std::vector<LoopOutcome> run_cells(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                   const std::vector<LoopCell>& cells, const LoopRun& run) {
    LoopRun whole = run;
    if (whole.steps == 0)
        for (const LoopCell& cell : cells)
            whole.steps = std::max(whole.steps, settling_steps(cell, run.patience));
    return engine.report().f64 ? run_as<double>(engine, surface, place, cells, whole)
                               : run_as<float>(engine, surface, place, cells, whole);
}

} // namespace forceshade::study
