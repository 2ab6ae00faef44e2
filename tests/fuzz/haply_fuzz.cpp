// What the Inverse Service may send, and how a device is asked for: only what is a position is taken for one.
#include <nlohmann/json.hpp>

#include "device/backends/haply.h"
#include "device/backends/haply_protocol.h"
#include "host/error.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade::device {
namespace {

using fuzz::require;

constexpr double kReach = 10; // m

/// The place as read another way: the first entry of that id has it.
bool holds_position(const std::string& message, std::string_view id, const glm::dvec3& position) {
    const nlohmann::json json = nlohmann::json::parse(message);
    for (const nlohmann::json& entry : json.at("inverse3"))
        if (entry.is_object() && entry.contains("device_id") && entry["device_id"] == id) {
            const nlohmann::json& place = entry.at("state").at("cursor_position");
            return place.at("x") == position.x && place.at("y") == position.y && place.at("z") == position.z;
        }
    return false;
}

void check_messages(const std::string& message) {
    for (const std::string_view id : {"04BA", "A", "", "\xff"}) {
        const State state = read_state(message, id);
        require(std::abs(state.position.x) <= kReach && std::abs(state.position.y) <= kReach &&
                    std::abs(state.position.z) <= kReach,
                "a place out of reach");
        require((state.readiness.unmet & ~state.readiness.told) == 0, "what was not told is not met");
        require(state.buttons < 8, "there are three buttons");
        if (!state.fault)
            require(holds_position(message, id, state.position) || id.empty(), "the message has another position");
        else
            require(state.position == glm::dvec3(0), "a fault with a position");
    }
    if (const auto devices = read_inventory(message))
        for (const HaplyDevice& device : *devices) {
            require(!device.id.empty(), "a device without an id");
            std::string command;
            write_command(command, HaplyOptions::Dialect::vector, device.id, {1, -0.5, 1e-9});
            const auto json = nlohmann::json::parse(command);
            require(json.at("inverse3").at(0).at("device_id") == device.id, "a command for another device");
            parse_basis(device.basis);
        }
    tells_of_grip(message);
    dialect_of(read_version(message));
}

void check_words(const std::string& text) {
    if (const auto axes = parse_basis(text)) {
        const glm::dvec3 place(1, 2, 3);
        require(axes->to_world(axes->to_service(place)) == place, "axes do not lead back");
    }
    const std::string bytes = frame(text.substr(0, 300));
    require(bytes.size() >= 6 + std::min<std::size_t>(text.size(), 300), "a frame is too short");
    dialect_of(text);
    try {
        const HaplyOptions options = parse_haply(text);
        const Address address = parse_address(options.url);
        require(!address.host.empty() && !address.port.empty() && address.path.starts_with('/'), "half an address");
        require((address.host + address.path).find_first_of(" \r\n") == std::string::npos,
                "an address with a line end");
    } catch (const UsageError&) {
    }
}

} // namespace
} // namespace forceshade::device

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    forceshade::device::check_messages(text);
    forceshade::device::check_words(text);
    return 0;
}
