// Hands like the surface's own, what sets their limits, and diagrams of their loops.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "host/reference/elementary.h"
#include "host/study/stability/stability.h"

namespace forceshade::study {
namespace {

constexpr double kOwnStiffness = 1000;    // N/m: of the study's own surfaces over quantum and friction
constexpr double kOwnFriction = 0.05;     // N: of hands that have none
constexpr std::size_t kMostSteps = 30000; // of a simulated loop of the atlas
constexpr double kOwnQuantum = 1e-5;      // m: of hands that measure exactly
constexpr double kRounded = 0.5;          // of the depth: the kick where friction stops small motions
constexpr double kTurned = 1e-3;          // rad: of a force that is another one

struct Fineness {
    int columns, rows;
    double patience;
};

Fineness fineness_of(const LoopSurface& surface, bool quick) {
    if (surface.is_mesh()) // a hundred times dearer
        return quick ? Fineness{8, 4, 60} : Fineness{16, 8, 120};
    return quick ? Fineness{16, 8, 200} : Fineness{32, 16, 400};
}

// From the first of a diagram's columns or rows to the last.
struct Ends {
    double low, high;
};

// Loops like `first` over a diagram, each changed by set(loop, x, y), and their outcomes: a row is run at once, with
// its own number of steps and its own kick, if any.
template <typename Set>
std::vector<DiagramLoop> diagram_of(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick,
                                    const DiagramLoop& first, const Ends& x, const Ends& y, LoopRun run,
                                    const Set& set) {
    const Fineness fine = fineness_of(surface, quick);
    run.patience = fine.patience;
    std::vector<DiagramLoop> loops;
    for (int j = 0; j < fine.rows; ++j) {
        std::vector<LoopCell> cells;
        for (int i = 0; i < fine.columns; ++i) {
            DiagramLoop& loop = loops.emplace_back(first);
            set(loop, short_between(x.low, x.high, i, fine.columns), short_between(y.low, y.high, j, fine.rows));
            cells.push_back(loop.cell);
        }
        if (loops.back().kick > 0)
            run.disturbance = loops.back().kick / place.depth;
        const std::vector<LoopOutcome> outcomes = run_cells(engine, surface, place, cells, run);
        for (std::size_t i = 0; i < cells.size(); ++i)
            loops[loops.size() - cells.size() + i].outcome = outcomes[i];
    }
    return loops;
}

std::optional<double> limit_at(const LeastLimit& least, const LoopCell& cell) {
    return linear_limit(cell.hand, cell.rate, least.hold, least.place.force_around());
}

const Quantity kQuantities[] = {
    {"mass", "kg", 1e-3, 10, [](LoopCell& cell, double value) { cell.hand.mass = value; }},
    {"grip", "N/m", 20, 5000, [](LoopCell& cell, double value) { cell.hand.grip_stiffness = value; }},
    {"damping", "N s/m", 0.03, 100, [](LoopCell& cell, double value) { cell = damped(cell, value); }},
    {"rate", "Hz", 1e2, 1e5, [](LoopCell& cell, double value) { cell.rate = value; }},
    {"delay", "samples", 0, 8,
     [](LoopCell& cell, double value) { cell.hand.delay_samples = static_cast<std::uint64_t>(value); }},
    {"lag", "s", 1e-5, 0.1, [](LoopCell& cell, double value) { cell.lag = value; }},
    {"depth", "m", 0.01, 1, [](LoopCell&, double) {}},
    {"quantum", "m", 1e-6, 2e-4,
     [](LoopCell& cell, double value) {
         cell.hand.quantisation = value;
         cell.hand.coulomb = kOwnFriction;
     }},
    {"friction", "N", 5e-4, 5, [](LoopCell& cell, double value) {
         cell.hand.quantisation = kOwnQuantum;
         cell.hand.coulomb = value;
     }}};

bool is(const Quantity& quantity, const char* name) {
    return std::string_view(quantity.name) == name;
}

bool is_rounded(const LoopCell& cell) {
    return cell.hand.quantisation > 0;
}

// Of each of `count` values between `low` and `high` that at which rests(values) turns from true to false, all at once,
// to 0.1 %; empty where it is the same at both ends.
template <typename Rests>
std::vector<std::optional<double>> last_at_rest(std::vector<double> low, std::vector<double> high, const Rests& rests) {
    constexpr double kClose = 1.001;
    const std::vector<bool> at_low = rests(low), at_high = rests(high);
    const auto close = [&] {
        for (std::size_t i = 0; i < low.size(); ++i)
            if (high[i] > kClose * low[i])
                return false;
        return true;
    };
    while (!close()) {
        std::vector<double> middle(low.size());
        for (std::size_t i = 0; i < low.size(); ++i)
            middle[i] = std::sqrt(low[i] * high[i]);
        const std::vector<bool> at_middle = rests(middle);
        for (std::size_t i = 0; i < low.size(); ++i)
            (at_middle[i] ? low : high)[i] = middle[i];
    }
    std::vector<std::optional<double>> last(low.size());
    for (std::size_t i = 0; i < low.size(); ++i)
        if (at_low[i] && !at_high[i])
            last[i] = std::sqrt(low[i] * high[i]);
    return last;
}

std::vector<bool> stable_of(const std::vector<LoopOutcome>& outcomes) {
    std::vector<bool> stable;
    stable.reserve(outcomes.size());
    for (const LoopOutcome& one : outcomes)
        stable.push_back(one.state == LoopState::stable);
    return stable;
}

// Of points whose positions are measured in steps.
void step_rounded(Engine& engine, const LoopSurface& surface, std::vector<AtlasPoint>& points) {
    std::vector<AtlasPoint*> rounded;
    std::vector<LoopCell> cells;
    std::vector<double> low, high;
    for (AtlasPoint& point : points)
        if (is_rounded(point.least.cell) && point.least.limit && settling_steps(point.least.cell, 400) <= kMostSteps) {
            rounded.push_back(&point);
            cells.push_back(point.least.cell);
            low.push_back(*point.least.limit / 2);
            high.push_back(*point.least.limit * 2);
        }
    if (rounded.empty())
        return;
    LoopRun run;
    run.disturbance = kRounded;
    const auto found = last_at_rest(low, high, [&](const std::vector<double>& stiffness) {
        for (std::size_t i = 0; i < cells.size(); ++i)
            cells[i].stiffness = stiffness[i];
        return stable_of(run_cells(engine, surface, rounded.front()->least.place, cells, run));
    });
    for (std::size_t i = 0; i < rounded.size(); ++i)
        rounded[i]->least.simulated = found[i];
}

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

double short_between(double low, double high, int i, int count) {
    const double value = low * std::pow(high / low, double(i) / (count - 1));
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3);
    return std::round(value / unit) * unit;
}

LoopCell damped(LoopCell cell, double damping) {
    cell.hand.damping = damping;
    cell.hand.grip_damping = 0;
    return cell;
}

std::vector<LoopCell> settings_of(const LoopSurface& surface, bool quick) {
    HandSpec linear = surface.hand;
    linear.quantisation = linear.coulomb = 0; // of the linear loop
    std::vector<LoopCell> cells{{linear, surface.rate, 1}};
    const double damping = damping_of(linear);
    const std::vector<double> dampings = quick ? std::vector{1.0, 5.0} : std::vector{1.0 / 3, 1.0, 2.0, 5.0};
    const std::vector<double> rates = quick ? std::vector{1.0, 4.0} : std::vector{0.5, 1.0, 4.0};
    for (const double times : dampings)
        for (const double faster : rates)
            for (const std::uint64_t delay : {0U, 1U}) {
                LoopCell cell = cells.front();
                cell.rate = faster * surface.rate;
                cell.hand.delay_samples = delay;
                if (times != 1)
                    cell = damped(cell, times * damping);
                if (times != 1 || faster != 1 || delay != linear.delay_samples)
                    cells.push_back(cell);
            }
    for (const double times : {0.1, 4.0}) { // of the grip's spring, on which the limit on a shaded slope depends alone
        LoopCell& cell = cells.emplace_back(cells.front());
        cell.hand.grip_stiffness *= times;
    }
    return cells;
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

std::vector<DiagramLoop> damping_diagram(Engine& engine, const LoopSurface& surface, const LeastLimit& least,
                                         bool quick) {
    const double damping = damping_of(least.cell.hand), wall = least.wall;
    const double least_shown = std::max(least.limit.value_or(wall), 1e-3 * wall); // N/m
    const double low = std::min(least_shown, surface.stiffness > 0 ? surface.stiffness : wall) / 10;
    const double high = std::max(wall, surface.stiffness) * 10;
    std::optional<double> limit; // of a row
    double row = NAN;
    LoopRun run;
    run.all_sides = least.hold.along == glm::dvec3(0);
    return diagram_of(engine, surface, least.place, quick, {"damping", surface.name, least.cell}, {low, high},
                      {0.2 * damping, 20 * damping}, run, [&](DiagramLoop& loop, double stiffness, double damped_by) {
                          loop.cell = damped(loop.cell, damped_by);
                          if (damped_by != std::exchange(row, damped_by))
                              limit = limit_at(least, loop.cell);
                          loop.cell.stiffness = stiffness;
                          loop.foreseen = !limit || stiffness < *limit;
                      });
}

std::vector<DiagramLoop> coupling_diagram(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                          bool quick) {
    constexpr double kRigid = 1e7; /* N/m */
    HandSpec linear = surface.hand;
    linear.quantisation = linear.coulomb = 0;
    const double damping = damping_of(linear);
    const double passive = passive_stiffness(damping, 1 / surface.rate, linear.delay_samples);
    const Hold down = pressed_along({0, 0, 1});
    return diagram_of(engine, surface, place, quick, {"coupling", surface.name, {linear, surface.rate, kRigid}},
                      {0.1 * passive, 30 * passive}, {0.03 * damping, 100 * damping}, {},
                      [&](DiagramLoop& loop, double stiffness, double damper) {
                          loop.cell.hand = coupled(linear, stiffness, damper);
                          loop.foreseen = !grows(loop.cell.hand, surface.rate, down, place.force_around(), kRigid);
                      });
}

std::vector<DiagramLoop> rounding_diagram(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                          bool quick) {
    const LoopCell cell{surface.hand, surface.rate, surface.stiffness > 0 ? surface.stiffness : kOwnStiffness};
    const double quantum = cell.hand.quantisation > 0 ? cell.hand.quantisation : kOwnQuantum;
    const double friction = cell.hand.coulomb > 0 ? cell.hand.coulomb : kOwnFriction;
    const double passive = passive_stiffness(damping_of(cell.hand), 1 / cell.rate, cell.hand.delay_samples);
    LoopRun run;
    run.disturbance = kRounded;
    return diagram_of(engine, surface, place, quick, {"rounding", surface.name, cell}, {0.1 * quantum, 30 * quantum},
                      {0.02 * friction, 20 * friction}, run, [&](DiagramLoop& loop, double step, double coulomb) {
                          loop.cell.hand.quantisation = step;
                          loop.cell.hand.coulomb = coulomb;
                          loop.foreseen = cell.stiffness <= std::min(passive, held_by_friction(loop.cell.hand));
                      });
}

std::vector<BasinRow> basins_of(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick) {
    constexpr double kOfDepth = 0.01, kOfEdge = 0.05;
    const std::vector<double> turns = quick || surface.is_mesh() ? std::vector{0.2} : std::vector{0.1, 0.2}; // rad: w T
    std::vector<BasinRow> rows;
    const auto add = [&](const LeastLimit& worst, const Hold& hold, double grip, std::uint64_t delay, double turn) {
        BasinRow row;
        row.there = worst;
        row.there.own = false;
        row.there.limit = {};
        row.there.hold = hold;
        LoopCell& cell = row.there.cell = damped(worst.cell, 0);
        cell.hand.grip_stiffness = grip;
        cell.hand.delay_samples = delay;
        cell.stiffness = turn * turn * cell.hand.mass * cell.rate * cell.rate;
        if (const auto most = grip_limit(cell.hand, hold, worst.place.force_around()))
            cell.stiffness = std::min(cell.stiffness, *most / 2);
        if (!(cell.stiffness > 0))
            return;
        cell.hand.coulomb = 1;
        row.foreseen = kOfDepth * worst.place.depth;
        if (const auto jump = worst.place.edge_distance) // beyond it lies another force
            row.foreseen = std::min(row.foreseen, kOfEdge * *jump);
        cell.hand.coulomb = row.foreseen / friction_basin(cell, worst.place, hold);
        row.stepped = dying_kick(surface, row.there, row.foreseen);
        rows.push_back(row);
    };
    for (const PlaceKind kind : kPlaceKinds) {
        const LeastLimit* const worst = worst_of(limits, surface.name, {}, kind);
        if (!worst)
            continue;
        const Hold down = pressed_along({0, 0, 1}), all_sides{"on all sides", glm::dvec3(0)};
        for (const std::uint64_t delay : {0U, 1U, 2U})
            for (const double turn : turns) {
                const bool held = supports(down.along, worst->place.force, worst->place.slope);
                if (held && surface.hand.grip_stiffness > 0)
                    add(*worst, down, surface.hand.grip_stiffness, delay, turn);
                if (held)
                    add(*worst, down, 0, delay, turn);
                add(*worst, all_sides, surface.hand.grip_stiffness, delay, turn);
            }
    }
    return rows;
}

std::vector<DiagramLoop> basin_diagram(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick) {
    const double friction = surface.hand.coulomb > 0 ? surface.hand.coulomb : kOwnFriction;
    LoopCell cell = damped({surface.hand, surface.rate, 1}, 0);
    cell.hand.quantisation = 0;
    cell.hand.delay_samples = 0;
    cell.hand.coulomb = friction;
    const double highest = 0.16 * cell.hand.mass * cell.rate * cell.rate; // N/m: w T of 0.4
    LoopRun run;
    run.steps = 8000;
    return diagram_of(engine, surface, place, quick, {"basin", surface.name, cell}, {highest / 100, highest},
                      {place.depth / 200, place.depth / 2}, run, [&](DiagramLoop& loop, double stiffness, double kick) {
                          loop.kick = kick;
                          loop.cell.stiffness = stiffness;
                          loop.foreseen = kick < friction_basin(cell.hand.mass, friction, stiffness, 1 / cell.rate, 0);
                      });
}

std::vector<CurvePoint> curves_over(const std::vector<DiagramLoop>& loops, const LeastLimit& least) {
    std::vector<CurvePoint> points;
    // Visits a row or a column of a diagram, the loops of the least `number`, with the largest one of the diagram.
    const auto over = [&](const char* diagram, double (*number)(const DiagramLoop&), const auto& visit) {
        double low = INFINITY, high = 0;
        for (const DiagramLoop& loop : loops)
            if (loop.diagram == diagram) {
                low = std::min(low, number(loop));
                high = std::max(high, number(loop));
            }
        for (const DiagramLoop& loop : loops)
            if (loop.diagram == diagram && number(loop) == low)
                visit(loop, loop.cell, high);
    };
    for (const char* curve : {"K_crit", "linearised"})
        over(
            "damping", [](const DiagramLoop& loop) { return loop.cell.stiffness; },
            [&](const DiagramLoop&, const LoopCell& cell, double) {
                const std::optional<double> limit =
                    curve[0] == 'K' ? wall_limit(cell.hand, cell.rate) : limit_at(least, cell);
                if (limit && *limit > 0)
                    points.push_back(
                        {.diagram = "damping", .curve = curve, .stiffness = *limit, .damping = damping_of(cell.hand)});
            });
    over(
        "coupling", [](const DiagramLoop& loop) { return loop.cell.hand.coupling_stiffness; },
        [&](const DiagramLoop&, const LoopCell& cell, double) {
            const double softest = cell.hand.coupling_stiffness, damper = cell.hand.coupling_damping;
            const auto add = [&](const std::string& curve, double stiffness) {
                points.push_back(
                    {.diagram = "coupling", .curve = curve, .coupling = stiffness, .coupling_damping = damper});
            };
            const double passive = passive_stiffness(damping_of(cell.hand) - damper, 1 / cell.rate,
                                                     cell.hand.delay_samples); // Colgate & Schenkel
            if (cell.hand.delay_samples == 0 && passive >= softest)
                add("passive", passive);
            const ForceAround wall = wall_place().force_around();
            for (const int samples : {0, kUsualFilter, 4 * kUsualFilter}) {
                HandSpec filtered = cell.hand;
                filtered.coupling_filter = samples / cell.rate;
                const auto limit = least_growing(softest, 300 * softest, 1.001, [&](double k) {
                    return grows(coupled(filtered, k, damper), cell.rate, pressed_along(wall.direction), wall,
                                 cell.stiffness);
                });
                if (limit && *limit > 1.01 * softest)
                    add(samples == 0 ? "linearised" : fmt::format("filter of {} samples", samples), *limit);
            }
        });
    over(
        "rounding", [](const DiagramLoop& loop) { return loop.cell.hand.coulomb; },
        [&](const DiagramLoop&, const LoopCell& cell, double most) {
            const double quantum = cell.hand.quantisation, friction = cell.stiffness * quantum / 2;
            if (friction >= cell.hand.coulomb && friction <= most)
                points.push_back(
                    {.diagram = "rounding", .curve = "f_c = K quantum / 2", .quantum = quantum, .friction = friction});
        });
    over(
        "basin", [](const DiagramLoop& loop) { return loop.kick; },
        [&](const DiagramLoop& loop, const LoopCell& cell, double most) {
            const double kick = friction_basin(cell.hand.mass, cell.hand.coulomb, cell.stiffness, 1 / cell.rate, 0);
            if (kick >= loop.kick && kick <= most)
                points.push_back(
                    {.diagram = "basin", .curve = "8 f_c / (pi K T w)", .stiffness = cell.stiffness, .kick = kick});
        });
    return points;
}

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

double AtlasPoint::lag_group() const {
    return least.cell.lag * least.cell.rate;
}

double AtlasPoint::depth_group() const {
    const double group = least.place.depth * turn_of(least.place);
    return std::abs(group) > 1e-6 ? group : 0;
}

double AtlasPoint::balance_group() const {
    const double turn = depth_group(), grip = least.cell.hand.grip_stiffness;
    return turn > 0 && grip > 0 ? least.limit.value_or(NAN) * turn / grip : NAN;
}

double AtlasPoint::friction_group() const {
    const HandSpec& hand = least.cell.hand;
    return is_rounded(least.cell) ? hand.coulomb / (damping_of(hand) * hand.quantisation * least.cell.rate) : NAN;
}

std::vector<AtlasPoint> atlas_of(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick,
                                 Engine* engine) {
    std::vector<AtlasPoint> points;
    for (const PlaceKind kind : kPlaceKinds) {
        const LeastLimit* const worst = worst_of(limits, surface.name, {}, kind);
        if (!worst)
            continue;
        std::vector<AtlasPoint> rounded;
        for (const Quantity& quantity : kQuantities) {
            const std::vector<double> values = values_of(quantity, quick);
            for (std::size_t i = 0; i < values.size(); ++i) {
                LoopCell cell = worst->cell;
                quantity.set(cell, values[i]);
                // Friction and steps from a kick of half the deepest, which is many of these.
                if (is_rounded(cell) && !(engine && kind == PlaceKind::flat))
                    continue;
                std::optional<RestPlace> place = worst->place;
                if (is(quantity, "depth") || is_rounded(cell))
                    place = at_depth(surface, worst->place, (is_rounded(cell) ? 1 : values[i]) * surface.deepest);
                // Deeper down another facet may be the nearest: then it is no flat place any more.
                if (!place ||
                    (kind == PlaceKind::flat && reference::angle_between(place->force, worst->place.force) > kTurned))
                    continue;
                place->kind = kind;
                const double value = is(quantity, "depth") ? place->depth : values[i];
                LeastLimit least = least_of(surface, {&*place}, cell);
                if (is_rounded(cell)) {
                    least.limit = rounded_limit(cell, kRounded * place->depth);
                    rounded.push_back({least, quantity.name, value});
                    continue;
                }
                const bool chosen = i == 0 || i == values.size() / 2 || i + 1 == values.size();
                if (chosen && settling_steps(cell, 400) <= (surface.is_mesh() ? kMostSteps / 2 : kMostSteps))
                    least.simulated = simulated_limit(surface, least);
                points.push_back({least, quantity.name, value});
            }
        }
        if (engine)
            step_rounded(*engine, surface, rounded);
        append(points, std::move(rounded));
    }
    return points;
}

} // namespace forceshade::study
