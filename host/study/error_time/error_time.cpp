#include "host/study/error_time/error_time.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "host/study/error_time/subject.h"

namespace forceshade::study {
namespace error_time {
namespace {

using Forces = std::vector<glm::dvec3>;

Forces true_forces(const Subject& subject, std::span<const TouchPlace> at) {
    Forces forces;
    for (const TouchPlace& place : at)
        forces.push_back(subject.force(place));
    return forces;
}

MethodErrors errors_of(const Forces& forces, const Forces& exact, const KindPlaces& places, const Forces& truth,
                       double typical) {
    MethodErrors errors;
    errors.shared =
        force_errors(std::span(forces).first(places.shared), std::span(truth).first(places.shared), typical);
    for (const Kind kind : kKinds) {
        Forces some, true_ones;
        for (std::size_t i = 0; i < forces.size(); ++i)
            if (places.kinds[i] == kind) {
                some.push_back(forces[i]);
                true_ones.push_back(truth[i]);
            }
        errors.by_kind[static_cast<std::size_t>(kind)] = force_errors(some, true_ones, typical);
    }
    errors.precision = force_errors(forces, exact, typical).typical;
    return errors;
}

// Each number's median over the draws that have it, so that no single one decides; of rounding the largest.
MethodErrors over_all(std::vector<MethodErrors> all) {
    if (all.size() == 1)
        return std::move(all.front());
    MethodErrors errors;
    errors.by_draw = std::move(all);
    const auto median_of = [&](const auto& number) {
        const auto spread = over_draws(errors, number);
        return spread ? spread->median : NAN;
    };
    const auto settle = [&](ForceErrors& median, const auto& of) {
        for (const auto count :
             {&ForceErrors::places, &ForceErrors::missed, &ForceErrors::phantom, &ForceErrors::above})
            median.*count = static_cast<std::size_t>(
                std::llround(median_of([&](const MethodErrors& one) { return double(of(one).*count); })));
        median.phantom_largest = median_of([&](const MethodErrors& one) { return of(one).phantom_largest; });
        for (const auto summary :
             {&ForceErrors::direction, &ForceErrors::local, &ForceErrors::size, &ForceErrors::typical})
            for (const auto number : {&Summary::rms, &Summary::median, &Summary::p95, &Summary::largest})
                median.*summary.*number = median_of([&](const MethodErrors& one) { return of(one).*summary.*number; });
    };
    settle(errors.shared, [](const MethodErrors& one) -> const ForceErrors& { return one.shared; });
    for (const Kind kind : kKinds)
        settle(errors.by_kind[static_cast<std::size_t>(kind)],
               [&](const MethodErrors& one) -> const ForceErrors& { return one.of(kind); });
    errors.precision.largest = 0;
    for (const MethodErrors& one : errors.by_draw)
        errors.precision.largest = std::max(errors.precision.largest, one.precision.largest);
    return errors;
}

// The errors of one draw, by method.
std::map<std::string, MethodErrors> errors_by_method(std::span<const Method> methods, const KindPlaces& places,
                                                     const Subject& subject, const Variant& drawn) {
    const Forces truth = true_forces(subject, places.at);
    const double typical = rms({truth.begin(), truth.begin() + static_cast<std::ptrdiff_t>(places.shared)});
    KindOf kind_of(subject, drawn);
    std::map<std::string, Forces> in_double; // of the static law and of the god-object
    std::map<std::string, MethodErrors> all;
    for (const Method& method : methods) {
        if (!method.places) {
            const Forces forces = method.forces(places.at);
            const bool with_history = method.family == "god-object" ||
                                      (method.family.starts_with("renderer") && method.variant->prepared->images.mesh);
            const std::string law = with_history ? "god-object" : "direct";
            if (method.family == law && method.precision == "f64")
                in_double[law] = forces;
            if (!in_double.contains(law))
                in_double[law] = method.exact(places.at);
            all[method.name] = errors_of(forces, in_double[law], places, truth, typical);
            continue;
        }
        KindPlaces own{method.places(), {}, 0};
        own.shared = own.at.size();
        for (const TouchPlace& place : own.at)
            own.kinds.push_back(kind_of(place));
        all[method.name] =
            errors_of(method.forces(own.at), method.exact(own.at), own, true_forces(subject, own.at), typical);
    }
    return all;
}

} // namespace

void add_errors(std::vector<Method>& methods, const Subject& subject, const Variant& variant, const Extents& extents,
                const Engines& engines, KnownPlaces& known) {
    std::vector<Method> own; // that have errors
    std::ranges::copy_if(methods, std::back_inserter(own),
                         [&](const Method& method) { return method.variant == &variant && method.forces; });
    std::vector<std::map<std::string, MethodErrors>> draws(extents.draws);
    if (known.subject != &subject)
        known = {&subject, variant.elements, std::vector<std::optional<SharedPlaces>>(extents.draws), {}};
    if (known.elements != variant.elements || known.of_law.empty())
        known.of_law = std::vector<std::optional<KindPlaces>>(extents.draws);
    known.elements = variant.elements;
    const auto take = [&](std::size_t draw) { // a thread has a draw to itself
        const Variant& drawn = variant.at(draw);
        if (!known.shared[draw])
            known.shared[draw].emplace(shared_places(subject, extents, draw));
        if (!known.of_law[draw])
            known.of_law[draw] = places_of(subject, drawn, *known.shared[draw], extents, draw);
        std::vector<Method> moved;
        if (draw > 0) {
            add_methods(moved, subject, variant, draw, engines);
            std::erase_if(moved, [&](const Method& method) {
                return std::ranges::find(own, method.name, &Method::name) == own.end();
            });
        }
        draws[draw] = errors_by_method(draw > 0 ? moved : own, *known.of_law[draw], subject, drawn);
    };
    const std::size_t alone = variant.thorough ? 1 : 0; // it measures how long volumes take to make
    if (alone)
        take(0);
    on_all_cores(draws.size() - alone, [&](std::size_t i) { take(i + alone); });
    for (Method& method : methods)
        if (method.variant == &variant && method.forces) {
            std::vector<MethodErrors> all;
            for (auto& draw : draws)
                if (const auto found = draw.find(method.name); found != draw.end())
                    all.push_back(std::move(found->second));
            method.errors = over_all(std::move(all));
        }
}

std::vector<std::size_t> shuffled(std::size_t count, std::size_t number) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t(0));
    Random draw(1000 + number);
    for (std::size_t i = count; i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(draw(0, static_cast<double>(i)))]);
    return order;
}

