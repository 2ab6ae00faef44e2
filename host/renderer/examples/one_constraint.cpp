// A proxy that knows one constraint an update: it goes towards the probe, and the first triangle in its way, other than
// that of the last update, is the plane from which the probe is pushed. Where two planes hold it, as in a groove, it
// takes them in turn: a ripple of half the loop's rate.
#include <cmath>
#include <string>
#include <vector>

#include "triangles.h"

namespace {

constexpr double kSkin = 1e-6; // m: that the proxy keeps off the surface

struct Proxy {
    double stiffness; /* N/m */
    std::vector<Triangle> triangles;
    Vec at{};
    bool begun = false;
    int touched = -1; /* the triangle whose plane it is held by; -1: none */
};

// How far along from a to b, in [0, 1], a triangle is met from its front; 2 if it is not.
double hit(const Triangle& t, Vec a, Vec b) {
    const Vec n = unit_normal(t), way = b - a;
    const double down = dot(way, n), above = dot(a - t.a, n);
    if (down >= 0 || above < 0)
        return 2;
    const double at = std::fmax((above - kSkin) / -down, 0);
    if (at > 1)
        return 2;
    const Vec p = a + at * way;
    const auto left_of = [&](Vec from, Vec to) { return dot(cross(to - from, p - from), n) >= -1e-12; };
    return left_of(t.a, t.b) && left_of(t.b, t.c) && left_of(t.c, t.a) ? at : 2;
}

struct Met {
    double share = 1; // of the way to a place
    int triangle = -1;
};

// The first triangle on the proxy's way to a place, but for one.
Met first_met(const Proxy& self, Vec to, int but) {
    Met met;
    for (std::size_t i = 0; i < self.triangles.size(); ++i)
        if (const double at = int(i) == but ? 2 : hit(self.triangles[i], self.at, to); at < met.share)
            met = {at, int(i)};
    return met;
}

} // namespace

int fsr_version() {
    return FSR_VERSION;
}

int fsr_open(const fsr_scene* scene, void** renderer) {
    auto* const made = new Proxy{scene->stiffness, {}};
    *renderer = made;
    for (std::size_t i = 0; i < scene->triangle_count; ++i)
        if (const Triangle one = triangle_of(*scene, i); length(cross(one.b - one.a, one.c - one.a)) > 0)
            made->triangles.push_back(one);
    return 0;
}

int fsr_reset(void* renderer) {
    static_cast<Proxy*>(renderer)->begun = false;
    return 0;
}

int fsr_update(void* renderer, const double probe[3], fsr_touch* touch) {
    auto& self = *static_cast<Proxy*>(renderer);
    const Vec p{probe[0], probe[1], probe[2]};
    if (!self.begun) {
        self.at = p;
        self.touched = -1;
        self.begun = true;
    }
    if (const int met = first_met(self, p, self.touched).triangle; met >= 0)
        self.touched = met;
    Vec goal = p;
    if (self.touched >= 0) { // the place of its plane nearest to the probe; the probe itself in front of it
        const Triangle& plane = self.triangles[std::size_t(self.touched)];
        const Vec n = unit_normal(plane);
        const double below = kSkin - dot(p - plane.a, n);
        goal = p + std::fmax(below, 0) * n;
        if (below <= 0)
            self.touched = -1;
    }
    self.at = self.at + first_met(self, goal, self.touched).share * (goal - self.at);
    const Vec force = self.stiffness * (goal - p);
    const double f[3] = {force.x, force.y, force.z}, s[3] = {goal.x, goal.y, goal.z};
    for (int i = 0; i < 3; ++i) {
        touch->force[i] = f[i];
        touch->proxy[i] = s[i];
    }
    touch->has_proxy = 1;
    return 0;
}

const char* fsr_error(void*, int) {
    return "";
}

void fsr_close(void* renderer) {
    delete static_cast<Proxy*>(renderer);
}
