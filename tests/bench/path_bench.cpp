// What `explore` does, in every way that a probe moves: on the device and on the CPU engine in turn, so that the ratio
// holds while the machine's speed drifts. Over a shaded bump of three facets, a sphere of 25 mm and 100 820 triangles,
// and the model spot; as deep as scenes are by default, half out of contact, at random, in taps and strokes and
// circles.
#include <map>

#include <benchmark/benchmark.h>

#include "host/field/engine.h"
#include "host/paths/scene_paths.h"
#include "host/sweep/sweep.h"
#include "tests/bench/geodesic.h"
#include "tests/bench/measure.h"
#include "tests/places.h"

namespace forceshade::bench {
namespace {

enum Surface { bump, sphere, spot };

/// A scene on a sphere that is no file.
PreparedCase on_sphere(Case one) {
    static const auto mesh = [] {
        auto made = std::make_shared<SceneMesh>();
        PolygonSoup polygons = shapes::moved(geodesic(71), glm::dvec3(0.025), glm::dvec3(0));
        made->findings = inspect(polygons);
        made->mesh = prepare_mesh(std::move(polygons), {}, VertexNormals::plain);
        made->structure = build_structure(made->mesh);
        return made;
    }();
    PreparedCase prepared;
    prepared.one = std::move(one);
    prepared.images.mesh = mesh;
    return prepared;
}

PreparedCase prepared(Surface surface, const std::string& paths) {
    const std::string force = "\n[force]\nstiffness = \"500 N/m\"\nshading = \"";
    if (surface == bump)
        return CasePreparation().prepare(
            parse_scene("[surface]\nfacets = 3" + force + "reference\"\n[paths]\n" + paths, "bench"));
    const std::string mesh = "[surface]\nkind = \"mesh\"\ntransform = { scale = 0.03 }\nfile = \"" +
                             in_source("tests/data/spot.obj") + "\"" + force + "mean_value\"\n[paths]\n" + paths;
    const Case one = parse_scene(mesh, "bench");
    return surface == spot ? CasePreparation().prepare(one) : on_sphere(one);
}

template <typename T>
void explore(benchmark::State& state, Surface surface, layout::uint channels, const std::string& paths) {
    const PreparedCase one = prepared(surface, paths);
    ScenePaths<T> scene(one);
    layout::PathInput<T> input = scene.input();
    input.features.channels = channels;
    EngineOptions options;
    options.needs_f64 = sizeof(T) == 8;
    const std::unique_ptr<Engine> device = make_engine(options);
    options.cpu = true;
    const std::unique_ptr<Engine> cpu = make_engine(options);
    std::uint64_t touched = 0, steps = 0;
    const auto run = [&](Engine& engine) {
        const double before = cpu_seconds();
        const double wall = seconds([&] {
            engine.explore<T>(
                input, [](const auto&) {},
                [&](std::size_t, std::span<const layout::PathMetrics<T>> metrics) {
                    for (const layout::PathMetrics<T>& path : metrics)
                        touched += path.contact_samples;
                    steps += metrics.size() * input.steps;
                });
        });
        return std::pair(wall, cpu_seconds() - before);
    };
    run(*device); // compiles
    std::vector<double> walls, cpu_walls, cores, cpu_cores;
    for (auto _ : state) {
        const auto [wall, core] = run(*device);
        const auto [cpu_wall, cpu_core] = run(*cpu);
        walls.push_back(wall), cores.push_back(core), cpu_walls.push_back(cpu_wall), cpu_cores.push_back(cpu_core);
        state.SetIterationTime(wall);
    }
    const double all = static_cast<double>(input.paths * input.steps);
    state.SetLabel(device->report().device);
    state.counters["M_steps_per_s"] = 1e-6 * all / median(walls);
    state.counters["cpu_M_steps_per_s"] = 1e-6 * all / median(cpu_walls);
    state.counters["of_cpu"] = median(cpu_walls) / median(walls);
    state.counters["of_cpu_by_core_s"] = median(cpu_cores) / median(cores);
    state.counters["in_contact"] = static_cast<double>(touched) / static_cast<double>(steps);
}

struct Way {
    const char* name;
    Surface surface;
    layout::uint channels; /* of samples; 0: metrics alone */
    std::string paths;     /* of the scene */
};

constexpr layout::uint kSamples = layout::kChannelForce | layout::kChannelPosition;

// About ten million steps over the bump, three over a mesh. A way there 1 mm deep and back 1 mm above: half out of
// contact.
const Way kWays[] = {
    {"bump_strokes", bump, 0, "count = 5000"},
    {"bump_strokes_samples", bump, kSamples, "count = 5000"},
    {"bump_half_out", bump, 0, "count = 5000\ndepth_back = \"-1 mm\""},
    {"bump_tremor", bump, 0, "count = 5000\ntremor.amplitude = \"0.1 mm\""},
    {"bump_random_walk", bump, 0, "count = 2000\nkind = \"random_walk\""},
    {"bump_taps", bump, 0, "count = 5000\nkind = \"taps\""},
    {"bump_closed_loop", bump, 0, "count = 5000\npress = \"1 N\""},
    {"bump_closed_loop_samples", bump, kSamples, "count = 5000\npress = \"1 N\""},
    {"sphere_strokes", sphere, 0, "count = 1500"},
    {"sphere_circle", sphere, 0, "count = 1500\nkind = \"circle\"\nlength = \"30 mm\"\ndepth = \"8 mm\""},
    {"sphere_half_out", sphere, 0, "count = 1500\ndepth_back = \"-1 mm\""},
    {"sphere_random_walk", sphere, 0, "count = 1500\nkind = \"random_walk\"\ndepth = \"5 mm\""},
    {"sphere_taps", sphere, 0, "count = 1500\nkind = \"taps\""},
    {"spot_strokes", spot, 0, "count = 1500"},
    {"spot_circle", spot, 0, "count = 1500\nkind = \"circle\"\ndepth = \"10 mm\""},
    {"spot_half_out", spot, 0, "count = 1500\ndepth = \"5 mm\"\ndepth_back = \"-1 mm\""},
    {"spot_random_walk", spot, 0, "count = 1500\nkind = \"random_walk\"\ndepth = \"10 mm\""},
    {"spot_taps", spot, 0, "count = 1500\nkind = \"taps\"\ndepth = \"5 mm\""},
    {"spot_closed_loop", spot, 0, "count = 1500\npress = \"1 N\""},
};

template <typename T> void add(const char* precision) {
    for (const Way& way : kWays)
        benchmark::RegisterBenchmark(
            (precision + std::string("/") + way.name).c_str(),
            [&way](benchmark::State& state) { explore<T>(state, way.surface, way.channels, way.paths); })
            ->UseManualTime()
            ->Iterations(3);
}

[[maybe_unused]] const bool kAdded = (add<float>("f32"), add<double>("f64"), true);

} // namespace
} // namespace forceshade::bench
