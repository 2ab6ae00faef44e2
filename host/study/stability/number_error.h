// How far a precision is from the truth in a field.
#pragma once

#include <string>

#include "host/engine/engine.h"
#include "host/study/stability/number_cases.h"

namespace forceshade::study {

/// Relative to the largest force, but for the angle.
struct NumberErrors {
    double force = 0;     /* 1: largest |F - F_true| */
    double direction = 0; /* rad: largest angle, of forces of at least a thousandth of the largest */
    double step = -1;     /* 1: of the differences of neighbours along x, over the largest of those; -1: none */
    double bound = -1;    /* 1: the bound that validation holds to; -1: none of meshes */
    double share_off = 0; /* 1: of the voxels, those that are off by more than 1e-6 of the largest force */
    std::string refused;  /* why there is no number; empty: there is */
};

/// The engine in single precision against the oracle in double.
NumberErrors single_errors(Engine& engine, const NumberCase& one);
/// The engine in double precision against closed forms and plain loops in extended precision.
NumberErrors double_errors(Engine& engine, const NumberCase& one);

} // namespace forceshade::study
