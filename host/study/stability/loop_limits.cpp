#include "host/study/stability/loop_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "host/study/stability/loop_curves.h"
#include "host/study/stability/loop_laws.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

// Of a ladder; on a mesh, where a path is dear, fewer.
std::size_t rungs_on(const LoopPlace& place) {
    return place.prepared.images.mesh ? 16 : 32;
}

struct Rung {
    double stiffness, growth; /* N/m; the logarithm of the speeds late over early */
    bool decays;              /* clearly */
};

std::vector<Rung> climb(Engine& engine, const LoopPlace& place, const LoopCell& cell, double low, double high) {
    // Of the depth: no loop leaves the neighbourhood where it is linear, and it is far above rounding.
    constexpr double kSmall = 1e-4, kSmallInSingle = 2e-2;
    constexpr double kNear = 0.2;        // depths: what comes further grew, and settles elsewhere if at all
    constexpr std::size_t kLeast = 5000; // steps: a fast oscillation's largest sample is near its largest speed
    constexpr double kClearly = -0.5; // what is bounded by leaving contact grows no more, but does not decay like this
    std::vector<LoopCell> cells(rungs_on(place), cell);
    for (std::size_t i = 0; i < cells.size(); ++i)
        cells[i].stiffness = low * std::pow(high / low, double(i) / double(cells.size() - 1));
    LoopRun run;
    run.disturbance = engine.report().f64 ? kSmall : kSmallInSingle;
    run.bound = kNear;
    for (const LoopCell& one : cells)
        run.steps = std::max(run.steps, settling_steps(one, run.patience));
    if (!place.prepared.images.mesh)
        run.steps = std::max(run.steps, kLeast);
    std::vector<Rung> rungs;
    for (const LoopOutcome& outcome : run_cells(engine, place, cells, run)) {
        const double growth = outcome.left ? 1 : outcome.late > 0 ? std::log(outcome.late / outcome.early) : -1;
        rungs.push_back(
            {cells[rungs.size()].stiffness, growth, !outcome.left && (outcome.at_rest || growth < kClearly)});
    }
    return rungs;
}

// The two neighbours between which growth begins; nothing if there are none.
std::optional<std::pair<Rung, Rung>> neighbours(const std::vector<Rung>& rungs) {
    for (std::size_t i = 1; i < rungs.size(); ++i)
        if (rungs[i - 1].growth < 0 && rungs[i].growth >= 0)
            return std::pair{rungs[i - 1], rungs[i]};
    return std::nullopt;
}

double zero_between(const Rung& below, const Rung& above) {
    return below.stiffness + (above.stiffness - below.stiffness) * below.growth / (below.growth - above.growth);
}

LoopCell cell_of(const LoopPlace& place, double mass, double damping, double rate, std::uint64_t delay) {
    LoopCell cell{place.hand, rate, 1};
    cell.hand.mass = mass;
    cell.hand.damping = damping;
    cell.hand.grip_damping = 0;
    cell.hand.delay_samples = delay;
    cell.hand.quantisation = cell.hand.coulomb = 0; // the linear loop's limit
    return cell;
}

// Hands of many kinds, and a grid around the nominal one.
std::vector<LoopCell> plane_cells(const LoopPlace& place, bool quick) {
    constexpr std::array<std::array<double, 3>, 6> kTable{{{0.075, 0.5, 1000},
                                                           {0.1, 1, 1000},
                                                           {0.1, 5, 1000},
                                                           {0.1, 1, 10000},
                                                           {0.05, 20, 1000},
                                                           {0.01, 50, 1000}}}; // kg, N s/m, Hz
    std::vector<LoopCell> cells;
    for (const std::uint64_t delay : {0U, 1U}) {
        for (const auto& [mass, damping, rate] : kTable)
            cells.push_back(cell_of(place, mass, damping, rate, delay));
        if (quick)
            continue;
        for (const double rate : {250.0, 500.0, 1000.0, 2000.0, 4000.0})
            for (const double damping : {0.5, 1.0, 2.0, 5.0, 10.0})
                if (rate != 1000 || (damping != 1 && damping != 5)) // which the table has
                    cells.push_back(cell_of(place, 0.1, damping, rate, delay));
    }
    std::ranges::stable_sort(cells, {}, [](const LoopCell& cell) {
        return std::tuple(cell.hand.delay_samples, cell.rate, cell.hand.mass, cell.hand.damping);
    });
    return cells;
}

