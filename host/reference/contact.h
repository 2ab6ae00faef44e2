// L1 to L5 and L8: depth, force, proxy and facet of a probe, step for step as shaders/laws/contact.glsl.
#pragma once

#include <limits>

#include "host/reference/mesh_contact.h"
#include "host/reference/surfaces.h"

namespace forceshade::reference {

/// The unit vector from the cylinder's axis to the probe and its distance in m; z and 0 where the probe is on the axis.
template <typename T> struct Radial {
    Vector<T> direction{0, 0, 1};
    T distance = T(0); /* m */
};

template <typename T> Radial<T> radial_at(const layout::LawParams<T>& params, T x, T z) noexcept {
    const T rise = z + params.centre_depth;
    const T square = x * x + rise * rise;
    if (!(square >= std::numeric_limits<T>::min()))
        return {};
    const T distance = sqrt(square);
    return {{x / distance, T(0), rise / distance}, distance};
}

/// L8: the tangential force of the texture, added to any law.
template <typename T>
Vector<T> textured(const layout::Law<T>& law, const Vector<T>& force, T depth, Gradient<T> texture) noexcept {
    if (law.features.texture == layout::kMapNone)
        return force;
    const T scale = law.params.texture_stiffness * depth;
    return {force.x - scale * texture.x, force.y - scale * texture.y, force.z};
}

/// L2: plane and cylinder, each computed alone, superposed. The depth is the deeper of the two; facet 0 is the
/// cylinder, 1 the plane.
template <typename T>
Contact<T> cylinder_bump_contact(const layout::Law<T>& law, const Column<T>& column, T z) noexcept {
    const layout::LawParams<T>& params = law.params;
    Contact<T> contact{T(0), Vector<T>(T(0)), Vector<T>(T(0)), {column.x, column.y, z}, layout::kNoFacet};
    const T plane_depth = z < T(0) ? -z : T(0);
    // R^2 - r^2 = (a-x)(a+x) - z(z + 2 sqrt(R^2-a^2)): R - r without cancellation.
    const T power = (params.half_width - column.x) * (params.half_width + column.x) -
                    z * (z + (params.centre_depth + params.centre_depth));
    if (!(plane_depth > T(0) || power > T(0)))
        return contact;
    const Radial<T> radial = radial_at(params, column.x, z);
    const T cylinder_depth = power > T(0) ? power / (params.radius + radial.distance) : T(0);
    const T plane_force = params.stiffness * plane_depth;
    const T cylinder_force = params.stiffness * cylinder_depth;
    const Vector<T> force{cylinder_force * radial.direction.x, T(0), plane_force + cylinder_force * radial.direction.z};
    const bool on_cylinder = cylinder_depth >= plane_depth;
    contact.depth = on_cylinder ? cylinder_depth : plane_depth;
    contact.facet = on_cylinder ? 0 : 1;
    contact.force = textured(law, force, contact.depth, column.texture);
    contact.unshaded = contact.force;
    contact.proxy = on_cylinder ? Vector<T>{column.x + cylinder_depth * radial.direction.x, column.y,
                                            z + cylinder_depth * radial.direction.z}
                                : Vector<T>{column.x, column.y, T(0)};
    return contact;
}

/// L1, L3, L4, L5: one nominal facet below the probe; shading replaces the direction and keeps the magnitude.
template <typename T> Contact<T> facet_contact(const layout::Law<T>& law, const Column<T>& column, T z) noexcept {
    const layout::Features& features = law.features;
    Contact<T> contact{T(0), Vector<T>(T(0)), Vector<T>(T(0)), {column.x, column.y, z}, layout::kNoFacet};
    T depth = column.facet.height - z;
    if (!(depth > T(0)))
        return contact;
    contact.proxy = {column.x, column.y, column.facet.height};
    const Vector<T> normal{column.facet.normal_x, T(0), column.facet.normal_z};
    if (features.depth == layout::kDepthNormal) {
        depth = depth * normal.z;
        contact.proxy = {column.x + depth * normal.x, column.y, z + depth * normal.z};
    }
    const T magnitude = law.params.stiffness * depth;
    Vector<T> direction = features.shading == layout::kShadingNone ? normal : column.direction;
    if (features.shading == layout::kShadingReference && features.reference == layout::kReferenceRadial &&
        column.on_bump)
        direction = radial_at(law.params, column.x, z).direction;
    contact.depth = depth;
    contact.facet = column.facet.id;
    contact.force = textured(law, Vector<T>(magnitude * direction), depth, column.texture);
    contact.unshaded = textured(law, Vector<T>(magnitude * normal), depth, column.texture);
    return contact;
}

/// The law at height z, m, in a column; of a mesh all three coordinates are those of its frame.
template <typename T> Contact<T> contact_at(const layout::Law<T>& law, const Column<T>& column, T z) noexcept {
    if (law.features.surface == layout::kSurfaceMesh)
        return mesh_contact(law, Vector<T>(column.x, column.y, z));
    if (law.features.surface == layout::kSurfaceCylinderBump)
        return cylinder_bump_contact(law, column, z);
    return facet_contact(law, column, z);
}

/// The law at a probe position, m. What the live loop calls.
template <typename T> Contact<T> evaluate(const layout::Law<T>& law, const Vector<T>& probe) noexcept {
    return contact_at(law, column_at(law, probe.x, probe.y), probe.z);
}

} // namespace forceshade::reference
