// A subject of comparison: laws over one surface, at places that a hand touches, against one truth.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/study/data/medians.h"
#include "host/touch/places.h"
#include "host/touch/true_force.h"

namespace forceshade::study::error_time {

/// The size of the study.
struct Extents {
    std::vector<unsigned> facets;   /* of the bump */
    std::vector<unsigned> cells;    /* a side, of the meshes */
    std::vector<double> spacings;   /* m, of look-up volumes, falling */
    std::size_t places = 0;         /* that all laws of a surface share */
    std::size_t places_of_kind = 0; /* of each kind, if that many are found */
    std::size_t rounds = 0;         /* of timing; each measures everything once */
    std::size_t draws = 1;          /* of grids' offsets and orientations and of the own meshes' tessellations */
    std::size_t runs = 0;           /* of whole fields and loops */
    std::size_t ticks = 0;          /* of a loop that waits, for each method */
    std::size_t colds = 0;          /* evaluations with empty caches, of each method */
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

    const Variant& at(std::size_t draw) const { return draw > 0 && !drawn.empty() ? drawn[draw - 1] : *this; }
};

/// Its force is the truth, its box that of volumes.
struct Subject : TouchedShape {
    Subject(std::string of, std::string counted) : name(std::move(of)), elements(std::move(counted)) { smooth = true; }
    std::string name;     /* "bump", "mesh", "scene" */
    std::string elements; /* what Variant::elements counts: "facets", "cells"; empty: none */
    std::string against = kSmoothShape;
    double stiffness = 1;           /* N/m */
    std::vector<TouchPlace> places; /* that all laws meet */
    GridSpec grid;                  /* for kernels */
    std::vector<double> spacings;
    std::vector<Variant> variants;
    std::vector<std::string> notes;
};

/// The paper's bump of R = 600 mil, and the same cylinder as meshes of triangles.
std::vector<Subject> own_subjects(const Extents& extents);
/// A user's scene. \throws UsageError if no sample of its grid is in contact.
Subject scene_subject(const PreparedCase& scene, const Extents& extents);

} // namespace forceshade::study::error_time
