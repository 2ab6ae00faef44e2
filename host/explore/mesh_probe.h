// L6 to L9 as one probe meets them in the world: the god-object begins, and follows.
#pragma once

#include "host/explore/path_law.h"
#include "host/field/scene_mesh.h"
#include "host/reference/god_object_contact.h"
#include "host/reference/god_object_start.h"

namespace forceshade {

/// Whether a place of the mesh's frame is one at which T still follows a probe.
template <typename T> bool is_within_reach(const reference::Vector<T>& local) noexcept {
    return reference::largest_coordinate(local) <= T(kMeshReach<T>);
}

/// Begins a path at a place of the mesh's frame; true if that is behind the surface.
template <typename T>
bool begin_probe(const layout::Law<T>& law, reference::Neighbourhood<T>& around, reference::GodObject<T>& proxy,
                 const reference::Vector<T>& local) noexcept {
    const layout::ProxyStart<T> start = reference::proxy_start(law, around, local);
    proxy = reference::begun(start);
    return start.inside != 0;
}

/// Takes the probe on, to `probe`, m, which in the mesh's frame is `local`. Neither allocates nor throws.
template <typename T>
PathContact<T> follow_probe(const layout::Law<T>& law, reference::Neighbourhood<T>& around,
                            reference::GodObject<T>& proxy, const glm::dvec3& probe,
                            const reference::Vector<T>& local) noexcept {
    const auto rest = reference::update(law.mesh, proxy, around, local);
    PathContact<T> felt;
    felt.contact = reference::mesh_contact(law, rest, local);
    if (felt.contact.facet == layout::kNoFacet)
        felt.contact.proxy = reference::Vector<T>(probe); // not there and back through the mesh's frame
    felt.finished = rest.finished;
    return felt;
}

} // namespace forceshade
