// An Inverse Service for tests: speaks both dialects over a real socket, remembers every force, and fails on demand.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace forceshade::device::test {

/// What a service does wrong, from the moment it is told to. Of bad messages one of each kind: the others are texts for
/// read_state() (haply_protocol_test.cpp).
enum class Fault {
    none,
    no_inventory,  // takes up connections and says nothing
    never_answers, // reads commands, answers none
    late,          // answers after `delay`
    unasked,       // after each answer, a state that nobody asked for, of a place far off
    older,         // after each answer, a state that nobody asked for, from half a second before
    not_json,      // answers with text that is none
    null,          // "x": null
    huge,          // an answer of several MiB
    no_websocket,  // an HTTP server that is nothing else
    no_http,       // answers what is not even HTTP
    closes,        // closes each connection at its first command
    uncalibrated,  // the device's status says: not calibrated, and so on
    no_power,
    not_ready,
    not_started,
};

struct ServiceScript {
    bool speaks_vector = true;     // false: 3.1's `values`
    std::string version = "3.5.0"; // empty: GET /version is not known
    std::string basis = "XYZ";     // in which positions are told and forces read
    std::vector<std::string> devices{"04BA"};
    std::chrono::milliseconds delay{250}; // of Fault::late
    Fault fault = Fault::none;
    std::string grip; // "a": a wireless VerseGrip with this button pressed; "-": with none; empty: no grip
    glm::dvec3 center{0, -0.1, 0.15};       /* m: the first device swings about it; others are far off */
    glm::dvec3 amplitude{0.01, 0.02, 0.03}; /* m */
    double frequency = 1;                   /* Hz */
};

struct Received {
    std::chrono::steady_clock::time_point time;
    std::string device_id;
    glm::dvec3 force{0};     /* N, in the world's axes */
    bool understood = true;  // in the service's dialect: only then is there a force
    unsigned connection = 0; // from 1 on
};

/// Runs on a thread of its own until it is destroyed. All from any thread.
class SimulatedService {
public:
    explicit SimulatedService(ServiceScript script);
    ~SimulatedService();

    std::string url() const; // ws://127.0.0.1:PORT, of a port that was free

    void set(Fault fault);
    void set_devices(std::vector<std::string> devices);
    void set_grip(const std::string& grip);
    void go_away();   // closes all connections without a word, listens no more
    void come_back(); // at the same port

    std::vector<Received> received() const;
    unsigned connections() const; // taken up so far, as WebSockets
    unsigned open() const;        // of them
    unsigned farewells() const;   // of them closed politely

private:
    class Inside;
    std::unique_ptr<Inside> inside_;
};

// What it says and understands, apart from sockets.

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
