// Where on the shape a way errs, and what a stroke over it feels: along a section across the middle.
#pragma once

#include <span>

#include "host/study/data/study_data.h"
#include "host/study/error_time/ways.h"

namespace forceshade::study::error_time {

/// Two tables, "fields" and "strokes", of some ways, numbers short.
std::vector<Table> section_tables(std::span<const Way* const> ways);

/// The figures of these tables for a subject, with `way`, one of its, to begin with.
std::vector<Figure> section_figures(const Subject& subject, const Way& way);

} // namespace forceshade::study::error_time
