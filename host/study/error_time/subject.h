// What is compared: laws over one surface, at the same places, against the same smooth shape.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/prepare/prepared_case.h"

namespace forceshade::study::error_time {

/// How much is done.
struct Extents {
    std::vector<unsigned> facets; /* of the bump */
    std::vector<unsigned> cells;  /* a side, of the meshes */
    std::vector<double> spacings; /* m, of look-up volumes, falling */
    std::size_t probes = 0;       /* places at which errors are computed */
    std::size_t timed = 0;        /* the first of them, at which time is measured */
    std::size_t rounds = 0;       /* of timing; each measures everything once */
};

Extents default_extents();
Extents quick_extents();

/// A law among those compared.
struct Variant {
    std::string name; /* "bump of 64 facets, shaded" */
    std::shared_ptr<const PreparedCase> prepared;
    std::string shading;
    std::optional<double> facets, cells;
    bool half = false;     /* also rounded to half */
    bool kernels = false;  /* also by the engine */
    bool lookups = false;  /* also from volumes */
    bool proxies = false;  /* also by the god-object */
    bool thorough = false; /* also grids in f64, with half output and on one thread, and closed loops */
};

/// The smooth shape's force, N, at a place, m.
using SmoothLaw = std::function<glm::dvec3(const glm::dvec3&)>;

/// What errors are against where it is known; only then is less error closer to a truth.
constexpr const char* kSmoothShape = "the smooth shape";

struct Subject {
    std::string name;                   /* "bump", "mesh" */
    SmoothLaw smooth;                   /* what errors are against */
    std::string against = kSmoothShape; /* its name; where that is not known, a law: "double of mean_value" */
    std::vector<glm::dvec3> probes;     /* m */
    std::size_t stroke = 0;             /* probes of a stroke, one after the other; 0: they have no order */
    std::shared_ptr<PreparedCase> best; /* a god-object's smooth shape: the god-object of this; null: `smooth` */
    GridSpec grid;                      /* for kernels */
    glm::dvec3 low{0}, high{0};         /* m: the box of volumes */
    std::vector<double> spacings;       /* m: of volumes */
    std::vector<Variant> variants;
    std::vector<std::string> notes;
};

/// The paper's bump of R = 600 mil. The smooth shape's force is F = K (U(x) - z) N(x), the depth read vertically as the
/// facets' is.
Subject bump_subject(const Extents& extents);
/// The same cylinder as meshes of triangles. The smooth shape's force is F = K (R - r) along the radius, the depth read
/// to the nearest point as the meshes' is.
Subject mesh_subject(const Extents& extents);
/// A user's scene. \throws UsageError if nothing of its grid is in contact.
Subject scene_subject(const PreparedCase& scene, const Extents& extents);

/// Numbers in [low, high), the same on every machine.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}
    double operator()(double low, double high);

private:
    std::uint64_t state_;
};

/// G1 with the force of the vertical reading, or of the normal one.
SmoothLaw cylinder_law(const Scene& scene);

} // namespace forceshade::study::error_time
