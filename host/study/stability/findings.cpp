// Findings of the loops.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/numbers.h"
#include "host/study/stability/stability.h"
#include "host/touch/force_errors.h"

namespace forceshade::study {
namespace {

std::string place_of(const LeastLimit& least) {
    const std::string from_jump =
        least.place.edge_distance ? fmt::format(" ({:.2g} µm from a jump)", 1e6 * *least.place.edge_distance) : "";
    return fmt::format("{}: {} at x = {:.4g} mm{}, y = {:.3g} mm, {:.2g} mm deep, held {}", least.surface,
                       name_of(least.place.kind), 1e3 * least.place.at.x, from_jump, 1e3 * least.place.at.y,
                       1e3 * least.place.depth, least.hold.name);
}

// The number of places of a surface, or of all, behind a minimum, and the agreement of the stepped paths.
std::string sureness_of(const LoopResults& results, const std::string& surface = {}) {
    std::size_t places = 0, stepped = 0;
    double most = 0; // 1
    for (const LeastLimit& one : results.limits) {
        if (!surface.empty() && one.surface != surface)
            continue;
        places += one.own ? one.places : 0;
        if (one.own && one.simulated && one.limit && *one.limit > 0) {
            ++stepped;
            most = std::max(most, std::abs(*one.simulated / *one.limit - 1));
        }
    }
    std::string text =
        fmt::format("minimum over {} contact points and depths, up to three boundary conditions each", places);
    if (stepped > 0)
        text += fmt::format("; {} of them stepped through the surface's own force agree within {:.2g} %", stepped,
                            100 * most);
    return text;
}

// Whether more damping, a faster rate and less delay do not raise the limit there: the hand's grip gives way, not the
// sampled loop.
bool is_of_the_grip(const LoopResults& results, const LeastLimit& worst) {
    constexpr double kSame = 0.01;
    return std::ranges::all_of(results.limits, [&](const LeastLimit& one) {
        const bool easier = damping_of(one.cell.hand) >= damping_of(worst.cell.hand) &&
                            one.cell.rate >= worst.cell.rate &&
                            one.cell.hand.delay_samples <= worst.cell.hand.delay_samples;
        const bool there =
            one.surface == worst.surface && one.place.kind == worst.place.kind && one.place.depth == worst.place.depth;
        return !easier || !there || (one.limit && std::abs(*one.limit / *worst.limit - 1) < kSame);
    });
}

// As "5313 N/m at 0.2 mm".
std::string limit_at(const LoopResults& results, const std::string& surface, double depth) {
    const LeastLimit* const least = worst_of(results.limits, surface, depth);
    return (least ? newtons(*least->limit) : "no limit") + fmt::format(" at {:.2g} mm", 1e3 * depth);
}

Finding about_least(const LoopResults& results, const LeastLimit& worst) {
    const LoopSurface& surface = results.surfaces.front();
    Finding finding{
        "loop_least", {}, "loop-kinds", place_of(worst), hand_text(surface), sureness_of(results, worst.surface)};
    if (worst.kick)
        finding.interval +=
            fmt::format("; at half that stiffness, displacements up to {:.2g} µm decay", 1e6 * *worst.kick);
    if (!(*worst.limit > 0)) {
        finding.text = fmt::format("Unstable at every stiffness somewhere on the {}.", worst.surface);
    } else if (surface.stiffness > 0) {
        const double ratio = surface.stiffness / *worst.limit;
        finding.text = fmt::format("Away from places where the direction jumps the scene's loop is stable{} up to {} "
                                   "(flat wall: {}); its own {} is {:.3g} times that{}.",
                                   surface.prepared.one.scene.hand.coupled() ? " without its virtual coupling" : "",
                                   newtons(*worst.limit), newtons(worst.wall), newtons(surface.stiffness), ratio,
                                   ratio < 1 ? "" : ", and unstable");
    } else {
        std::vector<std::string> lowest{worst.surface};
        for (const LoopSurface& other : results.surfaces)
            if (const LeastLimit* const least = worst_of(results.limits, other.name);
                least && other.name != worst.surface && *least->limit < 1.001 * *worst.limit)
                lowest.push_back(other.name);
        finding.text = fmt::format(
            "Of {} surfaces the {} {} the lowest limit: away from places where the direction jumps the loop is stable "
            "up to {} of depth{}, {} (flat wall: {}).",
            results.surfaces.size(), fmt::join(lowest, " and the "), lowest.size() > 1 ? "have" : "has",
            limit_at(results, worst.surface, worst.place.depth),
            is_of_the_grip(results, worst) ? fmt::format(" (the grip's spring holds at most {:.2g} N that turn so "
                                                         "fast; neither more damping nor a faster rate helps)",
                                                         *worst.limit * worst.place.depth)
                                           : "",
            limit_at(results, worst.surface, results.surfaces.front().depths().front()), newtons(worst.wall));
    }
    const TessellatedLimit* lower = nullptr;
    for (const TessellatedLimit& one : results.tessellated)
        if (one.least.limit && *one.least.limit < (lower ? *lower->least.limit : *worst.limit))
            lower = &one;
    if (lower)
        finding.text += fmt::format(" Held as usual, only the {} on another tessellation of its cells has a lower one, "
                                    "{}.",
                                    lower->least.surface, newtons(*lower->least.limit));
    if (worst.any_press && *worst.limit > 0 && worst.any_press->limit < 0.99 * *worst.limit)
        finding.text += fmt::format(" A press {} (90 is sideways) lowers the {} to {}.", worst.any_press->hold.name,
                                    newtons(*worst.limit), newtons(worst.any_press->limit)) +
                        (surface.stiffness > worst.any_press->limit && surface.stiffness < *worst.limit
                             ? " So its own is unstable there."
                             : "");
    return finding;
}

// " (1323 to 1550 N/m on 5 tessellations)": the least limits at a depth; empty where there is one alone.
std::string over_tessellations(const LoopResults& results, const std::string& surface, double depth) {
    std::map<std::size_t, double> least; // N/m
    double low = INFINITY, high = 0;
    for (const auto& [tessellation, one] : results.tessellated)
        if (one.surface == surface && one.place.depth == depth && one.limit)
            least[tessellation] = std::min(least.emplace(tessellation, INFINITY).first->second, *one.limit);
    for (const auto& [tessellation, limit] : least) {
        low = std::min(low, limit);
        high = std::max(high, limit);
    }
    return least.size() < 2 ? "" : fmt::format(" ({:.0f} to {} on {} tessellations)", low, newtons(high), least.size());
}

// N/m: the least of a surface at a depth, over the usual holds or over any press.
double least_at(const LoopResults& results, const std::string& surface, double depth, bool any_press) {
    double least = INFINITY;
    for (const LeastLimit& one : results.limits)
        if (one.own && one.surface == surface && one.place.depth == depth) {
            least = std::min(least, one.limit.value_or(INFINITY));
            if (any_press && one.any_press)
                least = std::min(least, one.any_press->limit);
        }
    return least;
}

void add_shading(std::vector<Finding>& findings, const LoopResults& results) {
    std::vector<std::string> parts, places, sure;
    for (const char* surface : {"bump of 2 facets", "mesh"}) {
        const LeastLimit *bare = worst_of(results.limits, surface),
                         *shaded = worst_of(results.limits, "shaded " + std::string(surface));
        if (!bare || !shaded)
            continue;
        const auto change_at = [&](double depth, bool any_press) {
            constexpr double kSame = 0.01;
            const double before = least_at(results, surface, depth, any_press),
                         after = least_at(results, shaded->surface, depth, any_press);
            return std::abs(after / before - 1) < kSame
                       ? fmt::format("the same at {:.2g} mm", 1e3 * depth)
                       : fmt::format("from {} to {} at {:.2g} mm", newtons(before), newtons(after), 1e3 * depth);
        };
        const double deep = shaded->place.depth, shallow = results.surfaces.front().depths().front();
        parts.push_back(fmt::format("the {}: {} of depth{}, {}; under a press in any direction {}, {}", surface,
                                    change_at(deep, false), over_tessellations(results, shaded->surface, deep),
                                    change_at(shallow, false), change_at(deep, true), change_at(shallow, true)));
        places.push_back(place_of(*shaded));
        sure.push_back(fmt::format("{}: {}", shaded->surface, sureness_of(results, shaded->surface)));
    }
    if (parts.empty())
        return;
    findings.push_back(
        {"loop_shading",
         fmt::format(
             "Force shading changes the largest stable stiffness (away from places where the direction jumps) of {}.",
             fmt::join(parts, ". Of ")),
         "loop-places", fmt::format("{}", fmt::join(places, "; ")), hand_text(results.surfaces.front()),
         fmt::format("{}", fmt::join(sure, "; "))});
}

// At the surface's own stiffness, or 1000 N/m.
void add_edges(std::vector<Finding>& findings, const LoopResults& results) {
    const LoopSurface& first = results.surfaces.front();
    const double stiffness = first.stiffness > 0 ? first.stiffness : 1000; // N/m
    const double depth = first.depths()[2];
    const EdgeSwing* most = nullptr;
    std::size_t all = 0, rest = 0;
    for (const EdgeSwing& one : results.swings) {
        if (one.stiffness != stiffness || one.place.depth != depth || one.place.kind != PlaceKind::foot)
            continue;
        ++all;
        const bool rests = one.outcome.state == LoopState::stable;
        rest += rests;
        if (!rests && !one.outcome.left && (!most || one.outcome.swing > most->outcome.swing))
            most = &one;
    }
    if (!most)
        return;
    findings.push_back(
        {"loop_edges",
         fmt::format("Where the direction jumps inwards, as at the foot of a bump, {}: at {} the probe keeps "
                     "oscillating, {:.3g} µm peak to peak, {:.2g} mm deep at the worst of eight places.",
                     rest == 0 ? (all == 1 ? "the loop is not stable"
                                           : fmt::format("loops are stable on none of {} surfaces", all))
                               : fmt::format("{} of {} loops are not stable", all - rest, all),
                     newtons(stiffness), 1e6 * most->outcome.swing, 1e3 * depth),
         "loop-edges",
         fmt::format("{}: jump of {:.3g} deg at x = {:.3g} mm, y = {:.3g} mm", most->surface,
                     most->place.jump / kDegree, 1e3 * most->place.at.x, 1e3 * most->place.at.y),
         fmt::format("{}, {:.2g} mm deep", hand_text(first), 1e3 * depth),
         fmt::format("the largest of eight places at feet of each surface; {} surfaces have some", all)});
}

// "20 to 5000 N/m", "20 µm to 2 mm"
std::string range_text(double from, double to, const Quantity& quantity) {
    const std::string unit = quantity.unit;
    if (unit != "m" && unit != "s" && unit != "Hz")
        return fmt::format("{:g} to {:g} {}", from, to, unit);
    return fmt::format("{} to {}", numbers::quantity_text(from, unit), numbers::quantity_text(to, unit));
}

// "grip (20 to 5000 N/m: 46.7 N/m to 5570 N/m)"
struct Span {
    const Quantity* quantity;
    double from, to;       // SI: of the quantity
    double at_from, at_to; // N/m: of the limit there
    double low, high;      // N/m: least and largest limit

