#include "host/study/error_time/tables.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/data/rows.h"
#include "host/study/error_time/sections.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kMostMissed = 0.01;  // of the places
constexpr double kLeastShown = 1e-7;  // deg or 1: less stands at this in figures
constexpr double kLoopSeconds = 1e-3; // of a loop of 1 kHz

struct WayRow {
    const Way& way;
    const std::optional<WayErrors>& errors;
    Interval seconds, unit_ratio;
    std::string on_front; /* name, if a front has it */
};

Cell part(const std::optional<Summary>& summary, double Summary::*number) {
    return summary ? cell((*summary).*number) : Cell();
}

template <typename Part> Cell of_errors(const WayRow& row, const Part& part_of) {
    return row.errors ? part_of(row.errors->shared) : Cell();
}

Cell shown(double error) {
    return std::isfinite(error) ? cell(std::max(error, kLeastShown)) : Cell();
}

const std::vector<ColumnOf<WayRow>>& way_columns() {
    using R = WayRow;
    static const std::vector<ColumnOf<R>> columns{
        {{"way", "", "the law, and how it is evaluated"}, [](const R& r) { return Cell(r.way.name); }},
        {{"surface", "", "what is compared with each other"}, [](const R& r) { return Cell(r.way.subject->name); }},
        {{"against", "", "what the errors are against"}, [](const R& r) { return Cell(r.way.subject->against); }},
        {{"use", "", "live: one place after the other on one thread; volume: whole grids; loop: steps with a hand"},
         [](const R& r) { return Cell(std::string(name_of(r.way.use))); }},
        {{"family", "", "how it is evaluated"}, [](const R& r) { return Cell(r.way.family); }},
        {{"precision", "", "of the arithmetic, and of what is stored"},
         [](const R& r) { return Cell(r.way.precision); }},
        {{"shading", "", "as in a scene's [force]"}, [](const R& r) { return Cell(r.way.variant->shading); }},
        {{"elements", "1", "facets of a bump, cells of a mesh along a side"},
         [](const R& r) { return cell_of(r.way.variant->elements); }},
        {{"one_element", "1", "1 / elements"},
         [](const R& r) { return r.way.variant->elements ? cell(1 / *r.way.variant->elements) : Cell(); }},
        {{"spacing_mm", "mm", "of a look-up's volume"},
         [](const R& r) { return r.way.spacing ? cell(1e3 * *r.way.spacing) : Cell(); }},
        {{"volume_bytes", "B", "of a look-up's volume"}, [](const R& r) { return cell_of(r.way.bytes); }},
        {{"time_ns", "ns", "of an evaluation, median over the rounds"},
         [](const R& r) { return cell(1e9 * r.seconds.median); }},
        {{"time_low_ns", "ns", "low end of its 95 % interval"}, [](const R& r) { return cell(1e9 * r.seconds.low); }},
        {{"time_high_ns", "ns", "high end"}, [](const R& r) { return cell(1e9 * r.seconds.high); }},
        {{"share_of_1ms", "1", "time_ns over the millisecond of a loop of 1 kHz"},
         [](const R& r) { return cell(r.seconds.median / kLoopSeconds); }},
        {{"ratio_to_unit", "1", "time over that of the unit (see the notes) in the same round, median"},
         [](const R& r) { return cell(r.unit_ratio.median); }},
        {{"ratio_low", "1", "low end of its 95 % interval"}, [](const R& r) { return cell(r.unit_ratio.low); }},
        {{"ratio_high", "1", "high end"}, [](const R& r) { return cell(r.unit_ratio.high); }},
        {{"places", "1", "that all laws of the surface share, or that a grid has there"},
         [](const R& r) { return of_errors(r, [](const ForceErrors& e) { return cell(double(e.places)); }); }},
        {{"missed", "1", "share of the places where there should be a force, and none is"},
         [](const R& r) {
             return of_errors(r, [](const ForceErrors& e) { return cell(double(e.missed) / double(e.places)); });
         }},
        {{"direction_rms_deg", "deg", "angle to the true force, root mean square"},
         [](const R& r) {
             return of_errors(r, [](const ForceErrors& e) { return part(e.direction, &Summary::rms); });
         }},
        {{"direction_max_deg", "deg", "the largest"},
         [](const R& r) {
             return of_errors(r, [](const ForceErrors& e) { return part(e.direction, &Summary::largest); });
         }},
        {{"local_median_1", "1", "error of the force over the true force there, median"},
         [](const R& r) { return of_errors(r, [](const ForceErrors& e) { return part(e.local, &Summary::median); }); }},
        {{"local_p95_1", "1", "likewise, what 95 % of the places do not exceed"},
         [](const R& r) { return of_errors(r, [](const ForceErrors& e) { return part(e.local, &Summary::p95); }); }},
        {{"typical_rms_1", "1", "error of the force over the RMS true force, root mean square"},
         [](const R& r) { return of_errors(r, [](const ForceErrors& e) { return part(e.typical, &Summary::rms); }); }},
        {{"precision_max_1", "1",
          "largest difference from the same law in double, over the RMS true force, at all places of "
          "all kinds"},
         [](const R& r) { return r.errors ? part(r.errors->precision, &Summary::largest) : Cell(); }},
        {{"shown_direction_deg", "deg", "direction_rms_deg where less than 1 % is missed, 1e-7 where it is less"},
         [](const R& r) { return r.errors ? shown(direction_error(r.errors->shared)) : Cell(); }},
        {{"shown_local_1", "1", "local_p95_1, likewise"},
         [](const R& r) { return r.errors ? shown(local_error(r.errors->shared)) : Cell(); }},
        {{"on_front", "", "its law and way, if it is on the front of live use or of volumes"},
         [](const R& r) { return r.on_front.empty() ? Cell() : Cell(r.on_front); }},
    };
    return columns;
}

