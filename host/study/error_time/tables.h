// Everything that was measured, as tables and figures.
#pragma once

#include <span>
#include <vector>

#include "host/study/data/study_data.h"
#include "host/study/error_time/errors.h"
#include "host/study/error_time/rounds.h"

namespace forceshade::study::error_time {

struct Measured {
    const std::vector<Subject>& subjects;
    const std::vector<Way>& ways;
    const std::vector<std::optional<WayErrors>>& errors; /* way by way; nothing where it has none */
    const Times& times;
};

/// A bound within which the cheapest way is named.
struct Bound {
    const char *criterion, *unit;
    double most;
    double (*error)(const ForceErrors&);
};

/// What fronts and bounds are about: RMS of the direction's error in deg, and what 95 % of the local errors do not
/// exceed; NaN where there is none, or where a force is missing at more than 1 % of the places.
double direction_error(const ForceErrors& errors);
double local_error(const ForceErrors& errors);

std::vector<Table> tables_of(const Measured& measured);
/// `own`: of the study's own surfaces.
std::vector<Figure> figures_of(const Measured& measured, bool own);

} // namespace forceshade::study::error_time
