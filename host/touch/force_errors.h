// What the force where a hand touches should be, and how far forces are from that.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "host/output/record.h"
#include "host/reference/elementary.h"
#include "host/touch/places.h"

namespace forceshade {

using NamedShading = std::pair<Shading, const char*>;

/// The shadings that a surface has; the last comes closest to the smooth shape.
std::vector<NamedShading> shadings_of(const PreparedCase& scene);

/// The cylinder that a bump's facets approximate.
struct SmoothCylinder {
    explicit SmoothCylinder(const Scene& scene)
        : half(scene.surface.width / 2), radius(scene.surface.radius), stiffness(scene.force.stiffness),
          centre_depth(std::sqrt((radius - half) * (radius + half))) {}
    double half, radius /* m */, stiffness /* N/m */, centre_depth /* m: of the axis, below the plane */;
};

/// Its force K (U(x) - z) along its normal, the depth read as the scene reads it.
ForceAt cylinder_force(const Scene& scene);

/// Gives a shape the force that it should have: of a bump without a texture the cylinder's; else that of the closest
/// shading in double precision, of a mesh the god-object's, which stays on its side. Returns whose it is: kSmoothShape,
/// or one of the laws.
std::string set_true_force(TouchedShape& shape, const PreparedCase& prepared);

/// Root mean square, median, the value that 95 % do not exceed, and the largest; NaN without values.
struct Summary {
    double rms = NAN, median = NAN, p95 = NAN, largest = NAN;
};

/// Of values that are not negative; their order does not matter.
Summary summary_of(std::vector<double> values);

/// The local error of a missing force is 1; out of contact a force has no direction.
struct ForceErrors {
    std::size_t places = 0;
    std::size_t missed = 0;     /* places without a force that should have one */
    std::size_t phantom = 0;    /* places with a force that should have none */
    std::size_t above = 0;      /* places that should have none */
    double phantom_largest = 0; /* 1: the largest force at these over the root mean square of the true force */
    Summary direction;          /* deg */
    Summary local;              /* 1: |F - truth| / |truth|, where there should be a force */
    Summary size;               /* 1: ||F| - |truth|| / |truth|, where both have a force */
    Summary typical;            /* 1: |F - truth| over the root mean square of the true force */

    double missed_share() const { return double(missed) / double(places); }
    /// Of the places, those where only one of the two has a force.
    double one_sided_share() const { return double(missed + phantom) / double(places); }
    /// Of the places that should have no force, those that have one; NaN without such places.
    double phantom_share() const { return double(phantom) / double(above); }
    /// The criteria of fronts and bounds: RMS error of the direction in deg, and 95th percentile of the local error;
    /// NaN without errors, or if a force is missing at more than 1 % of the places.
    double bounded_direction() const { return whole() ? direction.rms : NAN; }
    double bounded_local() const { return whole() ? local.p95 : NAN; }

private:
    bool whole() const { return double(missed) <= 0.01 * double(places); }
};

/// `forces` and `truth`, N, place by place; `typical`, N.
ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth, double typical);

/// Of a case's own law where a hand touches its surface, of a bump above the plane; empty where nothing is touched.
std::optional<TouchRecord> touched_error(const PreparedCase& prepared);

// Angles between directions, and directions across one.

constexpr double kDegree = std::numbers::pi / 180; /* rad */

using reference::angle_between; /* rad */

/// Two unit vectors across a unit vector, and across each other.
inline std::pair<reference::Vector<double>, reference::Vector<double>>
directions_across(const reference::Vector<double>& direction) {
    using Vector = reference::Vector<double>;
    const Vector u = reference::cross(direction, std::abs(direction.x) < 0.5 ? Vector(1, 0, 0) : Vector(0, 1, 0));
    const Vector unit = u / reference::length(u);
    return {unit, reference::cross(direction, unit)};
}

} // namespace forceshade