Json or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

// Of the linearised loop; nothing where it has none that a measured one could be compared with.
std::optional<double> linear_limit_of(const LoopPlace& place, const LoopCell& cell) {
    const double wall = wall_limit(cell);
    const auto limit = linear_limit(linear_loop(place, cell.hand, cell.rate), 1e-3 * wall, 10 * wall);
    return limit && *limit > 0 ? limit : std::nullopt;
}

} // namespace

std::optional<double> measured_limit(Engine& engine, const LoopPlace& place, const LoopCell& cell) {
    constexpr double kBeyond = 1.03; // where a rung may decay too slowly to tell
    const double passive = passive_stiffness(damping_of(cell), 1 / cell.rate, 0);
    double low = 2e-3 * passive, high = 8 * passive;
    for (int stage = 0; stage < 2; ++stage) {
        const std::vector<Rung> rungs = climb(engine, place, cell, low, high);
        std::size_t first = 0;
        while (first < rungs.size() && rungs[first].decays)
            ++first;
        if (first == 0 || first == rungs.size())
            return std::nullopt;
        low = rungs[first - 1].stiffness;
        high = kBeyond * rungs[first].stiffness;
    }
    const auto close = neighbours(climb(engine, place, cell, low, high));
    if (!close)
        return std::nullopt;
    const auto closer = neighbours(climb(engine, place, cell, close->first.stiffness, close->second.stiffness));
    return closer ? zero_between(closer->first, closer->second) : zero_between(close->first, close->second);
}

std::vector<LoopCell> limit_cells(const LoopPlace& place, bool quick) {
    if (place.flat)
        return plane_cells(place, quick);
    const bool mesh = place.prepared.images.mesh != nullptr;
    const double damping = damping_of({place.hand, place.rate, 1});
    std::vector<double> times{1, 5};
    if (!quick)
        times = mesh ? std::vector<double>{1, 2, 5} : std::vector<double>{0.5, 1, 2, 5, 10};
    if (quick && mesh)
        times = place.stiffness > 0 ? std::vector<double>{1} : std::vector<double>{5};
    std::vector<LoopCell> cells;
    for (const std::uint64_t delay : {0U, 1U})
        for (const double one : times)
            if (!(mesh && quick && delay > 0))
                cells.push_back(cell_of(place, place.hand.mass, one * damping, place.rate, delay));
    return cells;
}

Json limits_result(Engine& engine, const LoopPlace& place, const std::vector<LoopCell>& cells) {
    Json result{{"limits", place.name}, {"title", place.title}, {"flat", place.flat}, {"points", Json::array()}};
    result["pressed"] = pressed(place);
    result["precision"] = engine.report().f64 ? "double" : "single";
    if (place.stiffness > 0)
        result["hand"] = fmt::format(
            "Loops are those of the scene, around its own values: {:.4g} N/m, {:.4g} kg, {:.4g} N s/m, {:.4g} Hz.",
            place.stiffness, place.hand.mass, place.hand.damping + place.hand.grip_damping, place.rate);
    for (const LoopCell& cell : cells) {
        const int delay = static_cast<int>(cell.hand.delay_samples);
        const double damping = damping_of(cell), wall = wall_limit(cell);
        const bool own = place.stiffness > 0 && damping == damping_of({place.hand, place.rate, 1}) &&
                         cell.hand.delay_samples == place.hand.delay_samples;
        const bool loose = cell.hand.grip_stiffness == 0;
        const std::optional<double> flutter = flutter_stiffness(place.slope, cell.hand.mass, damping);
        result["points"].push_back({{"mass", cell.hand.mass},
                                    {"damping", damping},
                                    {"rate", cell.rate},
                                    {"delay", delay},
                                    {"measured", or_null(measured_limit(engine, place, cell))},
                                    {"wall", wall},
                                    {"passive", passive_stiffness(damping, 1 / cell.rate, delay)},
                                    {"linear", or_null(linear_limit_of(place, cell))},
                                    {"own", or_null(own ? std::optional(place.stiffness) : std::nullopt)},
                                    {"flutter", or_null(loose && delay == 0 ? flutter : std::nullopt)}});
    }
    return result;
}

} // namespace forceshade::study
