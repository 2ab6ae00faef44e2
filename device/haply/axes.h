// The axes in which the service speaks, against the world's.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include <glm/vec3.hpp>

namespace forceshade::device {

/// The Inverse3's own axes are the world's: x to the right, y forward (away from the user), z up. A session may have
/// another basis, which the service names by a permutation: "X-YZ" says that its y is the device's -y, "YZX" that its x
/// is the device's y, its y the device's z and its z the device's x. Positions come and forces go in that basis.
struct Axes {
    std::array<int, 3> from{0, 1, 2};
    glm::dvec3 sign{1};

    glm::dvec3 to_world(const glm::dvec3& told) const {
        glm::dvec3 world{0};
        for (int i = 0; i < 3; ++i)
            world[from[static_cast<std::size_t>(i)]] = sign[i] * told[i];
        return world;
    }

    glm::dvec3 to_service(const glm::dvec3& world) const {
        glm::dvec3 told{0};
        for (int i = 0; i < 3; ++i)
            told[i] = sign[i] * world[from[static_cast<std::size_t>(i)]];
        return told;
    }
};

/// Nothing for what is no permutation of X, Y and Z with signs before them; of an empty text, the device's own.
std::optional<Axes> parse_basis(std::string_view permutation);

} // namespace forceshade::device
