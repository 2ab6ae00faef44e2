#include "host/study/stability/limits.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/study/stability/felt_force.h"

namespace forceshade::study {
namespace {

constexpr double kSmall = 1e-6; // of the depth: a disturbance by which the loop is still linear

// How a disturbance of a loop grows: the logarithm of its energy late over early.
class Simulation {
public:
    Simulation(const LoopSurface& surface, const LeastLimit& least)
        : force_(surface), least_(least), place_{least.place.at, least.place.normal, least.place.below},
          axes_(axes_of(least.hold)), steps_(settling_steps(least.cell, surface.is_mesh() ? 100 : 400)) {
        const std::array<Axis, 3> held = axes_of(least.hold, least.cell.hand);
        for (std::size_t i = 0; i < 3; ++i)
            maps_[i] = axis_map(held[i], 1 / least.cell.rate);
    }

    // `disturbance`, m, in the hand's axes.
    double growth(double stiffness, const glm::dvec3& disturbance) {
        constexpr double kFar = 1e4, kFarthest = 3; // of the disturbance; depths
        const double begins = reference::length(disturbance);
        const double far = std::min(kFar * begins, kFarthest * least_.place.depth);
        glm::dvec3 at = disturbance, speed(0);
        std::vector<glm::dvec3> late(least_.cell.hand.delay_samples + 1, glm::dvec3(0));
        const double quick = stiffness / least_.cell.hand.mass; // 1 / s^2
        double early = 0, last = 0;
        for (std::size_t step = 0; step < steps_; ++step) {
            late[step % late.size()] =
                stiffness * glm::transpose(axes_) * (force_(place_, axes_ * at) - least_.place.force);
            const glm::dvec3 felt = late[(step + 1) % late.size()];
            for (int i = 0; i < 3; ++i) {
                const auto& map = maps_[static_cast<std::size_t>(i)];
                const double before = at[i];
                at[i] += map.x_error * before + map.x_speed * speed[i] + map.x_force * felt[i];
                speed[i] = map.v_error * before + map.v_speed * speed[i] + map.v_force * felt[i];
            }
            const double energy = glm::dot(speed, speed) + quick * glm::dot(at, at);
            if (energy > quick * far * far)
                return 1;
            if (step >= steps_ / 4 && step < steps_ / 2)
                early = std::max(early, energy);
            if (step >= steps_ - steps_ / 4)
                last = std::max(last, energy);
        }
        const bool gone = last < 1e-6 * quick * begins * begins;
        return gone ? -1 : std::log(last / early);
    }
    double growth(double stiffness) { return growth(stiffness, kSmall * place_.depth * glm::dvec3(0.5, 0.3, -1)); }

private:
    FeltForce force_;
    const LeastLimit& least_;
    error_time::Place place_;
    glm::dmat3 axes_;
    std::array<layout::AxisMap<double>, 3> maps_{};
    std::size_t steps_;
};

// The hand's own first.
std::vector<LoopCell> settings_of(const LoopSurface& surface, bool quick) {
    HandSpec linear = surface.hand;
    linear.quantisation = linear.coulomb = 0; // of the linear loop
    std::vector<LoopCell> cells{{linear, surface.rate, 1}};
    const double damping = linear.damping + linear.grip_damping;
    const std::vector<double> dampings = quick ? std::vector{1.0, 5.0} : std::vector{1.0 / 3, 1.0, 2.0, 5.0};
    const std::vector<double> rates = quick ? std::vector{1.0, 4.0} : std::vector{0.5, 1.0, 4.0};
    for (const double times : dampings)
        for (const double faster : rates)
            for (const std::uint64_t delay : {0U, 1U}) {
                LoopCell cell = cells.front();
                cell.rate = faster * surface.rate;
                cell.hand.delay_samples = delay;
                if (times != 1) {
                    cell.hand.damping = times * damping;
                    cell.hand.grip_damping = 0;
                }
                if (times != 1 || faster != 1 || delay != linear.delay_samples)
                    cells.push_back(cell);
            }
    return cells;
}

} // namespace

std::vector<LeastLimit> least_limits(const LoopSurface& surface, const std::vector<RestPlace>& places, bool quick) {
    const std::vector<LoopCell> cells = settings_of(surface, quick);
    std::vector<LeastLimit> least;
    for (const PlaceKind kind : kPlaceKinds)
        for (const double depth : surface.depths()) {
            std::vector<const RestPlace*> some;
            for (const RestPlace& place : places)
                if (place.kind == kind && !jumps(kind) && place.depth == depth)
                    some.push_back(&place);
            for (const LoopCell& cell : cells) {
                if (some.empty())
                    continue;
                LeastLimit one;
                one.surface = surface.name;
                one.place = *some.front();
                one.cell = cell;
                one.own = &cell == &cells.front();
                one.places = some.size();
                one.wall = wall_limit(cell.hand, cell.rate);
                for (const RestPlace* place : some)
                    for (const Hold& hold : holds_at(place->force, place->slope)) {
                        // Only where it is not stable up to the least so far.
                        if (one.limit && !grows(cell.hand, cell.rate, hold, place->slope, *one.limit * 0.9999))
                            continue;
                        const auto limit = linear_limit(cell.hand, cell.rate, hold, place->slope);
                        if (limit && (!one.limit || *limit < *one.limit)) {
                            one.limit = limit;
                            one.place = *place;
                            one.hold = hold;
                        }
                    }
                least.push_back(one);
            }
        }
    return least;
}

std::optional<double> simulated_limit(const LoopSurface& surface, const LeastLimit& least) {
    constexpr double kFrom = 0.3, kTo = 3, kStep = 1.1, kClose = 1.0005; // of the linearised loop's limit
    if (!least.limit || !(*least.limit > 0))
        return std::nullopt;
    Simulation simulation(surface, least);
    double below = kFrom * *least.limit, above = below;
    while (simulation.growth(above) < 0) {
        below = above;
        above *= kStep;
        if (above > kTo * *least.limit)
            return std::nullopt;
    }
    while (above > kClose * below) {
        const double middle = std::sqrt(below * above);
        (simulation.growth(middle) < 0 ? below : above) = middle;
    }
    return std::sqrt(below * above);
}

std::optional<double> largest_kick(const LoopSurface& surface, const LeastLimit& least) {
    constexpr double kShare = 0.5, kDies = -0.7; // of the limit; halves its energy
    if (!least.limit || !(*least.limit > 0))
        return std::nullopt;
    Simulation simulation(surface, least);
    double largest = 0;
    for (const double kick : {0.1e-6, 0.2e-6, 0.5e-6, 1e-6, 2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6}) {
        for (const double way : {-kick, kick})
            if (simulation.growth(kShare * *least.limit, way / std::sqrt(3.0) * glm::dvec3(1)) > kDies)
                return largest;
        largest = kick;
    }
    return largest;
}

std::vector<EdgeSwing> edge_swings(Engine& engine, const LoopSurface& surface, const std::vector<RestPlace>& places) {
    constexpr std::size_t kMostEdges = 8; // a limit cycle depends on where in a sample the probe crosses
    std::vector<LoopCell> cells;
    for (const double stiffness : {100, 200, 500, 1000, 2000, 5000})
        cells.push_back({surface.hand, surface.rate, stiffness});
    if (surface.stiffness > 0)
        cells.push_back({surface.hand, surface.rate, surface.stiffness});
    std::ranges::stable_sort(cells, {}, &LoopCell::stiffness);
    std::vector<EdgeSwing> swings;
    for (const PlaceKind kind : {PlaceKind::edge, PlaceKind::foot})
        for (const double depth : surface.depths()) {
            std::vector<const RestPlace*> some;
            for (const RestPlace& place : places)
                if (place.kind == kind && place.depth == depth)
                    some.push_back(&place);
            std::ranges::stable_sort(some, {}, [](const RestPlace* place) { return -place->jump; });
            some.resize(std::min(some.size(), kMostEdges));
            const std::size_t first = swings.size();
            for (const RestPlace* place : some) {
                LoopRun run;
                run.swings = true;
                const std::vector<LoopOutcome> outcomes = run_cells(engine, surface, *place, cells, run);
                for (std::size_t i = 0; i < cells.size(); ++i) {
                    if (place == some.front())
                        swings.push_back({surface.name, *place, cells[i].stiffness, outcomes[i]});
                    else if (!outcomes[i].left && outcomes[i].swing > swings[first + i].outcome.swing)
                        swings[first + i] = {surface.name, *place, cells[i].stiffness, outcomes[i]};
                }
            }
        }
    return swings;
}

} // namespace forceshade::study
