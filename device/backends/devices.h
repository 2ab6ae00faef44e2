// Which devices a live loop could have here, and why not the others.
#pragma once

#include <string>
#include <vector>

namespace forceshade::device {

/// One kind of device, found or not.
struct DeviceKind {
    std::string option;               // as it is asked for: "dhd[:INDEX]"
    std::string what;                 // in words
    std::vector<std::string> devices; // what can be asked for now: "dhd:0"
    std::string name;                 // of the devices, if the kind tells: "Touch (serial number 8042)"
    std::string software;             // through what it is driven, with its version; empty: not found
    std::string place;                // the library's file, the service's address; empty: there is none
    std::string problem;              // why there is no device and what to do about it; empty: there is
};

/// Every kind. Vendors' libraries are loaded and asked; no device moves. Haply's service is asked at its usual address,
/// or at `service` ("ws://..."), for at most `wait` s a step.
std::vector<DeviceKind> list_devices(const std::string& service = {}, double wait = 1);

} // namespace forceshade::device
