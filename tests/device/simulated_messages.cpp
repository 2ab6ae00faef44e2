#include "tests/device/simulated_service.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace forceshade::device::test {
namespace {

using Json = nlohmann::json;

/// Of the world's axis number i, which letter of the basis tells it and with which sign: an implementation of its own,
/// so that the tested one is not held against itself.
struct Told {
    std::size_t place = 0;
    double sign = 1;
};

Told told(const std::string& basis, int axis) {
    std::size_t place = 0;
    for (std::size_t i = 0; i < basis.size(); ++i) {
        if (basis[i] == '-' || basis[i] == '+')
            continue;
        if (basis[i] == "XYZ"[axis])
            return {place, i > 0 && basis[i - 1] == '-' ? -1.0 : 1.0};
        ++place;
    }
    throw std::invalid_argument("no basis: " + basis);
}

Json told_vector(const std::string& basis, const glm::dvec3& world) {
    std::array<double, 3> values{};
    for (int axis = 0; axis < 3; ++axis) {
        const Told to = told(basis, axis);
        values[to.place] = to.sign * world[axis];
    }
    return {{"x", values[0]}, {"y", values[1]}, {"z", values[2]}};
}

glm::dvec3 world_vector(const std::string& basis, const Json& vector) {
    constexpr std::array names{"x", "y", "z"};
    glm::dvec3 world{0};
    for (int axis = 0; axis < 3; ++axis) {
        const Told from = told(basis, axis);
        world[axis] = from.sign * vector.at(names[from.place]).get<double>();
    }
    return world;
}

Json device(const ServiceScript& script, std::size_t index, double seconds, const glm::dvec3& force) {
    const glm::dvec3 place = index == 0 ? place_at(script, seconds) : glm::dvec3(5, 6, 7);
    return {{"device_id", script.devices[index]},
            {"state",
             {{"cursor_position", told_vector(script.basis, place)},
              {"cursor_velocity", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
              {"current_cursor_force", told_vector(script.basis, force)},
              {"control_mode", "idle"}}},
            {"status",
             {{"calibrated", script.fault != Fault::uncalibrated},
              {"in_use", false},
              {"power_supply", script.fault != Fault::no_power},
              {"ready", script.fault != Fault::not_ready},
              {"started", script.fault != Fault::not_started}}}};
}

Json state(const ServiceScript& script, double seconds, const glm::dvec3& force) {
    Json list = Json::array();
    for (std::size_t i = 0; i < script.devices.size(); ++i)
        list.push_back(device(script, i, seconds, force));
    Json grips = Json::array();
    if (!script.grip.empty())
        grips.push_back(
            {{"device_id", "VG01"},
             {"state",
              {{"buttons", {{"a", script.grip == "a"}, {"b", script.grip == "b"}, {"c", script.grip == "c"}}},
               {"orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}}}},
             {"status", {{"awake", true}, {"ready", true}}}});
    return {{"session_id", 7}, {"inverse3", list}, {"verse_grip", Json::array()}, {"wireless_verse_grip", grips}};
}

} // namespace

glm::dvec3 place_at(const ServiceScript& script, double seconds) {
    return script.center + script.amplitude * std::sin(2 * M_PI * script.frequency * seconds);
}

std::optional<Received> read_command(const std::string& message, const ServiceScript& script) {
    const Json json = Json::parse(message, nullptr, false);
    if (!json.is_object() || !json.contains("inverse3"))
        return std::nullopt;
    Received received;
    const Json& entry = json["inverse3"].at(0);
    received.device_id = entry.at("device_id").get<std::string>();
    const Json& command = entry.at("commands").at("set_cursor_force");
    const char* const key = script.speaks_vector ? "vector" : "values";
    received.understood = command.contains(key);
    if (received.understood)
        received.force = world_vector(script.basis, command.at(key));
    return received;
}

std::string inventory(const ServiceScript& script) {
    Json json = state(script, 0, glm::dvec3(0));
    for (Json& entry : json["inverse3"])
        entry["config"] = {{"type", "inverse3"},
                           {"port", "COM12"},
                           {"handedness", "right"},
                           {"preset", "defaults"},
                           {"basis", {{"permutation", script.basis}}}};
    if (!script.speaks_vector)
        json.erase("session_id");
    return json.dump();
}

std::string answer(const ServiceScript& script, double seconds, const glm::dvec3& force) {
    Json json = state(script, seconds, force);
    if (script.fault == Fault::not_json)
        return R"({"inverse3": [{"device_id": "04BA", "sta)";
    if (script.fault == Fault::null)
        json["inverse3"][0]["state"]["cursor_position"]["x"] = nullptr;
    return std::string(script.fault == Fault::huge ? std::size_t(4) << 20 : 0, ' ') + json.dump();
}

std::string unasked_state(const ServiceScript& script, double seconds) {
    if (script.fault == Fault::older)
        return state(script, seconds - 0.5, glm::dvec3(0)).dump();
    ServiceScript elsewhere = script;
    elsewhere.center = glm::dvec3(9, 9, 9);
    return state(elsewhere, 0, glm::dvec3(0)).dump();
}

} // namespace forceshade::device::test
