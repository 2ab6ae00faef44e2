// L6: where a god-object that comes from far off enters the region in which it minds the mesh.
#pragma once

#include <algorithm>
#include <cmath>

#include "host/reference/god_object_planes.h"

namespace forceshade::reference {

/// Half the side of the box in which a proxy minds the mesh, none of whose coordinates is beyond 1.
constexpr int kRegion = 2;

/// Where a straight way from a proxy outside of the region enters it; false if it does not. The way is measured from
/// its end nearer to the region, in double, so that it meets the region where it should.
template <typename T> bool find_entry(const Vector<T>& proxy, const Vector<T>& probe, Vector<T>& place) noexcept {
    constexpr double kSide = kRegion * 0.75;
    const bool back = largest_of(probe) < largest_of(proxy);
    const glm::dvec3 near_end(back ? probe : proxy), far_end(back ? proxy : probe);
    double begin = 0, end = 1;
    for (int i = 0; i < 3; ++i) {
        const double way = far_end[i] - near_end[i];
        if (!std::isfinite(way))
            return false;
        if (way == 0) {
            end = std::abs(near_end[i]) > kSide ? -1 : end;
            continue;
        }
        const double low = (-kSide - near_end[i]) / way, high = (kSide - near_end[i]) / way;
        begin = std::max(begin, std::min(low, high));
        end = std::min(end, std::max(low, high));
    }
    if (!(begin <= end))
        return false;
    for (int i = 0; i < 3; ++i) {
        const double there = near_end[i] + (back ? end : begin) * (far_end[i] - near_end[i]);
        place[i] = static_cast<T>(std::clamp(there, -kSide, kSide));
    }
    // On the region's border to the last bit, so that it is outside of the mesh.
    int side = std::abs(place[0]) < std::abs(place[1]) ? 1 : 0;
    side = std::abs(place[side]) < std::abs(place[2]) ? 2 : side;
    place[side] = std::copysign(T(kSide), place[side]);
    return true;
}

} // namespace forceshade::reference
