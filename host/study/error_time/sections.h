// Errors of a method on a section across the middle of the shape, and its force along a stroke there.
#pragma once

#include <span>

#include "host/study/data/study_data.h"
#include "host/study/error_time/methods.h"

namespace forceshade::study::error_time {

/// Two tables, "fields" and "strokes", of some methods, numbers rounded.
std::vector<Table> section_tables(std::span<const Method* const> methods);

/// The figures of these tables for a subject; `method`, one of its, is shown first.
std::vector<Figure> section_figures(const Subject& subject, const Method& method);

} // namespace forceshade::study::error_time
