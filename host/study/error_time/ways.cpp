#include "host/study/error_time/ways.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/paths/scene_paths.h"
#include "host/reference/field.h"
#include "host/reference/paths.h"
#include "host/study/error_time/law_at.h"
#include "host/study/error_time/volume.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kTimedPlaces = 2048;
constexpr std::size_t kGridPlaces = 2000; // of a grid, at which it is held against the truth
constexpr double kShortest = 1e-3;        // s: of a measurement
constexpr const char* kGodObject = "god-object";

template <typename T> constexpr const char* kPrecision = std::is_same_v<T, float> ? "f32" : "f64";

// What is made when it is first wanted, and then kept.
template <typename Make> auto lazily(Make make) {
    auto kept = std::make_shared<std::optional<decltype(make())>>();
    return [ kept, make ]() -> auto& {
        if (!*kept)
            kept->emplace(make());
        return **kept;
    };
}

// Measures the seconds of one of `count` evaluations that pass() does, by as many passes as take a millisecond or more.
// What pass() returns is used, so that nothing is left out.
template <typename Pass> std::function<double()> timed(std::size_t count, Pass pass) {
    return [count, pass, passes = std::size_t(0), sink = 0.0]() mutable {
        const auto run = [&](std::size_t times) {
            const Clock::time_point start = Clock::now();
            for (std::size_t i = 0; i < times; ++i)
                sink += pass();
            return seconds_since(start);
        };
        if (passes == 0) {
            run(1);
            passes = static_cast<std::size_t>(std::fmin(1000, std::ceil(kShortest / std::fmax(run(1), 1e-6))));
        }
        const double seconds = run(passes);
        volatile double kept = sink;
        static_cast<void>(kept);
        return seconds / static_cast<double>(passes * count);
    };
}

// The places at which live ways are timed.
std::span<const Place> timed_places(const Subject& subject) {
    return std::span(subject.places).first(std::min(kTimedPlaces, subject.places.size()));
}

template <typename T> double sum_of(const reference::Vector<T>& force) {
    return static_cast<double>(force.x) + static_cast<double>(force.z);
}

Way way_of(const Subject& subject, const Variant& variant, Use use, const std::string& family,
           const std::string& precision) {
    Way way;
    way.name = fmt::format("{}, {}: {} {}", subject.name, variant.name, family, precision);
    way.subject = &subject;
    way.variant = &variant;
    way.use = use;
    way.family = family;
    way.precision = precision;
    return way;
}

template <typename T> Way direct(const Subject& subject, const Variant& variant) {
    Way way = way_of(subject, variant, Use::live, "direct", kPrecision<T>);
    way.forces = [&variant](std::span<const Place> at) { return direct_forces<T>(*variant.prepared, at); };
    struct Loop {
        std::unique_ptr<DirectLaw<T>> law;
        std::vector<reference::Vector<T>> places;
    };
    const auto loop = lazily([&] {
        std::vector<glm::dvec3> world;
        for (const Place& place : timed_places(subject))
            world.push_back(place.at);
        return Loop{std::make_unique<DirectLaw<T>>(*variant.prepared), rounded_places<T>(*variant.prepared, world)};
    });
    way.seconds = timed(timed_places(subject).size(), [loop] {
        auto& [law, places] = loop();
        double sum = 0;
        for (const reference::Vector<T>& place : places)
            sum += sum_of(law->at(place).force);
        return sum;
    });
    return way;
}

template <typename T> Way god_object(const Subject& subject, const Variant& variant) {
    Way way = way_of(subject, variant, Use::live, kGodObject, kPrecision<T>);
    way.forces = [&](std::span<const Place> at) { return proxy_forces<T>(*variant.prepared, at, subject.scale); };
    struct Loop {
        std::unique_ptr<ProxyLaw<T>> law;
        std::vector<std::vector<reference::Vector<T>>> descents;
    };
    const auto loop = lazily([&] {
        Loop made{std::make_unique<ProxyLaw<T>>(*variant.prepared), {}};
        for (const Place& place : timed_places(subject))
            made.descents.push_back(rounded_places<T>(*variant.prepared, descent(place, subject.scale)));
        return made;
    });
    way.seconds = timed(kDescent * timed_places(subject).size(), [loop] {
        auto& [law, descents] = loop();
        double sum = 0;
        for (const auto& one : descents)
            sum += sum_of(law->force(one));
        return sum;
    });
    return way;
}

