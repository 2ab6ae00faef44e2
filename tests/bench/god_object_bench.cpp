// Full updates of the god-object (L6) on one thread in double: the probe spirals 1 mm deep in a sphere of 25 mm, 0.1 mm
// a step. Rate, and how long the slowest updates take beyond what the clock itself does.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>

#include <benchmark/benchmark.h>

#include "host/mesh/structure.h"
#include "host/reference/god_object.h"
#include "tests/bench/geodesic.h"
#include "tests/mesh/shapes.h"

namespace forceshade::bench {
namespace {

constexpr double kRadius = 0.025; /* m */
constexpr double kDepth = 0.001;  /* m */
constexpr double kStep = 0.0001;  /* m a step */
constexpr double kTurn = 0.0005;  /* m between turns of the spiral */

/// From pole to pole and back, at constant speed.
std::vector<glm::dvec3> spiral(const MeshStructure& structure, std::size_t steps) {
    std::vector<glm::dvec3> probes;
    const double radius = kRadius - kDepth;
    double polar = 0.2, around = 0, sign = 1;
    for (std::size_t i = 0; i < steps; ++i) {
        const glm::dvec3 way(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
        probes.push_back(to_mesh_frame(structure, radius * way));
        const double turn = kStep / (radius * std::sin(polar));
        around += turn;
        polar += sign * turn * kTurn / (2 * 3.141592653589793 * radius);
        if (polar > 2.9 || polar < 0.2)
            sign = -sign;
    }
    return probes;
}

struct Course {
    MeshStructure structure;
    MeshTables<double> tables;
    std::vector<glm::dvec3> probes;
};

const Course& course(unsigned frequency) {
    static std::map<unsigned, Course> courses;
    const auto found = courses.find(frequency);
    if (found != courses.end())
        return found->second;
    PolygonSoup sphere = geodesic(frequency);
    for (glm::dvec3& v : sphere.vertices)
        v *= kRadius;
    Course made{build_structure(shapes::mesh_of(std::move(sphere))), {}, {}};
    made.tables = make_mesh_tables<double>(made.structure, 500.0);
    find_obstacles(made.tables);
    made.probes = spiral(made.structure, std::size_t(1) << 20);
    return courses.emplace(frequency, std::move(made)).first->second;
}

/// On the whole spiral; or (range 1 above 0) there and back on so many of its steps, whose triangles stay in the
/// caches.
void god_object(benchmark::State& state) {
    const Course& path = course(static_cast<unsigned>(state.range(0)));
    const auto warm = static_cast<std::size_t>(state.range(1));
    const layout::MeshView<double> mesh = path.tables.view();
    auto around = std::make_unique<reference::Neighbourhood<double>>();
    reference::GodObject<double> proxy;
    // The path begins within the sphere: brought in from outside.
    reference::update(mesh, proxy, *around, path.probes[0] * 2.0);
    std::size_t i = 0, substeps = 0, touching = 0;
    for ([[maybe_unused]] auto _ : state) {
        const std::size_t folded = warm > 0 ? i % (2 * warm) : i;
        const auto contact = reference::update(mesh, proxy, *around,
                                               path.probes[folded < warm || warm == 0 ? folded : 2 * warm - folded]);
        benchmark::DoNotOptimize(contact);
        substeps += contact.substeps;
        touching += contact.touching;
        i = (i + 1) & (path.probes.size() - 1);
    }
    const auto updates = static_cast<double>(state.iterations());
    state.counters["updates/s"] = benchmark::Counter(updates, benchmark::Counter::kIsRate);
    state.counters["triangles"] = static_cast<double>(path.structure.triangles());
    state.counters["substeps"] = static_cast<double>(substeps) / updates;
    state.counters["touching"] = static_cast<double>(touching) / updates;
}

double percentile(std::vector<double>& times, double share) {
    const auto place = times.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(times.size() - 1));
    std::nth_element(times.begin(), place, times.end());
    return *place;
}

void god_object_latency(benchmark::State& state) {
    using Clock = std::chrono::steady_clock;
    const Course& path = course(static_cast<unsigned>(state.range(0)));
    const layout::MeshView<double> mesh = path.tables.view();
    auto around = std::make_unique<reference::Neighbourhood<double>>();
    reference::GodObject<double> proxy;
    std::vector<double> times(path.probes.size()), idle(path.probes.size());
    for ([[maybe_unused]] auto _ : state) {
        reference::update(mesh, proxy, *around, path.probes[0] * 2.0);
        for (std::size_t i = 0; i < path.probes.size(); ++i) {
            const auto begin = Clock::now();
            benchmark::DoNotOptimize(reference::update(mesh, proxy, *around, path.probes[i]));
            times[i] = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
        }
        for (double& time : idle) {
            const auto begin = Clock::now();
            time = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
        }
    }
    state.counters["p50 us"] = percentile(times, 0.5);
    state.counters["p99.9 us"] = percentile(times, 0.999);
    state.counters["max us"] = percentile(times, 1.0);
    state.counters["clock p99.9 us"] = percentile(idle, 0.999);
    state.counters["clock max us"] = percentile(idle, 1.0);
}

// 980, 100 820 and 1 003 520 triangles.
BENCHMARK(god_object)->ArgsProduct({{7, 71, 224}, {0, 512}});
BENCHMARK(god_object_latency)->Arg(7)->Arg(71)->Arg(224)->Iterations(1)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace forceshade::bench

BENCHMARK_MAIN();
