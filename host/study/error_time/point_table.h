// Every contender as a table, the Pareto fronts, and the cheapest within a bound.
#pragma once

#include "host/study/error_time/measured.h"

namespace forceshade::study::error_time {

Table point_table(const Measured& measured);
/// Of a point table, for each surface, use and criterion.
Table front_table(const Table& points);
Table cheapest_table(const Table& points);

} // namespace forceshade::study::error_time
