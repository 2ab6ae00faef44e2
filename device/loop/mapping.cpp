#include "device/loop/mapping.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace forceshade::device {

namespace {

// "-y", or "(0.8660, 0.5000, 0.0000)" if it is not along an axis.
std::string direction_text(const glm::dvec3& direction) {
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(direction[axis]) == 1)
            return fmt::format("{}{}", direction[axis] < 0 ? "-" : "", "xyz"[axis]);
    return fmt::format("({:.4f}, {:.4f}, {:.4f})", direction.x, direction.y, direction.z);
}

} // namespace

std::string mapping_text(const Mapping& mapping) {
    const glm::dvec3 origin = 1e3 * mapping.origin + 0.0; // no -0
    std::string text = fmt::format("origin at ({:.6g}, {:.6g}, {:.6g}) mm", origin.x, origin.y, origin.z);
    if (mapping.turn != glm::dmat3(1))
        text += fmt::format(", scene's x, y, z along the device's {}, {}, {}", direction_text(mapping.turn[0]),
                            direction_text(mapping.turn[1]), direction_text(mapping.turn[2]));
    if (mapping.scale != 1)
        text += fmt::format("; {0:.6g} m of the scene in a metre of the device: springs feel {0:.6g} times as stiff",
                            mapping.scale);
    return text;
}

glm::dmat3 turn_about(int axis, double angle) {
    constexpr double kQuarter = std::numbers::pi / 2;
    const double quarters = angle / kQuarter, whole = std::round(quarters);
    double sine = std::sin(angle), cosine = std::cos(angle);
    if (std::abs(quarters - whole) < 1e-12) {
        constexpr double kSines[]{0, 1, 0, -1};
        const int quarter = static_cast<int>(std::fmod(std::fmod(whole, 4) + 4, 4));
        sine = kSines[quarter];
        cosine = kSines[(quarter + 1) % 4];
    }
    const int next = (axis + 1) % 3, after = (axis + 2) % 3;
    glm::dmat3 turn(1);
    turn[next] = glm::dvec3(0);
    turn[after] = glm::dvec3(0);
    turn[next][next] = cosine;
    turn[next][after] = sine;
    turn[after][next] = -sine;
    turn[after][after] = cosine;
    return turn;
}

} // namespace forceshade::device
