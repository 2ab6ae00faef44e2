// L6: the god-object (Zilles & Salisbury 1995) on a polygon mesh, converged fully in every update.
#pragma once

#include "host/reference/god_object_held.h"
#include "host/reference/god_object_rest.h"

namespace forceshade::reference {

/// The state of one path, in the mesh's frame. As constructed: a path that has not begun.
template <typename T> struct GodObject {
    Vector<T> proxy{T(0)};              /* a skin away from every triangle; the probe itself out of contact */
    layout::uint triangles[3]{0, 0, 0}; /* that held it at the last update */
    layout::uint count = 0;
    bool cornered = false; /* rested at a corner or an edge */
    bool started = false;
};

/// Begins a path: the proxy is the probe, or a skin away from what it touches, on the side where it is; in front of a
/// triangle if it is on it exactly.
template <typename T>
void begin_path(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& around,
                const Vector<T>& probe) noexcept {
    constexpr int kTries = 64;
    state.proxy = probe;
    state.count = 0;
    state.cornered = false;
    state.started = true;
    if (largest_of(probe) > T(kRegion))
        return;
    for (int i = 0; i < kTries; ++i) {
        Touch<T> nearest{}, touch{};
        nearest.distance = Skin<T>::kImpact;
        visit_near(mesh, around, Move<T>{state.proxy, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
            begin_touch(mesh, index, touch);
            look(touch, state.proxy);
            const layout::uint facet = mesh.triangle_facets[index], other = mesh.triangle_facets[nearest.index];
            const bool first =
                touch.distance == nearest.distance && (facet < other || (facet == other && index < nearest.index));
            if (touch.distance < nearest.distance || first)
                nearest = touch;
        });
        if (!(nearest.distance < Skin<T>::kImpact))
            return;
        const Vector<T> out = nearest.distance > Skin<T>::kRest ? nearest.away : nearest.face;
        state.proxy += (Skin<T>::kWidth - nearest.distance) * out;
    }
}

/// The update of a path that has begun, to a probe that is finite.
template <typename T, typename Trace>
GodObjectContact<T> follow(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& around,
                           const Vector<T>& probe, const Trace& trace) noexcept {
    Rest<T> rest{
        state.proxy, {state.triangles[0], state.triangles[1], state.triangles[2]}, state.count, state.cornered};
    Walk<T, Trace> walk(mesh, around, state.proxy, probe, trace);
    Settler<T, Walk<T, Trace>> settler(mesh, around, probe, walk);
    GodObjectContact<T> contact = settler.run(rest);
    contact.finished = settler.finished();
    contact.substeps = walk.substeps();
    state.proxy = rest.proxy;
    state.cornered = rest.cornered;
    state.count = rest.cornered ? rest.count : contact.count;
    for (layout::uint i = 0; i < 3; ++i)
        if (i < state.count)
            state.triangles[i] = rest.cornered ? rest.triangles[i] : contact.triangles[i];
    return contact;
}

/// L6: the probe takes its new position, in the mesh's frame; the proxy follows until nothing lets it come closer,
/// crossing no triangle. A probe that is not finite changes nothing and is out of contact. No allocation.
template <typename T, typename Trace = NoTrace>
GodObjectContact<T> update(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& around,
                           const Vector<T>& probe, const Trace& trace = {}) noexcept {
    if (!is_finite(probe))
        return out_of_contact(probe);
    if (!state.started)
        begin_path(mesh, state, around, probe);
    return follow(mesh, state, around, probe, trace);
}

} // namespace forceshade::reference