Round measure_round(std::span<const Method> methods, std::size_t number) {
    Round round(methods.size());
    for (const std::size_t i : shuffled(methods.size(), number))
        round[i] = methods[i].seconds();
    return round;
}

Interval Times::ratio(std::size_t method, std::size_t other) const {
    const auto [known, is_new] = ratios_.try_emplace({method, other});
    if (is_new) {
        std::vector<double> ratios;
        for (const Round& round : rounds_)
            ratios.push_back(round[method] / round[other]);
        known->second = bootstrap_median(ratios);
    }
    return known->second;
}

Interval Times::seconds(std::size_t method) const {
    std::vector<double> units;
    for (const Round& round : rounds_)
        units.push_back(round[unit_]);
    const double unit = quantile(units, 0.5);
    const Interval of_unit = ratio(method, unit_);
    return {of_unit.low * unit, of_unit.median * unit, of_unit.high * unit};
}

std::vector<double> front_shares(const Times& times, const std::vector<std::size_t>& methods,
                                 const std::vector<std::vector<double>>& errors) {
    constexpr int kSamples = 200;
    constexpr double kBetter = 1.05; // times, in error or time
    const std::vector<Round>& rounds = times.rounds();
    Random random(8);
    const auto below = [&random](std::size_t count) {
        return static_cast<std::size_t>(random(0, static_cast<double>(count)));
    };
    std::vector<double> shares(methods.size());
    for (int sample = 0; sample < kSamples; ++sample) {
        std::vector<const Round*> some;
        for (std::size_t i = 0; i < rounds.size(); ++i)
            some.push_back(&rounds[below(rounds.size())]);
        const std::size_t draw = below(1 << 20);
        struct Found {
            double error, time;
            std::size_t at; /* in `methods` */
        };
        std::vector<Found> found;
        for (std::size_t i = 0; i < methods.size(); ++i)
            if (const double error = errors[i][draw % errors[i].size()]; std::isfinite(error)) {
                std::vector<double> ratios;
                ratios.reserve(some.size());
                for (const Round* round : some)
                    ratios.push_back((*round)[methods[i]] / (*round)[times.unit()]);
                const double rerun = std::pow(kRerun, random(-1, 1));
                found.push_back({error, rerun * quantile(std::move(ratios), 0.5), i});
            }
        for (const Found& one : found)
            shares[one.at] += std::ranges::none_of(found, [&](const Found& other) {
                return (other.error <= one.error && kBetter * other.time <= one.time) ||
                       (other.time <= one.time && kBetter * other.error <= one.error);
            });
    }
    for (double& share : shares)
        share /= kSamples;
    return shares;
}

