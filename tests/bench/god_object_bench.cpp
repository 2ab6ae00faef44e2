// Full updates of the god-object (L6) on one thread, in both precisions: rate, and how long the slowest take beyond
// what the clock itself does. The probe spirals 1 mm deep in a sphere of 25 mm, 0.1 mm a step; or it goes in and out at
// every place of that way, wanders at random about the surface, or strokes a pole where 224 or 1000 facets
// meet.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>
#include <glm/geometric.hpp>

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
constexpr std::size_t kSteps = std::size_t(1) << 20;

/// From pole to pole and back, at constant speed, at a depth that depends on the step.
template <typename Depth> std::vector<glm::dvec3> spiral(Depth&& depth) {
    std::vector<glm::dvec3> probes;
    double polar = 0.2, around = 0, sign = 1;
    for (std::size_t i = 0; i < kSteps; ++i) {
        const double radius = kRadius - depth(i);
        const glm::dvec3 way(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
        probes.push_back(radius * way);
        const double turn = kStep / (radius * std::sin(polar));
        around += turn;
        polar += sign * turn * kTurn / (2 * 3.141592653589793 * radius);
        if (polar > 2.9 || polar < 0.2)
            sign = -sign;
    }
    return probes;
}

/// A probe that a spring draws to the surface while it is pushed about at random.
std::vector<glm::dvec3> random_walk() {
    std::mt19937 random(1);
    const auto push = [&random] { return kStep * (double(random()) / 0x1p31 - 1); };
    std::vector<glm::dvec3> probes;
    glm::dvec3 at(0, 0, kRadius);
    for (std::size_t i = 0; i < kSteps; ++i) {
        at += glm::dvec3(push(), push(), push());
        at += 0.01 * (kRadius / glm::length(at) - 1) * at;
        probes.push_back(at);
    }
    return probes;
}

/// To and fro over the pole, 1 mm deep, each stroke in another direction and past the pole by another distance.
std::vector<glm::dvec3> strokes_over_pole() {
    constexpr std::size_t kStroke = 100; /* steps */
    std::vector<glm::dvec3> probes;
    for (std::size_t i = 0; i < kSteps; ++i) {
        const double angle = double(i / kStroke) * 2.4, past = double(i / kStroke % 16) * 2e-5;
        const double along = (double(i % kStroke) - kStroke / 2.0) * kStep * (i / kStroke % 2 == 0 ? 1 : -1);
        const glm::dvec3 over(along * std::cos(angle) - past * std::sin(angle),
                              along * std::sin(angle) + past * std::cos(angle), kRadius);
        probes.push_back((kRadius - kDepth) * glm::normalize(over));
    }
    return probes;
}

enum Way { on_surface, in_and_out, at_random, over_pole };
// In place of a frequency, how many facets meet at a pole: latitudes and longitudes, about 100 000 triangles.
constexpr int kPole = -224, kLargePole = -1000;

/// `facets` round each pole.
PolygonSoup ringed_sphere(unsigned facets) {
    PolygonSoup sphere;
    sphere.vertices = {{0, 0, 1}, {0, 0, -1}};
    const unsigned rings = 50'000 / facets + 1;
    for (unsigned ring = 1; ring < rings; ++ring)
        for (unsigned i = 0; i < facets; ++i) {
            const double polar = 3.141592653589793 * ring / rings, around = 2 * 3.141592653589793 * i / facets;
            sphere.vertices.emplace_back(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                         std::cos(polar));
        }
    const auto at = [&](unsigned ring, unsigned i) { return 2 + (ring - 1) * facets + i % facets; };
    for (unsigned i = 0; i < facets; ++i) {
        shapes::add_facet(sphere, {0, at(1, i), at(1, i + 1)});
        for (unsigned ring = 1; ring + 1 < rings; ++ring) {
            shapes::add_facet(sphere, {at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
            shapes::add_facet(sphere, {at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
        }
        shapes::add_facet(sphere, {1, at(rings - 1, i + 1), at(rings - 1, i)});
    }
    return sphere;
}

const MeshStructure& sphere(int frequency) {
    static std::map<int, MeshStructure> spheres;
    const auto found = spheres.find(frequency);
    if (found != spheres.end())
        return found->second;
    const PolygonSoup unit =
        frequency < 0 ? ringed_sphere(static_cast<unsigned>(-frequency)) : geodesic(static_cast<unsigned>(frequency));
    const Mesh mesh = shapes::mesh_of(shapes::moved(unit, glm::dvec3(kRadius), {}));
    return spheres.emplace(frequency, build_structure(mesh)).first->second;
}

template <typename T> struct Course {
    MeshTables<T> tables;
    std::vector<glm::vec<3, T>> probes;

    Course(const MeshStructure& structure, Way way) : tables(make_mesh_tables<T>(structure, 500.0)) {
        find_obstacles(tables);
        std::vector<glm::dvec3> world;
        if (way == on_surface)
            world = spiral([](std::size_t) { return kDepth; });
        else if (way == in_and_out)
            world = spiral([](std::size_t i) { return kDepth * std::sin(0.05 * double(i)); });
        else
            world = way == at_random ? random_walk() : strokes_over_pole();
        for (const glm::dvec3& probe : world)
            probes.emplace_back(to_mesh_frame(structure, probe));
    }
};

template <typename T> const Course<T>& course(int frequency, Way way) {
    static std::map<std::pair<int, Way>, Course<T>> courses;
    return courses.try_emplace({frequency, way}, sphere(frequency), way).first->second;
}

/// On the whole way; or (range 1 above 0) there and back on so many of its steps, whose triangles stay in the caches.
template <typename T> void god_object(benchmark::State& state, Way way) {
    const Course<T>& path = course<T>(static_cast<int>(state.range(0)), way);
    const auto warm = static_cast<std::size_t>(state.range(1));
    const layout::MeshView<T> mesh = path.tables.view();
    auto around = std::make_unique<reference::Neighbourhood<T>>();
    reference::GodObject<T> proxy;
    // Some paths begin within the sphere: brought in from outside.
    reference::update(mesh, proxy, *around, path.probes[0] * T(2));
    std::size_t i = 0, substeps = 0, touching = 0;
    for ([[maybe_unused]] auto _ : state) {
        const std::size_t folded = warm > 0 ? i % (2 * warm) : i;
        const auto contact = reference::update(mesh, proxy, *around,
                                               path.probes[folded < warm || warm == 0 ? folded : 2 * warm - folded]);
        benchmark::DoNotOptimize(contact);
        substeps += contact.substeps;
        touching += contact.touching;
        i = (i + 1) % kSteps;
    }
    const auto updates = static_cast<double>(state.iterations());
    state.counters["updates/s"] = benchmark::Counter(updates, benchmark::Counter::kIsRate);
    state.counters["triangles"] = static_cast<double>(path.tables.params.triangles);
    state.counters["substeps"] = static_cast<double>(substeps) / updates;
    state.counters["touching"] = static_cast<double>(touching) / updates;
}

double percentile(std::vector<double>& times, double share) {
    const auto place = times.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(times.size() - 1));
    std::nth_element(times.begin(), place, times.end());
    return *place;
}

template <typename T> void latency(benchmark::State& state, Way way) {
    using Clock = std::chrono::steady_clock;
    const Course<T>& path = course<T>(static_cast<int>(state.range(0)), way);
    const layout::MeshView<T> mesh = path.tables.view();
    auto around = std::make_unique<reference::Neighbourhood<T>>();
    reference::GodObject<T> proxy;
    std::vector<double> times(path.probes.size()), idle(path.probes.size());
    for ([[maybe_unused]] auto _ : state) {
        reference::update(mesh, proxy, *around, path.probes[0] * T(2));
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

template <typename T> void add(const std::string& precision) {
    const std::vector<std::int64_t> spheres{7, 71, 224}; // 980, 100 820 and 1 003 520 triangles
    const auto rate = [&](const std::string& name, Way way) {
        return benchmark::RegisterBenchmark((name + '/' + precision).c_str(), god_object<T>, way);
    };
    rate("spiral", on_surface)->ArgsProduct({spheres, {0, 512}});
    rate("in and out", in_and_out)->ArgsProduct({spheres, {0}});
    rate("random walk", at_random)->ArgsProduct({spheres, {0}});
    rate("pole", over_pole)->ArgsProduct({{kPole, kLargePole}, {0}});
    const auto slowest = [&](const std::string& name, Way way) {
        return benchmark::RegisterBenchmark((name + " latency/" + precision).c_str(), latency<T>, way)
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
    };
    slowest("spiral", on_surface)->ArgsProduct({spheres});
    slowest("pole", over_pole)->Arg(kPole)->Arg(kLargePole);
}

[[maybe_unused]] const bool kAdded = (add<double>("f64"), add<float>("f32"), true);

} // namespace
} // namespace forceshade::bench
