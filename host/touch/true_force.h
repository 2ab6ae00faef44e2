// What the force where a hand touches should be.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/touch/place.h"

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

/// The reference of errors where it is known; only then is less error closer to the truth.
constexpr const char* kSmoothShape = "the smooth shape";

struct TrueForce {
    ForceAt force;
    std::string against; /* kSmoothShape, or one of the laws */
    bool smooth = false;
};

/// Of a bump without a texture the cylinder's; else that of the closest shading in double precision, of a mesh the
/// god-object's, which stays on its side.
TrueForce true_force(const PreparedCase& prepared, const TouchScale& scale);

} // namespace forceshade
