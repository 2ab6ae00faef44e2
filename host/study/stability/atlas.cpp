#include "host/study/stability/atlas.h"

#include <cmath>
#include <numbers>

namespace forceshade::study {
namespace {

constexpr std::size_t kMostSteps = 30000; // of a simulated loop

const Quantity kQuantities[] = {
    {"mass", "kg", 1e-3, 10, [](LoopCell& cell, double value) { cell.hand.mass = value; }},
    {"grip", "N/m", 20, 5000, [](LoopCell& cell, double value) { cell.hand.grip_stiffness = value; }},
    {"damping", "N s/m", 0.03, 100, [](LoopCell& cell, double value) { cell = damped(cell, value); }},
    {"rate", "Hz", 1e2, 1e5, [](LoopCell& cell, double value) { cell.rate = value; }},
    {"delay", "samples", 0, 8,
     [](LoopCell& cell, double value) { cell.hand.delay_samples = static_cast<std::uint64_t>(value); }}};

std::vector<double> values_of(const Quantity& quantity, bool quick) {
    if (quantity.low == 0)
        return quick ? std::vector{0.0, 1.0, 4.0} : std::vector{0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0};
    const int count = quick ? 5 : 13;
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
        values.push_back(short_between(quantity.low, quantity.high, i, count));
    return values;
}

} // namespace

std::span<const Quantity> quantities() {
    return kQuantities;
}

const LeastLimit* worst_of(const std::vector<LeastLimit>& limits, const std::string& surface,
                           std::optional<double> depth, std::optional<PlaceKind> kind) {
    const LeastLimit* least = nullptr;
    for (const LeastLimit& one : limits)
        if (one.own && one.limit && (surface.empty() || one.surface == surface) &&
            (!depth || one.place.depth == *depth) && (!kind || one.place.kind == *kind) &&
            (!least || *one.limit < *least->limit))
            least = &one;
    return least;
}

double AtlasPoint::limit_group() const {
    return least.limit.value_or(NAN) / (damping_of(least.cell.hand) * least.cell.rate);
}
double AtlasPoint::mass_group() const {
    return damping_of(least.cell.hand) / (least.cell.hand.mass * least.cell.rate);
}
double AtlasPoint::grip_group() const {
    return least.cell.hand.grip_stiffness / (damping_of(least.cell.hand) * least.cell.rate);
}

std::vector<AtlasPoint> atlas_of(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick) {
    std::vector<AtlasPoint> points;
    for (const PlaceKind kind : kPlaceKinds) {
        const LeastLimit* const worst = worst_of(limits, surface.name, {}, kind);
        if (!worst)
            continue;
        for (const Quantity& quantity : kQuantities) {
            std::vector<LoopCell> cells;
            const std::vector<double> values = values_of(quantity, quick);
            for (const double value : values)
                quantity.set(cells.emplace_back(worst->cell), value);
            std::vector<LeastLimit> least = least_limits(surface, {worst->place}, cells);
            for (std::size_t i = 0; i < least.size(); ++i) {
                least[i].own = false;
                const bool chosen = i == 0 || i == least.size() / 2 || i + 1 == least.size();
                if (chosen && !surface.is_mesh() && settling_steps(cells[i], 400) <= kMostSteps)
                    least[i].simulated = simulated_limit(surface, least[i]);
                points.push_back({least[i], quantity.name, values[i]});
            }
        }
    }
    return points;
}

double friction_basin(double mass, double friction, double stiffness, double sample_time) {
    return 8 * friction / (std::numbers::pi * stiffness * sample_time * std::sqrt(stiffness / mass));
}

std::vector<MapLoop> basin_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick) {
    const int columns = quick ? 16 : 32, rows = quick ? 8 : 16;
    const double friction = surface.hand.coulomb > 0 ? surface.hand.coulomb : 0.05; // N
    LoopCell cell = damped({surface.hand, surface.rate, 1}, 0);
    cell.hand.quantisation = 0;
    cell.hand.delay_samples = 0;
    cell.hand.coulomb = friction;
    const double highest = 0.16 * cell.hand.mass * cell.rate * cell.rate; // N/m: w T of 0.4
    std::vector<MapLoop> loops;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            MapLoop loop{"basin", surface.name, cell, {}, false, 0};
            loop.kick = short_between(place.depth / 200, place.depth / 2, j, rows);
            loop.cell.stiffness = short_between(highest / 100, highest, i, columns);
            loop.foreseen = loop.kick < friction_basin(cell.hand.mass, friction, loop.cell.stiffness, 1 / cell.rate);
            loops.push_back(loop);
        }
    LoopRun run;
    run.steps = 8000;
    for (std::size_t row = 0; row < loops.size(); row += static_cast<std::size_t>(columns)) {
        run.disturbance = loops[row].kick / place.depth;
        run_row(engine, surface, place, std::span(loops).subspan(row, static_cast<std::size_t>(columns)), run);
    }
    return loops;
}

} // namespace forceshade::study
