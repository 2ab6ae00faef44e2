// A god-object on a mesh, in the mesh's frame, for the tests of the god-object.
#pragma once

#include <cstdlib>
#include <memory>

#include <glm/geometric.hpp>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade::walks {

/// Not to be copied: its parts refer to each other.
template <typename T> struct Run {
    static constexpr double kSkin = double(reference::Skin<T>::kWidth);

    explicit Run(PolygonSoup polygons)
        : structure(build_structure(shapes::mesh_of(std::move(polygons)))), tables(make_mesh_tables<T>(structure, 1.0)),
          mesh(tables.view()), triangles(brute::Triangles::of(mesh.vertices, mesh.triangle_corners)), grid(triangles) {}
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    /// Moves the probe; every piece of the way is checked in exact arithmetic.
    reference::GodObjectContact<T> update(const glm::vec<3, T>& probe) {
        crossed = false;
        return reference::update(mesh, state, *around, probe, [&](const auto& from, const auto& to) {
            crossed = crossed || grid.touches(wide(from), wide(to));
        });
    }

    /// How far the contact moves if the same probe is given again.
    double moves_again(const glm::vec<3, T>& probe, const reference::GodObjectContact<T>& contact) {
        reference::GodObject<T> same = state;
        return glm::length(wide(reference::update(mesh, same, *around, probe).proxy) - wide(contact.proxy));
    }

    MeshStructure structure;
    MeshTables<T> tables;
    layout::MeshView<T> mesh;
    brute::Triangles triangles;
    brute::TriangleGrid grid;
    reference::GodObject<T> state;
    std::unique_ptr<reference::Neighbourhood<T>> around = std::make_unique<reference::Neighbourhood<T>>();
    bool crossed = false; /* by the last update */
};

inline bool in_long_form() {
    return std::getenv("FORCESHADE_LONG") != nullptr;
}

} // namespace forceshade::walks
