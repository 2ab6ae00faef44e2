#include "device/backends/haply.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/text.h"

namespace forceshade::device {

namespace {

[[noreturn]] void refuse(std::string_view url, std::string_view why) {
    throw UsageError("the Inverse Service's address '{}' {}: it looks like ws://localhost:10001", url, why);
}

std::string checked_port(std::string_view url, std::string_view port) {
    if (!number_in(port, 1u, 65535u))
        refuse(url, fmt::format("has the port '{}', which is not from 1 to 65535", port));
    return std::string(port);
}

void set(HaplyOptions& options, std::string_view key, std::string_view value) {
    using Dialect = HaplyOptions::Dialect;
    if (value.empty())
        throw UsageError("haply: '{}' has no value: ?device=04BA&dialect=values", key);
    if (key == "device")
        options.device_id = value;
    else if (key != "dialect")
        throw UsageError("haply: unknown option '{}': there are device and dialect", key);
    else if (value != "vector" && value != "values")
        throw UsageError("haply: the dialect is vector or values, not '{}'", value);
    else
        options.dialect = value == "vector" ? Dialect::vector : Dialect::values;
}

using Json = nlohmann::json;
using Dialect = HaplyOptions::Dialect;

constexpr std::array kGrips{"wireless_verse_grip", "verse_grip"};
constexpr std::array kGripButtons{"a", "b", "c"};
constexpr double kHaplyReach = 10; /* m: positions further away are invalid: no hand-held device reaches so far */

Json parse(std::string_view text) {
    return Json::parse(text.begin(), text.end(), nullptr, false);
}

// Null unless there is an object that has it.
const Json* member(const Json* object, const char* name) {
    if (object == nullptr || !object->is_object())
        return nullptr;
    const auto found = object->find(name);
    return found == object->end() ? nullptr : &*found;
}

// The elements of a list that a message may have.
const Json& list_of(const Json& message, const char* name) {
    static const Json kNone = Json::array();
    const Json* list = member(&message, name);
    return list != nullptr && list->is_array() ? *list : kNone;
}

std::string text_of(const Json* value) {
    return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::string status_of(const Json* status) {
    std::string text;
    if (status == nullptr || !status->is_object())
        return text;
    for (const auto& [name, value] : status->items()) {
        if (!value.is_boolean())
            continue;
        text += fmt::format("{}{}{}", text.empty() ? "" : ", ", value.get<bool>() ? "" : "not ", name);
    }
    for (char& letter : text)
        letter = letter == '_' ? ' ' : letter;
    return text;
}

struct Condition {
    const char* name; // in the status
    const char* objection;
    bool wanted = true;
};
constexpr std::array kConditions{
    Condition{"power_supply", "the Inverse3 has no power supply: plug it in"},
    Condition{"started", "the Inverse3 is not started: switch it on (Haply Hub shows it)"},
    Condition{"calibrated", "the Inverse3 is not calibrated: calibrate it (Haply Hub shows how)"},
    Condition{"ready", "the Inverse3 is not ready (Haply Hub shows why)"},
    Condition{"frozen", "the Inverse3 is frozen: its position does not change (Haply Hub shows why)", false},
};

// A condition that is given is met if it has the value that a force needs.
Readiness readiness_of(const Json* status) {
    Readiness readiness;
    for (std::size_t i = 0; i < kConditions.size(); ++i)
        if (const Json* value = member(status, kConditions[i].name)) {
            readiness.known |= 1u << i;
            readiness.unmet |= *value == kConditions[i].wanted ? 0u : 1u << i;
        }
    return readiness;
}

// The numbers in a part of a configuration that are not `usual`, as "x 2, y 2"; empty: none.
std::string unusual(const Json* part, double usual) {
    std::string text;
    const auto add = [&](const std::string& name, const Json& value) {
        if (value.is_number() && value.get<double>() != usual)
            text +=
                fmt::format("{}{}{:g}", text.empty() ? "" : ", ", name.empty() ? "" : name + " ", value.get<double>());
    };
    if (part != nullptr && part->is_object())
        for (const auto& [name, value] : part->items())
            add(name, value);
    else if (part != nullptr)
        add("", *part);
    return text;
}

// What a user must know before the device is used: the program takes positions and forces as the service has them.
std::string remark_of(const Json* config, const Json* status) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
    const Json *const mount = member(config, "mount"), *const filters = member(config, "filters");
    for (const Json* of_mount : {mount, member(mount, "transform")}) // as it is listed, and as it is set
        if (const std::string scale = unusual(member(of_mount, "scale"), 1); !scale.empty())
            add(fmt::format("the service scales its positions ({}), so that stiffness is not what the scene says: set "
                            "the mount's scale to 1 in Haply Hub",
                            scale));
    for (const Json* of_filters : {filters, config}) {
        if (const std::string gate = unusual(member(of_filters, "force_gate"), 1); !gate.empty())
            add(fmt::format("the service's force gate ({}) lowers forces where it detects oscillations", gate));
        if (const std::string damping = unusual(member(of_filters, "damping"), 0); !damping.empty())
            add(fmt::format("the service adds damping ({})", damping));
    }
    if (const Json* used = member(status, "in_use"); used != nullptr && *used == true)
        add("another program uses it, too");
    return text;
}

std::optional<glm::dvec3> position_of(const Json* value) {
    glm::dvec3 position{0};
    constexpr std::array names{"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
        const Json* coordinate = member(value, names[static_cast<std::size_t>(i)]);
        if (coordinate == nullptr || !coordinate->is_number())
            return std::nullopt;
        position[i] = coordinate->get<double>();
        if (!(std::abs(position[i]) <= kHaplyReach))
            return std::nullopt;
    }
    return position;
}

// Of all grips that the service lists; none of one that is asleep or gone.
std::uint32_t buttons_of(const Json& message) {
    std::uint32_t pressed = 0;
    for (const char* list : kGrips)
        for (const Json& grip : list_of(message, list))
            for (std::size_t i = 0; i < kGripButtons.size(); ++i)
                if (const Json* button = member(member(member(&grip, "state"), "buttons"), kGripButtons[i]);
                    button != nullptr && *button == true)
                    pressed |= 1u << i;
    return pressed;
}

} // namespace

std::string Address::host_field() const {
    return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port) : fmt::format("[{}]:{}", host, port);
}

