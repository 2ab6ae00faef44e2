// L6 static with L7 to L9: depth, force, proxy and facet of a probe in a mesh, step for step as
// shaders/laws/mesh_contact.glsl.
#pragma once

#include "host/reference/contact_result.h"
#include "host/reference/height_map.h"
#include "host/reference/mesh_nearest.h"
#include "host/reference/mesh_shading.h"
#include "host/reference/mesh_winding.h"

namespace forceshade::reference {

/// A point of the mesh's frame in m.
template <typename T> Vector<T> to_world(const layout::MeshParams<T>& params, const Vector<T>& point) noexcept {
    return {point.x * params.scale + params.centre_x, point.y * params.scale + params.centre_y,
            point.z * params.scale + params.centre_z};
}

/// The part of a height map's gradient that lies in a facet's plane.
template <typename T> Vector<T> in_plane(Gradient<T> gradient, const Vector<T>& facet_normal) noexcept {
    const T across = gradient.x * facet_normal.x + gradient.y * facet_normal.y;
    return {gradient.x - across * facet_normal.x, gradient.y - across * facet_normal.y, -(across * facet_normal.z)};
}

/// Where a probe touches a mesh.
template <typename T> struct MeshTouch {
    layout::uint facet;
    Vector<T> offset; /* 1: proxy - probe */
    Vector<T> point;  /* 1: the proxy, in the mesh's frame */
    T distance;       /* 1: |offset| */
};

/// L7 and L9: the force before texture; as the unshaded one where the direction has no length or `two_pass` would pull.
/// With both, `two_pass` makes up for the direction that the map has tilted.
template <typename T>
Vector<T> shaded_force(const layout::Law<T>& law, const MeshTouch<T>& touch, const Vector<T>& unshaded,
                       const Vector<T>& world) noexcept {
    const layout::Features& features = law.features;
    if (features.shading == layout::kShadingNone && features.map == layout::kMapNone)
        return unshaded;
    const Vector<T> facet_normal = vector_at(law.mesh.facet_normals, touch.facet);
    Vector<T> direction = shading_direction(law.mesh, features.shading, touch.facet, touch.point);
    if (!(dot(direction, direction) > T(0)))
        return unshaded;
    if (features.map != layout::kMapNone) {
        const Gradient<T> slope = gradient_at(features.map, law.params.map, law.map_gradients, world.x, world.y);
        direction = normalised(Vector<T>(direction - in_plane(slope, facet_normal)));
        if (!(dot(direction, direction) > T(0)))
            return unshaded;
    }
    T magnitude = law.mesh.params.stiffness * touch.distance;
    if (features.shading == layout::kShadingTwoPass) {
        const T lift = dot(direction, facet_normal);
        if (!(lift > T(0)))
            return unshaded;
        magnitude = magnitude / lift;
    }
    return {magnitude * direction.x, magnitude * direction.y, magnitude * direction.z};
}

/// The law where a probe touches; what the static field and the god-object have in common.
template <typename T> Contact<T> touching_contact(const layout::Law<T>& law, const MeshTouch<T>& touch) noexcept {
    const T stiffness = law.mesh.params.stiffness;
    const Vector<T> world = to_world(law.mesh.params, touch.point);
    Contact<T> contact;
    contact.depth = touch.distance * law.mesh.params.scale;
    contact.facet = touch.facet;
    contact.proxy = world;
    contact.unshaded = {stiffness * touch.offset.x, stiffness * touch.offset.y, stiffness * touch.offset.z};
    contact.force = shaded_force(law, touch, contact.unshaded, world);
    if (law.features.texture != layout::kMapNone) {
        const Vector<T> slope =
            in_plane(gradient_at(law.features.texture, law.params.texture, law.texture_gradients, world.x, world.y),
                     vector_at(law.mesh.facet_normals, touch.facet));
        const T pull = law.params.texture_stiffness * contact.depth;
        contact.force = contact.force - pull * slope;
        contact.unshaded = contact.unshaded - pull * slope;
    }
    return contact;
}

template <typename T> Contact<T> free_contact(const layout::Law<T>& law, const Vector<T>& probe) noexcept {
    return {T(0), Vector<T>(T(0)), Vector<T>(T(0)), to_world(law.mesh.params, probe), layout::kNoFacet};
}

/// L6 static: the probe (in the mesh's frame) is pulled to the nearest point of the surface that it is inside of.
/// `hint` as for nearest(); receives the nearest triangle.
template <typename T>
Contact<T> mesh_contact(const layout::Law<T>& law, const Vector<T>& probe, layout::uint& hint) noexcept {
    const Nearest<T> found = nearest(law.mesh, probe, hint);
    hint = found.triangle;
    const bool inside = law.features.inside == layout::kInsideWinding ? inside_by_winding(law.mesh, probe)
                                                                      : inside_by_pseudonormal(law.mesh, found);
    if (!inside)
        return free_contact(law, probe);
    return touching_contact(
        law, MeshTouch<T>{found.facet, found.offset, Vector<T>(probe + found.offset), std::sqrt(found.square)});
}

template <typename T> Contact<T> mesh_contact(const layout::Law<T>& law, const Vector<T>& probe) noexcept {
    layout::uint hint = 0;
    return mesh_contact(law, probe, hint);
}

} // namespace forceshade::reference
