// A method of computing a force: a law, its evaluation, and its errors.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/field/engine.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {

/// The use of a method. live: one place after the other on one thread; volume: whole grids; loop: steps with a hand.
enum class Use { live, volume, loop };
const char* name_of(Use use);

/// N, at places.
using ForcesAt = std::function<std::vector<glm::dvec3>(std::span<const TouchPlace>)>;

/// A volume in memory.
struct Built {
    double bytes = 0, seconds = 0; /* B; s: sampled on all cores and put in order */
    double loading = 0;            /* s: as many bytes read from a file that the system has in memory */
};

/// The errors of a method.
struct MethodErrors {
    ForceErrors shared;                             /* over the places that all laws share */
    std::array<ForceErrors, kKinds.size()> by_kind; /* without places: there are none of that kind */
    Summary precision; /* 1: |F - same law in double| over the root mean square true force; all places */
    /// Of each draw of grid or mesh; then the others are those of the draw with the median RMS error.
    std::vector<MethodErrors> by_draw;

    const ForceErrors& of(Kind kind) const { return by_kind[static_cast<std::size_t>(kind)]; }
};

struct Method {
    std::string name; /* unique: "bump, 64 facets, reference: direct f64" */
    const Subject* subject = nullptr;
    const Variant* variant = nullptr;
    Use use = Use::live;
    std::string family;            /* "direct", "god-object", "look-up, trilinear", "field, kernel", ... */
    std::string precision;         /* "f64", "f32", "f32, half stored" */
    std::optional<double> spacing; /* m: of a look-up's volume */
    std::function<Built()> built;  /* its volume, measured once; empty: it has none */
    ForcesAt forces;               /* empty: has no errors of its own */
    bool drawn = false;            // its errors depend on where its samples or its mesh's vertices lie: on the draw
    ForcesAt exact;                /* the same law in double: the reference for precision */
    /// The places at which it has forces, if not any; empty: any.
    std::function<std::vector<TouchPlace>()> places;
    /// s of an evaluation, measured now.
    std::function<double()> seconds;
    /// s of one evaluation alone, the clock's own included, at the places in turn (of a
    /// god-object's approach to one, the next update); empty: it has none alone.
    std::function<double(std::size_t number)> once;
    std::optional<MethodErrors> errors; /* once they are measured; empty: it has none */
};

struct Engines {
    Engine& engine;
    Engine& single_thread; /* the oracle on one thread */
};

/// All methods of a law of a subject, in a fixed order, from volumes and over grids at random offsets; from draw 1 on
/// volumes are turned about the vertical as well, and the study's own meshes are tessellated anew. `subject` and the
/// engines must outlive them.
void add_methods(std::vector<Method>& methods, const Subject& subject, const Variant& variant, std::size_t draw,
                 const Engines& engines);

} // namespace forceshade::study::error_time
