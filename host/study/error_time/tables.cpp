// All measurements as tables and figures.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kLeastShown = 1e-7; // deg or 1: smaller errors are drawn here

// A method, and its errors over all places that laws share or over those of a kind.
struct ErrorRow {
    const Method& method;
    const ForceErrors* errors;
    Interval seconds{}, unit_ratio{};
    std::string on_front{}; /* name, if a front has it */
    Kind kind{};
    bool busy = false; /* the machine */
};
using ErrorColumns = std::vector<ColumnOf<ErrorRow>>;

// A number of the errors; empty without errors.
template <typename Number> auto of_errors(Number number) {
    return [number](const ErrorRow& row) { return row.errors ? Cell(std::invoke(number, *row.errors)) : Cell(); };
}
auto of_errors(Summary ForceErrors::*summary, double Summary::*number) {
    return of_errors([=](const ForceErrors& e) { return e.*summary.*number; });
}

// Keeps NaN.
double shown(double error) {
    return error < kLeastShown ? kLeastShown : error;
}

// Of the RMS error over the draws.
auto of_draws(Summary ForceErrors::*summary, double Interval::*end) {
    return [=](const ErrorRow& r) {
        const auto spread = r.method.errors ? rms_over_draws(*r.method.errors, summary) : std::nullopt;
        return spread ? Cell(*spread.*end) : Cell();
    };
}

const ErrorColumns& method_columns() {
    using R = ErrorRow;
    static const ErrorColumns columns{
        {"way", "", "method: the law, and its evaluation", [](const R& r) { return r.method.name; }},
        {"surface", "", "the subject of comparison", [](const R& r) { return r.method.subject->name; }},
        {"against", "", "the reference of the errors", [](const R& r) { return r.method.subject->against; }},
        {"use", "",
         "live: one place after the other on one thread; batch: 65536 places at once; volume: whole grids; loop: steps "
         "with a hand",
         [](const R& r) { return name_of(r.method.use); }},
        {"family", "",
         "kind of evaluation; every block: of a mesh, blocks of free space are visited, too; control: the unit of the "
         "notes once more",
         [](const R& r) { return r.method.family; }},
        {"method", "", "the family's kind",
         [](const R& r) { return r.method.family.substr(0, r.method.family.find(',')); }},
        {"precision", "", "of the arithmetic, and of the stored forces", [](const R& r) { return r.method.precision; }},
        {"shading", "", "as in a scene's [force]", [](const R& r) { return r.method.variant->shading; }},
        {"elements", "1", "facets of a bump, cells of a mesh along a side",
         [](const R& r) { return r.method.variant->elements; }},
        {"spacing_mm", "mm", "of a look-up's volume", [](const R& r) { return 1e3 * r.method.spacing.value_or(NAN); }},
        {"volume_bytes", "B", "of a look-up's volume",
         [](const R& r) { return r.method.built ? Cell(r.method.built().bytes) : Cell(); }},
        {"time_ns", "ns", "of an evaluation, median over the rounds",
         [](const R& r) { return 1e9 * r.seconds.median; }},
        {"time_low_ns", "ns", "low end of its 95 % interval", [](const R& r) { return 1e9 * r.seconds.low; }},
        {"time_high_ns", "ns", "high end", [](const R& r) { return 1e9 * r.seconds.high; }},
        {"ratio_to_unit", "1",
         "time over that of the unit (see the notes) in the same round, median; empty: the interval holds 1, or busy",
         [](const R& r) { return is_significant(r.unit_ratio) && !r.busy ? Cell(r.unit_ratio.median) : Cell(); }},
        {"ratio_low", "1", "low end of its 95 % interval", [](const R& r) { return r.unit_ratio.low; }},
        {"ratio_high", "1", "high end", [](const R& r) { return r.unit_ratio.high; }},
        {"busy", "", "yes: the controls say that the machine was too busy for times to be compared",
         [](const R& r) { return r.busy ? "yes" : "no"; }},
        {"places", "1", "that all laws of the surface share, or that a grid has there",
         of_errors(&ForceErrors::places)},
        {"one_sided", "1", "share of the places where only one of the two has a force, this method or the reference",
         of_errors(&ForceErrors::one_sided_share)},
        {"direction_rms_deg", "deg",
         "angle to the true force, root mean square; this and all errors: median over draws",
         of_errors(&ForceErrors::direction, &Summary::rms)},
        {"direction_max_deg", "deg", "the largest", of_errors(&ForceErrors::direction, &Summary::largest)},
        {"size_median_1", "1", "error of the force's size alone over the true force there, where both have one, median",
         of_errors(&ForceErrors::size, &Summary::median)},
        {"size_p95_1", "1", "the same, 95th percentile", of_errors(&ForceErrors::size, &Summary::p95)},
        {"local_p95_1", "1",
         "error of the force, size and direction, over the true force there, 95th percentile; a missing force errs by "
         "1",
         of_errors(&ForceErrors::local, &Summary::p95)},
        {"typical_rms_1", "1", "error of the force over the RMS true force, root mean square",
         of_errors(&ForceErrors::typical, &Summary::rms)},
        {"direction_low_deg", "deg", "direction_rms_deg, the least over draws of places, grid and mesh (table draws)",
         of_draws(&ForceErrors::direction, &Interval::low)},
        {"direction_high_deg", "deg", "the largest", of_draws(&ForceErrors::direction, &Interval::high)},
        {"typical_low_1", "1", "typical_rms_1, the least over draws", of_draws(&ForceErrors::typical, &Interval::low)},
        {"typical_high_1", "1", "the largest", of_draws(&ForceErrors::typical, &Interval::high)},
        {"precision_max_1", "1",
         "largest difference from the same law in double, over the RMS true force, at all places of all kinds",
         [](const R& r) { return r.method.errors ? Cell(r.method.errors->precision.largest) : Cell(); }},
        {"shown_local_1", "1", "local_p95_1 where less than 1 % is missed, at least 1e-7",
         of_errors([](const ForceErrors& e) { return shown(e.bounded_local()); })},
        {"on_front", "", "its law and method, if it is surely on the front of live use or of volumes",
         [](const R& r) { return r.on_front.empty() ? Cell() : Cell(r.on_front); }},
    };
    return columns;
}