struct KindRow {
    const Way& way;
    Kind kind;
    const ForceErrors& errors;
};

const std::vector<ColumnOf<KindRow>>& kind_columns() {
    using R = KindRow;
    static const std::vector<ColumnOf<R>> columns{
        {{"way", "", "as in ways"}, [](const R& r) { return Cell(r.way.name); }},
        {{"surface", "", "as in ways"}, [](const R& r) { return Cell(r.way.subject->name); }},
        {{"family", "", "as in ways"}, [](const R& r) { return Cell(r.way.family); }},
        {{"precision", "", "as in ways"}, [](const R& r) { return Cell(r.way.precision); }},
        {{"shading", "", "as in ways"}, [](const R& r) { return Cell(r.way.variant->shading); }},
        {{"elements", "1", "as in ways"}, [](const R& r) { return cell_of(r.way.variant->elements); }},
        {{"spacing_mm", "mm", "as in ways"},
         [](const R& r) { return r.way.spacing ? cell(1e3 * *r.way.spacing) : Cell(); }},
        {{"kind", "", "flat, facet, edge, rim, boundary: see the notes"},
         [](const R& r) { return Cell(std::string(name_of(r.kind))); }},
        {{"places", "1", "of this kind"}, [](const R& r) { return cell(double(r.errors.places)); }},
        {{"missed", "1", "of these: no force where one should be"},
         [](const R& r) { return cell(double(r.errors.missed)); }},
        {{"phantom", "1", "of these: a force where none should be"},
         [](const R& r) { return cell(double(r.errors.phantom)); }},
        {{"direction_rms_deg", "deg", "as in ways"},
         [](const R& r) { return part(r.errors.direction, &Summary::rms); }},
        {{"direction_max_deg", "deg", "as in ways"},
         [](const R& r) { return part(r.errors.direction, &Summary::largest); }},
        {{"local_median_1", "1", "as in ways"}, [](const R& r) { return part(r.errors.local, &Summary::median); }},
        {{"local_p95_1", "1", "as in ways"}, [](const R& r) { return part(r.errors.local, &Summary::p95); }},
        {{"typical_rms_1", "1", "as in ways"}, [](const R& r) { return part(r.errors.typical, &Summary::rms); }},
    };
    return columns;
}

// What a front is about.
struct Criterion {
    const char *name, *unit;
    double (*error)(const ForceErrors&);
};
constexpr Criterion kCriteria[] = {{"direction, RMS", "deg", direction_error},
                                   {"local force, 95 % of places", "1", local_error}};
constexpr std::array<Use, 2> kUses{Use::live, Use::volume};

std::vector<std::size_t> ways_with(const Measured& measured, const Subject& subject, Use use) {
    std::vector<std::size_t> ways;
    for (std::size_t i = 0; i < measured.ways.size(); ++i)
        if (measured.ways[i].subject == &subject && measured.ways[i].use == use && measured.errors[i])
            ways.push_back(i);
    return ways;
}

struct FrontRow {
    const Subject& subject;
    Use use;
    const Criterion& criterion;
    std::size_t way;
};

