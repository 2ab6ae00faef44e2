// The scene's placement in the device's space. The hand's position is in the device's axes and metres, relative to the
// scene's origin; the probe is that point in the scene.
#pragma once

#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace forceshade::device {

/// Positions are scaled, forces are not: a spring of the scene feels `scale` times as stiff. A force that is turned
/// back does the work on the hand that the law's force does on the probe, divided by the scale.
struct Mapping {
    glm::dvec3 origin{0}; /* m: where the scene's origin lies in the device's space */
    glm::dmat3 turn{1};   // columns: the scene's x, y and z in the device's axes; a rotation
    double scale = 1;     // of a metre of the device, in metres of the scene

    bool is_plain() const noexcept { return scale == 1 && turn == glm::dmat3(1); }

    // A scene that is neither turned nor scaled gives the same bits as without a mapping.
    glm::dvec3 to_scene(const glm::dvec3& hand) const noexcept {
        return is_plain() ? hand : scale * (hand * turn); // v * M: by the transpose
    }
    glm::dvec3 to_hand(const glm::dvec3& probe) const noexcept { return is_plain() ? probe : turn * probe / scale; }
    glm::dvec3 force_to_device(const glm::dvec3& force) const noexcept { return is_plain() ? force : turn * force; }
    glm::dvec3 force_to_scene(const glm::dvec3& force) const noexcept { return is_plain() ? force : force * turn; }
};

/// One line: "origin at (0, -150, 200) mm, scene's x, y, z along the device's y, -x, z; 2 m of the scene in a
/// metre of the device: springs feel 2 times as stiff".
std::string mapping_text(const Mapping& mapping);

/// A right-handed turn by `angle`, rad, about the device's axis 0, 1 or 2; exact for quarter turns.
glm::dmat3 turn_about(int axis, double angle);

} // namespace forceshade::device