ErrorColumns kind_columns() {
    using R = ErrorRow;
    ErrorColumns columns;
    const auto as_in_methods = [&](std::initializer_list<const char*> names) {
        for (const char* name : names) {
            columns.push_back(
                *std::ranges::find(method_columns(), name, [](const auto& one) { return one.column.name; }));
            columns.back().column.meaning = "as in ways";
        }
    };
    as_in_methods({"way", "surface", "family", "precision", "shading", "elements", "spacing_mm"});
    columns.insert(
        columns.end(),
        {{"kind", "", "flat, facet, edge, rim, boundary: see the notes", [](const R& r) { return name_of(r.kind); }},
         {"places", "1", "of this kind", of_errors(&ForceErrors::places)},
         {"missed", "1", "of these: no force, but there should be one", of_errors(&ForceErrors::missed)},
         {"phantom", "1", "of these: a force, but there should be none", of_errors(&ForceErrors::phantom)}});
    as_in_methods({"direction_rms_deg", "direction_max_deg", "local_p95_1", "typical_rms_1"});
    const auto local_over_draws = [](double Interval::*end) {
        return [end](const R& r) {
            const auto local =
                over_draws(*r.method.errors, [&](const MethodErrors& one) { return one.of(r.kind).local.p95; });
            return local ? Cell(*local.*end) : Cell();
        };
    };
    columns.push_back({"local_low_1", "1", "local_p95_1, the least over draws", local_over_draws(&Interval::low)});
    columns.push_back({"local_high_1", "1", "the largest", local_over_draws(&Interval::high)});
    return columns;
}

// The error of a front.
struct Criterion {
    const char* name;
    double (ForceErrors::*error)() const;
};
constexpr Criterion kDirection{"direction, RMS", &ForceErrors::bounded_direction},
    kLocal{"local force, 95 % of places", &ForceErrors::bounded_local};
