// One way of coming by a force: what it costs, and how far off it is.
#pragma once

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "host/engine/engine.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {

template <typename T> constexpr const char* kPrecision = std::is_same_v<T, float> ? "f32" : "f64";

/// Forces at places of the world.
struct Evaluated {
    std::vector<glm::dvec3> at;    /* m */
    std::vector<glm::dvec3> force; /* N */
};

struct Contender {
    std::string name;                   /* unique */
    std::string subject;                /* Subject::name */
    std::string against = kSmoothShape; /* Subject::against */
    std::string family;                 /* "direct", "field, kernel", "look-up, trilinear", "god-object", ... */
    std::string shading;                /* as in scenes */
    std::string precision;              /* "f64", "f32", "f32, half output" */
    std::optional<double> facets, cells, spacing; /* 1, 1, m */
    std::optional<double> bytes;                  /* of the volume */
    std::string reference;               /* the contender that is the same law by reference<double>, on one thread */
    std::function<Evaluated()> evaluate; /* empty: has no errors here */
    std::function<std::vector<glm::dvec3>(const std::vector<glm::dvec3>&)> exact;  /* reference<double> at places */
    std::function<std::vector<glm::dvec3>(const std::vector<glm::dvec3>&)> smooth; /* empty: Subject::smooth */
    std::function<double()> seconds;                                               /* of an evaluation, measured now */
};

using Contenders = std::vector<Contender>;

/// Direct evaluation in f64 and f32, with half output, and the god-object: one thread, one place after the other.
void add_direct(Contenders& contenders, const Subject& subject, const Variant& variant, const Extents& extents);
/// Grids by the engine and by the CPU oracle on one thread. `engine` must outlive them.
void add_grids(Contenders& contenders, const Subject& subject, const Variant& variant, Engine& engine);
/// Volumes read trilinear and tricubic.
void add_lookups(Contenders& contenders, const Subject& subject, const Variant& variant, const Extents& extents);
/// Steps of a closed loop, by the engine and by the CPU oracle on one thread. `engine` must outlive them.
void add_loops(Contenders& contenders, const Subject& subject, const Variant& variant, Engine& engine);

/// All ways of all laws of a subject, in a fixed order.
void add_contenders(Contenders& contenders, const Subject& subject, const Extents& extents, Engine& engine);

/// "bump, 64 facets, shaded: direct f64"
std::string contender_name(const Subject& subject, const Variant& variant, const std::string& way);
/// Whose errors and times those of a variant are compared with.
std::string reference_name(const Subject& subject, const Variant& variant);
/// What all ways of a law have in common.
Contender contender_of(const Subject& subject, const Variant& variant, const std::string& family,
                       const std::string& precision);

/// What is made when it is first wanted, and then kept.
template <typename Make> auto lazily(Make make) {
    using Made = decltype(make());
    auto kept = std::make_shared<std::optional<Made>>();
    return [kept, make]() -> Made& {
        if (!*kept)
            kept->emplace(make());
        return **kept;
    };
}

/// Measures the seconds of one of `count` evaluations that pass() does, by as many passes as take a millisecond or
/// more. What pass() returns is used, so that nothing is left out.
template <typename Pass> std::function<double()> timed(std::size_t count, Pass pass) {
    return [count, pass, passes = std::size_t(0), sink = 0.0]() mutable {
        using Clock = std::chrono::steady_clock;
        const auto run = [&](std::size_t times) {
            const Clock::time_point start = Clock::now();
            for (std::size_t i = 0; i < times; ++i)
                sink += pass();
            return std::chrono::duration<double>(Clock::now() - start).count();
        };
        if (passes == 0) {
            run(1);
            const double once = run(1);
            passes = static_cast<std::size_t>(std::fmin(1000, std::ceil(1e-3 / std::fmax(once, 1e-6))));
        }
        const double seconds = run(passes);
        volatile double kept = sink;
        static_cast<void>(kept);
        return seconds / static_cast<double>(passes * count);
    };
}

} // namespace forceshade::study::error_time
