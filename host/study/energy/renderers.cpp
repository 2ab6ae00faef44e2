// Renderers of the user's own, and the scene's law with friction and vibration, round the loops of a scene.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/study/energy/energy.h"

namespace forceshade::study {
namespace {

constexpr const char* kOwnLaw = "own law";

// The scene's own law, as loops take it.
EnergyLaw own_law(const PreparedCase& scene) {
    return {"scene", kOwnLaw, std::nullopt, false, std::make_shared<PreparedCase>(scene)};
}

std::vector<glm::dvec3> turned(std::vector<glm::dvec3> places) {
    std::ranges::reverse(places);
    return places;
}

double period_of(const EnergyLaw& law) {
    return 1 / law.prepared->one.scene.paths.value_or(PathsSpec{}).rate;
}

RendererLoops::Loop loop_of(std::size_t number, const LoopWork& forth, const LoopWork& back,
                            const std::vector<glm::dvec3>& places, double period) {
    double way = 0;
    for (std::size_t i = 1; i < places.size(); ++i)
        way += glm::distance(places[i - 1], places[i]);
    return {number, std::max(forth.work, back.work), 0.5 * (forth.effort + back.effort),
            way / (double(places.size() - 1) * period)};
}

// Of the scene's own law; empty where it leaves contact.
std::optional<RendererLoops::Loop> own_loop(const EnergyLaw& law, const Stroke& stroke, std::size_t number,
                                            std::size_t steps) {
    const auto places = places_of_loop(law, stroke, steps);
    const auto forth = places ? work_by_history(law, *places) : std::nullopt;
    const auto back = forth ? work_by_history(law, turned(*places)) : std::nullopt;
    return back ? std::optional(loop_of(number, *forth, *back, *places, period_of(law))) : std::nullopt;
}

void add_own_loops(RendererLoops& own, const EnergyLaw& law, const std::vector<Stroke>& strokes, std::size_t steps) {
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        auto loop = own_loop(law, strokes[i], i, steps);
        const auto coarse = loop ? own_loop(law, strokes[i], i, steps / 2) : std::nullopt;
        if (!coarse)
            continue;
        loop->rule = std::abs(loop->gain - coarse->gain);
        own.loops.push_back(*loop);
    }
}

// The forces, N, on a path from its begin on.
using Walk = std::function<std::vector<glm::dvec3>(const std::vector<glm::dvec3>& path)>;
using MakeWalk = std::function<Walk(const EnergyLaw& law)>;

// In a process of its own.
MakeWalk walks_of(const RendererSource& source) {
    return [source](const EnergyLaw& law) -> Walk {
        auto renderer = std::make_shared<RendererProcess>(source, *law.prepared, period_of(law));
        return [renderer](const std::vector<glm::dvec3>& path) {
            renderer->begin_path();
            std::vector<glm::dvec3> forces;
            for (const RendererAnswer& answer : renderer->update(path))
                forces.push_back(finite_force(answer));
            return forces;
        };
    };
}

MakeWalk walks_of(const RubbingLaw& rubbing) {
    return [rubbing](const EnergyLaw& law) -> Walk {
        const std::shared_ptr<ProbeLaw> probe = rubbing.on(*law.prepared, period_of(law));
        return [probe](const std::vector<glm::dvec3>& path) {
            probe->begin_path();
            std::vector<glm::dvec3> forces;
            forces.reserve(path.size());
            for (const glm::dvec3& at : path)
                forces.push_back(probe->at(at).force);
            return forces;
        };
    };
}

// A renderer's error ends it.
void add_walked_loops(const MakeWalk& make, RendererLoops& found, const RendererLoops& own, const EnergyLaw& law,
                      const std::vector<Stroke>& strokes, std::size_t steps) {
    std::string where;
    try {
        const Walk walk = make(law);
        const auto work = [&](const std::vector<glm::dvec3>& places) {
            const std::vector<glm::dvec3> path = path_of_loop(law, places);
            return work_of_last(path, walk(path), places.size() - 1);
        };
        for (const RendererLoops::Loop& loop : own.loops) {
            where = fmt::format(" (closed stroke {})", loop.number);
            const std::vector<glm::dvec3> places = places_of_loop(law, strokes[loop.number], steps).value();
            const LoopWork forth = work(places), back = work(turned(places));
            found.loops.push_back(loop_of(loop.number, forth, back, places, period_of(law)));
        }
    } catch (const RendererError& error) {
        found.status = error.what() + where;
        found.loops.clear();
    }
}

std::vector<double> values_of(const RendererLoops& one, double RendererLoops::Loop::*value) {
    std::vector<double> values;
    for (const RendererLoops::Loop& loop : one.loops)
        values.push_back(loop.*value);
    return values;
}

// NaN without a loop.
double largest(const RendererLoops& one, double RendererLoops::Loop::*value) {
    return one.loops.empty() ? NAN : std::ranges::max(values_of(one, value));
}

Table renderer_table(const std::vector<RendererLoops>& found) {
    using R = RendererLoops;
    const auto median = [](double R::Loop::*value, double Interval::*end) {
        return [=](const R& r) { return r.loops.empty() ? NAN : 1e3 * bootstrap_median(values_of(r, value)).*end; };
    };
    const auto most = [](double R::Loop::*value) { return [=](const R& r) { return 1e3 * largest(r, value); }; };
    return table_of<R>(
        "energy_renderers", "Energy gained per closed stroke by renderers, each closed stroke walked as a sampled path",
        {{"renderer", "",
          "the library and its options; own law: the scene's without friction and vibration, by the same samples",
          &R::name},
         {"status", "", "ok, or what the renderer did wrong", &R::status},
         {"closed_strokes", "1", "in which the scene's own law stays in contact",
          [](const R& r) { return r.loops.size(); }},
         {"gain_mJ", "mJ",
          "energy gained per closed stroke in the worse direction of travel: median of the closed strokes",
          median(&R::Loop::gain, &Interval::median)},
         {"gain_from_mJ", "mJ", "95 % interval of the median (bootstrap)", median(&R::Loop::gain, &Interval::low)},
         {"gain_to_mJ", "mJ", "the other end", median(&R::Loop::gain, &Interval::high)},
         {"largest_mJ", "mJ", "the closed stroke that gives most", most(&R::Loop::gain)},
         {"effort_mJ", "mJ", "the integral of |F dl|: median of the closed strokes",
          median(&R::Loop::effort, &Interval::median)},
         {"speed_mm_per_s", "mm/s", "along a closed stroke: median of the closed strokes",
          median(&R::Loop::speed, &Interval::median)},
         {"rule_mJ", "mJ", "the largest change of the own law's gain with half the steps: the error of the sum",
          most(&R::Loop::rule)}},
        found);
}

Table renderer_loop_table(const std::vector<RendererLoops>& found) {
    struct R {
        const std::string* renderer;
        RendererLoops::Loop loop, own;
    };
    std::vector<R> rows;
    for (const RendererLoops& one : found)
        for (std::size_t i = 0; i < one.loops.size() && &one != &found.front(); ++i)
            rows.push_back({&one.name, one.loops[i], found.front().loops[i]});
    return table_of<R>("renderer_strokes", "Every closed stroke of the renderers",
                       {{"renderer", "", "the library and its options", [](const R& r) { return *r.renderer; }},
                        {"stroke", "1", "which stroke", [](const R& r) { return r.loop.number; }},
                        {"gain_mJ", "mJ", "energy gained in the worse direction of travel",
                         [](const R& r) { return 1e3 * r.loop.gain; }},
                        {"effort_mJ", "mJ", "the integral of |F dl|", [](const R& r) { return 1e3 * r.loop.effort; }},
                        {"own_law_mJ", "mJ", "gain of the scene's own law on the same samples",
                         [](const R& r) { return 1e3 * r.own.gain; }}},
                       rows);
}

// "gives up to 0.1 mJ a closed stroke"; `error`, J, is that of the sum.
std::string gives(double most, double error) {
    constexpr double kRounding = 1e-9; // J
    if (std::abs(most) > std::max(kRounding, error))
        return most > 0 ? fmt::format("gives up to {} a closed stroke", milli(most))
                        : fmt::format("takes at least {} a closed stroke", milli(-most));
    return error > kRounding ? fmt::format("gives no more than the error of the sum, {} a closed stroke", milli(error))
                             : "gives no energy";
}

Finding finding_of(const RendererLoops& one, const RendererLoops& own, std::size_t number) {
    Finding finding{fmt::format("energy_renderer_{}", number), {}, "", "strokes anywhere in the scene's region", ""};
    if (one.loops.empty()) {
        finding.text = one.status == "ok"
                           ? fmt::format("{}: the scene's own law stays in contact in no closed stroke.", one.name)
                           : fmt::format("{} {}: its energy is not known.", one.name, one.status);
        return finding;
    }
    const double error = largest(own, &RendererLoops::Loop::rule);
    finding.text = fmt::format("{} {} ({} {}).", one.name, gives(largest(one, &RendererLoops::Loop::gain), error),
                               own_name(one.name), gives(largest(own, &RendererLoops::Loop::gain), error));
    finding.figure = "energy-renderers";
    finding.condition = fmt::format("the second round of a sampled path at {:.2g} mm/s, worse direction of travel",
                                    1e3 * bootstrap_median(values_of(one, &RendererLoops::Loop::speed)).median);
    const Interval gain = bootstrap_median(values_of(one, &RendererLoops::Loop::gain));
    finding.interval = fmt::format("{} closed strokes; median {:.2g} mJ, 95 % of bootstrap medians: {:.2g} to {:.2g} "
                                   "mJ; half the steps change the own law's gain by up to {}",
                                   one.loops.size(), 1e3 * gain.median, 1e3 * gain.low, 1e3 * gain.high, milli(error));
    return finding;
}

} // namespace

