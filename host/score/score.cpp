#include "host/score/score.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/clock.h"
#include "host/long_run.h"
#include "host/mesh/structure.h"
#include "host/norm.h"
#include "host/paths/scene_paths.h"
#include "host/program.h"
#include "host/reference/path_step.h"

namespace forceshade::score {
namespace {

constexpr std::size_t kCold = 60;                // updates with caches full of other memory
constexpr std::size_t kRoundTrips = 500;         // updates one at a time
constexpr std::uint64_t kMostSamples = 10000000; // of a scene's own paths: some 3 GB

UpdateTimes times_of(std::vector<double> first, const std::vector<double>& again, const std::vector<double>& cold) {
    UpdateTimes times;
    double sum = 0;
    for (const double seconds : again)
        sum += seconds;
    times.warm = again.empty() ? NAN : sum / double(again.size());
    times.median = study::quantile(first, 0.5);
    times.p999 = study::quantile(first, 0.999);
    times.worst = first.empty() ? NAN : *std::ranges::max_element(first);
    times.cold = cold.empty() ? NAN : study::quantile(cold, 0.5);
    return times;
}

// A run along all strokes: forces, proxies and times.
struct Walked {
    Track forces, proxies;
    std::vector<double> seconds;
    bool has_proxies = false; // some
};

Walked walk(RendererProcess& renderer, const Strokes& strokes) {
    Walked walked;
    Stage stage("strokes", strokes.all.size(), "strokes");
    for (const Stroke& stroke : strokes.all) {
        renderer.begin_path();
        std::vector<glm::dvec3>&forces = walked.forces.emplace_back(), &proxies = walked.proxies.emplace_back();
        for (const RendererAnswer& answer : renderer.update(stroke.probe)) {
            forces.push_back(answer.force);
            proxies.push_back(answer.has_proxy ? answer.proxy : glm::dvec3(NAN));
            walked.seconds.push_back(answer.seconds);
            walked.has_proxies = walked.has_proxies || answer.has_proxy;
        }
        stage.update(walked.forces.size());
    }
    return walked;
}

// The stroke and sample of an update, counted over all strokes from 0, twice.
std::string place_of(const Strokes& strokes, std::uint64_t update) {
    const std::uint64_t samples = strokes.samples();
    if (update >= 2 * samples)
        return "in a run for its times";
    if (update >= samples)
        return "in a second run, " + place_of(strokes, update - samples);
    for (const Stroke& stroke : strokes.all) {
        if (update < stroke.probe.size())
            return fmt::format("path {}, t = {:.6g} s", stroke.id, stroke.time[update]);
        update -= stroke.probe.size();
    }
    return "";
}

std::vector<StrokeScore> score_track(const Yardstick& yardstick, const Strokes& strokes,
                                     const std::vector<Truth>& truths, const Track& forces, const Track& proxies) {
    std::vector<StrokeScore> scores;
    for (std::size_t i = 0; i < strokes.all.size(); ++i)
        scores.push_back(score_stroke(yardstick, strokes.all[i], truths[i], forces[i],
                                      proxies.empty() ? std::vector<glm::dvec3>{} : proxies[i], strokes.period));
    return scores;
}

Scored score_renderer(const RendererSource& source, const PreparedCase& prepared, const ScoreOptions& options,
                      const Yardstick& yardstick, const std::vector<Truth>& truths,
                      std::vector<std::string>& warnings) {
    Scored scored{source.name, "renderer", {}, {}, std::nullopt, ""};
    const Strokes& strokes = options.strokes;
    try {
        RendererProcess renderer(source, prepared, strokes.period.value_or(0), options.patience);
        Walked first = walk(renderer, strokes);
        const Walked again = walk(renderer, strokes);
        std::vector<double> cold, boundary;
        const std::vector<glm::dvec3>& places = strokes.all.front().probe;
        renderer.begin_path();
        for (const RendererAnswer& answer :
             renderer.update(std::span(places).first(std::min(kCold, places.size())), {.cold = true}))
            cold.push_back(answer.seconds);
        renderer.begin_path();
        for (std::size_t i = 0; i < std::min(kRoundTrips, places.size()); ++i) {
            const Clock::time_point start = Clock::now();
            const double inside = renderer.update(std::span(places).subspan(i, 1)).front().seconds;
            boundary.push_back(seconds_since(start) - inside);
        }
        scored.times = times_of(first.seconds, again.seconds, cold);
        scored.times->boundary = study::quantile(boundary, 0.5);
        scored.strokes =
            score_track(yardstick, strokes, truths, first.forces, first.has_proxies ? first.proxies : Track{});
        scored.track = std::move(first.forces);
        if (const std::string wrong = renderer.close(); !wrong.empty())
            warnings.push_back(fmt::format("{} {}; its scores stand", source.name, wrong));
    } catch (const RendererError& error) {
        scored.failed = error.what();
        if (error.update)
            scored.failed += fmt::format(" ({})", place_of(strokes, *error.update));
    }
    return scored;
}

// A law of this program along the strokes, with the clock about each update as in a renderer's process.
template <typename T, typename At>
Scored score_law(const char* name, CaseProbe<T>& probe, const At& at, const Yardstick& yardstick,
                 const ScoreOptions& options, const std::vector<Truth>& truths) {
    Scored scored{name, "forceshade", {}, {}, std::nullopt, ""};
    Track proxies;
    std::vector<double> first, again;
    const double clock = clock_seconds();
    for (std::vector<double>* const seconds : {&first, &again}) {
        scored.track.clear();
        proxies.clear();
        for (const Stroke& stroke : options.strokes.all) {
            check_interrupt();
            probe.begin_path();
            std::vector<glm::dvec3>&forces = scored.track.emplace_back(), &own = proxies.emplace_back();
            for (const glm::dvec3& place : stroke.probe) {
                const Clock::time_point start = Clock::now();
                const reference::Contact<T> contact = at(place);
                seconds->push_back(std::max(seconds_since(start) - clock, 0.0));
                forces.emplace_back(contact.force);
                own.push_back(contact.facet == layout::kNoFacet ? place : probe.law().in_world(contact.proxy));
            }
        }
    }
    scored.times = times_of(first, again, {});
    scored.strokes = score_track(yardstick, options.strokes, truths, scored.track, proxies);
    return scored;
}

template <typename T>
Scored score_probe(const char* name, const PreparedCase& prepared, const Yardstick& yardstick,
                   const ScoreOptions& options, const std::vector<Truth>& truths) {
    CaseProbe<T> probe(prepared);
    probe.law().find_obstacles();
    return score_law(
        name, probe, [&](const glm::dvec3& place) { return probe.at(place).contact; }, yardstick, options, truths);
}

// What looks like another unit or sign of recorded forces: by the factor that brings the oracle's forces nearest.
std::string doubt_of(const Track& forces, const std::vector<Truth>& truths) {
    double both = 0, own = 0;
    for (std::size_t i = 0; i < forces.size(); ++i)
        for (std::size_t j = 0; j < forces[i].size(); ++j)
            if (is_force(forces[i][j])) {
                both += glm::dot(forces[i][j], truths[i].force[j]);
                own += glm::dot(truths[i].force[j], truths[i].force[j]);
            }
    const double factor = both / own, size = std::abs(factor);
    if (size > 300 || (size > 0 && size < 1.0 / 300))
        return fmt::format(
            "its forces are some {:.3g} times the oracle's; are they in another unit? --map \"fx=COLUMN mN, ...\"",
            factor);
    return factor < -0.3 ? "its forces point the other way; are they those on the surface? --map \"fx=-COLUMN N, ...\""
                         : "";
}

} // namespace

Strokes scene_strokes(const PreparedCase& prepared) {
    const std::optional<PathsSpec>& spec = prepared.one.scene.paths;
    if (!spec)
        throw UsageError(
            "score needs strokes: --paths STROKES.csv, --forces of a file that has positions, or a scene with [paths]");
    if (spec->closed() || spec->kind == PathKind::recorded)
        throw UsageError("the scene's [paths] are {}: give positions with --paths, such as explore writes them",
                         spec->closed() ? "of a hand, whose positions depend on the forces" : "in a file");
    Strokes strokes{"[paths]", {}, 1 / spec->rate, {}};
    ScenePaths<double> paths(prepared);
    const layout::PathInput<double> input = paths.input();
    const glm::dvec3 origin = scene_origin(prepared);
    std::uint64_t samples = 0;
    for (std::size_t path = 0; path < input.paths; ++path) {
        check_interrupt();
        const layout::PathBatch<double> batch = input.source->batch(path, 1);
        reference::BatchPath<double> moved{input, batch, 0};
        const std::size_t steps = moved.steps();
        if ((samples += steps) > kMostSamples)
            throw UsageError("the scene's [paths] have more than {} samples, which a score holds in memory; make "
                             "paths.count or paths.steps smaller",
                             kMostSamples);
        if (moved.recorded())
            moved.follow(input.source->positions(0, steps), 0);
        Stroke& stroke = strokes.all.emplace_back();
        stroke.id = path;
        for (std::size_t step = 0; step < steps; ++step) {
            stroke.time.push_back(double(step) / spec->rate);
            stroke.probe.push_back(world_place(glm::dvec3(moved.at(step)), origin));
            stroke.lines.push_back(static_cast<std::uint32_t>(step));
            stroke.rows.push_back(static_cast<std::uint32_t>(samples - steps + step));
        }
    }
    strokes.warnings = paths.warnings();
    return strokes;
}

double size_of(const PreparedCase& prepared) {
    if (const SurfaceSpec& surface = prepared.one.scene.surface;
        surface.kind == SurfaceKind::bump || surface.kind == SurfaceKind::cylinder_bump)
        return surface.width / 2;
    const RendererMesh mesh = renderer_mesh(prepared);
    double farthest = 0;
    for (const glm::dvec3& vertex : mesh.vertices)
        farthest = std::max({farthest, std::abs(vertex.x), std::abs(vertex.y), std::abs(vertex.z)});
    return farthest;
}

Scores score_all(const PreparedCase& prepared, const ScoreOptions& options) {
    Scores scores{{}, options.strokes.warnings};
    if (prepared.one.scene.rubs())
        scores.warnings.emplace_back("the oracle is the scene's law without its friction and vibration");
    Yardstick yardstick(prepared);
    std::vector<Truth> truths;
    std::uint64_t touched = 0;
    {
        Stage stage("oracle", options.strokes.all.size(), "strokes");
        for (const Stroke& stroke : options.strokes.all) {
            check_interrupt();
            for (std::size_t i = 0; i < stroke.probe.size(); ++i)
                if (!yardstick.law().reaches(stroke.probe[i]))
                    throw UsageError("{}:{}: {}", options.strokes.source, stroke.lines[i],
                                     beyond_reach<double>(stroke.probe[i]));
            truths.push_back(yardstick.along(stroke));
            touched += static_cast<std::uint64_t>(std::ranges::count(truths.back().touching, true));
            stage.update(truths.size());
        }
    }
    const auto begun_inside = std::ranges::count_if(truths, [](const Truth& truth) { return truth.touching.front(); });
    if (begun_inside > 0)
        scores.warnings.push_back(fmt::format(
            "{} of {} strokes begin below the surface, where a renderer with a history has none; begin them above it",
            begun_inside, truths.size()));
    std::uint64_t unfinished = 0;
    for (const Truth& truth : truths)
        unfinished += static_cast<std::uint64_t>(std::ranges::count(truth.certain, false));
    if (unfinished > 0)
        scores.warnings.push_back(
            fmt::format("at {} samples the oracle's contact has no certificate (its proxy did not come to rest): do "
                        "not trust errors there; faults are not counted there",
                        unfinished));
    if (touched == 0)
        throw UsageError("{}: no sample touches the surface; are its axes and its unit the scene's? --map says which "
                         "column is what: --map \"x=x mm, y=z mm, z=-y mm\"",
                         options.strokes.source);
    std::vector<Scored>& all = scores.all;
    all.push_back(score_probe<double>("oracle (f64)", prepared, yardstick, options, truths));
    all.back().kind = "oracle";
    all.push_back(score_probe<float>("oracle in f32", prepared, yardstick, options, truths));
    if (prepared.one.scene.force.shading != Shading::none) { // what a renderer without shading can come to
        PreparedCase plain = prepared;
        plain.one.scene.force.shading = Shading::none;
        all.push_back(score_probe<double>("oracle without shading", plain, yardstick, options, truths));
    }
    if (prepared.images.mesh) {
        CaseProbe<double> field(prepared);
        layout::uint hint = 0;
        all.push_back(score_law(
            "field, without history", field, [&](const glm::dvec3& place) { return field.law().at(place, hint); },
            yardstick, options, truths));
    }
    for (const auto& [name, track] : options.recorded) {
        Scored scored{name, "recorded", track, {}, std::nullopt, ""};
        scored.strokes = score_track(yardstick, options.strokes, truths, track, {});
        if (const std::string doubt = doubt_of(track, truths); !doubt.empty())
            scores.warnings.push_back(fmt::format("{}: {}", name, doubt));
        all.push_back(std::move(scored));
    }
    for (const RendererSource& source : options.renderers)
        all.push_back(score_renderer(source, prepared, options, yardstick, truths, scores.warnings));
    for (std::size_t i = 0; i < all.size(); ++i) { // rows are known by their names
        const auto before =
            std::ranges::count(all.begin(), all.begin() + std::ptrdiff_t(i), all[i].name, &Scored::name);
        if (before > 0)
            all[i].name += fmt::format(" ({})", before + 1);
    }
    return scores;
}

} // namespace forceshade::score