    // A limit that is largest or least in between is said, too.
    std::string text() const {
        constexpr double kSame = 0.99;
        std::string text = fmt::format("{} ({}: {} to {}", quantity->name, range_text(from, to, *quantity),
                                       newtons(at_from), newtons(at_to));
        if (low < kSame * std::min(at_from, at_to))
            text += fmt::format(", {} in between", newtons(low));
        if (high * kSame > std::max(at_from, at_to))
            text += fmt::format(", {} in between", newtons(high));
        return text + ")";
    }
};

std::vector<Span> spans_of(const LoopResults& results, const LeastLimit& worst) {
    std::vector<Span> spans;
    for (const Quantity& quantity : quantities()) {
        Span span{&quantity, INFINITY, 0, 0, 0, INFINITY, 0};
        for (const AtlasPoint& point : results.atlas) {
            if (point.quantity != quantity.name || point.least.surface != worst.surface ||
                point.least.place.kind != worst.place.kind || !point.least.limit)
                continue;
            if (point.value < span.from)
                std::tie(span.from, span.at_from) = std::pair(point.value, *point.least.limit);
            if (point.value > span.to)
                std::tie(span.to, span.at_to) = std::pair(point.value, *point.least.limit);
            span.low = std::min(span.low, *point.least.limit);
            span.high = std::max(span.high, *point.least.limit);
        }
        if (span.low > 0 && span.high > 0)
            spans.push_back(span);
    }
    std::ranges::stable_sort(spans, {}, [](const Span& span) { return span.low / span.high; });
    return spans;
}

// What moves the lowest limit, most first, and what does not.
void add_atlas(std::vector<Finding>& findings, const LoopResults& results, const LeastLimit& worst) {
    constexpr double kSame = 0.99;
    std::vector<std::string> moved, still;
    for (const Span& span : spans_of(results, worst)) {
        if (span.low / span.high < kSame)
            moved.push_back(span.text());
        else
            still.push_back(
                fmt::format("{} ({})", span.quantity->name, range_text(span.from, span.to, *span.quantity)));
    }
    if (moved.empty())
        return;
    std::size_t stepped = 0, apart = 0;
    for (const SteppedCheck& one : stepped_checks(results))
        if (one.what.starts_with("limit")) {
            ++stepped;
            apart += one.apart();
        }
    findings.push_back(
        {"loop_atlas",
         fmt::format("The limit there moves with {}{}.", fmt::join(moved, ", "),
                     still.empty() ? "" : fmt::format("; not with {}", fmt::join(still, ", "))),
         "loop-atlas-grip", place_of(worst), hand_text(results.surfaces.front()) + ", one varied at a time",
         stepped == 0
             ? ""
             : fmt::format(
                   "of {} limits of all surfaces stepped through the surface's own force {} differ by more than 1 %",
                   stepped, apart)});
}

// Of a diagram: the loops that are foreseen to come to rest, and those that are not.
struct Tally {
    const DiagramLoop* any = nullptr;                         /* null: there is no such diagram */
    std::size_t foreseen = 0, kept = 0, others = 0, rest = 0; /* kept, rest: of either, those that do come to rest */

