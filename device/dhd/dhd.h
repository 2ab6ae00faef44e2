// Force Dimension's devices (omega, delta, sigma, lambda; Novint's Falcon), through the vendor's DHD SDK.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "device/back_end.h"

namespace forceshade::device {

/// Opens a device: the one of this index, or with an empty text the first that is free. Its watchdog, where the device
/// has one, takes the force away when none was written for 32 ms. A position that is none in metres is refused.
/// \throws UsageError for what is no index, DeviceAbsent without library or device.
std::unique_ptr<BackEnd> open_dhd(std::string_view index);

/// What there is to be opened; nothing is moved.
struct DhdFound {
    std::string file;     // of the library
    std::string software; // "DHD SDK 3.17.6.0"
    int devices = 0;
    std::string complaint; // of the library, where there is no device
};

/// \throws DeviceAbsent without the library.
DhdFound find_dhd();

} // namespace forceshade::device