std::vector<Part> renderer_parts(const StudyRun& run, const EnergySurface& surface, std::size_t strokes,
                                 std::size_t steps, std::vector<RendererLoops>& found) {
    const EnergyLaw law = own_law(run.scene().value());
    const std::vector<Stroke> some(surface.strokes.begin(),
                                   surface.strokes.begin() + std::ptrdiff_t(std::min(strokes, surface.strokes.size())));
    found = {{kOwnLaw}};
    std::vector<Part> parts{
        {"closed strokes of the scene's own law", [=, &found] { add_own_loops(found[0], law, some, steps); }}};
    const auto add = [&](const std::string& name, const MakeWalk& make) {
        parts.push_back(
            {"closed strokes of " + name,
             [=, &found, at = found.size()] { add_walked_loops(make, found[at], found[0], law, some, steps); }, true});
        found.push_back({name});
    };
    for (const RubbingLaw& one : run.rubbing())
        add(one.name, walks_of(one));
    for (const RendererSource& source : run.options().renderers)
        add(source.name, walks_of(source));
    return parts;
}

void add_renderers(StudyData& data, const std::vector<RendererLoops>& found) {
    if (found.empty())
        return;
    data.failed_renderers = static_cast<std::size_t>(
        std::ranges::count_if(found, [](const RendererLoops& one) { return one.status != "ok"; }));
    data.tables.push_back(renderer_table(found));
    data.tables.push_back(renderer_loop_table(found));
    if (!data.tables.back().rows.empty())
        data.figures.push_back(
            make_figure("energy-renderers", "Energy gained per closed stroke, against the scene's own law",
                        "Each point is a closed stroke; on the diagonal a renderer gives what the law gives, below 0 "
                        "it takes energy.",
                        FigureKind::scatter, "renderer_strokes", {}, {"own_law_mJ", "gain of the own law / mJ"},
                        {"gain_mJ", "gain / mJ"}, "renderer"));
    data.notes.push_back(
        "A renderer, or the scene's law with its friction or vibration, comes down from above the surface to the begin "
        "of a closed stroke and goes round twice; the work of the second round counts, by the mean of neighbouring "
        "forces times the step. The scene's own law without them goes the same way: rule_mJ is the change of its gain "
        "with half the steps. A negative gain is what the hand loses.");
    for (std::size_t i = 1; i < found.size(); ++i)
        data.findings.push_back(finding_of(found[i], found.front(), i));
}

} // namespace forceshade::study
