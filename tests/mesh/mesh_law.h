// A mesh as a law of the oracle.
#pragma once

#include "host/mesh/structure.h"
#include "host/reference/contact.h"
#include "tests/mesh/shapes.h"

namespace forceshade::shapes {

/// With the tree of winding numbers; not to be copied, for the law refers to the tables.
template <typename T = double> struct MeshLaw {
    Mesh mesh;
    MeshStructure structure;
    MeshTables<T> tables;
    layout::Law<T> law{};
    layout::MeshView<T> view;

    /// `stiffness`: N/m.
    explicit MeshLaw(Mesh given, double stiffness = 1)
        : mesh(std::move(given)), structure(build_structure(mesh, {.winding = true})),
          tables(make_mesh_tables<T>(structure, stiffness)), view(tables.view()) {
        law.features.surface = layout::kSurfaceMesh;
        law.mesh = view;
    }
    explicit MeshLaw(PolygonSoup polygons, double stiffness = 1) : MeshLaw(mesh_of(std::move(polygons)), stiffness) {}
    MeshLaw(const MeshLaw&) = delete;
    MeshLaw& operator=(const MeshLaw&) = delete;

    reference::Vector<T> local(const glm::dvec3& world) const {
        return reference::Vector<T>(to_mesh_frame(structure, world));
    }
    reference::Contact<T> at(const glm::dvec3& world) const { return reference::evaluate(law, local(world)); }
};

} // namespace forceshade::shapes