template <typename Stored, typename Volume>
Way lookup(const Subject& subject, const Variant& variant, const VolumeGrid& grid, bool cubic, const Volume& volume) {
    const bool half = sizeof(Stored) == 2;
    Way way = way_of(subject, variant, Use::live, cubic ? "look-up, tricubic" : "look-up, trilinear",
                     half ? "f32, half stored" : "f32");
    way.name = fmt::format("{}, {}: {} {:.3g} mm{}", subject.name, variant.name, way.family, grid.spacing * 1e3,
                           half ? ", half stored" : "");
    way.spacing = grid.spacing;
    way.bytes = static_cast<double>(3 * sizeof(Stored) * grid.samples());
    const auto read = [volume, cubic](const reference::Vector<float>& place) {
        return cubic ? volume().tricubic(place) : volume().trilinear(place);
    };
    way.forces = [read](std::span<const Place> at) {
        std::vector<glm::dvec3> forces;
        for (const Place& place : at)
            forces.emplace_back(read(reference::Vector<float>(place.at)));
        return forces;
    };
    const auto places = lazily([&] {
        std::vector<reference::Vector<float>> made;
        for (const Place& place : timed_places(subject))
            made.emplace_back(place.at);
        return made;
    });
    way.seconds = timed(timed_places(subject).size(), [places, read] {
        double sum = 0;
        for (const reference::Vector<float>& place : places())
            sum += sum_of(read(place));
        return sum;
    });
    return way;
}

void add_lookups(std::vector<Way>& ways, const Subject& subject, const Variant& variant) {
    for (const double spacing : subject.spacings) {
        const VolumeGrid grid = volume_grid(subject.low, subject.high, spacing);
        const auto volume = lazily(
            [&variant, grid] { return ForceVolume<float, float>(grid, sampled<float>(*variant.prepared, grid)); });
        const auto halves = lazily([&variant, grid] {
            return ForceVolume<Half, float>(grid, halves_of(sampled<float>(*variant.prepared, grid)));
        });
        ways.push_back(lookup<float>(subject, variant, grid, false, volume));
        ways.push_back(lookup<float>(subject, variant, grid, true, volume));
        ways.push_back(lookup<Half>(subject, variant, grid, false, halves));
    }
}

// Evaluates a grid, and hands its chunks on; returns seconds.
template <typename T> using TakeField = std::function<void(const layout::FieldChunk<T>&)>;
template <typename T> using EvaluateGrid = std::function<double(const layout::FieldInput<T>&, const TakeField<T>&)>;

// Voxels at which a hand would touch, and the forces there.
struct TouchedVoxels {
    std::vector<Place> at;
    std::vector<glm::dvec3> forces;
};

template <typename T>
TouchedVoxels touched_voxels(const Subject& subject, const FieldTables<T>& tables, const EvaluateGrid<T>& evaluate) {
    TouchedVoxels all;
    evaluate(tables.input(), [&](const layout::FieldChunk<T>& chunk) {
        for (std::size_t z = 0; z < chunk.z_count; ++z)
            for (std::size_t y = 0; y < chunk.y_count; ++y)
                for (std::size_t x = 0; x < chunk.x_count; ++x) {
                    const std::size_t index[3] = {x, chunk.y_first + y, chunk.z_first + z};
                    Place place;
                    for (int i = 0; i < 3; ++i) {
                        const auto axis = static_cast<std::size_t>(i);
                        place.at[i] =
                            subject.grid.origin[axis] + subject.grid.spacing[axis] * static_cast<double>(index[axis]);
                    }
                    const glm::dvec3 force(
                        reference::vector_at(chunk.force, (z * chunk.y_count + y) * chunk.x_pitch + x));
                    if (force == glm::dvec3(0))
                        continue;
                    place.normal = force / reference::length(force);
                    place.depth = reference::length(force) / subject.stiffness;
                    if (place.depth < subject.scale.shallowest() || place.depth > subject.scale.deepest)
                        continue;
                    all.at.push_back(place);
                    all.forces.push_back(force);
                }
    });
    const std::size_t stride = all.at.size() / kGridPlaces + 1;
    TouchedVoxels some;
    for (std::size_t i = 0; i < all.at.size(); i += stride) {
        some.at.push_back(all.at[i]);
        some.forces.push_back(all.forces[i]);
    }
    return some;
}

template <typename T>
Way grid_way(const Subject& subject, const Variant& variant, const std::string& family,
             const EvaluateGrid<T>& evaluate) {
    Way way = way_of(subject, variant, Use::volume, family, kPrecision<T>);
    const auto tables = lazily([&] {
        Scene scene = variant.prepared->one.scene;
        scene.grid = subject.grid;
        scene.output.channels = layout::kChannelForce;
        return make_tables<T>(scene, variant.prepared->images, Extent::everything);
    });
    const auto touched =
        lazily([&subject, tables, evaluate] { return touched_voxels<T>(subject, tables(), evaluate); });
    way.places = [touched] { return touched().at; };
    way.forces = [touched](std::span<const Place>) { return touched().forces; };
    way.seconds = [tables, evaluate] {
        const auto voxels = static_cast<double>(tables().x.size() * tables().y.size() * tables().z.size());
        // A small grid is over in a millisecond, of which one says little: the median of three.
        double seconds[3];
        for (double& one : seconds)
            one = evaluate(tables().input(), [](const layout::FieldChunk<T>&) {}) / voxels;
        std::ranges::sort(seconds);
        return seconds[1];
    };
    return way;
}

