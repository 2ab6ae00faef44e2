// A subject of comparison: laws over one surface, at places that a hand touches, against one truth.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/study/run/sampling.h"

namespace forceshade::study::error_time {

/// The size of the study.
struct Extents {
    std::vector<unsigned> facets;   /* of the bump */
    std::vector<unsigned> cells;    /* a side, of the meshes */
    std::vector<double> spacings;   /* m, of look-up volumes, falling */
    std::size_t places = 0;         /* that all laws of a surface share */
    std::size_t places_of_kind = 0; /* of each kind, if that many are found */
    std::size_t rounds = 0;         /* of timing; each measures everything once */
};

Extents extents_of(bool quick);

/// A place that a hand touches.
struct Place {
    glm::dvec3 at{0};           /* m */
    glm::dvec3 normal{0, 0, 1}; /* of the surface above it */
    double depth = 0;           /* m: under the surface along the normal; negative above it */
};

/// Lengths that follow from how deep a hand goes, m.
struct TouchScale {
    double deepest = 2e-3;
    double shallowest() const { return deepest / 100; }
    double ring() const { return deepest / 20; }
    double skin() const { return deepest / 40; } /* shallower is boundary */
};

/// The true force, N, at a place.
using Truth = std::function<glm::dvec3(const Place&)>;

/// A law among those compared.
struct Variant {
    std::string name; /* "64 facets, reference" */
    std::shared_ptr<const PreparedCase> prepared;
    std::string shading;
    std::optional<double> elements; /* facets of a bump, cells of a mesh along a side */
    bool thorough = false;          /* also from volumes, over grids and along closed loops */
};

/// The reference of errors if it is known; only then is less error closer to the truth.
constexpr const char* kSmoothShape = "the smooth shape";

struct Subject {
    std::string name;     /* "bump", "mesh", "scene" */
    std::string elements; /* what Variant::elements counts: "facets", "cells"; empty: none */
    std::string against = kSmoothShape;
    Truth truth{};
    double stiffness = 1; /* N/m */
    TouchScale scale{};
    std::vector<Place> places{}; /* uniform over the surface, depths log-uniform: all laws meet these */
    GridSpec grid{};             /* for kernels */
    glm::dvec3 low{0}, high{0};  /* m: the box of volumes */
    std::vector<double> spacings{};
    std::vector<Variant> variants{};
    std::vector<std::string> notes{};
};

/// The paper's bump of R = 600 mil, and the same cylinder as meshes of triangles.
std::vector<Subject> own_subjects(const Extents& extents);
/// A user's scene. \throws UsageError if no sample of its grid is in contact.
Subject scene_subject(const PreparedCase& scene, const Extents& extents);

} // namespace forceshade::study::error_time