constexpr Use kUses[] = {Use::live, Use::volume};
constexpr double kOnFront = 0.8; // 1: of front_shares; with less a method may not be on another run's front

std::vector<std::size_t> methods_with(const Measured& measured, const Subject& subject, Use use) {
    return measured.find([&](const Method& method) { return method.subject == &subject && method.use == use; });
}

struct FrontRow {
    const Subject& subject;
    Use use;
    const Criterion& criterion;
    std::size_t method;
    double error;
    double stays; /* 1: share of front_shares */
};

// By rising error.
std::vector<FrontRow> fronts(const Measured& measured) {
    std::vector<FrontRow> rows;
    for (const Subject& subject : measured.subjects)
        for (const Use use : kUses)
            for (const Criterion* criterion : {&kDirection, &kLocal}) {
                const auto error_of = [&](const MethodErrors& errors) {
                    return shown((errors.shared.*criterion->error)());
                };
                const auto median_error = [&](std::size_t method) {
                    return error_of(*measured.methods[method].errors);
                };
                std::vector<std::size_t> methods = methods_with(measured, subject, use);
                std::erase_if(methods, [&](std::size_t method) { return !std::isfinite(median_error(method)); });
                std::ranges::stable_sort(methods, {}, median_error);
                std::vector<std::vector<double>> by_draw;
                for (const std::size_t method : methods) {
                    std::vector<double>& draws = by_draw.emplace_back();
                    for (const MethodErrors& one : measured.methods[method].errors->by_draw)
                        draws.push_back(error_of(one));
                    if (draws.empty())
                        draws.push_back(median_error(method));
                }
                const std::vector<double> shares = front_shares(measured.times, methods, by_draw);
                for (std::size_t i = 0; i < methods.size(); ++i)
                    if (shares[i] >= kOnFront)
                        rows.push_back({subject, use, *criterion, methods[i], median_error(methods[i]), shares[i]});
            }
    return rows;
}

Table front_table(const Measured& measured, const std::vector<FrontRow>& rows) {
    using R = FrontRow;
    const auto time = [&](double Interval::*end) {
        return [&measured, end](const R& r) { return 1e9 * measured.times.seconds(r.method).*end; };
    };
    return table_of<R>("front",
                       "The fronts: no method is both as fast and as close and better in one of them, in 80 % of "
                       "random samples or more",
                       {{"surface", "", "as in ways", [](const R& r) { return r.subject.name; }},
                        {"use", "", "as in ways: fronts of live use and of volumes are separate",
                         [](const R& r) { return name_of(r.use); }},
                        {"criterion", "", "the error", [](const R& r) { return r.criterion.name; }},
                        {"way", "", "as in ways", [&](const R& r) { return measured.methods[r.method].name; }},
                        {"time_ns", "ns", "as in ways", time(&Interval::median)},
                        {"time_low_ns", "ns", "as in ways", time(&Interval::low)},
                        {"time_high_ns", "ns", "as in ways", time(&Interval::high)},
                        {"error", "deg or 1", "the criterion's, at least 1e-7", &R::error},
                        {"stays", "1",
                         "share of 200 random samples, of rounds, draws and a tenth by which reruns differ, in which "
                         "none is as good in both and better in one by 5 %",
                         &R::stays}},
                       rows);
}

// A bound, and the methods within it.
struct CheapestRow {
    const Subject& subject;
    Use use;
    const char* criterion;
    double bound;
    std::size_t candidates;
    Cell method{}, time{}, error{}, ties{}, tied_with{};
};

