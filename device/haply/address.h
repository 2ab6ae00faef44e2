// Where the service listens: the parts of a ws:// URL.
#pragma once

#include <string>
#include <string_view>

namespace forceshade::device {

struct Address {
    std::string host; // without the brackets of an IPv6 address
    std::string port;
    std::string path; // from its slash on
    std::string host_field() const;
};

/// Throws UsageError for what is no `ws://HOST[:PORT][/PATH]`.
Address parse_address(std::string_view url);

} // namespace forceshade::device
