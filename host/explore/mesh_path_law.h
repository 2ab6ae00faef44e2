// L6 to L9 along paths: the god-object, one for each path.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/explore/path_law.h"
#include "host/field/scene_mesh.h"
#include "host/reference/god_object.h"
#include "host/reference/mesh_contact.h"

namespace forceshade {

/// What a god-object at rest feels. A facet that holds it from behind is shaded as its mirror image, so that the force
/// points to the proxy's side there too.
template <typename T>
reference::Contact<T> god_object_contact(const layout::Law<T>& law, const reference::GodObjectContact<T>& rest,
                                         const reference::Vector<T>& probe) noexcept {
    using reference::dot, reference::vector_at;
    if (!rest.touching)
        return reference::free_contact(law, probe);
    const reference::Vector<T> offset = rest.proxy - probe;
    const reference::MeshTouch<T> touch{rest.facets[0], offset, rest.proxy, std::sqrt(dot(offset, offset))};
    if (!(dot(rest.normals[0], vector_at(law.mesh.facet_normals, rest.facets[0])) < T(0)))
        return reference::touching_contact(law, touch);
    // Texture (L8) knows no side: its pull is what it is from above.
    layout::Law<T> smooth = law;
    smooth.features.texture = layout::kMapNone;
    reference::MeshTouch<T> mirrored = touch;
    mirrored.offset = -offset;
    reference::Contact<T> contact = reference::touching_contact(smooth, mirrored);
    contact.force = -contact.force;
    contact.unshaded = -contact.unshaded;
    if (law.features.texture != layout::kMapNone) {
        const reference::Contact<T> textured = reference::touching_contact(law, touch);
        const reference::Contact<T> plain = reference::touching_contact(smooth, touch);
        contact.force += textured.unshaded - plain.unshaded;
        contact.unshaded += textured.unshaded - plain.unshaded;
    }
    return contact;
}

template <typename T> class MeshPathLaw final : public PathLaw<T> {
public:
    explicit MeshPathLaw(const PreparedCase& prepared)
        : structure_(prepared.images.mesh->structure),
          tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}

    double largest_coordinate() const override {
        const glm::dvec3& centre = structure_.centre;
        const double middle = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)});
        return std::min(kLargestLength<T>, middle + kLargestLength<T> * structure_.scale);
    }

    PathContact<T> at(std::size_t path, const glm::dvec3& probe) override {
        const reference::Vector<T> local(to_mesh_frame(structure_, probe));
        const bool begins = path == proxies_.size();
        if (begins)
            proxies_.emplace_back();
        const auto rest = reference::update(law_.mesh, proxies_[path], around_, local);
        PathContact<T> felt;
        felt.contact = god_object_contact(law_, rest, local);
        if (felt.contact.facet == layout::kNoFacet)
            felt.contact.proxy = reference::Vector<T>(probe); // not there and back through the mesh's frame
        felt.finished = rest.finished;
        felt.begins_inside = begins && is_inside(local);
        return felt;
    }

private:
    bool is_inside(const reference::Vector<T>& local) const {
        if (law_.features.inside == layout::kInsideWinding)
            return reference::inside_by_winding(law_.mesh, local);
        return reference::inside_by_pseudonormal(law_.mesh, reference::nearest(law_.mesh, local));
    }

    const MeshStructure& structure_;
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
    reference::Neighbourhood<T> around_;
    std::vector<reference::GodObject<T>> proxies_; // by path
};

} // namespace forceshade