Table cheapest_table(const Measured& measured) {
    using R = CheapestRow;
    std::vector<R> rows;
    for (const Subject& subject : measured.subjects)
        for (const Use use : kUses)
            for (const auto& within :
                 {std::pair(&kDirection, 1.0), {&kDirection, 0.1}, {&kLocal, 0.1}, {&kLocal, 0.01}}) {
                const Criterion* const criterion = within.first;
                const double bound = within.second;
                if (subject.against != kSmoothShape)
                    continue;
                const auto error_of = [&](std::size_t method) {
                    return (measured.methods[method].errors->shared.*criterion->error)();
                };
                std::vector<std::size_t> methods = methods_with(measured, subject, use);
                std::erase_if(methods, [&](std::size_t method) { return !(error_of(method) <= bound); });
                R& row = rows.emplace_back(R{subject, use, criterion->name, bound, methods.size()});
                if (methods.empty())
                    continue;
                const auto [cheapest, ties] = cheapest_of(measured.times, methods);
                std::vector<std::string> names;
                names.reserve(ties.size());
                for (const std::size_t method : ties)
                    names.push_back(measured.methods[method].name);
                row.method = measured.methods[cheapest].name;
                row.time = 1e9 * measured.times.seconds(cheapest).median;
                row.error = error_of(cheapest);
                row.ties = ties.size();
                if (!names.empty())
                    row.tied_with = fmt::format("{}", fmt::join(names, "; "));
            }
    return table_of<R>("cheapest", "The cheapest method within a bound, and those not significantly slower",
                       {{"surface", "", "as in ways", [](const R& r) { return r.subject.name; }},
                        {"use", "", "as in ways", [](const R& r) { return name_of(r.use); }},
                        {"criterion", "", "the bounded error", &R::criterion},
                        {"bound", "deg or 1", "its largest allowed value", &R::bound},
                        {"candidates", "1", "methods within it", &R::candidates},
                        {"way", "", "the one of the least median time; empty: none", &R::method},
                        {"time_ns", "ns", "its time", &R::time},
                        {"error", "deg or 1", "its error by the criterion", &R::error},
                        {"ties", "1", "other methods whose paired ratio to it does not exclude 1", &R::ties},
                        {"tied_with", "", "their names", &R::tied_with}},
                       rows);
}

Table rounds_table(const Measured& measured) {
    struct R {
        std::size_t round, method;
        double time;
    };
    std::vector<R> rows;
    for (std::size_t round = 0; round < measured.times.rounds().size(); ++round)
        for (std::size_t method = 0; method < measured.methods.size(); ++method)
            rows.push_back({round, method + 1, 1e9 * measured.times.rounds()[round][method]});
    return table_of<R>("rounds", "All measured times",
                       {{"round", "1", "each measures every method once, in an order of its own", &R::round},
                        {"way", "1", "its row in ways, from 1", &R::method},
                        {"time_ns", "ns", "of an evaluation", &R::time}},
                       rows);
}

Table draws_table(const Measured& measured) {
    struct R {
        const Method& method;
        std::size_t draw;
        const MethodErrors& errors;
    };
    std::vector<R> rows;
    for (const Method& method : measured.methods)
        for (std::size_t draw = 0; method.errors && draw < method.errors->by_draw.size(); ++draw)
            rows.push_back({method, draw + 1, method.errors->by_draw[draw]});
    return table_of<R>(
        "draws",
        "Errors at random places, of volumes and fields also at random offsets and orientations, of meshes also "
        "tessellated at random",
        {{"way", "", "as in ways", [](const R& r) { return r.method.name; }},
         {"spacing_mm", "mm", "as in ways", [](const R& r) { return 1e3 * r.method.spacing.value_or(NAN); }},
         {"draw", "1", "its number; from the second on a volume is shifted and turned", &R::draw},
         {"typical_rms_1", "1", "as in ways", [](const R& r) { return r.errors.shared.typical.rms; }},
         {"direction_rms_deg", "deg", "as in ways", [](const R& r) { return r.errors.shared.direction.rms; }},
         {"rim_direction_rms_deg", "deg", "angle to the true force at the rim, root mean square",
          [](const R& r) { return r.errors.of(Kind::rim).direction.rms; }},
         {"boundary_p95_1", "1", "error of the force over the true force near the surface, 95th percentile",
          [](const R& r) { return r.errors.of(Kind::boundary).local.p95; }},
         {"phantom_1", "1", "share of the places just above the surface that have a force",
          [](const R& r) { return r.errors.of(Kind::boundary).phantom_share(); }},
         {"phantom_max_1", "1", "the largest of these forces over the RMS true force",
          [](const R& r) { return r.errors.of(Kind::boundary).phantom_largest; }}},
        rows);
}

