#include "host/study/stability/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
            const glm::dvec3 delayed = late[(step + 1) % late.size()];
            for (int i = 0; i < 3; ++i) {
                const auto& map = maps_[static_cast<std::size_t>(i)];
                const double before = at[i];
                at[i] += map.x_error * before + map.x_speed * speed[i] + map.x_force * delayed[i];
                speed[i] = map.v_error * before + map.v_speed * speed[i] + map.v_force * delayed[i];
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
    ContactForce force_;
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

constexpr double kOwnStiffness = 1000; // N/m: of the study's own surfaces over quantum and friction
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Fineness {
    int columns, rows;
    double patience;
};

Fineness fineness_of(const LoopSurface& surface, bool quick) {
    if (surface.is_mesh()) // a hundred times dearer
        return quick ? Fineness{8, 4, 60} : Fineness{16, 8, 120};
    return quick ? Fineness{16, 8, 200} : Fineness{32, 16, 400};
}

// With four digits: numbers that are chosen freely are chosen short.
double between(double low, double high, int i, int count) {
    const double value = low * std::pow(high / low, double(i) / (count - 1));
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3);
    return std::round(value / unit) * unit;
}

LoopCell damped(LoopCell cell, double damping) {
    cell.hand.damping = damping;
    cell.hand.grip_damping = 0;
    return cell;
}

// Runs the loops of a map a row at a time, each with its own number of steps.
void run_rows(Engine& engine, const LoopSurface& surface, const RestPlace& place, std::vector<MapLoop>& loops,
              std::size_t columns, const LoopRun& run) {
    for (std::size_t first = 0; first < loops.size(); first += columns) {
        std::vector<LoopCell> cells;
        for (std::size_t i = first; i < first + columns; ++i)
            cells.push_back(loops[i].cell);
        const std::vector<LoopOutcome> outcomes = run_cells(engine, surface, place, cells, run);
        for (std::size_t i = 0; i < columns; ++i)
            loops[first + i].outcome = outcomes[i];
    }
}

std::optional<double> limit_at(const LeastLimit& least, const LoopCell& cell) {
    return linear_limit(cell.hand, cell.rate, least.hold, least.place.slope);
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
    constexpr double kFrom = 0.3, kTo = 3, kClose = 1.0005; // of the linearised loop's limit
    if (!least.limit || !(*least.limit > 0))
        return std::nullopt;
    Simulation simulation(surface, least);
    return least_growing(kFrom * *least.limit, kTo * *least.limit, kClose,
                         [&](double stiffness) { return !(simulation.growth(stiffness) < 0); });
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

std::vector<MapLoop> damping_map(Engine& engine, const LoopSurface& surface, const LeastLimit& least, bool quick) {
    const Fineness fine = fineness_of(surface, quick);
    const double damping = damping_of(least.cell), wall = least.wall;
    const double least_shown = std::max(least.limit.value_or(wall), 1e-3 * wall); // N/m
    const double low = std::min(least_shown, surface.stiffness > 0 ? surface.stiffness : wall) / 10;
    const double high = std::max(wall, surface.stiffness) * 10;
    std::vector<MapLoop> loops;
    for (int j = 0; j < fine.rows; ++j) {
        LoopCell row = damped(least.cell, between(0.2 * damping, 20 * damping, j, fine.rows));
        const std::optional<double> limit = limit_at(least, row);
        for (int i = 0; i < fine.columns; ++i) {
            row.stiffness = between(low, high, i, fine.columns);
            loops.push_back({"damping", surface.name, row, {}, !limit || row.stiffness < *limit});
        }
    }
    LoopRun run;
    run.patience = fine.patience;
    run.all_sides = least.hold.along == glm::dvec3(0);
    run_rows(engine, surface, least.place, loops, static_cast<std::size_t>(fine.columns), run);
    return loops;
}

std::vector<MapLoop> rounding_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick) {
    const Fineness fine = fineness_of(surface, quick);
    LoopCell cell{surface.hand, surface.rate, surface.stiffness > 0 ? surface.stiffness : kOwnStiffness};
    const double quantum = cell.hand.quantisation > 0 ? cell.hand.quantisation : 1e-5; // m
    const double friction = cell.hand.coulomb > 0 ? cell.hand.coulomb : 0.05;          // N
    const double passive = passive_stiffness(damping_of(cell), 1 / cell.rate, cell.hand.delay_samples);
    std::vector<MapLoop> loops;
    for (int j = 0; j < fine.rows; ++j)
        for (int i = 0; i < fine.columns; ++i) {
            cell.hand.quantisation = between(0.1 * quantum, 30 * quantum, i, fine.columns);
            cell.hand.coulomb = between(0.02 * friction, 20 * friction, j, fine.rows);
            const double still = 2 * cell.hand.coulomb / cell.hand.quantisation; // N/m (Abbott & Okamura)
            loops.push_back({"rounding", surface.name, cell, {}, cell.stiffness <= std::min(passive, still)});
        }
    LoopRun run;
    run.patience = fine.patience;
    run.disturbance = 0.5; // friction stops small motions
    run_rows(engine, surface, place, loops, static_cast<std::size_t>(fine.columns), run);
    return loops;
}

std::vector<MapCurvePoint> curves_over(const std::vector<MapLoop>& loops, const LeastLimit& least) {
    std::vector<MapCurvePoint> points;
    const auto add_over_damping = [&](const char* curve, const auto& limit_of) {
        std::optional<double> last;
        for (const MapLoop& loop : loops) {
            if (loop.map != "damping" || last == damping_of(loop.cell))
                continue;
            last = damping_of(loop.cell);
            if (const std::optional<double> limit = limit_of(loop.cell); limit && *limit > 0)
                points.push_back({"damping", curve, *limit, *last, kNone, kNone});
        }
    };
    add_over_damping("K_crit", [](const LoopCell& cell) { return std::optional(wall_limit(cell.hand, cell.rate)); });
    add_over_damping("linearised", [&](const LoopCell& cell) { return limit_at(least, cell); });
    double low = std::numeric_limits<double>::infinity(), high = 0; // N
    for (const MapLoop& loop : loops)
        if (loop.map == "rounding") {
            low = std::min(low, loop.cell.hand.coulomb);
            high = std::max(high, loop.cell.hand.coulomb);
        }
    std::optional<double> last;
    for (const MapLoop& loop : loops) {
        const double quantum = loop.cell.hand.quantisation, friction = loop.cell.stiffness * quantum / 2;
        if (loop.map != "rounding" || (last && quantum <= *last))
            continue;
        last = quantum;
        if (friction >= low && friction <= high)
            points.push_back({"rounding", "f_c = K quantum / 2", kNone, kNone, quantum, friction});
    }
    return points;
}

} // namespace forceshade::study