Cheapest cheapest_of(const Times& times, const std::vector<std::size_t>& methods) {
    Cheapest cheapest;
    cheapest.method =
        *std::ranges::min_element(methods, {}, [&](std::size_t method) { return times.seconds(method).median; });
    for (const std::size_t method : methods)
        if (method != cheapest.method && !times.is_cheaper(cheapest.method, method))
            cheapest.ties.push_back(method);
    return cheapest;
}

} // namespace error_time

using namespace error_time;
namespace {

// The unit of time: the first subject's thorough law, shaded, in double.
std::size_t unit_of(const std::vector<Method>& methods) {
    std::size_t unit = 0;
    for (std::size_t i = 0; i < methods.size(); ++i)
        if (methods[i].subject == methods.front().subject && methods[i].variant->thorough &&
            methods[i].family == "direct" && methods[i].precision == "f64")
            unit = i;
    return unit;
}

// The unit once more, a method like any other.
Method control_of(const Method& unit) {
    Method control = unit;
    control.name += ", again";
    control.family = "control";
    control.forces = nullptr;
    control.once = nullptr;
    return control;
}

std::vector<std::string> notes_of(const std::vector<Subject>& subjects, const Method& unit, const EngineReport& engine,
                                  unsigned cores) {
    std::vector<std::string> notes;
    for (const Subject& subject : subjects) {
        notes.insert(notes.end(), subject.notes.begin(), subject.notes.end());
        notes.push_back(fmt::format(
            "Of \"{}\", places lie under points anywhere on the surface, {:.3g} to {:.3g} mm deep along its normal, "
            "log-uniform. Kinds: rim, if the smooth shape turns by more than 5 deg within {:.3g} mm; else edge, if the "
            "facets turn by more than 0.5 deg; else boundary, if the depth is below {:.3g} mm, and as many up to as "
            "far above the surface; else flat or, where anything turns, facet.",
            subject.name, 1e3 * subject.scale.shallowest(), 1e3 * subject.scale.deepest, 1e3 * subject.scale.ring(),
            1e3 * subject.scale.skin()));
    }
    notes.push_back(fmt::format(
        "Times are of paired rounds, each in an order of its own; intervals are 95 % of 1000 bootstrap samples of the "
        "median ratio to \"{}\" in the same round. Direct evaluation, god-object and look-up are one thread, one place "
        "after the other, in processor time of that thread; a field's time is that of all voxels over their number, on "
        "{} ({} cores{}), without reading back, of a mesh with the plan of its contact regions.",
        unit.name, engine.device, cores, engine.software ? ", a software device" : ""));
    return notes;
}

// Whether a law is the user's scene's own.
bool is_scenes(const Variant& variant, const std::optional<PreparedCase>& scene) {
    return variant.thorough && scene && variant.prepared->one.scene.force.shading == scene->one.scene.force.shading;
}

} // namespace

