// 3D Systems' devices (Touch, Touch X, Phantom), through the vendor's OpenHaptics HDAPI.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "device/backends/back_end.h"

namespace forceshade::device {

/// Opens a device: the one of this configured name, or with an empty text the default one. The vendor's scheduler
/// displays the forces at 1 kHz, and none if none was written for 50 ms. A device that is not calibrated, or whose
/// position, workspace or largest force is none in mm and N, is refused.
/// \throws DeviceAbsent without library or device.
std::unique_ptr<BackEnd> open_hd(std::string_view name);

/// What there is to be opened.
struct HdFound {
    std::string file;      // of the library
    std::string software;  // "OpenHaptics HDAPI 3.4.0"
    std::string device;    // the default one; empty: none
    std::string complaint; // of the library, where there is none
};

/// Opens the default device for a moment, without any force. \throws DeviceAbsent without the library.
HdFound find_hd();

} // namespace forceshade::device