Address parse_address(std::string_view url) {
    constexpr std::string_view kScheme = "ws://", kDefaultPort = "10001", kBlanks = " \t\r\n";
    if (url.starts_with("wss://"))
        refuse(url, "asks for TLS, which the service does not speak");
    if (!url.starts_with(kScheme))
        refuse(url, "does not begin with ws://");
    std::string_view rest = url.substr(kScheme.size());
    const std::size_t slash = rest.find('/');
    Address address;
    address.path = slash == std::string_view::npos ? "/" : rest.substr(slash);
    rest = rest.substr(0, slash);
    const bool bracketed = rest.starts_with('[');
    const std::size_t end = std::min(rest.find(bracketed ? ']' : ':'), rest.size()); // of the host
    if (bracketed && end == rest.size())
        refuse(url, "has a bracket that is not closed");
    address.host = rest.substr(bracketed, end - bracketed);
    const std::string_view after = rest.substr(end + bracketed);
    if (address.host.empty())
        refuse(url, "names no host");
    if ((address.host + address.path).find_first_of(kBlanks) != std::string::npos)
        refuse(url, "has a blank in it");
    if (!after.empty() && after.front() != ':')
        refuse(url, "has something other than a port after its host");
    address.port = after.empty() ? std::string(kDefaultPort) : checked_port(url, after.substr(1));
    return address;
}

HaplyOptions parse_haply(std::string_view after_colon) {
    HaplyOptions options;
    const std::size_t mark = after_colon.find('?');
    const std::string_view url = after_colon.substr(0, mark);
    if (!url.empty())
        options.url = url;
    parse_address(options.url); // to report errors now
    for (std::size_t end = mark; end != std::string_view::npos;) {
        const std::string_view query = after_colon.substr(end + 1), pair = query.substr(0, query.find('&'));
        const std::size_t equals = pair.find('=');
        set(options, pair.substr(0, equals), equals == std::string_view::npos ? "" : pair.substr(equals + 1));
        end = after_colon.find('&', end + 1);
    }
    return options;
}

std::optional<Axes> parse_basis(std::string_view permutation) {
    if (permutation.empty())
        return Axes{};
    Axes axes;
    unsigned seen = 0;
    for (int i = 0; i < 3; ++i) {
        axes.sign[i] = permutation.starts_with('-') ? -1 : 1;
        permutation.remove_prefix(permutation.starts_with('-') || permutation.starts_with('+'));
        const std::size_t axis = permutation.empty() ? 3 : std::string_view("XxYyZz").find(permutation.front()) / 2;
        if (axis > 2 || (seen >> axis & 1u) != 0)
            return std::nullopt;
        seen |= 1u << axis;
        axes.from[static_cast<std::size_t>(i)] = static_cast<int>(axis);
        permutation.remove_prefix(1);
    }
    return permutation.empty() ? std::optional(axes) : std::nullopt;
}