    std::size_t all() const { return foreseen + others; }
    std::size_t as_foreseen() const { return kept + others - rest; }
};

Tally tally_of(const LoopResults& results, const char* diagram) {
    Tally tally;
    for (const DiagramLoop& loop : results.diagrams) {
        if (loop.diagram != diagram)
            continue;
        tally.any = &loop;
        (loop.foreseen ? tally.foreseen : tally.others) += 1;
        (loop.foreseen ? tally.kept : tally.rest) += loop.outcome.state == LoopState::stable;
    }
    return tally;
}

const CouplingRow* safe_on(const LoopResults& results, const std::string& surface, double scene) {
    const auto row = std::ranges::find_if(results.couplings, [&](const CouplingRow& one) {
        return one.surface == surface && one.which == "safe" && one.scene == scene;
    });
    return row == results.couplings.end() ? nullptr : &*row;
}

// On the first surface, and on the one that needs the softest coupling.
void add_couplings(std::vector<Finding>& findings, const LoopResults& results) {
    constexpr double kSoft = 1e4, kStiff = 1e7; /* N/m */
    std::vector<std::string> parts;
    std::size_t stepped = 0, foreseen = 0;
    const CouplingRow *least = nullptr, *damped = nullptr;
    for (const CouplingRow& row : results.couplings) {
        stepped += row.foreseen.has_value();
        foreseen += row.foreseen.value_or(false);
        if (row.scene != kStiff)
            continue;
        if (row.which == "safe" && (!least || row.coupling.stiffness < least->coupling.stiffness))
            least = &row;
        if (row.which == "stiffest" && (!damped || row.coupling.stiffness > damped->coupling.stiffness))
            damped = &row;
    }
    if (!least || !damped)
        return;
    const auto felt = [](const CouplingRow& row) {
        return newtons(displayed_stiffness(row.scene, row.coupling.stiffness));
    };
    const auto on = [&](const std::string& surface) {
        return results.surfaces.size() == 1 ? "" : fmt::format("on the {} ", surface);
    };
    const auto add = [&](const std::string& surface) {
        const CouplingRow *soft = safe_on(results, surface, kSoft), *stiff = safe_on(results, surface, kStiff);
        if (stiff)
            parts.push_back(
                fmt::format("{}at most {}{} for 1e7 N/m, displayed as {}", on(surface),
                            soft ? fmt::format("{} for 1e4 N/m and ", newtons(soft->coupling.stiffness)) : "",
                            newtons(stiff->coupling.stiffness), felt(*stiff)));
    };
    const std::string& first = results.surfaces.front().name;
    add(first);
    if (least->surface != first)
        add(least->surface);
    const Tally loops = tally_of(results, "coupling");
    const auto own = std::ranges::find(results.couplings, "own", &CouplingRow::which);
    std::string text;
    if (own != results.couplings.end())
        text = fmt::format("Through its own virtual coupling the scene displays {}, {}. ", felt(*own),
                           own->rests ? "stable everywhere" : "but is not stable everywhere");
    text +=
        fmt::format("In a scene of up to 1e7 N/m this hand is stable through a virtual coupling (hand.coupling): {}.",
                    fmt::join(parts, "; "));
    const auto filtered = std::ranges::find_if(results.couplings, [&](const CouplingRow& row) {
        return row.which == "filtered" && row.surface == damped->surface && row.scene == kStiff;
    });
    if (damped->coupling.damping > 0)
        text += fmt::format(" A damper of {:.3g} N s/m displays {}{}{}, but impacts may then add energy.",
                            damped->coupling.damping, on(damped->surface), felt(*damped),
                            filtered == results.couplings.end()
                                ? ""
                                : fmt::format(" (the best one whose speed is filtered over {} samples {})",
                                              kUsualFilter, felt(*filtered)));
    findings.push_back(
        {"loop_couplings", text, "loop-couplings", "at rest at all places, in all holds",
         hand_text(results.surfaces.front()),
         fmt::format(
             "of {} couplings stepped through the surface's own force {} rest 2 % softer and grow 2 % stiffer{}",
             stepped, foreseen,
             loops.any ? fmt::format("; of {} in loop-coupling {} do as foreseen", loops.all(), loops.as_foreseen())
                       : "")});
}

// "; with grip and delay, on all surfaces, ...".
std::string basins_text(const std::vector<BasinRow>& rows) {
    std::vector<double> off; // 1
    for (const BasinRow& row : rows)
        if (row.stepped)
            off.push_back(*row.stepped / row.foreseen);
    if (off.empty())
        return "";
    std::ranges::sort(off);
    return fmt::format("; with the grip's spring, up to two samples late, at places of all surfaces: {} stepped kicks "
                       "are {:.3g} to {:.3g} of that along the force, half of them {:.3g} to {:.3g}{}",
                       off.size(), off.front(), off.back(), off[off.size() / 4], off[off.size() * 3 / 4],
                       off.size() == rows.size()
                           ? ""
                           : fmt::format(", {} others are beyond a factor of four", rows.size() - off.size()));
}

void add_basin(std::vector<Finding>& findings, const LoopResults& results) {
    const Tally loops = tally_of(results, "basin");
    if (!loops.any)
        return;
    const LoopCell& cell = loops.any->cell;
    const auto basin = [&](double stiffness) {
        return 1e3 * friction_basin(cell.hand.mass, cell.hand.coulomb, stiffness, 1 / cell.rate, 0);
    };
    findings.push_back(
        {"loop_basin",
         fmt::format(
             "Without any damping {:.3g} N of friction lets a kick die out up to 8 f_c / (pi K T w), w = sqrt(K / m): "
             "{:.2g} mm on 1000 N/m, {:.2g} mm on 5000 N/m; a larger one grows. That is of a flat wall; other places "
             "stand in the interval, and where the force is a sample late it falls to as little as a third of that.",
             cell.hand.coulomb, basin(1000), basin(5000)),
         "loop-basin", fmt::format("{}, a wall", loops.any->surface),
         hand_text(results.surfaces.front()) + ", no damping",
         fmt::format("{} of {} stepped loops do as foreseen{}", loops.as_foreseen(), loops.all(),
                     basins_text(results.basins))});
}

void add_rounding(std::vector<Finding>& findings, const LoopResults& results) {
    const Tally loops = tally_of(results, "rounding");
    if (loops.foreseen == 0 || loops.others == 0)
        return;
    findings.push_back(
        {"loop_rounding",
         fmt::format("With a rounded position, {} of {} loops within K <= min(2 b / T, 2 f_c / quantum) come to rest, "
                     "and {} of {} beyond.",
                     loops.kept, loops.foreseen, loops.rest, loops.others),
         "loop-rounding", fmt::format("{}, the worst place", loops.any->surface),
         fmt::format("{}, K = {}", hand_text(results.surfaces.front()), newtons(loops.any->cell.stiffness)), ""});
}

} // namespace

std::string newtons(double stiffness) {
    return stiffness >= 100 ? fmt::format("{:.0f} N/m", stiffness) : fmt::format("{:.3g} N/m", stiffness);
}

std::vector<SteppedCheck> stepped_checks(const LoopResults& results) {
    std::vector<SteppedCheck> all;
    // Of what was stepped.
    const auto add = [&](const std::string& what, const LeastLimit& there, double value = NAN) {
        if (there.simulated && there.limit && *there.limit > 0)
            all.push_back({what, there, value, *there.limit, *there.simulated});
    };
    for (const LeastLimit& one : results.limits) {
        add("limit", one);
        if (!one.any_press || !one.any_press->simulated)
            continue;
        LeastLimit turned = one;
        turned.limit = one.any_press->limit;
        turned.hold = one.any_press->hold;
        turned.place = one.any_press->place;
        turned.simulated = one.any_press->simulated;
        add("limit of any press", turned);
    }
    for (const LeastLimit& one : results.by_edges)
        add(one.place.by_vertex ? "limit at a vertex" : "limit by an edge", one);
    for (const AtlasPoint& point : results.atlas)
        add("limit over " + point.quantity, point.least, point.value);
    for (const BasinRow& row : results.basins)
        all.push_back(
            {"kick that dies out", row.there, row.there.cell.stiffness, row.foreseen, row.stepped.value_or(NAN)});
    return all;
}

std::vector<Finding> loop_findings(const LoopResults& results) {
    std::vector<Finding> findings;
    const LeastLimit* const worst = worst_of(results.limits);
    if (worst) {
        findings.push_back(about_least(results, *worst));
        add_atlas(findings, results, *worst);
    }
    add_shading(findings, results);
    add_edges(findings, results);
    add_couplings(findings, results);
    add_basin(findings, results);
    if (results.surfaces.front().stiffness > 0)
        add_rounding(findings, results);
    return findings;
}

} // namespace forceshade::study
