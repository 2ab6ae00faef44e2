// L6: the proxy with which a path begins.
#pragma once

#include "host/reference/god_object.h"
#include "host/reference/mesh_nearest.h"
#include "host/reference/mesh_winding.h"

namespace forceshade::reference {

/// m to the mesh's frame.
template <typename T> Vector<T> to_mesh_frame(const layout::MeshParams<T>& params, const Vector<T>& world) noexcept {
    return {(world.x - params.centre_x) / params.scale, (world.y - params.centre_y) / params.scale,
            (world.z - params.centre_z) / params.scale};
}

template <typename T> bool is_inside(const layout::Law<T>& law, const Nearest<T>& found, const Vector<T>& probe) {
    return law.features.inside == layout::kInsideWinding ? inside_by_winding(law.mesh, probe)
                                                         : inside_by_pseudonormal(law.mesh, found);
}

/// Where the proxy is before the first step: at the probe, or a skin away from what it touches. A path that begins
/// behind the surface begins at the nearest place of it, in front. `probe` is in the mesh's frame.
template <typename T>
layout::ProxyStart<T> proxy_start(const layout::Law<T>& law, Neighbourhood<T>& around,
                                  const Vector<T>& probe) noexcept {
    Vector<T> place = probe;
    bool inside = false;
    if (largest_of(probe) <= T(kRegion)) {
        const Nearest<T> found = nearest(law.mesh, probe);
        inside = is_inside(law, found, probe);
        if (inside) {
            const Vector<T> way = normalised(found.offset);
            const bool deep = dot(way, way) > T(0);
            const Vector<T> out = deep ? way : vector_at(law.mesh.triangle_normals, found.triangle);
            place = (probe + found.offset) + Skin<T>::kWidth * out;
        }
    }
    GodObject<T> state;
    begin_path(law.mesh, state, around, place);
    return {state.proxy.x, state.proxy.y, state.proxy.z, inside ? 1U : 0U};
}

/// A god-object before its first update.
template <typename T> GodObject<T> begun(const layout::ProxyStart<T>& start) noexcept {
    GodObject<T> state;
    state.proxy = {start.x, start.y, start.z};
    state.started = true;
    return state;
}

} // namespace forceshade::reference
