// A scene's law by the CPU oracle at places of the world, one after the other: what a live loop does.
#pragma once

#include <span>
#include <vector>

#include "host/prepare/prepared_case.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {

/// Places of the world, m, as a law in T receives them: rounded once, of a mesh in its own frame.
template <typename T>
std::vector<reference::Vector<T>> rounded_places(const PreparedCase& prepared, std::span<const glm::dvec3> world) {
    std::vector<reference::Vector<T>> places;
    places.reserve(world.size());
    for (const glm::dvec3& at : world)
        places.emplace_back(prepared.images.mesh ? to_mesh_frame(prepared.images.mesh->structure, at) : at);
    return places;
}

/// Without a history: of a mesh the static field.
template <typename T> class DirectLaw {
public:
    /// `prepared` must outlive it.
    explicit DirectLaw(const PreparedCase& prepared)
        : prepared_(prepared),
          tables_(make_tables<T>(on_a_point(prepared.one.scene), prepared.images, Extent::what_varies)),
          law_(tables_.law()) {}
    DirectLaw(const DirectLaw&) = delete;
    DirectLaw& operator=(const DirectLaw&) = delete;

    /// At one of rounded_places().
    reference::Contact<T> at(const reference::Vector<T>& place) noexcept {
        if (law_.features.surface == layout::kSurfaceMesh)
            return reference::mesh_contact(law_, place, hint_);
        return reference::evaluate(law_, place);
    }
    const layout::Law<T>& law() const { return law_; }

    /// What the law takes of a place, and the force there, N.
    reference::Vector<T> input(const Place& place) const {
        return rounded_places<T>(prepared_, std::span(&place.at, 1))[0];
    }
    reference::Vector<T> force(const reference::Vector<T>& input) noexcept { return at(input).force; }

private:
    static Scene on_a_point(Scene scene) {
        scene.grid.size = {1, 1, 1};
        if (scene.surface.kind == SurfaceKind::mesh)
            scene.grid.samples = 0;
        return scene;
    }

    const PreparedCase& prepared_;
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
    layout::uint hint_ = 0;
};

/// Updates of a god-object on its way to a place.
inline constexpr std::size_t kDescent = 8;

/// The way to a place, m, from above the surface and down along the normal.
inline std::vector<glm::dvec3> descent(const Place& place, const TouchScale& scale) {
    const glm::dvec3 from = place.at + (place.depth + scale.ring()) * place.normal;
    std::vector<glm::dvec3> way;
    for (std::size_t i = 1; i <= kDescent; ++i)
        way.push_back(from + static_cast<double>(i) / kDescent * (place.at - from));
    return way;
}

/// With a history: the god-object of a mesh, which comes to places from above.
template <typename T> class ProxyLaw {
public:
    explicit ProxyLaw(const PreparedCase& prepared, const TouchScale& scale = {})
        : prepared_(prepared), scale_(scale), direct_(prepared) {}

    std::vector<reference::Vector<T>> input(const Place& place) const {
        return rounded_places<T>(prepared_, descent(place, scale_));
    }
    /// N, at the end of a way of rounded_places().
    reference::Vector<T> force(std::span<const reference::Vector<T>> way) noexcept {
        begin_probe(direct_.law(), around_, proxy_, way.front());
        reference::Vector<T> force(T(0));
        for (const reference::Vector<T>& place : way)
            force = follow_probe(direct_.law(), around_, proxy_, reference::Vector<T>(T(0)), place).contact.force;
        return force;
    }

private:
    const PreparedCase& prepared_;
    TouchScale scale_;
    DirectLaw<T> direct_;
    reference::Neighbourhood<T> around_;
    reference::GodObject<T> proxy_;
};

/// N, at places, by a law with input() and force().
template <typename Law> std::vector<glm::dvec3> forces_by(Law&& law, std::span<const Place> at) {
    std::vector<glm::dvec3> forces;
    for (const Place& place : at)
        forces.emplace_back(law.force(law.input(place)));
    return forces;
}

} // namespace forceshade::study::error_time
