// The C interface of 3D Systems' OpenHaptics HDAPI, as far as it is used: declared here, found in the library at run
// time. Lengths in mm, forces in N, x to the user's right, y up, z towards the user.
#pragma once

#include <string>

#include <fmt/format.h>

#include "device/backends/shared_library.h"

namespace forceshade::device {

struct HdErrorInfo {
    unsigned code = 0;
    int internal_code = 0;
    unsigned device = 0;
};
using HdCallback = unsigned (*)(void* user);

/// Arguments and results of the calls, by their names without HD_.
struct HdValue {
    static constexpr unsigned success = 0, invalid_handle = 0xFFFFFFFF;
    static constexpr unsigned callback_done = 0, callback_continue = 1;
    static constexpr unsigned current_buttons = 0x2000; // as an integer: button 1 to 4 as bit 0 to 3
    static constexpr unsigned current_position = 0x2050, current_force = 0x2700;
    static constexpr unsigned version = 0x2500, device_model_type = 0x2501, device_driver_version = 0x2502,
                              device_serial_number = 0x2504;
    static constexpr unsigned max_workspace_dimensions = 0x2550, calibration_style = 0x2555;
    static constexpr unsigned nominal_max_force = 0x2603, nominal_max_continuous_force = 0x2604;
    static constexpr unsigned force_output = 0x4000;
    static constexpr unsigned calibration_ok = 0x5000, calibration_needs_update = 0x5001,
                              calibration_needs_manual_input = 0x5002;
    static constexpr int calibrate_by_reset = 1, calibrate_by_itself = 2, calibrate_in_inkwell = 4; // styles, as bits
    static constexpr unsigned short default_priority = 0x7FFF;
};

/// Errors are put onto a stack, from which hdGetError takes the newest. \throws DeviceAbsent: the library is
/// missing or is a different one.
struct HdLibrary : SharedLibrary {
    HdLibrary()
        : SharedLibrary({"3D Systems OpenHaptics toolkit",
                         "FORCESHADE_HD_LIBRARY",
                         {"libHD.so", "libHD.so.3.4", "libHD.so.3.5", "libHD.so.3.0", "libHD.so.3"},
                         "Install OpenHaptics for Linux and the device's driver from 3D Systems "
                         "(support.3dsystems.com) and put the folder of libHD.so into LD_LIBRARY_PATH, or set "
                         "FORCESHADE_HD_LIBRARY to that file"}) {}

    unsigned (*init_device)(const char* name) = needed("hdInitDevice"); // null: the default device
    void (*disable_device)(unsigned device) = needed("hdDisableDevice");
    void (*make_current_device)(unsigned device) = needed("hdMakeCurrentDevice");
    void (*begin_frame)(unsigned device) = needed("hdBeginFrame");
    void (*end_frame)(unsigned device) = needed("hdEndFrame");
    void (*enable)(unsigned capability) = needed("hdEnable");
    void (*disable)(unsigned capability) = needed("hdDisable");
    void (*get_doublev)(unsigned what, double* values) = needed("hdGetDoublev");
    void (*set_doublev)(unsigned what, const double* values) = needed("hdSetDoublev");
    const char* (*get_string)(unsigned what) = needed("hdGetString");
    HdErrorInfo (*get_error)() = needed("hdGetError");
    const char* (*get_error_string)(unsigned code) = needed("hdGetErrorString"); // static
    unsigned long (*schedule_asynchronous)(HdCallback callback, void* user,
                                           unsigned short priority) = needed("hdScheduleAsynchronous");
    void (*unschedule)(unsigned long callback) = needed("hdUnschedule");
    void (*start_scheduler)() = needed("hdStartScheduler");
    void (*stop_scheduler)() = needed("hdStopScheduler");
    void (*get_integerv)(unsigned what, int* values) = needed("hdGetIntegerv");
    unsigned (*check_calibration)() = needed("hdCheckCalibration");
    void (*update_calibration)(unsigned style) = needed("hdUpdateCalibration");

    /// Empties the stack of errors; returns the first one, of which the others may be consequences. Ends even if the
    /// library reports errors without end.
    unsigned drain_errors() const noexcept {
        constexpr int kMost = 32;
        unsigned first = HdValue::success;
        for (int i = 0; i < kMost; ++i) {
            const unsigned code = get_error().code;
            if (code == HdValue::success)
                break;
            first = code;
        }
        return first;
    }

    /// The same, in the library's words with its code; empty: none.
    std::string error() const {
        const unsigned code = drain_errors();
        if (code == HdValue::success)
            return {};
        const char* text = get_error_string(code);
        return fmt::format("{} (HDAPI error 0x{:04X})", text && *text ? text : "no reason given", code);
    }

    std::string text(unsigned what) const { // empty if the library has none
        const char* text = get_string(what);
        return drain_errors() == HdValue::success && text ? text : "";
    }
};

} // namespace forceshade::device
