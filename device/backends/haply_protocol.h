// What is said to the Inverse Service and by it, as text: its address, the axes of its numbers, commands, answers.
// Nothing here knows a socket.
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

/// Counts the answers that are owed: the service gives exactly one for each command, in order, and numbers neither. As
/// a rule one command is under way at a time. Where its answer is late, one command without force is sent after it, so
/// that a service that recovers finds that as the last one; nothing more is sent until both answers are here. The first
/// of them is then older than what is asked for and is dropped. An answer that nobody owes is dropped too: should it
/// come while one is owed, it counts as that one (it is a state of the device as good as any), and the next is dropped.
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

/// The axes in which the service speaks. The Inverse3's own are the world's: x to the right, y forward (away from the
/// user), z up. A session may have others, which the service names by a permutation: "X-YZ" says that its y is the
/// device's -y, "YZX" that its x is the device's y, its y the device's z and its z the device's x. Positions and forces
/// are both in those axes.
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

/// The one in which a service of this version ("3.1.2", "3.5.0-2-gce34c39e") reads forces. The `vector` is documented
/// from 3.5 on, which took the API's vectors into one shape; clients of 3.1 send `values`. Of no version: vector.
HaplyOptions::Dialect dialect_of(std::string_view version);

/// What a service answers to GET /version; empty: it does not tell.
std::string read_version(std::string_view body);

/// Whether a message tells of a grip, which has the buttons a, b and c.
bool tells_of_grip(std::string_view message);

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
    std::uint32_t buttons = 0;   // of the grips: a, b, c as bits 0, 1, 2; none where the service tells of no grip
};

/// Of one device; others are passed over.
State read_state(std::string_view message, std::string_view device_id);

} // namespace forceshade::device