template <typename T> EvaluateGrid<T> grid_on_engine(Engine& engine) {
    return [&engine](const layout::FieldInput<T>& input, const TakeField<T>& take) {
        const EngineTimes times = engine.evaluate(input, take);
        return times.kernel + times.plan;
    };
}

template <typename T> double grid_on_one_thread(const layout::FieldInput<T>& input, const TakeField<T>& take) {
    reference::FieldOptions options;
    options.threads = 1;
    double seconds = 0;
    Clock::time_point start = Clock::now();
    reference::evaluate_field<T>(input, options, [&](const layout::FieldChunk<T>& chunk) {
        seconds += seconds_since(start);
        take(chunk);
        start = Clock::now();
    });
    return seconds;
}

// Takes all paths through their law; returns seconds.
template <typename T> using Explore = std::function<double(const layout::PathInput<T>&)>;

// Steps of a hand that presses a probe along the surface. Where the probe is then depends on all forces before: a step
// has a time, and no error of its own.
template <typename T>
Way closed_loop(const Subject& subject, const Variant& variant, const std::string& family, const Explore<T>& explore) {
    Way way = way_of(subject, variant, Use::loop, family, kPrecision<T>);
    struct Walk {
        std::unique_ptr<ScenePaths<T>> source;
        layout::PathInput<T> input;
    };
    const auto walk = lazily([&] {
        Walk made{std::make_unique<ScenePaths<T>>(*variant.prepared), {}};
        made.input = made.source->input();
        made.input.features.channels = 0;
        return made;
    });
    way.seconds = [walk, explore] {
        const layout::PathInput<T>& input = walk().input;
        return explore(input) / static_cast<double>(input.paths * input.steps);
    };
    return way;
}

template <typename T> Explore<T> loop_on_engine(Engine& engine) {
    return [&engine](const layout::PathInput<T>& input) {
        return engine
            .explore(
                input, [](const layout::PathChunk<T>&) {}, [](std::size_t, std::span<const layout::PathMetrics<T>>) {})
            .kernel;
    };
}

template <typename T> double loop_on_one_thread(const layout::PathInput<T>& input) {
    reference::PathOptions options;
    options.threads = 1;
    const Clock::time_point start = Clock::now();
    reference::evaluate_paths<T>(
        input, options, [](const layout::PathChunk<T>&) {},
        [](std::size_t, std::span<const layout::PathMetrics<T>>) {});
    return seconds_since(start);
}

void add_thorough(std::vector<Way>& ways, const Subject& subject, const Variant& variant, Engine& engine) {
    const EngineReport report = engine.report();
    const std::string by = report.engine == "gpu" ? "kernel" : "CPU on all cores", alone = "CPU on one thread";
    ways.push_back(grid_way<float>(subject, variant, "field, " + by, grid_on_engine<float>(engine)));
    if (report.f64)
        ways.push_back(grid_way<double>(subject, variant, "field, " + by, grid_on_engine<double>(engine)));
    ways.push_back(grid_way<float>(subject, variant, "field, " + alone, grid_on_one_thread<float>));
    ways.push_back(grid_way<double>(subject, variant, "field, " + alone, grid_on_one_thread<double>));
    ways.push_back(closed_loop<float>(subject, variant, "closed loop, " + by, loop_on_engine<float>(engine)));
    if (report.f64)
        ways.push_back(closed_loop<double>(subject, variant, "closed loop, " + by, loop_on_engine<double>(engine)));
    ways.push_back(closed_loop<float>(subject, variant, "closed loop, " + alone, loop_on_one_thread<float>));
    ways.push_back(closed_loop<double>(subject, variant, "closed loop, " + alone, loop_on_one_thread<double>));
}

} // namespace

const char* name_of(Use use) {
    constexpr const char* kNames[] = {"live", "volume", "loop"};
    return kNames[static_cast<std::size_t>(use)];
}

void add_ways(std::vector<Way>& ways, const Subject& subject, Engine& engine) {
    for (const Variant& variant : subject.variants) {
        ways.push_back(direct<double>(subject, variant));
        ways.push_back(direct<float>(subject, variant));
        if (variant.prepared->images.mesh) {
            ways.push_back(god_object<double>(subject, variant));
            ways.push_back(god_object<float>(subject, variant));
        }
        if (variant.lookups)
            add_lookups(ways, subject, variant);
        if (variant.thorough)
            add_thorough(ways, subject, variant, engine);
    }
}

std::vector<glm::dvec3> exact_forces(const Way& way, std::span<const Place> at) {
    const PreparedCase& prepared = *way.variant->prepared;
    return way.family == kGodObject ? proxy_forces<double>(prepared, at, way.subject->scale)
                                    : direct_forces<double>(prepared, at);
}

} // namespace forceshade::study::error_time
