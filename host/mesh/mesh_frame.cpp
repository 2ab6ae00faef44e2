#include "host/mesh/mesh_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "host/error.h"

namespace forceshade {

MeshFrame frame_of(const PolygonSoup& polygons) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t corner : polygons.corners) {
        low = glm::min(low, polygons.vertices[corner]);
        high = glm::max(high, polygons.vertices[corner]);
    }
    const glm::dvec3 centre = low / 2.0 + high / 2.0;
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis)
        reach = std::max({reach, centre[axis] - low[axis], high[axis] - centre[axis]});
    if (!std::isfinite(reach))
        throw UsageError("the mesh is too large: its bounding box is no finite number of metres");
    int exponent = 0;
    if (std::frexp(reach, &exponent) == 0.5)
        --exponent;
    const double scale = reach > 0 ? std::ldexp(1.0, exponent) : 1.0;
    if (!std::isfinite(scale))
        throw UsageError("the mesh is too large: its bounding box is no finite number of metres");
    return {centre, scale};
}

} // namespace forceshade
