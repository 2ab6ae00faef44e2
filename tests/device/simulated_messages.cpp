#include "tests/device/simulated_service.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

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

/// The state with the first device's x replaced by what JSON may not even allow.
std::string with_x(Json json, const std::string& x) {
    json["inverse3"][0]["state"]["cursor_position"]["x"] = "HERE";
    std::string text = json.dump();
    text.replace(text.find("\"HERE\""), 6, x);
    return text;
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
    switch (script.fault) {
    case Fault::not_json:
        return "{\"inverse3\": [{\"device_id\": \"04BA\", \"sta";
    case Fault::wrong_types:
        return R"({"inverse3": {"device_id": 4, "state": [1, "two", null]}, "session_id": "seven"})";
    case Fault::huge:
        return std::string(std::size_t(4) << 20, ' ') + json.dump();
    case Fault::deep:
        return std::string(500'000, '[');
    case Fault::nan:
        return with_x(json, "NaN");
    case Fault::null:
        return with_x(json, "null");
    case Fault::text:
        return with_x(json, "\"0.1\"");
    case Fault::infinite:
        return with_x(json, "1e999");
    case Fault::far:
        return with_x(json, "1e30");
    case Fault::missing:
        json["inverse3"][0]["state"]["cursor_position"].erase("x");
        return json.dump();
    case Fault::no_state:
        json["inverse3"][0].erase("state");
        return json.dump();
    case Fault::empty:
        json["inverse3"] = Json::array();
        return json.dump();
    case Fault::refuses:
        return R"({"ok": false, "error": "unknown command"})";
    default:
        return json.dump();
    }
}

std::string unasked_state(const ServiceScript& script, double seconds) {
    if (script.fault == Fault::older)
        return state(script, seconds - 0.5, glm::dvec3(0)).dump();
    ServiceScript elsewhere = script;
    elsewhere.center = glm::dvec3(9, 9, 9);
    return state(elsewhere, 0, glm::dvec3(0)).dump();
}

Fault fault_named(const std::string& name) {
    constexpr std::array kNames{"none",      "no_inventory", "never_answers", "late",   "unasked",      "older",
                                "not_json",  "wrong_types",  "huge",          "deep",   "nan",          "null",
                                "text",      "missing",      "infinite",      "far",    "no_state",     "empty",
                                "refuses",   "no_websocket", "no_http",       "closes", "uncalibrated", "no_power",
                                "not_ready", "not_started"};
    static_assert(kNames.size() == static_cast<std::size_t>(Fault::not_started) + 1);
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (name == kNames[i])
            return static_cast<Fault>(i);
    throw std::invalid_argument("no such fault: " + name);
}

} // namespace forceshade::device::test
