// The errors of fields in single and in double precision; and where single precision is furthest from double: a search
// of a case, not samples of it.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"

namespace forceshade {

/// A field to be evaluated, and the same field at the origin, where its forces are known, voxel by voxel.
struct FieldAtHome {
    PreparedCase prepared, home;
};

/// Relative to the largest force; NaN: there is no such number.
struct PrecisionErrors {
    double force = NAN;  /* 1: largest |F - F_true| */
    double step = NAN;   /* 1: of the differences of neighbours along x, over the largest of those */
    double bound = NAN;  /* 1: the bound that validation holds to; none of meshes */
    std::string refused; /* why the errors are missing; empty: they are not */
};

/// The engine in single precision against the oracle in double.
PrecisionErrors single_errors(Engine& engine, std::span<const FieldAtHome> fields);
/// The engine in double precision against closed forms and plain loops in extended precision.
PrecisionErrors double_errors(Engine& engine, std::span<const FieldAtHome> fields);

/// A place at which single precision is far from double.
struct WorstRounding {
    bool same_facet = true; /* both precisions meet the same facet away from edges of the law; else rounding chose */
    double error = 0;       /* 1: |F32 - F64| over the largest force of the search, the stiffness times the deepest */
    double local = 0;       /* 1: over the force there */
    double turn = 0;        /* deg: between both forces */
    double gradient = 0; /* 1: most that the law in double changes by where single precision may round to, over K times
                            the way there: no more than some where it is smooth */
    double depth = 0;    /* m */
    glm::dvec3 place{0}; /* m, in the world */
    std::optional<glm::dvec3> from; /* m: where the stroke to it begins, of a god-object */
    std::size_t evaluations = 0;    /* of the law, in each precision */
};

/// The law without a history, searched as deep as a hand goes (scene_shape) by climbing from the worst of `places` that
/// are aimed at facets, edges and corners, and of a fifth as many ties, where two facets are equally near: below
/// ridges, where normals meet the medial axis, anywhere. At most two: the worst of the same facet, and the worst of a
/// choice between two.
/// With `strokes`: the same of a god-object on a mesh, at the ends of as many straight strokes of some samples from the
/// open. A tie is then where strokes fork: of two that are neighbours in double the proxies end on different facets.
std::vector<WorstRounding> worst_rounding(const PreparedCase& prepared, std::size_t places, bool strokes = false);

} // namespace forceshade
