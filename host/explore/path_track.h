// What is remembered of a recorded path while its samples pass by, in open loop.
#pragma once

#include <cstdint>

#include "host/path_output/contact_time.h"
#include "host/reference/path_step.h"

namespace forceshade {

template <typename T> struct PathTrack {
    std::uint64_t id;
    bool inside; /* it began behind the surface */
    std::uint64_t steps = 0;
    layout::PathState<T> state{};
    ContactTime contact;

    PathTrack(std::uint64_t number, bool began_inside) : id(number), inside(began_inside) {}

    /// The next sample: when, s, where the probe is, m, and what it feels. As reference::take_step in open loop.
    void add(double time, const reference::Vector<T>& probe, const reference::Contact<T>& felt, bool finished,
             T stretch) {
        if (steps == 0)
            state = reference::state_at(probe);
        const reference::PathSampled<T> sampled{probe, felt.force, felt};
        reference::add_sample(state.metrics, felt, felt.force);
        state.metrics.unfinished += finished ? 0 : 1;
        contact.add(time, felt.facet != layout::kNoFacet);
        reference::add_turn_at(state, sampled, stretch);
        reference::add_between(state, sampled);
        reference::keep_sample(state, sampled);
        ++steps;
    }
};

} // namespace forceshade
