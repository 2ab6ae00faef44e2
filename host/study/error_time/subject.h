// A subject of comparison: laws over one surface, at places that a hand touches, against one truth; and the kinds of
// these places.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/renderer/renderer_process.h"
#include "host/touch/force_at.h"
#include "host/touch/force_errors.h"

namespace forceshade::study::error_time {

/// The size of the study.
struct Extents {
    std::vector<unsigned> facets;   /* of the bump */
    std::vector<unsigned> cells;    /* a side, of the meshes */
    std::vector<double> spacings;   /* m, of look-up volumes, falling */
    std::size_t places = 0;         /* that all laws of a surface share */
    std::size_t places_of_kind = 0; /* of each kind, if that many are found */
    std::size_t rounds = 0;         /* of timing; each measures everything once */
    std::size_t draws = 1;          /* of places, grids' offsets and orientations, and the own meshes' tessellations */
    std::size_t runs = 0;           /* of whole fields and loops */
    std::size_t ticks = 0;          /* of a loop that waits, for each method */
    std::size_t colds = 0;          /* evaluations with empty caches, of each method */
    std::uint64_t first_draw = 0;   /* others have other random numbers */
};

Extents extents_of(bool quick);

/// A law among those compared.
struct Variant {
    std::string name; /* "64 facets, reference" */
    std::shared_ptr<const PreparedCase> prepared;
    std::string shading;
    std::optional<double> elements; /* facets of a bump, cells of a mesh along a side */
    bool thorough = false;          /* also from volumes, over grids and along closed loops */
    std::vector<Variant> drawn{};   /* the same on a mesh that is tessellated anew: from draw 1 on; empty: only one */

    bool is_main() const { return thorough && shading != "none"; }
    const Variant& at(std::size_t draw) const { return draw > 0 && !drawn.empty() ? drawn[draw - 1] : *this; }
};

/// Its force is the truth, its box that of volumes.
struct Subject : TouchedShape {
    Subject(std::string of, std::string counted) : name(std::move(of)), elements(std::move(counted)) { smooth = true; }
    std::string name;     /* "bump", "mesh", "scene" */
    std::string elements; /* what Variant::elements counts: "facets", "cells"; empty: none */
    std::string against = kSmoothShape;
    double stiffness = 1;           /* N/m */
    std::vector<TouchPlace> places; /* that all laws meet in the first draw; times are of these */
    std::uint64_t first_draw = 0;
    GridSpec grid; /* for kernels */
    std::vector<double> spacings;
    std::vector<Variant> variants;
    std::vector<std::string> notes;

    /// What random numbers are for.
    enum class Random { places = 1, kinds = 2, grids = 21, tessellation = 31 };
    std::uint64_t seed(Random use, std::size_t draw) const {
        return 1000 * (first_draw + draw) + static_cast<std::uint64_t>(use);
    }

    /// The law that all methods are measured on, shaded; null: none.
    const Variant* main_variant() const {
        const auto found = std::ranges::find_if(variants, &Variant::is_main);
        return found == variants.end() ? nullptr : &*found;
    }
};

/// The paper's bump of R = 600 mil, and the same cylinder as meshes of triangles.
std::vector<Subject> own_subjects(const Extents& extents);
/// A user's scene. \throws UsageError if no sample of its grid is in contact.
Subject scene_subject(const PreparedCase& scene, const Extents& extents);

/// The kind of a place, by the forces on a small ring about it. flat: the smooth shape is a plane there; facet: it is
/// curved, and the law has one facet; edge: facets meet; rim: the smooth shape itself has an edge; boundary: the place
/// is so shallow, or as little above the surface, that contact begins or ends nearby.
enum class Kind { flat, facet, edge, rim, boundary };
inline constexpr std::array kKinds{Kind::flat, Kind::facet, Kind::edge, Kind::rim, Kind::boundary};
const char* name_of(Kind kind);

/// rad: the largest turn of the true force on a small ring about a place.
double smooth_turn(const Subject& subject, const TouchPlace& place);

/// Classifies places of a law by kind.
class KindOf {
public:
    /// `subject` must outlive it.
    KindOf(const Subject& subject, const Variant& variant);
    Kind operator()(const TouchPlace& place) { return of(place, smooth_turn(subject_, place)); }
    Kind of(const TouchPlace& place, double smooth_turn);

private:
    const Subject& subject_;
    PreparedCase plain_; /* without shading */
    StaticForce<double> facets_;
};

/// The places at which a law is compared with the truth, and their kinds.
struct KindPlaces {
    std::vector<TouchPlace> at; /* the subject's own come first */
    std::vector<Kind> kinds;
    std::size_t shared = 0; /* how many the subject's own are */
};

/// Places drawn one after the other; each is drawn once.
class DrawnPlaces {
public:
    /// `subject`, and the mesh of `prepared`, must outlive it.
    DrawnPlaces(const Subject& subject, const PreparedCase& prepared, std::uint64_t seed)
        : subject_(subject), draw_(subject, prepared, seed) {}
    /// The place that a try finds, and the smooth_turn about it; empty without one.
    const std::optional<std::pair<TouchPlace, double>>& operator[](std::size_t tries);

private:
    const Subject& subject_;
    PlaceDraw draw_;
    std::vector<std::optional<std::pair<TouchPlace, double>>> found_;
};

/// The places that all laws of the subject meet in a draw.
struct SharedPlaces {
    std::vector<TouchPlace> at;
    std::vector<double> turns;            /* smooth_turn */
    std::optional<DrawnPlaces> further{}; /* which laws on the same mesh, or on none, meet where more are asked for */
};
SharedPlaces shared_places(const Subject& subject, const Extents& extents, std::size_t draw);

/// These and more, so that each kind has `extents.places_of_kind` where the surface has such places.
KindPlaces places_of(const Subject& subject, const Variant& variant, SharedPlaces& shared, const Extents& extents,
                     std::size_t draw);

// A method of computing a force: a law, its evaluation, and its errors.

/// The use of a method. live: one place after the other on one thread; batch: many places at once; volume: whole grids;
/// loop: steps with a hand.
enum class Use { live, batch, volume, loop };
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
    /// Of each draw of places, grid and mesh; then each of the others is the median over them, of `precision` the
    /// largest.
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

/// A renderer of the user's own as a method of a thorough law: it approaches each place as the god-object does, and its
/// updates are timed in its process. `renderer`, `subject` and `variant` must outlive it. \throws RendererError, with
/// its name, where it fails at the subject's places; then it is no method.
void add_renderer(std::vector<Method>& methods, const Subject& subject, const Variant& variant,
                  RendererProcess& renderer, const std::string& name);

/// All methods of a law of a subject, in a fixed order, from volumes and over grids at random offsets; from draw 1 on
/// volumes are turned about the vertical and tilted by up to 2 deg as well, and the study's own meshes are tessellated
/// anew. `subject` and the engines must outlive them.
void add_methods(std::vector<Method>& methods, const Subject& subject, const Variant& variant, std::size_t draw,
                 const Engines& engines);

} // namespace forceshade::study::error_time