StudyData study_error_time(StudyRun& run) {
    const Extents extents = extents_of(run.options().quick);
    const std::vector<Subject> subjects =
        run.scene() ? std::vector{scene_subject(*run.scene(), extents)} : own_subjects(extents);
    EngineOptions one_thread;
    one_thread.cpu = true;
    one_thread.threads = 1;
    const std::unique_ptr<Engine> single_thread = shared_engine(make_engine(one_thread));
    std::deque<RendererProcess> renderers;
    std::vector<Finding> failures; // of renderers
    std::vector<Method> methods;
    const Engines engines{run.engine(), *single_thread};
    KnownPlaces known;
    std::vector<Round> rounds;
    std::vector<double> crowding; // by round
    std::vector<Part> parts;
    for (const Subject& subject : subjects)
        for (const Variant& variant : subject.variants) {
            add_methods(methods, subject, variant, 0, engines);
            if (renderers.empty() && failures.empty() && is_scenes(variant, run.scene()))
                for (const RendererSource& source : run.options().renderers)
                    try {
                        renderers.emplace_back(source, *variant.prepared, 1 / kLoopRate);
                        add_renderer(methods, subject, variant, renderers.back(), source.name);
                    } catch (const RendererError& error) {
                        const std::string what = error.what();
                        failures.push_back({fmt::format("renderer_{}", failures.size() + 1),
                                            fmt::format("{}{}; it has no row.",
                                                        what.starts_with(source.name) ? "" : source.name + " ", what)});
                    }
            parts.push_back({fmt::format("errors of {}, {}", subject.name, variant.name),
                             [&] { add_errors(methods, subject, variant, extents, engines, known); }});
        }
    const std::size_t unit = unit_of(methods), control = methods.size();
    methods.push_back(control_of(methods[unit]));
    OtherTimes others;
    VisitingEngine visiting(run.engine());
    EngineOptions all_cores;
    all_cores.cpu = true;
    const std::unique_ptr<Engine> processor = make_engine(all_cores);
    const bool gpu = run.engine().report().engine == "gpu";
    const std::vector<std::string> cpu{"--engine", "cpu"};
    std::vector<std::string> own = gpu ? std::vector<std::string>{"--engine", "gpu"} : cpu;
    if (const std::string& name = run.options().engine.gpu; gpu && !name.empty())
        own.insert(own.end(), {"--gpu", name});
    std::vector<FieldEngine> by{{gpu ? "kernel" : "CPU on all cores", &run.engine(), own},
                                {gpu ? "kernel, every block" : "CPU on all cores, every block", &visiting, own, true},
                                {"CPU on one thread", single_thread.get(), {"--engine", "cpu", "--jobs", "1"}}};
    if (gpu && most_threads() > 1)
        by.push_back({"CPU on all cores", processor.get(), cpu});
    for (const Subject& subject : subjects)
        append(others.fields, field_runs(subject, by));
    for (std::size_t round = 0; round < extents.runs; ++round)
        parts.push_back({"whole fields", [&] { measure(others.fields, run.options().folder); }});
    for (const Subject& subject : subjects)
        for (const Variant& variant : subject.variants)
            if (variant.is_main())
                parts.push_back({"loops of " + subject.name, [&] {
                                     append(others.loops,
                                            loop_runs(subject.name, variant, *single_thread, (extents.runs + 1) / 2));
                                 }});
    parts.push_back({"compiling", [&] { measure_round(methods, 0); }}); // and making volumes: not within a round
    for (std::size_t round = 1; round <= extents.rounds; ++round)
        parts.push_back({"times", [&, round] {
                             crowding.push_back(crowding_of_cores());
                             rounds.push_back(measure_round(methods, round));
                         }});
    constexpr std::size_t kPartsOfWaiting = 10;
    AsMetTimes as_met(methods, met_methods(methods));
    for (std::size_t part = 0; part < kPartsOfWaiting; ++part)
        parts.push_back({"forces waited for",
                         [&] { as_met.measure(extents.ticks / kPartsOfWaiting, extents.colds / kPartsOfWaiting); }});
    run.run(parts);
    others.met = as_met.result();
    const Times times(std::move(rounds), unit);
    const Measured measured{subjects, methods, times, times.ratio(control, unit), bootstrap_median(crowding)};
    StudyData data = run.data();
    append(data.notes, notes_of(subjects, methods[unit], run.engine().report(), data.cores));
    if (!measured.steady())
        data.notes.push_back(fmt::format(
            "The machine was busy: \"{}\" took {:.2g} to {:.2g} times as long as itself, and work on all cores {:.2g} "
            "to {:.2g} times its processor time. Findings compare no times; run the study again.",
            methods[unit].name, measured.control.low, measured.control.high, measured.crowding.low,
            measured.crowding.high));
    data.tables = tables_of(measured);
    data.figures = figures_of(measured, !run.scene());
    data.findings = error_time::findings_of(measured);
    add_other_times(data, measured, others);
    for (Figure& figure : data.figures)
        if (!measured.steady() && (figure.x.column.starts_with("time_") || !figure.curves.empty()))
            figure.caption += " The machine was busy while these were measured: their times are not to be compared.";
    data.failed_renderers = failures.size();
    append(data.findings, std::move(failures));
    return data;
}

} // namespace forceshade::study
