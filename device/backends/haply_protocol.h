// The Inverse Service's protocol as text: its address, the axes of its numbers, commands, answers. No sockets here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "device/backends/haply.h"

namespace forceshade::device {

/// Counts the answers that are due: the service gives exactly one for each command, in order, and numbers neither.
/// Normally one command is under way at a time. If its answer is late, one command without force is sent after it, so
/// that a service that recovers finds that as the last one; then no command is sent until both answers are here. The
/// first of them is too old and is dropped. An answer without a command is dropped too: if it comes while another is
/// due, it counts as that one (it is a valid state of the device), and the next is dropped.
class LockStep {
public:
    enum class Kind { current, older, unasked };

    std::size_t owed() const { return owed_; }
    void sent() { ++owed_; }
    void reset() { owed_ = 0; }

    Kind answered() {
        if (owed_ == 0)
            return Kind::unasked;
        return --owed_ == 0 ? Kind::current : Kind::older;
    }

private:
    std::size_t owed_ = 0;
};

/// The axes of the service's numbers. The Inverse3's own are the world's: x to the right, y forward (away from the
/// user), z up. A session may have others, which the service names by a permutation: "X-YZ" says that its y is the
/// device's -y, "YZX" that its x is the device's y, its y the device's z and its z the device's x. Positions and forces
/// are both in those axes.
struct Axes {
    std::array<int, 3> from{0, 1, 2};
    glm::dvec3 sign{1};

    glm::dvec3 to_world(const glm::dvec3& service) const {
        glm::dvec3 world{0};
        for (int i = 0; i < 3; ++i)
            world[from[static_cast<std::size_t>(i)]] = sign[i] * service[i];
        return world;
    }

    glm::dvec3 to_service(const glm::dvec3& world) const {
        glm::dvec3 service{0};
        for (int i = 0; i < 3; ++i)
            service[i] = sign[i] * world[from[static_cast<std::size_t>(i)]];
        return service;
    }
};

/// Empty unless it is a permutation of X, Y and Z with optional signs; for an empty text, the device's own axes.
std::optional<Axes> parse_basis(std::string_view permutation);

/// The one in which a service of this version ("3.1.2", "3.5.0-2-gce34c39e") reads forces. The `vector` is documented
/// from 3.5 on, which unified the API's vectors; clients of 3.1 send `values`. Without a version: vector.
HaplyOptions::Dialect dialect_of(std::string_view version);

/// The version in a service's answer to GET /version; empty: none.
std::string read_version(std::string_view body);

/// Whether a message lists a grip, which has the buttons a, b and c.
bool tells_of_grip(std::string_view message);

/// The first message of a connection; empty: it is not an inventory.
std::optional<std::vector<HaplyDevice>> read_inventory(std::string_view message);

/// A force, N, in the service's axes, finite, as the command for one device. It holds for one answer of the service:
/// commands do not persist.
void write_command(std::string& message, HaplyOptions::Dialect dialect, std::string_view device_id,
                   const glm::dvec3& force);

/// A command as a WebSocket frame, ready to be sent.
std::string frame(std::string_view message);

/// The conditions for a force in a device's status, one bit each: calibrated, power_supply, ready, started. A status
/// need not name all of them.
struct Readiness {
    unsigned known = 0;
    unsigned unmet = 0; // of those in the status
};

/// The first condition that is not met, in words; null: none.
const char* objection(unsigned unmet);

/// An answer of the service.
struct State {
    const char* fault = nullptr; // the error, in words; null: it has a position
    glm::dvec3 position{0};      /* m, in the service's axes */
    Readiness readiness;         // of the device; with a fault, too
    std::uint32_t buttons = 0;   // of the grips: a, b, c as bits 0, 1, 2; none if the service lists no grip
};

/// Of one device; others are ignored.
State read_state(std::string_view message, std::string_view device_id);

} // namespace forceshade::device
