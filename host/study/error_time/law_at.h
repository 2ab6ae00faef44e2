// A scene's law by the CPU oracle at places of the world, one after the other: what a live loop does.
#pragma once

#include <span>
#include <vector>

#include "host/prepare/prepared_case.h"

namespace forceshade::study::error_time {

/// Places of the world, m, as a law in T receives them: rounded once, of a mesh in its own frame.
template <typename T>
std::vector<reference::Vector<T>> places_of(const PreparedCase& prepared, std::span<const glm::dvec3> world) {
    std::vector<reference::Vector<T>> places;
    places.reserve(world.size());
    for (const glm::dvec3& at : world)
        places.emplace_back(prepared.images.mesh ? to_mesh_frame(prepared.images.mesh->structure, at) : at);
    return places;
}

/// Without a history: of a mesh the static field.
template <typename T> class DirectLaw {
public:
    explicit DirectLaw(const PreparedCase& prepared)
        : tables_(make_tables<T>(on_a_point(prepared.one.scene), prepared.images, Extent::what_varies)),
          law_(tables_.law()) {}
    DirectLaw(const DirectLaw&) = delete;
    DirectLaw& operator=(const DirectLaw&) = delete;

    /// At one of places_of().
    reference::Contact<T> at(const reference::Vector<T>& place) noexcept {
        if (law_.features.surface == layout::kSurfaceMesh)
            return reference::mesh_contact(law_, place, hint_);
        return reference::evaluate(law_, place);
    }
    const layout::Law<T>& law() const { return law_; }

private:
    static Scene on_a_point(Scene scene) {
        scene.grid.size = {1, 1, 1};
        if (scene.surface.kind == SurfaceKind::mesh)
            scene.grid.samples = 0;
        return scene;
    }

    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
    layout::uint hint_ = 0;
};

/// With a history: the god-object, which begins anew every `stroke` places. A mesh's law alone.
template <typename T> class ProxyLaw {
public:
    explicit ProxyLaw(const PreparedCase& prepared) : direct_(prepared) {}

    void begin(const reference::Vector<T>& place) { begin_probe(direct_.law(), around_, proxy_, place); }
    reference::Vector<T> force(const reference::Vector<T>& place) noexcept {
        return follow_probe(direct_.law(), around_, proxy_, glm::dvec3(0), place).contact.force;
    }

private:
    DirectLaw<T> direct_;
    reference::Neighbourhood<T> around_;
    reference::GodObject<T> proxy_;
};

/// The forces, N, at places of the world.
template <typename T>
std::vector<reference::Vector<T>> direct_forces(const PreparedCase& prepared, std::span<const glm::dvec3> world) {
    DirectLaw<T> law(prepared);
    std::vector<reference::Vector<T>> forces;
    forces.reserve(world.size());
    for (const reference::Vector<T>& place : places_of<T>(prepared, world))
        forces.push_back(law.at(place).force);
    return forces;
}

/// Likewise along strokes of so many places each.
template <typename T>
std::vector<reference::Vector<T>> proxy_forces(const PreparedCase& prepared, std::span<const glm::dvec3> world,
                                               std::size_t stroke) {
    ProxyLaw<T> law(prepared);
    const auto places = places_of<T>(prepared, world);
    std::vector<reference::Vector<T>> forces;
    forces.reserve(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i % stroke == 0)
            law.begin(places[i]);
        forces.push_back(law.force(places[i]));
    }
    return forces;
}

template <typename T> std::vector<glm::dvec3> in_double(std::span<const reference::Vector<T>> forces) {
    return {forces.begin(), forces.end()};
}

} // namespace forceshade::study::error_time
