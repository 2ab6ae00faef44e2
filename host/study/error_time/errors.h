// How far forces are from what they should be, by kinds of places.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "host/study/error_time/places.h"

namespace forceshade::study::error_time {

/// Root mean square, median, the value that 95 % do not exceed, and the largest.
struct Summary {
    double rms = 0, median = 0, p95 = 0, largest = 0;
};

/// Of values that are not negative; their order does not matter. Nothing of none.
std::optional<Summary> summary_of(std::vector<double> values);

/// Where there should be a force and none is, the local error is 1; out of contact a force has no direction.
struct ForceErrors {
    std::size_t places = 0;
    std::size_t missed = 0;           /* places where there should be a force, and none is */
    std::size_t phantom = 0;          /* places where there is a force, and none should be */
    std::optional<Summary> direction; /* deg */
    std::optional<Summary> local;     /* 1: |F - truth| / |truth|, where there should be a force */
    std::optional<Summary> typical;   /* 1: |F - truth| over the root mean square of the true force */
};

/// `forces` and `truth`, N, place by place; `typical`, N.
ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth, double typical);

/// N: root mean square of forces.
double rms_of(std::span<const glm::dvec3> forces);

/// All that is told of a way's errors.
struct WayErrors {
    ForceErrors shared;                                            /* over the places that all laws share */
    std::array<std::optional<ForceErrors>, kKinds.size()> by_kind; /* nothing where there is no such place */
    std::optional<Summary> precision; /* 1: |F - same law in double| over the root mean square true force; all places */
};

} // namespace forceshade::study::error_time
