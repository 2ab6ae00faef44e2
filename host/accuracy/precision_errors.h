// The errors of fields in single and in double precision.
#pragma once

#include <span>
#include <string>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"

namespace forceshade {

/// A field to be evaluated, and the same field at the origin, where its forces are known, voxel by voxel.
struct FieldAtHome {
    PreparedCase prepared, home;
};

/// Relative to the largest force.
struct PrecisionErrors {
    double force = 0;    /* 1: largest |F - F_true| */
    double step = -1;    /* 1: of the differences of neighbours along x, over the largest of those; -1: none */
    double bound = -1;   /* 1: the bound that validation holds to; -1: none of meshes */
    std::string refused; /* why the errors are missing; empty: they are not */
};

/// The engine in single precision against the oracle in double.
PrecisionErrors single_errors(Engine& engine, std::span<const FieldAtHome> fields);
/// The engine in double precision against closed forms and plain loops in extended precision.
PrecisionErrors double_errors(Engine& engine, std::span<const FieldAtHome> fields);

} // namespace forceshade
