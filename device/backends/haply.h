// The Haply Inverse3 through the Inverse Service 3.x: a WebSocket that answers each command with one state.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

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
    std::string basis;  // "XYZ": the axes of its positions and forces (haply_protocol.h)
    unsigned unmet = 0; // conditions for a force that its status does not meet (haply_protocol.h)
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

/// Where the service listens: the parts of a ws:// URL.
struct Address {
    std::string host; // without the brackets of an IPv6 address
    std::string port;
    std::string path; // from its slash on
    std::string host_field() const;
};

/// Throws UsageError unless it has the form `ws://HOST[:PORT][/PATH]`.
Address parse_address(std::string_view url);

} // namespace forceshade::device
