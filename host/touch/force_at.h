// A scene's force by the CPU oracle where a hand touches: by the place alone, or after coming down to it, as in a live
// loop.
#pragma once

#include <span>
#include <vector>

#include "host/field/case_law.h"
#include "host/touch/places.h"

namespace forceshade {

/// Without a history: of a mesh the static field.
template <typename T> class StaticForce {
public:
    explicit StaticForce(const PreparedCase& prepared) : law_(prepared) {}

    /// The law's input for a place, and the force there, N.
    reference::Vector<T> input(const TouchPlace& place) const { return law_.rounded(place.at); }
    reference::Vector<T> force(const reference::Vector<T>& input) noexcept {
        return law_.at_rounded(input, hint_).force;
    }

private:
    CaseLaw<T> law_;
    layout::uint hint_ = 0;
};

/// Updates of a god-object on its approach to a place.
inline constexpr std::size_t kDescent = 8;

/// The approach to a place, m, from above the surface and down along the normal.
inline std::vector<glm::dvec3> descent(const TouchPlace& place, const TouchScale& scale) {
    const glm::dvec3 from = place.at + (place.depth + scale.ring()) * place.normal;
    std::vector<glm::dvec3> approach;
    for (std::size_t i = 1; i <= kDescent; ++i)
        approach.push_back(from + static_cast<double>(i) / kDescent * (place.at - from));
    return approach;
}

/// N, at the end of an approach, m.
template <typename T>
reference::Vector<T> force_after(CaseProbe<T>& probe, std::span<const glm::dvec3> approach) noexcept {
    probe.begin_path();
    reference::Vector<T> force(T(0));
    for (const glm::dvec3& place : approach)
        force = probe.at(place).contact.force;
    return force;
}

/// With a history: the god-object of a mesh, which approaches places from above. Without a hint it looks for the
/// triangles about its proxy anew at each update.
template <typename T, bool hint = true> class ProxyForce {
public:
    static constexpr std::size_t kUpdates = kDescent; /* of force() */

    explicit ProxyForce(const PreparedCase& prepared, const TouchScale& scale = {}) : scale_(scale), probe_(prepared) {}

    std::vector<glm::dvec3> input(const TouchPlace& place) const { return descent(place, scale_); }
    reference::Vector<T> force(std::span<const glm::dvec3> approach) noexcept {
        reference::Vector<T> force(T(0));
        for (std::size_t i = 0; i < approach.size(); ++i)
            force = update(approach, i);
        return force;
    }
    /// Of update `i` of an approach alone: they come in order.
    reference::Vector<T> update(std::span<const glm::dvec3> approach, std::size_t i) noexcept {
        if (i == 0)
            probe_.begin_path();
        if constexpr (!hint)
            probe_.forget_neighbours();
        return probe_.at(approach[i]).contact.force;
    }

private:
    TouchScale scale_;
    CaseProbe<T> probe_;
};

/// N, at places, by a law with input() and force().
template <typename Law> std::vector<glm::dvec3> forces_by(Law&& law, std::span<const TouchPlace> at) {
    std::vector<glm::dvec3> forces;
    for (const TouchPlace& place : at)
        forces.emplace_back(law.force(law.input(place)));
    return forces;
}

/// What a hand feels of a surface in double precision: on a mesh, after coming down to the place.
class ContactForce {
public:
    ContactForce(const PreparedCase& prepared, const TouchScale& scale)
        : scale_(scale), mesh_(prepared.images.mesh != nullptr), probe_(prepared) {}

    /// N: at the place, `aside` of it, m.
    glm::dvec3 operator()(const TouchPlace& place, const glm::dvec3& aside = glm::dvec3(0)) {
        const glm::dvec3 at = place.at + aside;
        if (!mesh_)
            return glm::dvec3(probe_.law().at(at).force);
        std::vector<glm::dvec3> way = descent(place, scale_);
        if (aside != glm::dvec3(0))
            way.push_back(at);
        return glm::dvec3(force_after(probe_, way));
    }

private:
    TouchScale scale_;
    bool mesh_;
    CaseProbe<double> probe_;
};

} // namespace forceshade
