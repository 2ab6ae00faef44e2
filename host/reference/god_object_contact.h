// L7 to L9 on the god-object's contact (L6): depth, force, proxy and facet in the world.
#pragma once

#include "host/reference/god_object.h"
#include "host/reference/mesh_contact.h"

namespace forceshade::reference {

/// The force on a probe (in the mesh's frame) that a god-object holds. The facet shaded is the lowest of those that
/// hold it; seen from behind, its interpolated normal is reversed.
template <typename T>
Contact<T> mesh_contact(const layout::Law<T>& law, const GodObjectContact<T>& held, const Vector<T>& probe) noexcept {
    if (!held.touching)
        return free_contact(law, probe);
    const Vector<T> offset = held.proxy - probe;
    MeshTouch<T> touch{held.facets[0], offset, held.proxy, std::sqrt(dot(offset, offset))};
    Contact<T> contact = touching_contact(law, touch);
    if (dot(held.normals[0], vector_at(law.mesh.triangle_normals, held.triangles[0])) < T(0)) {
        const T stiffness = law.mesh.params.stiffness;
        const Vector<T> pull{stiffness * offset.x, stiffness * offset.y, stiffness * offset.z};
        touch.offset = -offset;
        contact.force = (contact.unshaded - pull) - shaded_force(law, touch, Vector<T>(-pull), contact.proxy);
    }
    return contact;
}

} // namespace forceshade::reference
