// Loops with the forces of a user's own renderers, and of the scene's law with its friction and vibration.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/numbers.h"
#include "host/study/stability/stability.h"

namespace forceshade::study {

MakePathForce own_path_law(const LoopSurface& surface) {
    return [&surface](double stiffness) {
        return [probe = std::make_shared<CaseProbe<double>>(surface.prepared), stiffness](const glm::dvec3& at) {
            return stiffness * glm::dvec3(probe->at(at).contact.force);
        };
    };
}

namespace {

PreparedCase of_stiffness(const LoopSurface& surface, double stiffness) {
    PreparedCase prepared = surface.prepared; // of 1 N/m
    prepared.one.scene.force.stiffness *= stiffness;
    if (prepared.one.scene.texture)
        prepared.one.scene.texture->stiffness *= stiffness;
    prepared.scene = resolved_toml(prepared.one);
    return prepared;
}

// A process for each stiffness.
MakePathForce renderer_law(const LoopSurface& surface, const RendererSource& source) {
    return [&surface, source](double stiffness) {
        return
            [renderer = std::make_shared<RendererProcess>(source, of_stiffness(surface, stiffness), 1 / surface.rate)](
                const glm::dvec3& at) { return finite_force(renderer->update(at)); };
    };
}

// Bristle and vibration are as the scene has them.
MakePathForce rubbing_law(const LoopSurface& surface, const RubbingLaw& rubbing) {
    return [&surface, rubbing](double stiffness) {
        return [law = std::shared_ptr<ProbeLaw>(rubbing.on(of_stiffness(surface, stiffness), 1 / surface.rate))](
                   const glm::dvec3& at) { return law->at(at).force; };
    };
}

// The worst place of each kind with the scene's own hand; the worst of all, the last, over damping.
std::vector<LeastLimit> settings_over(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick) {
    const LeastLimit* const worst = worst_of(limits, surface.name);
    std::vector<LeastLimit> settings;
    if (!worst)
        return settings;
    for (const PlaceKind kind : kPlaceKinds)
        if (const LeastLimit* one = worst_of(limits, surface.name, {}, kind); one && one != worst)
            settings.push_back(*one);
    for (const double times : quick ? std::vector{0.5, 1.0, 2.0} : std::vector{0.25, 0.5, 1.0, 2.0, 4.0}) {
        LeastLimit& one = settings.emplace_back(*worst);
        one.own = times == 1;
        if (one.own)
            continue;
        one.cell = damped(worst->cell, times * damping_of(worst->cell.hand));
        one.limit = linear_limit(one.cell.hand, one.cell.rate, one.hold, one.place.force_around(), one.cell.lag);
        one.wall = wall_limit(one.cell.hand, one.cell.rate, one.cell.lag);
    }
    return settings;
}

// Until an error ends it.
void add_limits_of(const std::string& name, const MakePathForce& law, const LoopSurface& surface,
                   const std::vector<LeastLimit>& settings, std::vector<RendererLimit>& rows) {
    if (settings.empty())
        rows.push_back({name, {}, {NAN, {}}, {}, {NAN, {}}, "was not asked: the scene's own loop has no limit"});
    for (const LeastLimit& there : settings) {
        RendererLimit& row = rows.emplace_back();
        row.renderer = name;
        row.there = there;
        row.limit.limit = NAN;
        try {
            row.limit = stepped_limit(surface, there, law);
            row.rest = stepped_rest(surface, there, law, surface.stiffness);
            if (row.limit.end == LimitEnd::no_force)
                row.status = "gives no force";
        } catch (const RendererError& error) {
            row.status = error.what();
            return;
        }
    }
}

std::string place_text(const LeastLimit& there) {
    if (there.hold.name.empty())
        return "";
    return fmt::format("{}, {:.2g} mm deep, held {}", name_of(there.place.kind), 1e3 * there.place.depth,
                       there.hold.name);
}

// Over damping, at the worst place of all.
Figure limit_figure(const RendererLimit& varied) {
    const std::string place = place_text(varied.there);
    Figure figure = make_figure(
        "loop-renderers", "Z-width: largest stable stiffness over damping",
        fmt::format("At the worst place of the scene's own law ({}), the hand's damping varied. Line: the scene's own "
                    "law in the same loop.",
                    place),
        FigureKind::scatter, "loop_renderers", {{"place", place}}, {"damping_N_s_per_m", "damping / (N s/m)", true},
        {"limit_N_per_m", "largest stable stiffness / (N/m)", true}, "renderer", "", {.joined = true});
    figure.curves.push_back({"loop_renderers",
                             {{"place", place}, {"renderer", varied.renderer}},
                             "damping_N_s_per_m",
                             "own_law_N_per_m",
                             "own law",
                             true});
    return figure;
}

const char* range_of(const SteppedLimit& limit) {
    if (std::isnan(limit.limit))
        return "";
    return limit.end == LimitEnd::below ? "below" : limit.end == LimitEnd::above ? "above" : "within";
}

double ratio_of(const RendererLimit& row) {
    const bool both = row.limit.end == LimitEnd::within && row.own.end == LimitEnd::within;
    return both ? row.limit.limit / row.own.limit : NAN;
}

Table renderer_limit_table(const std::vector<RendererLimit>& limits) {
    using R = RendererLimit;
    return table_of<R>(
        "loop_renderers", "Largest stable stiffness of renderers, next to the scene's own law",
        {{"renderer", "", "the library and its options", &R::renderer},
         {"status", "", "ok, or what the renderer did wrong, after which it has no rows", &R::status},
         {"place", "", "kind, depth and hold: the worst of its kind by the scene's own law",
          [](const R& r) { return place_text(r.there); }},
         {"x_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.x; }},
         {"y_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.y; }},
         {"z_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.z; }},
         {"hand", "", "own: the scene's; varied: with other damping",
          [](const R& r) { return r.there.own ? "own" : "varied"; }},
         {"damping_N_s_per_m", "N s/m", "b of device and hand together",
          [](const R& r) { return damping_of(r.there.cell.hand); }},
         {"limit_N_per_m", "N/m", "the largest stiffness at which a kick decays, to 1 %",
          [](const R& r) { return r.limit.limit; }},
         {"range", "",
          "within: the limit was found; above: stable at the end of the range, too; below: unstable at its begin",
          [](const R& r) { return range_of(r.limit); }},
         {"swing_um", "um",
          "of the probe after a kick at the scene's own stiffness: about its mean place, root mean square, in the last "
          "quarter of the time; infinite: it went away",
          [](const R& r) { return 1e6 * r.rest.swing; }},
         {"moved_um", "um", "from where it was kicked to that mean place, at which friction may hold it",
          [](const R& r) { return 1e6 * r.rest.moved; }},
         {"own_law_N_per_m", "N/m", "the same limit of the scene's own law without friction and vibration",
          [](const R& r) { return r.own.limit; }},
         {"own_law_range", "", "where that lies", [](const R& r) { return range_of(r.own); }},
         {"ratio_1", "1", "of both limits, where both were found", ratio_of},
         {"linear_N_per_m", "N/m", "of the linearised loop with the scene's own law; 0: none is stable",
          [](const R& r) { return r.there.limit; }},
         {"wall_N_per_m", "N/m", "K_crit of a wall with this hand", [](const R& r) { return r.there.wall; }}},
        limits);
}

// "is stable up to 1166 N/m"
std::string stable_text(const SteppedLimit& limit) {
    switch (limit.end) {
    case LimitEnd::above:
        return fmt::format("is stable beyond {:.3g} N/m", limit.limit);
    case LimitEnd::below:
        return fmt::format("is not stable even at {}", newtons(limit.limit));
    case LimitEnd::no_force:
        return "gives no force";
    default:
        return "is stable up to " + newtons(limit.limit);
    }
}

// "; at the scene's 1000 N/m it shakes the probe by 2.1 µm"; empty where the probe comes to rest there.
std::string shakes_text(const RendererLimit& row, double stiffness) {
    if (row.limit.end == LimitEnd::no_force || std::isnan(row.limit.limit) || stiffness < row.limit.limit)
        return "";
    if (std::isinf(row.rest.swing))
        return fmt::format("; at the scene's {} the probe goes away", newtons(stiffness));
    const std::string moved = row.rest.moved > row.rest.swing
                                  ? fmt::format("moves {} away and ", numbers::quantity_text(row.rest.moved, "m"))
                                  : "";
    return fmt::format("; at the scene's {} the probe {}swings by {}", newtons(stiffness), moved,
                       numbers::quantity_text(row.rest.swing, "m"));
}

// At the place with the renderer's lowest limit with the hand's own damping.
Finding finding_of(const LoopSurface& surface, const std::vector<RendererLimit>& limits, const std::string& renderer,
                   std::size_t number) {
    Finding finding{fmt::format("loop_renderer_{}", number), {}, "", {}, hand_text(surface)};
    const RendererLimit *least = nullptr, *own = nullptr; // the lowest of the law's own, perhaps at another place
    double low = INFINITY, high = 0;                      // of the ratios
    for (const RendererLimit& row : limits) {
        if (row.renderer != renderer)
            continue;
        if (row.status != "ok") {
            finding.place = place_text(row.there);
            finding.text = fmt::format("{} {}{}.", renderer, row.status,
                                       finding.place.empty() ? "" : fmt::format(" ({})", finding.place));
            return finding;
        }
        if (row.there.own && (!least || row.limit.limit < least->limit.limit))
            least = &row;
        if (row.there.own && (!own || row.own.limit < own->own.limit))
            own = &row;
        if (const double ratio = ratio_of(row); !std::isnan(ratio)) {
            low = std::min(low, ratio);
            high = std::max(high, ratio);
        }
    }
    finding.text = fmt::format("{} {}{} ({} {}).", renderer, stable_text(least->limit),
                               shakes_text(*least, surface.stiffness), own_name(renderer), stable_text(own->own));
    finding.figure = "loop-renderers";
    finding.place = place_text(least->there);
    if (high > 0)
        finding.interval = fmt::format(
            "where both have a limit, the renderer's is {:.3g} to {:.3g} of the own law's; each to 1 %", low, high);
    return finding;
}

// Along the surface a bristle is a wall of its stiffness.
Finding bristle_finding(const LoopSurface& surface, const FrictionSpec& friction) {
    const double wall = wall_limit(surface.hand, surface.rate);
    return {"loop_bristle",
            fmt::format("The bristle of [friction] is a spring of {} along the surface: {}, as a wall is up to {}.",
                        newtons(friction.stiffness), friction.stiffness < wall ? "stable" : "unstable", newtons(wall)),
            "", "where the probe sticks", hand_text(surface)};
}

} // namespace

std::vector<RendererLimit> renderer_limits(StudyRun& run, const LoopSurface& surface,
                                           const std::vector<LeastLimit>& limits) {
    std::vector<std::pair<std::string, MakePathForce>> laws;
    for (const RubbingLaw& one : run.rubbing())
        laws.emplace_back(one.name, rubbing_law(surface, one));
    for (const RendererSource& source : run.options().renderers)
        laws.emplace_back(source.name, renderer_law(surface, source));
    if (laws.empty())
        return {};
    const std::vector<LeastLimit> settings = settings_over(surface, limits, run.options().quick);
    std::vector<SteppedLimit> own(settings.size());
    std::vector<std::vector<RendererLimit>> found(laws.size());
    std::vector<Part> parts{{"limits of the scene's own law",
                             [&] {
                                 for (std::size_t i = 0; i < settings.size(); ++i)
                                     own[i] = stepped_limit(surface, settings[i], own_path_law(surface));
                             },
                             true}};
    for (std::size_t i = 0; i < laws.size(); ++i)
        parts.push_back({"limits of " + laws[i].first,
                         [&, i] { add_limits_of(laws[i].first, laws[i].second, surface, settings, found[i]); }, true});
    run.run(parts);
    std::vector<RendererLimit> all;
    for (std::vector<RendererLimit>& rows : found) {
        for (std::size_t i = 0; i < std::min(rows.size(), own.size()); ++i)
            rows[i].own = own[i];
        append(all, std::move(rows));
    }
    return all;
}

void add_renderer_limits(StudyData& data, const LoopSurface& surface, const std::vector<RubbingLaw>& rubbing,
                         const std::vector<RendererLimit>& limits) {
    if (limits.empty())
        return;
    data.failed_renderers = static_cast<std::size_t>(
        std::ranges::count_if(limits, [](const RendererLimit& row) { return row.status != "ok"; }));
    data.tables.push_back(renderer_limit_table(limits));
    const auto varied = std::ranges::find_if(limits, [](const RendererLimit& row) { // of a renderer with all rows
        return !row.there.own && row.status == "ok";
    });
    if (varied != limits.end())
        data.figures.push_back(limit_figure(*varied));
    if (const auto& friction = rubbing.empty() ? std::nullopt : rubbing.front().friction)
        data.findings.push_back(bristle_finding(surface, *friction));
    std::size_t number = 0;
    for (auto row = limits.begin(); row != limits.end(); ++row)
        if (row == limits.begin() || row->renderer != std::prev(row)->renderer)
            data.findings.push_back(finding_of(surface, limits, row->renderer, ++number));
    data.notes.push_back(
        "Limits of renderers: the probe comes down to a place, where the hand balances the renderer's own force, and "
        "is displaced by a thousandth of its depth. The least stiffness from 10 to 1e7 N/m at which that does not "
        "decay is found by bisection, each in a process of its own; the scene's own law takes the place of the "
        "renderer in the same loop. The law with the scene's friction or vibration is stepped alike: their bristle and "
        "their material stay as the scene has them. A vibration is fed by the probe's own speed and may keep it from "
        "rest; swing_um says how much is left.");
}

} // namespace forceshade::study
