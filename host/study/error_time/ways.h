// A way of coming by a force: a law, and how it is evaluated.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/engine/engine.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {

/// What a way is for. live: one place after the other on one thread; volume: whole grids; loop: steps with a hand.
enum class Use { live, volume, loop };
const char* name_of(Use use);

struct Way {
    std::string name; /* unique: "bump, 64 facets, reference: direct f64" */
    const Subject* subject = nullptr;
    const Variant* variant = nullptr;
    Use use = Use::live;
    std::string family;                   /* "direct", "god-object", "look-up, trilinear", "kernel", ... */
    std::string precision;                /* "f64", "f32", "f32, half stored" */
    std::optional<double> spacing, bytes; /* m, B: of a look-up's volume */
    /// N, at places. Empty: has no errors of its own.
    std::function<std::vector<glm::dvec3>(std::span<const Place>)> forces;
    /// The places at which it has forces, where it cannot have any; empty: any.
    std::function<std::vector<Place>()> places;
    /// s of an evaluation, measured now.
    std::function<double()> seconds;
};

/// All ways of all laws of a subject, in a fixed order. `subject` and `engine` must outlive them.
void add_ways(std::vector<Way>& ways, const Subject& subject, Engine& engine);

/// The same law in double at the same places: what precision is held against.
std::vector<glm::dvec3> exact_forces(const Way& way, std::span<const Place> at);

} // namespace forceshade::study::error_time
