// The Haply Inverse3 through the Inverse Service 3.x, a WebSocket that answers each command with one state: the device,
// the service's protocol as text (haply_protocol.cpp), and the thread that talks to it (haply_link.cpp).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "device/backends/back_end.h"

namespace forceshade::device {

struct HaplyOptions {
    /// How a force is written. The service changed it: 3.5 reads a `vector`, those before it `values`.
    enum class Dialect { by_version, vector, values };

    std::string url = "ws://localhost:10001";
    Dialect dialect = Dialect::by_version; // if the service does not report its version: vector
    std::string device_id;                 // empty: the only one
    double wait = 3;                       /* s: for the service to answer at all */
    double patience = 0.1;                 /* s: later answers count as lost, older positions as missing */
};

/// What follows the colon of `haply:URL`: `ws://HOST[:PORT][/PATH][?device=ID&dialect=vector|values]`. Empty: all by
/// default; `?device=ID` alone keeps the default address. Throws UsageError.
HaplyOptions parse_haply(std::string_view after_colon);

/// Opens the device. Throws DeviceAbsent where the service or the device is not there, with what to do about it, and
/// UsageError where there are several devices to choose from.
std::unique_ptr<BackEnd> open_haply(const HaplyOptions& options);

struct HaplyDevice {
    std::string id;     // "04BA"
    std::string type;   // "inverse3", as the service calls it
    std::string status; // "ready, not calibrated": as the service reports it
    std::string basis;  // "XYZ": the axes of its positions and forces
    unsigned unmet = 0; // conditions for a force that its status does not meet
    std::string remark; // what its configuration makes of positions and forces; empty: nothing
};

/// The result of a query at an address.
struct HaplyFinding {
    std::string url;
    std::string problem; // why the service cannot be used; empty: it can
    std::string version; // "3.5.0"; empty: not reported
    std::vector<HaplyDevice> devices;
    bool has_grip = false; // a VerseGrip with the buttons a, b and c
};

/// Asks for version and inventory; sends no command. `wait`, in s, is for each answer.
HaplyFinding look_for_haply(const std::string& url, double wait = 3);

// The service's protocol as text: its address, the axes of its numbers, commands, answers (haply_protocol.cpp).

/// Where the service listens: the parts of a ws:// URL.
struct Address {
    std::string host; // without the brackets of an IPv6 address
    std::string port;
    std::string path; // from its slash on
    std::string host_field() const;
};

/// Throws UsageError unless it has the form `ws://HOST[:PORT][/PATH]`.
Address parse_address(std::string_view url);

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

// The thread that talks to the service, and the data that it exchanges with the live loop's (haply_link.cpp).

/// The device's last answer.
struct Measurement {
    bool good = false;      // it has a position; false: it has none, came too late, or the service is gone
    std::int64_t time = 0;  /* ns, of the steady clock: when it arrived */
    glm::dvec3 position{0}; /* m, in the world's axes, finite */
    std::uint32_t buttons = 0;
};

/// Forces one way, positions the other, without either thread waiting for the other.
class Exchange {
public:
    /// `zero_frame`: a command without force, as sent. Throws Error if the system has no more descriptors.
    explicit Exchange(std::string zero_frame);
    ~Exchange();
    Exchange(const Exchange&) = delete;
    Exchange& operator=(const Exchange&) = delete;

    Newest<glm::dvec3> force;          /* N: from the live loop */
    Newest<Measurement> measurement;   // for the live loop
    std::atomic<bool> there{false};    // the service answers and lists the device
    std::atomic<bool> stopping{false}; // no force any more; set once
    std::atomic<bool> resting{false};  // no force until the next one
    std::atomic<const char*> error_text{nullptr};
    std::atomic<const char*> withheld{nullptr};        // why the device is not ready for a force; null: it is
    std::atomic<const char*> lately_withheld{nullptr}; // the same until the live loop has asked for no force

    /// Wakes the other thread. Safe in a signal's handler, like stop().
    void wake() const noexcept;

    /// Sets `stopping` and sends the command without force at once, past the thread that owns the line, because this
    /// process may end before that thread runs. A frame is one system call, so that the two do not mix; if the line is
    /// so full that they could, this one is not sent, and the service gets no command and applies no force.
    void stop() noexcept;

    /// Readable after wake().
    int wake_descriptor() const noexcept { return wake_; }

    /// The socket over which stop() may send from now on; -1: none. Its number never changes, so that stop() cannot
    /// write to a file that got the number of a socket just closed.
    void lend_line(int socket) noexcept;

private:
    std::string zero_frame_;
    int wake_ = -1, null_device_ = -1, line_ = -1;
};

/// Main function of that thread: connects, keeps commands and answers in lock-step, reconnects, until
/// `exchange.stopping`; then ends within 200 ms, with a last command without force. `options` name a device and a
/// dialect. Does not throw.
void run_link(Exchange& exchange, const HaplyOptions& options) noexcept;

} // namespace forceshade::device
