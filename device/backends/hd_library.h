// The C interface of 3D Systems' OpenHaptics HDAPI, as far as it is used: declared here, found in the library at run
// time. Lengths in mm, forces in N, x to the user's right, y up, z towards the user.
#pragma once

#include <string>

#include "device/backends/shared_library.h"

namespace forceshade::device {

struct HdErrorInfo {
    unsigned code = 0;
    int internal_code = 0;
    unsigned device = 0;
};
using HdCallback = unsigned (*)(void* user);

/// What the calls are given and give, by its name without HD_.
struct HdValue {
    static constexpr unsigned success = 0, invalid_handle = 0xFFFFFFFF;
    static constexpr unsigned callback_done = 0, callback_continue = 1;
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

/// Errors are put onto a stack, from which hdGetError takes the newest.
struct HdCalls {
    unsigned (*init_device)(const char* name); // null: the default device
    void (*disable_device)(unsigned device);
    void (*make_current_device)(unsigned device);
    void (*begin_frame)(unsigned device);
    void (*end_frame)(unsigned device);
    void (*enable)(unsigned capability);
    void (*disable)(unsigned capability);
    void (*get_doublev)(unsigned what, double* values);
    void (*set_doublev)(unsigned what, const double* values);
    const char* (*get_string)(unsigned what);
    HdErrorInfo (*get_error)();
    const char* (*get_error_string)(unsigned code); // static
    unsigned long (*schedule_asynchronous)(HdCallback callback, void* user, unsigned short priority);
    void (*unschedule)(unsigned long callback);
    void (*start_scheduler)();
    void (*stop_scheduler)();
    void (*get_integerv)(unsigned what, int* values);
    unsigned (*check_calibration)();
    void (*update_calibration)(unsigned style);
};

/// The loaded library.
class HdLibrary {
public:
    /// \throws DeviceAbsent: not there, or not what it should be.
    HdLibrary();

    const HdCalls& calls() const { return calls_; }
    const std::string& file() const { return library_.file(); }

    /// Empties the stack of errors and tells the one that came first, in the library's words with its code; empty:
    /// none.
    std::string error() const;

    std::string text(unsigned what) const; // empty if the library does not tell

private:
    SharedLibrary library_;
    HdCalls calls_{};
};

/// Empties the stack of errors: the one that came first, of which the others may be consequences. Ends even where the
/// library reports errors without end.
unsigned drain_errors(const HdCalls& calls) noexcept;

} // namespace forceshade::device