std::vector<FrontRow> fronts(const Measured& measured) {
    std::vector<FrontRow> rows;
    for (const Subject& subject : measured.subjects)
        for (const Use use : kUses)
            for (const Criterion& criterion : kCriteria) {
                const std::vector<std::size_t> ways = ways_with(measured, subject, use);
                std::vector<double> errors;
                for (const std::size_t way : ways)
                    errors.push_back(std::max(criterion.error(measured.errors[way]->shared), kLeastShown));
                for (const std::size_t way : front_of(measured.times, ways, errors))
                    rows.push_back({subject, use, criterion, way});
            }
    return rows;
}

Table front_table(const Measured& measured, const std::vector<FrontRow>& rows) {
    using R = FrontRow;
    const auto time = [&](double Interval::*end) {
        return [&measured, end](const R& r) { return cell(1e9 * measured.times.seconds(r.way).*end); };
    };
    const std::vector<ColumnOf<R>> columns{
        {{"surface", "", "as in ways"}, [](const R& r) { return Cell(r.subject.name); }},
        {{"use", "", "as in ways: fronts of live use and of volumes are apart"},
         [](const R& r) { return Cell(std::string(name_of(r.use))); }},
        {{"criterion", "", "the error"}, [](const R& r) { return Cell(std::string(r.criterion.name)); }},
        {{"way", "", "as in ways"}, [&](const R& r) { return Cell(measured.ways[r.way].name); }},
        {{"time_ns", "ns", "as in ways"}, time(&Interval::median)},
        {{"time_low_ns", "ns", "as in ways"}, time(&Interval::low)},
        {{"time_high_ns", "ns", "as in ways"}, time(&Interval::high)},
        {{"error", "deg or 1", "the criterion's, 1e-7 where it is less"},
         [&](const R& r) { return shown(r.criterion.error(measured.errors[r.way]->shared)); }},
    };
    return table_of<R>("front",
                       "The fronts: each way is cheaper, for sure, than all that are closer (paired rounds, 95 % "
                       "bootstrap interval of the ratio below 1)",
                       columns, rows);
}

constexpr Bound kBounds[] = {{"direction, RMS", "deg", 1, direction_error},
                             {"direction, RMS", "deg", 0.1, direction_error},
                             {"local force, 95 % of places", "1", 0.1, local_error},
                             {"local force, 95 % of places", "1", 0.01, local_error}};

struct CheapestRow {
    const Subject& subject;
    Use use;
    const Bound& bound;
    std::vector<std::size_t> candidates;
    std::optional<Cheapest> cheapest;
};

Table cheapest_table(const Measured& measured) {
    std::vector<CheapestRow> rows;
    for (const Subject& subject : measured.subjects) {
        if (subject.against != kSmoothShape)
            continue;
        for (const Use use : kUses)
            for (const Bound& bound : kBounds) {
                CheapestRow row{subject, use, bound, ways_with(measured, subject, use), {}};
                std::erase_if(row.candidates, [&](std::size_t way) {
                    return !(bound.error(measured.errors[way]->shared) <= bound.most);
                });
                if (!row.candidates.empty())
                    row.cheapest = cheapest_of(measured.times, row.candidates);
                rows.push_back(std::move(row));
            }
    }
    using R = CheapestRow;
    const auto names = [&measured](const std::vector<std::size_t>& ways) {
        std::vector<std::string> all;
        for (const std::size_t way : ways)
            all.push_back(measured.ways[way].name);
        return fmt::format("{}", fmt::join(all, "; "));
    };
    const std::vector<ColumnOf<R>> columns{
        {{"surface", "", "as in ways"}, [](const R& r) { return Cell(r.subject.name); }},
        {{"use", "", "as in ways"}, [](const R& r) { return Cell(std::string(name_of(r.use))); }},
        {{"criterion", "", "what is bounded"}, [](const R& r) { return Cell(std::string(r.bound.criterion)); }},
        {{"bound", "deg or 1", "the most that it may be"}, [](const R& r) { return cell(r.bound.most); }},
        {{"candidates", "1", "ways that keep to it"}, [](const R& r) { return cell(double(r.candidates.size())); }},
        {{"way", "", "of the least median time among them; nothing if there is none"},
         [&](const R& r) { return r.cheapest ? Cell(measured.ways[r.cheapest->way].name) : Cell(); }},
        {{"time_ns", "ns", "its time"},
         [&](const R& r) { return r.cheapest ? cell(1e9 * measured.times.seconds(r.cheapest->way).median) : Cell(); }},
        {{"error", "deg or 1", "what it has of the criterion"},
         [&](const R& r) {
             return r.cheapest ? cell(r.bound.error(measured.errors[r.cheapest->way]->shared)) : Cell();
         }},
        {{"ties", "1", "others whose paired ratio to it does not exclude 1"},
         [](const R& r) { return r.cheapest ? cell(double(r.cheapest->ties.size())) : Cell(); }},
        {{"tied_with", "", "their names"},
         [&](const R& r) { return r.cheapest && !r.cheapest->ties.empty() ? Cell(names(r.cheapest->ties)) : Cell(); }},
    };
    return table_of<R>("cheapest", "The cheapest way within a bound, and those that the rounds do not tell from it",
                       columns, rows);
}

