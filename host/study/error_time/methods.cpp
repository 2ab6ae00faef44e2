#include "host/study/error_time/subject.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <type_traits>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/field/case_law.h"
#include "host/field/engine.h"
#include "host/norm.h"
#include "host/numbers.h"
#include "host/paths/scene_paths.h"
#include "host/random.h"
#include "host/reference/chunks.h"
#include "host/study/error_time/volumes.h"
#include "host/study/study_run.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kTimedPlaces = 2048;
constexpr std::size_t kStride = 617;      // from one place evaluated alone to the next: no neighbour
constexpr std::size_t kGridPlaces = 2000; // of a grid, at which it is compared with the truth
constexpr std::size_t kShare = 1024;      // of them that a thread takes at once
constexpr double kShortest = 1e-3;        // s: of a measurement
constexpr double kTilt = 2 * kDegree;     // of a volume, at most: more wants much larger ones

template <typename T> constexpr const char* kPrecision = forceshade::name_of(kPrecisionOf<T>);

// Makes a value on first use, which no other thread may share, and keeps it.
template <typename Make> auto lazily(Make make) {
    auto kept = std::make_shared<std::optional<decltype(make())>>();
    return [ kept, make ]() -> auto& {
        if (!*kept)
            kept->emplace(make());
        return **kept;
    };
}

