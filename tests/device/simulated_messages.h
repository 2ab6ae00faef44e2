// What the simulated service says and understands, apart from sockets.
#pragma once

#include <optional>
#include <string>

#include "tests/device/simulated_service.h"

namespace forceshade::device::test {

/// Of a command; nothing for what is none. `understood` is false, and the force zero, in the other dialect.
std::optional<Received> read_command(const std::string& message, const ServiceScript& script);

std::string inventory(const ServiceScript& script);

/// The answer to a command `seconds` after the start, spoiled as the script's fault says.
std::string answer(const ServiceScript& script, double seconds, const glm::dvec3& force);

/// A state that nobody asked for: as the script's fault says, of a place where the device never is, or an older one.
std::string unasked_state(const ServiceScript& script, double seconds);

/// Where the first device is.
glm::dvec3 place_at(const ServiceScript& script, double seconds);

} // namespace forceshade::device::test
