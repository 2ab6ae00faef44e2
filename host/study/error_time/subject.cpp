#include "host/study/error_time/subject.h"

#include <cmath>

#include "host/reference/elementary.h"

namespace forceshade::study::error_time {

Extents default_extents() {
    Extents extents;
    extents.facets = {1, 2, 3, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096};
    extents.cells = {4, 8, 16, 32, 64};
    extents.spacings = {0.8e-3, 0.4e-3, 0.2e-3, 0.1e-3};
    extents.probes = 16384;
    extents.timed = 4096;
    extents.rounds = 60;
    return extents;
}

Extents quick_extents() {
    Extents extents;
    extents.facets = {1, 4, 16, 64, 512, 4096};
    extents.cells = {4, 8, 16, 32};
    extents.spacings = {0.8e-3, 0.4e-3, 0.2e-3};
    extents.probes = 4096;
    extents.timed = 2048;
    extents.rounds = 5;
    return extents;
}

// splitmix64
double Draw::operator()(double low, double high) {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
    mixed ^= mixed >> 31;
    return low + (high - low) * (static_cast<double>(mixed >> 11) * 0x1p-53);
}

SmoothLaw cylinder_law(const Scene& scene) {
    const double half = scene.surface.width / 2, radius = scene.surface.radius, stiffness = scene.force.stiffness;
    const double centre_depth = std::sqrt((radius - half) * (radius + half));
    const bool normal = scene.force.depth == DepthReading::normal;
    return [=](const glm::dvec3& at) {
        double depth = reference::cylinder_height(half, radius, centre_depth, at.x) - at.z;
        if (!(depth > 0))
            return glm::dvec3(0);
        glm::dvec3 direction(0, 0, 1);
        if (std::abs(at.x) < half)
            direction = {at.x / radius, 0, reference::circle_rise(radius, at.x) / radius};
        if (normal)
            depth *= direction.z;
        return stiffness * depth * direction;
    };
}

} // namespace forceshade::study::error_time