// Which volume to take: what each holds, costs and errs by.
Table volumes_table(const Measured& measured) {
    struct R {
        const Method& method;
        const MethodErrors& errors;
        Interval seconds;
        Built built;
    };
    std::vector<R> rows;
    for (std::size_t i = 0; i < measured.methods.size(); ++i)
        if (const Method& method = measured.methods[i]; method.built && method.errors)
            rows.push_back({method, *method.errors, measured.times.seconds(i), method.built()});
    return table_of<R>(
        "volumes", "Look-up volumes: memory, time to build and load, errors",
        {{"way", "", "as in ways", [](const R& r) { return r.method.name; }},
         {"family", "",
          "trilinear, tricubic: forces at all samples; depth and direction: signed depth; narrow band: bricks of 8 "
          "cells a side in which a force acts that is at most twice that where a hand is deepest; adaptive: an octree "
          "of as many bytes as a volume of this spacing, finer where reading between samples is furthest off",
          [](const R& r) { return r.method.family; }},
         {"spacing_mm", "mm", "of the samples; adaptive: of a volume of forces of as many bytes",
          [](const R& r) { return 1e3 * *r.method.spacing; }},
         {"bytes", "B", "in memory", [](const R& r) { return r.built.bytes; }},
         {"build_s", "s", "evaluated on all cores and put in order", [](const R& r) { return r.built.seconds; }},
         {"load_s", "s", "as many bytes read from a file that the system has in memory",
          [](const R& r) { return r.built.loading; }},
         {"time_ns", "ns", "of an evaluation, as in ways", [](const R& r) { return 1e9 * r.seconds.median; }},
         {"typical_rms_1", "1", "as in ways", [](const R& r) { return r.errors.shared.typical.rms; }},
         {"missed_1", "1", "share of the places that should have a force and have none",
          [](const R& r) { return r.errors.shared.missed_share(); }},
         {"rim_direction_rms_deg", "deg", "angle to the true force at the rim, root mean square",
          [](const R& r) { return r.errors.of(Kind::rim).direction.rms; }},
         {"phantom_1", "1", "share of the places just above the surface that have a force",
          [](const R& r) { return r.errors.of(Kind::boundary).phantom_share(); }},
         {"phantom_max_1", "1", "the largest of these forces over the RMS true force",
          [](const R& r) { return r.errors.of(Kind::boundary).phantom_largest; }}},
        rows);
}

Figure error_over_time(const Subject& subject, bool own) {
    Figure figure = make_figure(
        "error-time-" + subject.name,
        fmt::format("{}: error of the force against the time of an evaluation",
                    own ? subject.name == "bump" ? "Bump" : "Mesh" : "Scene"),
        fmt::format(
            "Each mark is a way of computing a force where a hand touches: its colour is the shading, its shape the "
            "method. Left is cheaper, down is closer to {}. The error is the 95th percentile over the places, over the "
            "force there. Whiskers are 95 % intervals of paired rounds. The lines join the methods that no other beats "
            "in both, in 80 % of repetitions or more; names stand where there is room. Methods that miss the force at "
            "more than 1 % of the places are left out. A loop of 4 kHz has 250 000 ns for a force, one of 1 kHz "
            "1 000 000; 1e9 voxels in 10 min are 600 ns each.",
            subject.against),
        FigureKind::scatter, "ways", {{"surface", subject.name}}, {"time_ns", "time of an evaluation / ns", true},
        {"shown_local_1", "error over the force there, 95 % of places", true}, "shading", "on_front",
        {.shape = "method", .x_low = "time_low_ns", .x_high = "time_high_ns"});
    for (const Use use : kUses) {
        const Where front{{"surface", subject.name}, {"use", name_of(use)}, {"criterion", kLocal.name}};
        figure.curves.push_back(
            {"front", front, "time_ns", "error", fmt::format("front, {}", name_of(use)), use == Use::volume});
    }
    return figure;
}

