// Differences between single and double precision: of forces over sizes, stiffnesses and distances, one parameter of a
// plain scene after the other, to the limits of the numbers; and the worst that a search finds.
#pragma once

#include "host/accuracy/precision_errors.h"
#include "host/accuracy/rounding_search.h"
#include "host/study/run/study_run.h"

namespace forceshade::study {

/// A surface with one parameter of a plain scene at one value: the errors of its fields count together. Axes:
/// "radius_ratio", "facets", "stiffness", "origin", "spacing", "depth"; SI.
using NumberCase = std::vector<FieldAtHome>;
NumberCase number_case(const std::string& surface, const std::string& axis, double value);
const std::vector<std::string>& number_surfaces();

/// A surface with one parameter at one value, in a precision.
struct NumberRow {
    std::string surface, axis;
    double value = 0; /* SI */
    std::string precision;
    PrecisionErrors errors;
};

/// A part for each surface and axis; `rows` must outlive them.
std::vector<Part> number_parts(Engine& engine, bool quick, std::vector<NumberRow>& rows);

/// Adds table, figures and notes.
void add_numbers(StudyData& data, const std::vector<NumberRow>& rows);

/// The worst of a law.
struct LawRounding : WorstRounding {
    std::string law; /* "mesh of 8 cells, morgenbesser" */
};

/// A part for each law of the study's own, or of the scene; `found` must outlive them and receives two a law, at most:
/// the worst of the same facet, and of another one.
std::vector<Part> worst_rounding_parts(const PreparedCase* scene, bool quick, std::vector<LawRounding>& found);

/// Adds the table and its finding. `own`: of the study's laws, not of a scene's.
void add_worst_rounding(StudyData& data, const std::vector<LawRounding>& found, bool own);

} // namespace forceshade::study
