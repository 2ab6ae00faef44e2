#include "device/haply/address.h"

#include <charconv>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade::device {
namespace {

constexpr std::string_view kScheme = "ws://";
constexpr std::string_view kDefaultPort = "10001";

[[noreturn]] void refuse(std::string_view url, std::string_view why) {
    throw UsageError(
        fmt::format("the Inverse Service's address '{}' {}: it looks like ws://localhost:10001", url, why));
}

std::string checked_port(std::string_view url, std::string_view port) {
    unsigned number = 0;
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (error != std::errc() || end != port.data() + port.size() || number == 0 || number > 65535)
        refuse(url, fmt::format("has the port '{}', which is none from 1 to 65535", port));
    return std::string(port);
}

} // namespace

std::string Address::host_field() const {
    return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port) : fmt::format("[{}]:{}", host, port);
}

Address parse_address(std::string_view url) {
    if (url.starts_with("wss://"))
        refuse(url, "asks for TLS, which the service does not speak");
    if (!url.starts_with(kScheme))
        refuse(url, "does not begin with ws://");
    std::string_view rest = url.substr(kScheme.size());
    const std::size_t slash = rest.find('/');
    Address address;
    address.path = slash == std::string_view::npos ? "/" : std::string(rest.substr(slash));
    rest = rest.substr(0, slash);
    std::string_view after; // the host
    if (rest.starts_with('[')) {
        const std::size_t close = rest.find(']');
        if (close == std::string_view::npos)
            refuse(url, "has a bracket that is not closed");
        address.host = rest.substr(1, close - 1);
        after = rest.substr(close + 1);
    } else {
        const std::size_t colon = rest.find(':');
        address.host = rest.substr(0, colon);
        after = colon == std::string_view::npos ? std::string_view() : rest.substr(colon);
    }
    if (address.host.empty())
        refuse(url, "names no host");
    if (address.host.find_first_of(" \t\r\n") != std::string::npos ||
        address.path.find_first_of(" \t\r\n") != std::string::npos)
        refuse(url, "has a blank in it");
    if (!after.empty() && after.front() != ':')
        refuse(url, "has something other than a port after its host");
    address.port = after.empty() ? std::string(kDefaultPort) : checked_port(url, after.substr(1));
    return address;
}

} // namespace forceshade::device
