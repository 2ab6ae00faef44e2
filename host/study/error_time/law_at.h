// A scene's law by the CPU oracle at places of the world, one after the other, as in a live loop.
#pragma once

#include <span>
#include <vector>

#include "host/field/case_law.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {

/// Without a history: of a mesh the static field.
template <typename T> class DirectLaw {
public:
    explicit DirectLaw(const PreparedCase& prepared) : law_(prepared) {}

    /// The law's input for a place, and the force there, N.
    reference::Vector<T> input(const Place& place) const { return law_.rounded(place.at); }
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
inline std::vector<glm::dvec3> descent(const Place& place, const TouchScale& scale) {
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

/// With a history: the god-object of a mesh, which approaches places from above.
template <typename T> class ProxyLaw {
public:
    explicit ProxyLaw(const PreparedCase& prepared, const TouchScale& scale = {}) : scale_(scale), probe_(prepared) {}

    std::vector<glm::dvec3> input(const Place& place) const { return descent(place, scale_); }
    reference::Vector<T> force(std::span<const glm::dvec3> approach) noexcept { return force_after(probe_, approach); }

private:
    TouchScale scale_;
    CaseProbe<T> probe_;
};

/// N, at places, by a law with input() and force().
template <typename Law> std::vector<glm::dvec3> forces_by(Law&& law, std::span<const Place> at) {
    std::vector<glm::dvec3> forces;
    for (const Place& place : at)
        forces.emplace_back(law.force(law.input(place)));
    return forces;
}

} // namespace forceshade::study::error_time
