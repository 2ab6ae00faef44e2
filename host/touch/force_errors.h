// How far forces are from those that should be.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "host/output/record.h"

namespace forceshade {

/// Root mean square, median, the value that 95 % do not exceed, and the largest.
struct Summary {
    double rms = 0, median = 0, p95 = 0, largest = 0;
};

/// Of values that are not negative; their order does not matter. Empty for no values.
std::optional<Summary> summary_of(std::vector<double> values);

/// The local error of a missing force is 1; out of contact a force has no direction.
struct ForceErrors {
    std::size_t places = 0;
    std::size_t missed = 0;           /* places without a force that should have one */
    std::size_t phantom = 0;          /* places with a force that should have none */
    std::size_t above = 0;            /* places that should have none */
    std::optional<Summary> direction; /* deg */
    std::optional<Summary> local;     /* 1: |F - truth| / |truth|, where there should be a force */
    std::optional<Summary> typical;   /* 1: |F - truth| over the root mean square of the true force */

    /// The criteria of fronts and bounds: RMS error of the direction in deg, and 95th percentile of the local error;
    /// NaN without errors, or if a force is missing at more than 1 % of the places.
    double bounded_direction() const { return whole() && direction ? direction->rms : NAN; }
    double bounded_local() const { return whole() && local ? local->p95 : NAN; }

private:
    bool whole() const { return double(missed) <= 0.01 * double(places); }
};

/// `forces` and `truth`, N, place by place; `typical`, N.
ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth, double typical);

struct PreparedCase;

/// Of a case's own law where a hand touches its surface; empty where nothing is touched in its box.
std::optional<TouchRecord> touched_error(const PreparedCase& prepared);

} // namespace forceshade