struct RoundRow {
    std::size_t round, way;
    double seconds;
};

Table rounds_table(const Measured& measured) {
    std::vector<RoundRow> rows;
    for (std::size_t round = 0; round < measured.times.rounds().size(); ++round)
        for (std::size_t way = 0; way < measured.ways.size(); ++way)
            rows.push_back({round, way, measured.times.rounds()[round][way]});
    using R = RoundRow;
    return table_of<R>("rounds", "Every time that was taken",
                       {{{"round", "1", "each measures every way once, in an order of its own"},
                         [](const R& r) { return cell(double(r.round)); }},
                        {{"way", "1", "its row in ways, from 1"}, [](const R& r) { return cell(double(r.way + 1)); }},
                        {{"time_ns", "ns", "of an evaluation"}, [](const R& r) { return cell(1e9 * r.seconds); }}},
                       rows);
}

// What time there is: an evaluation a period of a loop, or a voxel of a sweep.
struct BudgetRow {
    const char* name;
    double seconds, error;
};
constexpr std::pair<const char*, double> kBudgets[] = {
    {"loop of 4 kHz", 0.25e-3}, {"loop of 1 kHz", 1e-3}, {"1e9 voxels in 10 min", 600e-9}};

Table budgets_table(const Measured& measured) {
    double least = 1, most = kLeastShown;
    for (const auto& errors : measured.errors)
        if (const double error = errors ? local_error(errors->shared) : NAN; std::isfinite(error)) {
            least = std::min(least, std::max(error, kLeastShown));
            most = std::max(most, error);
        }
    std::vector<BudgetRow> rows;
    for (const auto& [name, seconds] : kBudgets) {
        rows.push_back({name, seconds, least});
        rows.push_back({name, seconds, most});
    }
    using R = BudgetRow;
    return table_of<R>("budgets", "Lines of figures: the time there is for an evaluation",
                       {{{"budget", "", "of what"}, [](const R& r) { return Cell(std::string(r.name)); }},
                        {{"time_ns", "ns", "for an evaluation"}, [](const R& r) { return cell(1e9 * r.seconds); }},
                        {{"error", "1", "where the line begins and ends"}, [](const R& r) { return cell(r.error); }}},
                       rows);
}

Figure error_over_time(const Subject& subject, bool own) {
    Figure figure;
    figure.name = "error-time-" + subject.name;
    figure.title = fmt::format("{}: error of the force against the time of an evaluation",
                               own ? subject.name == "bump" ? "Bump" : "Mesh" : "Scene");
    figure.caption = fmt::format(
        "Each mark is a way of coming by a force, where a hand touches; left is cheaper, down is closer to {}. The "
        "error is what 95 % of the places do not exceed, over the force there. Whiskers are 95 % intervals of paired "
        "rounds. The lines join the ways that are cheaper, for sure, than all closer ones. Ways that miss the force at "
        "more than 1 % of the places are left out.",
        subject.against);
    figure.table = "ways";
    figure.where = {{"surface", subject.name}};
    figure.x = {"time_ns", "time of an evaluation / ns", true};
    figure.y = {"shown_local_1", "error over the force there, 95 % of places", true};
    figure.series = "family";
    figure.label = "on_front";
    figure.x_low = "time_low_ns";
    figure.x_high = "time_high_ns";
    for (const Use use : kUses)
        figure.curves.push_back({"front",
                                 {{"surface", subject.name}, {"use", name_of(use)}, {"criterion", kCriteria[1].name}},
                                 "time_ns",
                                 "error",
                                 fmt::format("front, {}", name_of(use)),
                                 use == Use::volume});
    for (const auto& [name, seconds] : kBudgets)
        figure.curves.push_back({"budgets", {{"budget", name}}, "time_ns", "error", name, true});
    return figure;
}

