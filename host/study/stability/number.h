// Differences between single and double precision: of forces over sizes, stiffnesses and distances, one parameter of a
// plain scene after the other, to the limits of the numbers; and the worst that a search finds.
#pragma once

#include "host/study/run/study_run.h"

namespace forceshade::study {

/// A field to be evaluated, and the same field at the origin, where its forces are known, voxel by voxel.
struct NumberField {
    PreparedCase prepared, home;
};

/// A surface with one parameter of a plain scene at one value: the errors of its fields count together. Axes:
/// "radius_ratio", "facets", "stiffness", "origin", "spacing", "depth"; SI.
using NumberCase = std::vector<NumberField>;
/// The plain scene of a surface: R = 2 a, a = 12.7 mm, 8 facets, K = 1000 N/m.
Scene number_scene(const std::string& surface);
NumberCase number_case(const std::string& surface, const std::string& axis, double value);
const std::vector<std::string>& number_surfaces();

/// Relative to the largest force.
struct NumberErrors {
    double force = 0;    /* 1: largest |F - F_true| */
    double step = -1;    /* 1: of the differences of neighbours along x, over the largest of those; -1: none */
    double bound = -1;   /* 1: the bound that validation holds to; -1: none of meshes */
    std::string refused; /* why the errors are missing; empty: they are not */
};

/// The engine in single precision against the oracle in double.
NumberErrors single_errors(Engine& engine, const NumberCase& one);
/// The engine in double precision against closed forms and plain loops in extended precision.
NumberErrors double_errors(Engine& engine, const NumberCase& one);

/// A surface with one parameter at one value, in a precision.
struct NumberRow {
    std::string surface, axis;
    double value = 0; /* SI */
    std::string precision;
    NumberErrors errors;
};

/// A part for each surface and axis; `rows` must outlive them.
std::vector<Part> number_parts(Engine& engine, bool quick, std::vector<NumberRow>& rows);

/// Adds table, figures and notes.
void add_numbers(StudyData& data, const std::vector<NumberRow>& rows);

/// A place at which single precision is far from double.
struct WorstRounding {
    std::string law;        /* "mesh of 8 cells, morgenbesser" */
    bool same_facet = true; /* both precisions meet the same facet away from edges of the law; else rounding chose */
    double error = 0;       /* 1: |F32 - F64| over the largest force of the search, K times 2 mm */
    double local = 0;       /* 1: over the force there */
    double turn = 0;        /* deg: between both forces */
    double depth = 0;       /* m */
    glm::dvec3 place{0};    /* m */
    std::size_t evaluations = 0; /* of the law, in each precision */
};

/// A part for each law; `found` must outlive them and receives two a law, at most: the worst of the same facet, and of
/// another one.
std::vector<Part> worst_rounding_parts(bool quick, std::vector<WorstRounding>& found);

/// Adds the table and its finding.
void add_worst_rounding(StudyData& data, const std::vector<WorstRounding>& found);

} // namespace forceshade::study
