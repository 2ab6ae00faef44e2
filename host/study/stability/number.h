// Where numbers of single precision leave those of double: how far forces differ over sizes, stiffnesses and distances.
#pragma once

#include <string>
#include <vector>

#include "host/study/run/study_run.h"
#include "host/study/stability/number_error.h"

namespace forceshade::study {

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

} // namespace forceshade::study
