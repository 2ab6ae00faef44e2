// A penalty renderer: the force goes to the nearest place of the surface, wherever the probe came from (Massie 1993).
// On a plate thinner than twice the depth of a press the other side is nearer, and the probe pops through.
#include <cmath>
#include <string>
#include <vector>

#include "triangles.h"

namespace {

struct Penalty {
    double stiffness; /* N/m */
    std::vector<Triangle> triangles;
    std::string problem;
};

} // namespace

int fsr_version() {
    return FSR_VERSION;
}

int fsr_open(const fsr_scene* scene, void** renderer) {
    auto* const made = new Penalty{scene->stiffness, {}, ""};
    *renderer = made;
    for (std::size_t i = 0; i < scene->triangle_count; ++i)
        if (const Triangle one = triangle_of(*scene, i); length(cross(one.b - one.a, one.c - one.a)) > 0)
            made->triangles.push_back(one);
    if (made->triangles.empty()) {
        made->problem = "there is no triangle with an area";
        return 1;
    }
    return 0;
}

int fsr_reset(void*) {
    return 0; // there is no past
}

int fsr_update(void* renderer, const double probe[3], fsr_touch* touch) {
    const auto& self = *static_cast<const Penalty*>(renderer);
    const Vec p{probe[0], probe[1], probe[2]};
    double least = INFINITY, most_along = 0;
    Vec place{};
    bool inside = false;
    for (const Triangle& one : self.triangles) {
        const Vec at = nearest(one, p);
        const double distance = length(at - p);
        const double along = distance > 0 ? dot(at - p, unit_normal(one)) / distance : 0;
        constexpr double kSame = 1e-12;
        // Of triangles that are equally near, the one that faces the probe most says on which side it is.
        if (distance < least - kSame || (distance < least + kSame && std::abs(along) > std::abs(most_along))) {
            least = distance;
            most_along = along;
            place = at;
            inside = along > 0;
        }
    }
    if (!inside)
        return 0;
    const Vec force = self.stiffness * (place - p);
    const double f[3] = {force.x, force.y, force.z}, s[3] = {place.x, place.y, place.z};
    for (int i = 0; i < 3; ++i) {
        touch->force[i] = f[i];
        touch->proxy[i] = s[i];
    }
    touch->has_proxy = 1;
    return 0;
}

const char* fsr_error(void* renderer, int) {
    return renderer ? static_cast<Penalty*>(renderer)->problem.c_str() : "";
}

void fsr_close(void* renderer) {
    delete static_cast<Penalty*>(renderer);
}