double clock_now() {
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

// Measures the seconds of one of the `count` evaluations of pass(), by as many passes as take a millisecond or more, by
// a clock in s: thread_seconds where one thread computes. The result of pass() is used, so that the compiler removes no
// part of it.
template <typename Pass> std::function<double()> timed(double (*now)(), std::size_t count, Pass pass) {
    return [now, count, pass, passes = std::size_t(0), sink = 0.0]() mutable {
        const auto run = [&](std::size_t times) {
            const double start = now();
            for (std::size_t i = 0; i < times; ++i)
                sink += pass();
            return now() - start;
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

// Evaluations in a law's force(): those of a law with a history are timed one by one.
template <typename Law> constexpr std::size_t kUpdatesOf = 1;
template <typename T, bool hint> constexpr std::size_t kUpdatesOf<ProxyForce<T, hint>> = ProxyForce<T, hint>::kUpdates;

// How a volume is stored and read.
enum class Reading { trilinear, tricubic, depth, band, adaptive };
constexpr const char* kFamilies[] = {"look-up, trilinear", "look-up, tricubic", "look-up, depth and direction",
                                     "look-up, narrow band", "look-up, adaptive"};

struct Sampled {
    std::vector<float> forces; /* N, 3 a sample */
    double seconds = 0;        /* that it took */
};

// s: of as many bytes from a file that the system has just written.
double loading_seconds(double bytes) {
    std::vector<char> data(static_cast<std::size_t>(bytes), '\1');
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(),
                                                               [](std::FILE* f) { return std::fclose(f); });
    if (!file || std::fwrite(data.data(), 1, data.size(), file.get()) != data.size())
        return NAN; // nowhere to write
    data = {};
    std::rewind(file.get());
    const Clock::time_point start = Clock::now();
    data.resize(static_cast<std::size_t>(bytes));
    const bool whole = std::fread(data.data(), 1, data.size(), file.get()) == data.size();
    return whole ? seconds_since(start) : NAN;
}

// A look-up volume as a law.
template <Reading R, typename Stored> class LookUp {
    using Whole = Volume<Stored, float, R == Reading::depth ? 4 : 3>;
    using Stores = std::conditional_t<R == Reading::band, NarrowBand,
                                      std::conditional_t<R == Reading::adaptive, AdaptiveVolume, Whole>>;

public:
    /// `deepest`, N: the force where a hand is deepest.
    LookUp(const PreparedCase& prepared, const TurnedGrid& grid, const Sampled& sampled, double deepest)
        : grid_(grid), begun_(Clock::now()), volume_(stores_of(prepared, grid, sampled.forces, float(deepest))),
          stiffness_(float(prepared.one.scene.force.stiffness)),
          built_{volume_.bytes(),
                 seconds_since(begun_) + (R == Reading::depth || R == Reading::adaptive ? 0 : sampled.seconds)} {}

    const Built& built() {
        if (built_.loading == 0)
            built_.loading = loading_seconds(built_.bytes);
        return built_;
    }

    reference::Vector<float> input(const TouchPlace& place) const {
        return reference::Vector<float>(grid_.in_grid(place.at));
    }
    reference::Vector<float> force(const reference::Vector<float>& at) const noexcept {
        if constexpr (R == Reading::tricubic) {
            return volume_.tricubic(at);
        } else if constexpr (R == Reading::depth) {
            const auto read = volume_.trilinear(at);
            const reference::Vector<float> direction(read.y, read.z, read.w);
            return read.x > 0 ? stiffness_ * read.x / reference::length(direction) * direction
                              : reference::Vector<float>(0.0F);
        } else if constexpr (R == Reading::trilinear) {
            return volume_.trilinear(at);
        } else {
            return volume_(at);
        }
    }

private:
    static Stores stores_of(const PreparedCase& prepared, const TurnedGrid& grid, const std::vector<float>& forces,
                            float deepest) {
        // Depth that is read vertically is up to twice that along the normal.
        if constexpr (R == Reading::band) {
            return {grid.grid, forces, 2 * deepest};
        } else if constexpr (R == Reading::adaptive) {
            const CaseLaw<float> law(prepared);
            layout::uint hint = 0;
            const auto force = [&](const glm::dvec3& at) { return law.at(grid.in_world(at), hint).force; };
            return {grid.grid, force, 2 * deepest, double(sizeof(float) * forces.size())};
        } else if constexpr (R == Reading::depth) {
            return {grid.grid, sampled_depths(prepared, grid)};
        } else {
            return {grid.grid, {forces.begin(), forces.end()}};
        }
    }

    TurnedGrid grid_;
    Clock::time_point begun_;
    Stores volume_;
    float stiffness_; /* N/m */
    Built built_;
};

// Voxels at which a hand would touch, and the forces there.
struct TouchedVoxels {
    std::vector<TouchPlace> at;
    std::vector<glm::dvec3> forces;
};

template <typename T>
TouchedVoxels touched_voxels(const Subject& subject, const GridSpec& grid, const FieldTables<T>& tables,
                             Engine& engine) {
    const std::vector<T> field = evaluate(tables.input(), 1, engine).force;
    TouchedVoxels all;
    for (std::size_t i = 0; i < field.size() / 3; ++i) {
        const glm::dvec3 force(field[3 * i], field[3 * i + 1], field[3 * i + 2]);
        const double size = reference::length(force), depth = size / subject.stiffness;
        if (size == 0 || depth < subject.scale.shallowest() || depth > subject.scale.deepest)
            continue;
        const std::size_t x = i % grid.size[0], y = i / grid.size[0] % grid.size[1];
        all.at.push_back({sample_place(grid, x, y, i / grid.size[0] / grid.size[1]), force / size, depth});
        all.forces.push_back(force);
    }
    TouchedVoxels some;
    for (std::size_t i = 0; i < all.at.size(); i += all.at.size() / kGridPlaces + 1) {
        some.at.push_back(all.at[i]);
        some.forces.push_back(all.forces[i]);
    }
    return some;
}

// Adds the methods of a law.
class MethodBuilder {
    template <typename T> auto direct_law() const {
        return [&prepared = *variant_.prepared] { return std::make_unique<StaticForce<T>>(prepared); };
    }

    // By a new instance of a law.
    template <typename Make> static ForcesAt forces_of(Make make) {
        return [make](std::span<const TouchPlace> at) { return forces_by(*make(), at); };
    }

public:
    MethodBuilder(std::vector<Method>& methods, const Subject& subject, const Variant& variant, std::size_t draw)
        : methods_(methods), subject_(subject), variant_(variant.at(draw)), draw_(draw),
          random_(subject.seed(Subject::Random::grids, draw)) {}

    void add_direct() {
        add_laws("direct", [&]<typename T>(T) { return direct_law<T>(); });
    }
    void add_god_object() {
        add_laws("god-object", [&]<typename T>(T) {
            return [&prepared = *variant_.prepared, &scale = subject_.scale] {
                return std::make_unique<ProxyForce<T>>(prepared, scale);
            };
        });
    }
    // Its errors are the god-object's, to the bit: it has none of its own.
    void add_god_object_without_hint() {
        const auto add_one = [&]<typename T>(T) {
            set_law(add(Use::live, "god-object, without a hint", kPrecision<T>), [&prepared = *variant_.prepared,
                                                                                  &scale = subject_.scale] {
                return std::make_unique<ProxyForce<T, false>>(prepared, scale);
            }).forces = nullptr;
        };
        add_one(0.0);
        add_one(0.0F);
    }
    // Many places at once, as Python's force() takes them; by 1, 2, 4 ... threads and all.
    template <typename T> void add_batches() {
        const auto law = lazily([&prepared = *variant_.prepared] { return std::make_unique<CaseLaw<T>>(prepared); });
        const auto inputs = lazily([law, &places = subject_.places] {
            std::vector<reference::Vector<T>> all;
            for (std::size_t i = 0; i < kBatch; ++i)
                all.push_back(law()->rounded(places[i % std::min(kTimedPlaces, places.size())].at));
            return all;
        });
        const auto add_by = [&](const std::string& threads_text, std::size_t threads) {
            add(Use::batch, "direct, a batch on " + threads_text, kPrecision<T>).seconds =
                timed(clock_now, kBatch, [law, inputs, threads] {
                    const CaseLaw<T>& one = *law(); // made here, before threads share them
                    const auto& at = inputs();
                    std::vector<double> sums(kBatch / kShare);
                    reference::share_out(threads, sums.size(), [&](std::size_t, std::size_t share) {
                        layout::uint hint = 0;
                        for (std::size_t i = share * kShare; i < (share + 1) * kShare; ++i)
                            sums[share] += static_cast<double>(one.at_rounded(at[i], hint).force.z);
                    });
                    return std::accumulate(sums.begin(), sums.end(), 0.0);
                });
        };
        const std::size_t all = reference::threads_for(0);
        for (std::size_t threads = 1; threads < all; threads *= 2)
            add_by(numbers::counted(threads, "thread"), threads);
        add_by("all threads", all);
    }
    void add_lookups() {
        for (const double spacing : subject_.spacings) {
            const glm::dvec3 offset(random_(0, 1), random_(0, 1), random_(0, 1));
            const double turn = random_(0, 2 * std::numbers::pi), tilt = random_(0, kTilt),
                         aside = random_(0, 2 * std::numbers::pi);
            const TurnedGrid grid(subject_.low, subject_.high, spacing, offset,
                                  draw_ > 0 ? turn_and_tilt(turn, tilt, aside) : glm::dmat3(1));
            const auto values = lazily([&prepared = *variant_.prepared, grid] {
                const Clock::time_point start = Clock::now();
                Sampled forces{sampled(prepared, grid)};
                forces.seconds = seconds_since(start);
                return forces;
            });
            add_lookup<Reading::trilinear, float>(grid, values);
            add_lookup<Reading::tricubic, float>(grid, values);
            add_lookup<Reading::trilinear, half>(grid, values);
            add_lookup<Reading::band, float>(grid, values);
            add_lookup<Reading::adaptive, float>(grid, values);
            if (has_depths(*variant_.prepared))
                add_lookup<Reading::depth, float>(grid, values);
        }
    }

    // Its own rounding is its error against the law that it stands for.
    void add_renderer(RendererProcess& renderer, const std::string& name) {
        Method& method = add(Use::live, "renderer, " + name, kPrecision<double>);
        const auto descent_to = [&scale = subject_.scale](const TouchPlace& place) { return descent(place, scale); };
        const auto force_at = [&renderer, descent_to, name](const TouchPlace& place) {
            renderer.begin_path();
            try {
                return renderer.update(descent_to(place));
            } catch (const RendererError& error) {
                throw RendererError(name + " " + error.what(), error.update);
            }
        };
        method.forces = [force_at](std::span<const TouchPlace> at) {
            std::vector<glm::dvec3> forces;
            for (const TouchPlace& place : at)
                forces.push_back(force_at(place).back().force);
            return forces;
        };
        if (variant_.prepared->images.mesh)
            method.exact = forces_of([&prepared = *variant_.prepared, &scale = subject_.scale] {
                return std::make_unique<ProxyForce<double>>(prepared, scale);
            });
        const std::span<const TouchPlace> places =
            std::span(subject_.places).first(std::min(kTimedPlaces, subject_.places.size()));
        method.seconds = [force_at, places] {
            double seconds = 0;
            for (const TouchPlace& place : places)
                for (const RendererAnswer& answer : force_at(place))
                    seconds += answer.seconds;
            return seconds / double(kDescent * places.size());
        };
        method.once = [&renderer, descent_to, places](std::size_t number) {
            const std::size_t update = number % kDescent;
            if (update == 0)
                renderer.begin_path();
            return renderer.update(descent_to(places[number / kDescent * kStride % places.size()])[update]).seconds;
        };
    }

    // Where free space is visited the forces are the same to the bit: it has no errors of its own.
    template <typename T> void add_field(const std::string& by, Engine& engine, FreeSpace free = FreeSpace::skipped) {
        const bool visits = free == FreeSpace::visited;
        Method& method = add(Use::volume, fmt::format("field, {}{}", by, visits ? ", every block" : ""), kPrecision<T>);
        GridSpec grid = subject_.grid;
        for (std::size_t axis = 0; axis < 3; ++axis)
            grid.origin[axis] -= draw_ > 0 ? random_(0, 1) * grid.spacing[axis] : 0;
        const auto tables = lazily([grid, &prepared = *variant_.prepared] {
            Scene scene = prepared.one.scene;
            scene.grid = grid;
            scene.output.channels = layout::kChannelForce;
            return make_tables<T>(scene, prepared.images, Extent::everything);
        });
        const auto touched = lazily([this_subject = &subject_, grid, tables, &engine] {
            return touched_voxels<T>(*this_subject, grid, tables(), engine);
        });
        if (!visits) {
            method.places = [touched] { return touched().at; };
            method.forces = [touched](std::span<const TouchPlace>) { return touched().forces; };
        }
        method.seconds = [tables, free, &engine] {
            const auto voxels = static_cast<double>(tables().x.size() * tables().y.size() * tables().z.size());
            // A small grid takes about a millisecond, too short for one measurement: then the median of three.
            constexpr double kEnough = 20e-3; /* s */
            std::vector<double> seconds;
            do {
                const EngineTimes times = study::evaluate<T>(engine, tables().input(), free, [](const auto&) {});
                seconds.push_back(times.kernel + times.plan);
            } while (seconds.size() < 3 && seconds.front() < kEnough);
            return quantile(seconds, 0.5) / voxels;
        };
    }

    // Steps of a hand that presses a probe along the surface. The probe's position depends on all forces before: a step
    // has a time, and no error of its own.
    template <typename T> void add_closed_loop(const std::string& by, Engine& engine) {
        const auto paths =
            lazily([&prepared = *variant_.prepared] { return std::make_unique<ScenePaths<T>>(prepared); });
        add(Use::loop, "closed loop, " + by, kPrecision<T>).seconds = [paths, &engine] {
            layout::PathInput<T> input = paths()->input();
            input.features.channels = 0;
            const EngineTimes times = engine.explore<T>(
                input, [](const auto&) {}, [](std::size_t, const auto&) {});
            return times.kernel / static_cast<double>(input.paths * input.steps);
        };
    }

private:
    Method& add(Use use, const std::string& family, const std::string& precision) {
        Method method;
        method.name = fmt::format("{}, {}: {} {}", subject_.name, variant_.name, family, precision);
        method.subject = &subject_;
        method.variant = &variant_;
        method.use = use;
        method.family = family;
        method.precision = precision;
        method.exact = forces_of(direct_law<double>());
        return methods_.emplace_back(std::move(method));
    }

    // A law in both precisions.
    template <typename MakeOf> void add_laws(const std::string& family, const MakeOf& make_of) {
        const ForcesAt exact = forces_of(make_of(0.0));
        const auto add_law = [&](const char* precision, const auto& make) {
            Method& method = set_law(add(Use::live, family, precision), make);
            method.exact = exact;
        };
        add_law("f64", make_of(0.0));
        add_law("f32", make_of(0.0F));
    }

    template <typename Make> Method& set_law(Method& method, Make make) const {
        constexpr std::size_t updates = kUpdatesOf<std::decay_t<decltype(*make())>>;
        method.forces = forces_of(make);
        const std::span<const TouchPlace> places =
            std::span(subject_.places).first(std::min(kTimedPlaces, subject_.places.size()));
        const auto loop = lazily([make, places] {
            auto law = make();
            std::vector<decltype(law->input(places[0]))> inputs;
            for (const TouchPlace& place : places)
                inputs.push_back(law->input(place));
            return std::pair(std::move(law), std::move(inputs));
        });
        method.seconds = timed(thread_seconds, updates * places.size(), [loop] {
            auto& [law, inputs] = loop();
            double sum = 0;
            for (const auto& input : inputs) {
                const auto force = law->force(input);
                sum += static_cast<double>(force.x) + static_cast<double>(force.z);
            }
            return sum;
        });
        method.once = [loop](std::size_t number) {
            auto& law = loop().first;
            const auto& inputs = loop().second;
            const auto& input = inputs[number / updates * kStride % inputs.size()];
            const auto evaluate = [&law, &input, i = number % updates] {
                if constexpr (updates > 1)
                    return law->update(input, i);
                else
                    return law->force(input);
            };
            const Clock::time_point start = Clock::now();
            const auto force = evaluate();
            volatile double kept = static_cast<double>(force.x) + static_cast<double>(force.z);
            static_cast<void>(kept);
            return seconds_since(start);
        };
        return method;
    }

    template <Reading R, typename Stored, typename Values>
    void add_lookup(const TurnedGrid& grid, const Values& values) {
        constexpr bool kHalves = std::is_same_v<Stored, half>;
        Method& method = add(Use::live, kFamilies[std::size_t(R)], kHalves ? "f32, half stored" : "f32");
        method.spacing = grid.grid.spacing[0];
        method.name = fmt::format("{}, {}: {} {:.3g} mm{}", subject_.name, variant_.name, method.family,
                                  *method.spacing * 1e3, kHalves ? ", half stored" : "");
        const double deepest = subject_.stiffness * subject_.scale.deepest;
        const auto law = lazily([&prepared = *variant_.prepared, grid, values, deepest] {
            return std::make_shared<LookUp<R, Stored>>(prepared, grid, values(), deepest);
        });
        set_law(method, [law] { return law(); });
        method.built = [law] { return law()->built(); };
    }

    std::vector<Method>& methods_;
    const Subject& subject_;
    const Variant& variant_; /* of this draw */
    std::size_t draw_;
    Random random_;
};

} // namespace

const char* name_of(Use use) {
    constexpr const char* kNames[] = {"live", "batch", "volume", "loop"};
    return kNames[static_cast<std::size_t>(use)];
}

void add_renderer(std::vector<Method>& methods, const Subject& subject, const Variant& variant,
                  RendererProcess& renderer, const std::string& name) {
    MethodBuilder(methods, subject, variant, 0).add_renderer(renderer, name);
    try {
        for (const glm::dvec3& force : methods.back().forces(subject.places))
            if (!is_force(force))
                throw RendererError(name + " gave a force that is not finite", std::nullopt);
    } catch (const RendererError&) {
        methods.pop_back();
        throw;
    }
}

void add_methods(std::vector<Method>& methods, const Subject& subject, const Variant& variant, std::size_t draw,
                 const Engines& engines) {
    auto& [engine, single_thread] = engines;
    const EngineReport report = engine.report();
    const std::string by = report.engine == "gpu" ? "kernel" : "CPU on all cores", by_one = "CPU on one thread";
    MethodBuilder law(methods, subject, variant, draw);
    law.add_direct();
    if (variant.prepared->images.mesh)
        law.add_god_object();
    if (!variant.thorough)
        return;
    if (variant.prepared->images.mesh)
        law.add_god_object_without_hint();
    law.add_batches<float>();
    law.add_batches<double>();
    law.add_lookups();
    law.add_field<float>(by, engine);
    if (report.f64)
        law.add_field<double>(by, engine);
    if (variant.prepared->images.mesh) {
        law.add_field<float>(by, engine, FreeSpace::visited);
        law.add_field<float>(by_one, single_thread, FreeSpace::visited);
    }
    law.add_field<float>(by_one, single_thread);
    law.add_field<double>(by_one, single_thread);
    law.add_closed_loop<float>(by, engine);
    if (report.f64)
        law.add_closed_loop<double>(by, engine);
    law.add_closed_loop<float>(by_one, single_thread);
    law.add_closed_loop<double>(by_one, single_thread);
}

} // namespace forceshade::study::error_time
