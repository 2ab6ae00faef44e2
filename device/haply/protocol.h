// The service's messages as text. What is written and read here is JSON; nothing here knows a socket.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "device/haply/haply.h"

namespace forceshade::device {

/// The one in which a service of this version ("3.1.2", "3.5.0-2-gce34c39e") reads forces. The `vector` is documented
/// from 3.5 on, which took the API's vectors into one shape; clients of 3.1 send `values`. Of no version: vector.
HaplyOptions::Dialect dialect_of(std::string_view version);

/// What a service answers to GET /version; empty: it does not tell.
std::string read_version(std::string_view body);

/// The first message of a connection; nothing: it is no inventory.
std::optional<std::vector<HaplyDevice>> read_inventory(std::string_view message);

/// A force, N, in the service's axes, finite, as the command for one device. It holds for one answer of the service:
/// commands do not persist.
void write_command(std::string& message, HaplyOptions::Dialect dialect, std::string_view device_id,
                   const glm::dvec3& force);

/// A command as a WebSocket frame, ready to be sent.
std::string frame(std::string_view message);

/// What a device's status says of the conditions for a force, one bit each: calibrated, power_supply, ready, started.
/// A status need not name all of them.
struct Readiness {
    unsigned told = 0;
    unsigned unmet = 0; // of those told
};

/// In words, the first of the conditions that are not met; null: none.
const char* objection(unsigned unmet);

/// An answer of the service.
struct State {
    const char* fault = nullptr; // in words, what is wrong with it; null: it has a position
    glm::dvec3 position{0};      /* m, in the service's axes */
    Readiness readiness;         // of the device; with a fault, too
};

/// Of one device; others are passed over.
State read_state(std::string_view message, std::string_view device_id);

} // namespace forceshade::device
