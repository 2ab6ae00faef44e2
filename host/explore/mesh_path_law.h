// L6 to L9 along paths: the god-object, one for each path.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/explore/path_law.h"
#include "host/field/scene_mesh.h"
#include "host/reference/god_object_contact.h"

namespace forceshade {

template <typename T> class MeshPathLaw final : public PathLaw<T> {
public:
    explicit MeshPathLaw(const PreparedCase& prepared)
        : structure_(prepared.images.mesh->structure),
          tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}

    double largest_coordinate() const override {
        const glm::dvec3& centre = structure_.centre;
        const double middle = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)});
        return std::min(kLargestLength<T>, middle + kMeshReach<T> * structure_.scale);
    }

    PathContact<T> at(std::size_t path, const glm::dvec3& probe) override {
        const reference::Vector<T> local(to_mesh_frame(structure_, probe));
        if (!(reference::largest_coordinate(local) <= T(kMeshReach<T>)))
            throw UsageError(
                fmt::format("path position ({}, {}, {}) m is more than {:.0f} times the mesh's size from its "
                            "centre, further than {} can follow; is the unit right?",
                            probe.x, probe.y, probe.z, kMeshReach<T> / 2, std::is_same_v<T, float> ? "f32" : "f64"));
        const bool begins = path == proxies_.size();
        if (begins)
            proxies_.emplace_back();
        const auto rest = reference::update(law_.mesh, proxies_[path], around_, local);
        PathContact<T> felt;
        felt.contact = reference::mesh_contact(law_, rest, local);
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