// Errors of look-ups over the volume's spacing, kind by kind, of the law that has them.
Figure lookup_figure(const Subject& subject, const Variant& variant) {
    return make_figure(
        "look-up-" + subject.name,
        fmt::format("{}, {}: error of a trilinear look-up by kind of place", subject.name, variant.name),
        "95th percentile over the places of a kind, over the force there: the median, the least and the largest of "
        "random draws of places and of the volume's grid. A finer volume helps least where contact begins and where "
        "facets or surfaces meet.",
        FigureKind::scatter, "kinds",
        {{"surface", subject.name},
         {"family", "look-up, trilinear"},
         {"precision", "f32"},
         {"shading", variant.shading}},
        {"spacing_mm", "spacing of the volume / mm", true},
        {"local_p95_1", "error over the force there, 95 % of places", true}, "kind", "",
        {.low = "local_low_1", .high = "local_high_1", .joined = true});
}

Figure convergence(const Subject& subject, const std::string& family) {
    return make_figure(
        "elements-" + subject.name,
        fmt::format("{}: error of the direction over the number of {}", subject.name, subject.elements),
        "In double precision, where the surface gives a force: coarse ones miss places, as in the table.",
        FigureKind::scatter, "ways", {{"surface", subject.name}, {"family", family}, {"precision", "f64"}},
        {"elements", subject.elements == "facets" ? "facets" : "cells along a side", true},
        {"direction_rms_deg", "RMS error of the direction / deg", true}, "shading", "", {.joined = true});
}

} // namespace

std::vector<Table> tables_of(const Measured& measured) {
    const std::vector<FrontRow> front = fronts(measured);
    std::set<std::size_t> on_front;
    std::vector<const Method*> front_methods;
    for (const FrontRow& row : front)
        if (&row.criterion == &kLocal && on_front.insert(row.method).second)
            front_methods.push_back(&measured.methods[row.method]);
    std::vector<ErrorRow> methods, kinds;
    for (std::size_t i = 0; i < measured.methods.size(); ++i) {
        const Method& method = measured.methods[i];
        methods.push_back({method, method.errors ? &method.errors->shared : nullptr, measured.times.seconds(i),
                           measured.times.ratio(i, measured.times.unit()),
                           on_front.contains(i) ? method.name.substr(method.subject->name.size() + 2) : "", Kind{},
                           !measured.steady()});
        for (const Kind kind : kKinds)
            if (method.errors && method.errors->of(kind).places > 0)
                kinds.push_back({.method = method, .errors = &method.errors->of(kind), .kind = kind});
    }
    std::vector<Table> tables = section_tables(front_methods);
    return {table_of("ways", "All methods of computing a force: error and time", method_columns(), methods),
            table_of("kinds", "Errors by kind of place", kind_columns(), kinds),
            front_table(measured, front),
            cheapest_table(measured),
            volumes_table(measured),
            draws_table(measured),
            std::move(tables[0]),
            std::move(tables[1]),
            rounds_table(measured)};
}

std::vector<Figure> figures_of(const Measured& measured, bool own) {
    std::vector<Figure> figures, sections;
    const std::vector<FrontRow> front = fronts(measured);
    for (const Subject& subject : measured.subjects) {
        Figure& figure = figures.emplace_back(error_over_time(subject, own));
        std::vector<std::size_t> live;
        for (const FrontRow& row : front)
            if (&row.subject == &subject && row.use == Use::live && &row.criterion == &kLocal)
                live.push_back(row.method);
        if (live.empty())
            continue;
        figure.pick = "way";
        for (Figure& one : section_figures(subject, measured.methods[live[live.size() / 2]])) {
            figure.linked.push_back(one.name);
            sections.push_back(std::move(one));
        }
    }
    const Subject &first = measured.subjects.front(), &last = measured.subjects.back();
    if (const Variant* shaded = first.main_variant())
        figures.push_back(lookup_figure(first, *shaded));
    if (!last.elements.empty())
        figures.push_back(convergence(last, last.variants.front().prepared->images.mesh ? "god-object" : "direct"));
    append(figures, std::move(sections));
    return figures;
}

} // namespace forceshade::study::error_time