HaplyOptions::Dialect dialect_of(std::string_view version) {
    unsigned major = 0, minor = 0;
    const char* const end = version.data() + version.size();
    const auto first = std::from_chars(version.data(), end, major);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != '.')
        return Dialect::vector;
    if (std::from_chars(first.ptr + 1, end, minor).ec != std::errc())
        return Dialect::vector;
    return major < 3 || (major == 3 && minor < 5) ? Dialect::values : Dialect::vector;
}

std::string read_version(std::string_view body) {
    const Json json = parse(body);
    const Json* data = member(&json, "data"); // the envelope that routes of 3.5 may put around their answers
    for (const Json* object : {static_cast<const Json*>(&json), data})
        for (const char* name : {"git_tag", "project_version"})
            if (std::string version = text_of(member(object, name)); !version.empty() && version.size() <= 64)
                return version.front() == 'v' ? version.substr(1) : version;
    return {};
}

bool tells_of_grip(std::string_view message) {
    const Json json = parse(message);
    return std::ranges::any_of(kGrips, [&](const char* list) { return !list_of(json, list).empty(); });
}

std::optional<std::vector<HaplyDevice>> read_inventory(std::string_view message) {
    const Json json = parse(message);
    if (!json.is_object())
        return std::nullopt;
    if (const Json* list = member(&json, "inverse3"); list != nullptr && !list->is_array())
        return std::nullopt;
    std::vector<HaplyDevice> devices;
    for (const Json& entry : list_of(json, "inverse3")) {
        HaplyDevice device;
        device.id = text_of(member(&entry, "device_id"));
        if (device.id.empty())
            return std::nullopt;
        const Json* const config = member(&entry, "config");
        device.type = text_of(member(config, "type"));
        device.basis = text_of(member(member(config, "basis"), "permutation"));
        device.status = status_of(member(&entry, "status"));
        device.unmet = readiness_of(member(&entry, "status")).unmet;
        device.remark = remark_of(config, member(&entry, "status"));
        devices.push_back(std::move(device));
    }
    return devices;
}

void write_command(std::string& message, Dialect dialect, std::string_view device_id, const glm::dvec3& force) {
    message = R"({"inverse3":[{"device_id":)";
    message += Json(device_id).dump(-1, ' ', true, Json::error_handler_t::replace);
    fmt::format_to(std::back_inserter(message),
                   R"(,"commands":{{"set_cursor_force":{{"{}":{{"x":{},"y":{},"z":{}}}}}}}}}]}})",
                   dialect == Dialect::values ? "values" : "vector", force.x, force.y, force.z);
}

std::string frame(std::string_view message) {
    constexpr std::array<unsigned char, 4> mask{0x5a, 0xc3, 0x96, 0x3c}; // a client has to mask; any mask will do
    std::string bytes;
    bytes += static_cast<char>(0x81); // the last piece, of text
    if (message.size() < 126) {
        bytes += static_cast<char>(0x80u | message.size());
    } else { // at most 65535: a device id would have to be longer than a message may be
        bytes += static_cast<char>(0x80u | 126u);
        bytes += static_cast<char>(message.size() >> 8 & 0xffu);
        bytes += static_cast<char>(message.size() & 0xffu);
    }
    for (const unsigned char key : mask)
        bytes += static_cast<char>(key);
    for (std::size_t i = 0; i < message.size(); ++i)
        bytes += static_cast<char>(static_cast<unsigned char>(message[i]) ^ mask[i % 4]);
    return bytes;
}

State read_state(std::string_view message, std::string_view device_id) {
    const Json json = parse(message);
    if (json.is_discarded())
        return {"the Inverse Service's answer is not JSON", {}, {}};
    if (member(&json, "error") != nullptr)
        return {"the Inverse Service refused a command: does it speak another dialect? (?dialect=values or vector)",
                {},
                {}};
    const Json* list = member(&json, "inverse3");
    if (list == nullptr || !list->is_array())
        return {"the Inverse Service answered without a list of devices", {}, {}};
    for (const Json& entry : *list) {
        if (text_of(member(&entry, "device_id")) != device_id)
            continue;
        const Readiness readiness = readiness_of(member(&entry, "status"));
        const std::optional<glm::dvec3> position = position_of(member(member(&entry, "state"), "cursor_position"));
        if (!position)
            return {"the Inverse Service answered without a position of the device", {}, readiness};
        return {nullptr, *position, readiness, buttons_of(json)};
    }
    return {"the Inverse Service does not list the device any more", {}, {}};
}

const char* objection(unsigned unmet) {
    for (std::size_t i = 0; i < kConditions.size(); ++i)
        if (unmet >> i & 1u)
            return kConditions[i].objection;
    return nullptr;
}

} // namespace forceshade::device
