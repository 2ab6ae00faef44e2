// What the Inverse Service may send, and how a device is asked for: only what is a position is taken for one.
#include <bit>

#include <nlohmann/json.hpp>

#include "device/backends/haply.h"
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

/// The buttons as read another way.
std::uint32_t buttons_in(const std::string& message) {
    const nlohmann::json json = nlohmann::json::parse(message);
    std::uint32_t pressed = 0;
    for (const char* list : {"wireless_verse_grip", "verse_grip"})
        for (const nlohmann::json& grip : json.contains(list) && json[list].is_array() ? json[list] : nlohmann::json())
            for (std::uint32_t i = 0; i < 3; ++i) {
                const nlohmann::json::json_pointer place("/state/buttons/" +
                                                         std::string(1, static_cast<char>('a' + i)));
                pressed |= grip.is_structured() && grip.value(place, nlohmann::json()) == true ? 1u << i : 0u;
            }
    return pressed;
}

/// How many conditions a status tells of, and how many of them it does not call true.
std::pair<int, int> conditions_in(const nlohmann::json& entry) {
    std::pair<int, int> counts;
    for (const char* name : {"calibrated", "power_supply", "ready", "started"})
        if (entry.contains("status") && entry["status"].is_object() && entry["status"].contains(name)) {
            ++counts.first;
            counts.second += entry["status"][name] != true;
        }
    return counts;
}

/// What a status says in words: each name that is true or false, in their order.
std::string status_in(const nlohmann::json& entry) {
    std::string text;
    if (entry.contains("status") && entry["status"].is_object())
        for (const auto& [name, value] : entry["status"].items()) {
            std::string words = name;
            std::ranges::replace(words, '_', ' ');
            if (value == true)
                text += ", " + words;
            else if (value == false)
                text += ", not " + words;
        }
    return text.substr(std::min<std::size_t>(text.size(), 2));
}

/// The text of a frame, as a server takes it apart.
std::string unframed(std::string_view bytes) {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    const bool is_long = at(1) == (0x80 | 126);
    const std::size_t mask = is_long ? 4 : 2, length = is_long ? at(2) * 256u + at(3) : at(1) & 127u;
    require(at(0) == 0x81 && at(1) >= 0x80 && bytes.size() == mask + 4 + length, "a frame of another length");
    std::string text;
    for (std::size_t i = 0; i < length; ++i)
        text += static_cast<char>(at(mask + 4 + i) ^ at(mask + i % 4));
    return text;
}

void check_messages(const std::string& message) {
    for (const std::string_view id : {"04BA", "A", "", "\xff"}) {
        const State state = read_state(message, id);
        require(std::abs(state.position.x) <= kReach && std::abs(state.position.y) <= kReach &&
                    std::abs(state.position.z) <= kReach,
                "a place out of reach");
        require((state.readiness.unmet & ~state.readiness.known) == 0, "what is not known is not met");
        require(state.buttons < 8, "there are three buttons");
        if (state.readiness.known != 0) {
            const auto entries = nlohmann::json::parse(message).at("inverse3");
            const auto is_asked_for = [&](const nlohmann::json& entry) {
                return entry.is_object() && (id.empty() || entry.value("device_id", nlohmann::json()) == id);
            };
            const auto entry = std::ranges::find_if(entries, is_asked_for);
            require(entry != entries.end(), "a device that is not there is ready");
            require(id.empty() || conditions_in(*entry) == std::pair(std::popcount(state.readiness.known),
                                                                     std::popcount(state.readiness.unmet)),
                    "other conditions are met");
        }
        if (!state.fault)
            require((holds_position(message, id, state.position) || id.empty()) && state.buttons == buttons_in(message),
                    "the message has another position or other buttons");
        else
            require(state.position == glm::dvec3(0), "a fault with a position");
    }
    if (const auto devices = read_inventory(message))
        for (std::size_t i = 0; i < devices->size(); ++i) {
            const HaplyDevice& device = (*devices)[i];
            require(!device.id.empty(), "a device without an id");
            const auto entry = nlohmann::json::parse(message).at("inverse3").at(i);
            require(device.status == status_in(entry) && std::popcount(device.unmet) == conditions_in(entry).second,
                    "\"{}\" is another status", device.status);
            for (const auto& [dialect, release] : {std::pair("vector", "3.5"), {"values", "3.4"}}) {
                std::string command;
                write_command(command, dialect_of(release), device.id, {1, -0.5, 1e-9});
                const auto json = nlohmann::json::parse(command).at("inverse3").at(0);
                require(json.at("device_id") == device.id, "a command for another device");
                require(json.at("commands").at("set_cursor_force").at(dialect) ==
                            nlohmann::json{{"x", 1.0}, {"y", -0.5}, {"z", 1e-9}},
                        "a command of another force: {}", command);
            }
            parse_basis(device.basis);
        }
    const nlohmann::json all = nlohmann::json::parse(message, nullptr, false);
    const auto has_grip = [&](const char* list) {
        return all.is_object() && all.contains(list) && all[list].is_array() && all[list].size() > 0;
    };
    require(tells_of_grip(message) == (has_grip("wireless_verse_grip") || has_grip("verse_grip")), "a grip is told of");
    const std::string version = read_version(message);
    require(version.empty() || message.find("\"" + version) != std::string::npos ||
                message.find("\"v" + version) != std::string::npos || message.find('\\') != std::string::npos,
            "the version {} is not told", version);
    require(!version.starts_with('v') || message.find("\"vv") != std::string::npos ||
                message.find('\\') != std::string::npos,
            "the version {} has a v", version);
    dialect_of(version);
}

void check_words(const std::string& text) {
    for (std::size_t length = 0; length <= std::min<std::size_t>(text.size(), 6); ++length)
        if (const auto axes = parse_basis(text.substr(0, length))) {
            const glm::dvec3 place(1, 2, 3);
            require(axes->to_world(axes->to_service(place)) == place, "axes do not lead back");
            int axis = 0, sign = 1; // the same letter by letter
            for (const char c : text.substr(0, length))
                if (c == '+' || c == '-')
                    sign = c == '-' ? -1 : 1;
                else {
                    require(axes->to_service(place)[axis] == sign * place[(c | ' ') - 'x'], "the axis {} is another",
                            axis);
                    ++axis;
                    sign = 1;
                }
        }
    for (const std::size_t length : {125, 126, 300})
        require(unframed(frame(text.substr(0, length))) == text.substr(0, length), "a frame holds another text");
    dialect_of(text);
    try {
        const HaplyOptions options = parse_haply(text);
        const Address address = parse_address(options.url);
        const unsigned long port = std::strtoul(address.port.c_str(), nullptr, 10);
        require(port >= 1 && port <= 65535, "the port is {}", address.port);
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
