// What is remembered of a recorded path while its samples pass by, in open loop.
#pragma once

#include <cstdint>

#include "host/path_output/contact_time.h"
#include "host/reference/path_metrics.h"

namespace forceshade {

template <typename T> struct PathTrack {
    std::uint64_t id;
    bool inside; /* it began behind the surface */
    std::uint64_t steps = 0;
    layout::PathMetrics<T> metrics = reference::no_metrics<T>();
    ContactTime contact;

    PathTrack(std::uint64_t number, bool began_inside) : id(number), inside(began_inside) {}

    /// The next sample: when, s, where the probe is, m, and what it feels. As reference::take_step in open loop.
    void add(double time, const reference::Vector<T>& probe, const reference::Contact<T>& felt, bool finished) {
        reference::add_sample(metrics, felt, felt.force);
        metrics.unfinished += finished ? 0 : 1;
        const bool touches = felt.facet != layout::kNoFacet;
        contact.add(time, touches);
        if (steps > 0) {
            const reference::Vector<T> way{probe.x - last_.x, probe.y - last_.y, probe.z - last_.z};
            if (touching_ && touches)
                reference::add_turn(metrics, force_, felt.force, way);
            reference::add_work(metrics, T(0.5) * reference::dot(reference::Vector<T>(force_ + felt.force), way));
        }
        last_ = probe;
        force_ = felt.force;
        touching_ = touches;
        ++steps;
    }

private:
    reference::Vector<T> last_{T(0), T(0), T(0)}, force_{T(0), T(0), T(0)};
    bool touching_ = false;
};

} // namespace forceshade