// Errors of look-ups over the volume's spacing, kind by kind, of the law that has them.
Figure lookup_figure(const Measured& measured, const Variant& variant) {
    Figure figure;
    figure.name = "look-up-" + measured.subjects.front().name;
    figure.title = fmt::format("{}, {}: error of a trilinear look-up by what is touched",
                               measured.subjects.front().name, variant.name);
    figure.caption =
        "What 95 % of the places of a kind do not exceed, over the force there. A finer volume helps least "
        "where contact begins and where facets or surfaces meet.";
    figure.table = "kinds";
    figure.where = {{"surface", measured.subjects.front().name},
                    {"family", "look-up, trilinear"},
                    {"precision", "f32"},
                    {"shading", variant.shading}};
    figure.x = {"spacing_mm", "spacing of the volume / mm", true};
    figure.y = {"local_p95_1", "error over the force there, 95 % of places", true};
    figure.series = "kind";
    figure.joined = true;
    return figure;
}

Figure convergence(const Subject& subject, const std::string& family) {
    Figure figure;
    figure.name = "elements-" + subject.name;
    figure.title = fmt::format("{}: error of the direction over the number of {}", subject.name, subject.elements);
    figure.caption = "In double precision, at the places that all laws share. Marks below 1e-7 deg stand at that.";
    figure.table = "ways";
    figure.where = {{"surface", subject.name}, {"family", family}, {"precision", "f64"}};
    figure.x = {"elements", subject.elements == "facets" ? "facets" : "cells along a side", true};
    figure.y = {"shown_direction_deg", "RMS error of the direction / deg", true};
    figure.series = "shading";
    figure.joined = true;
    return figure;
}

} // namespace

double direction_error(const ForceErrors& errors) {
    const bool whole = double(errors.missed) <= kMostMissed * double(errors.places);
    return whole && errors.direction ? errors.direction->rms : NAN;
}

double local_error(const ForceErrors& errors) {
    const bool whole = double(errors.missed) <= kMostMissed * double(errors.places);
    return whole && errors.local ? errors.local->p95 : NAN;
}

std::vector<Table> tables_of(const Measured& measured) {
    const std::vector<FrontRow> front = fronts(measured);
    std::set<std::size_t> on_front;
    std::vector<const Way*> front_ways;
    for (const FrontRow& row : front)
        if (row.criterion.error == local_error && on_front.insert(row.way).second)
            front_ways.push_back(&measured.ways[row.way]);
    std::vector<WayRow> ways;
    std::vector<KindRow> kinds;
    for (std::size_t i = 0; i < measured.ways.size(); ++i) {
        const Way& way = measured.ways[i];
        ways.push_back({way, measured.errors[i], measured.times.seconds(i),
                        measured.times.ratio(i, measured.times.unit()),
                        on_front.contains(i) ? way.name.substr(way.subject->name.size() + 2) : ""});
        for (const Kind kind : kKinds)
            if (measured.errors[i])
                if (const auto& errors = measured.errors[i]->by_kind[static_cast<std::size_t>(kind)])
                    kinds.push_back({way, kind, *errors});
    }
    std::vector<Table> tables = section_tables(front_ways);
    return {table_of<WayRow>("ways", "Every way of coming by a force: error and time", way_columns(), ways),
            table_of<KindRow>("kinds", "Errors by what is touched", kind_columns(), kinds),
            front_table(measured, front),
            cheapest_table(measured),
            budgets_table(measured),
            std::move(tables[0]),
            std::move(tables[1]),
            rounds_table(measured)};
}

std::vector<Figure> figures_of(const Measured& measured, bool own) {
    std::vector<Figure> figures, sections;
    for (const Subject& subject : measured.subjects) {
        Figure figure = error_over_time(subject, own);
        std::vector<std::size_t> live;
        for (const FrontRow& row : fronts(measured))
            if (&row.subject == &subject && row.use == Use::live && row.criterion.error == local_error)
                live.push_back(row.way);
        if (!live.empty()) {
            figure.pick = "way";
            for (Figure& one : section_figures(subject, measured.ways[live[live.size() / 2]])) {
                figure.linked.push_back(one.name);
                sections.push_back(std::move(one));
            }
        }
        figures.push_back(std::move(figure));
    }
    for (const Variant& variant : measured.subjects.front().variants)
        if (variant.lookups && variant.shading != "none") {
            figures.push_back(lookup_figure(measured, variant));
            break;
        }
    if (const Subject& last = measured.subjects.back(); !last.elements.empty())
        figures.push_back(convergence(last, last.variants.front().prepared->images.mesh ? "god-object" : "direct"));
    std::ranges::move(sections, std::back_inserter(figures));
    return figures;
}

} // namespace forceshade::study::error_time
