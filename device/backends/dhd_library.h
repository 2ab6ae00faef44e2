// The C interface of Force Dimension's DHD SDK, as far as it is used: declared here, found in the library at run time.
// Lengths in m, forces in N, x towards the user, y to the user's right, z up.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "device/backends/shared_library.h"

namespace forceshade::device {

/// Calls that return an int return a negative one on an error; dhdErrorGetLastStr describes it. A device is
/// named by the number that opening it returned. \throws DeviceAbsent: the library is missing or is a different one.
struct DhdLibrary : SharedLibrary {
    static constexpr int kTimeGuard = 1;      // dhdGetPosition: called too soon, this is the previous position
    static constexpr int kMotorSaturated = 2; // dhdSetForce...: taken, but the motors give less

    /// Entries of dhdGetStatus by index, 1 or 0 except for the cause. Versions of the SDK have 15 to 17 of them.
    struct Status {
        static constexpr std::size_t power = 0, connected = 1, started = 2, reset = 3, force = 5, error = 9,
                                     force_off_cause = 14;
        std::array<int, 64> values{};
        int operator[](std::size_t index) const { return values[index]; }
    };
    enum ForceOffCause : int { none, button, velocity, watchdog, software, disconnected, dead_man };

    DhdLibrary()
        : SharedLibrary({"Force Dimension SDK",
                         "FORCESHADE_DHD_LIBRARY",
                         {"libdhd.so", "libdhd.so.3", "libdrd.so", "libdrd.so.3"},
                         "Install the SDK from forcedimension.com and put its lib/release/lin-x86_64-gcc into "
                         "LD_LIBRARY_PATH, or set FORCESHADE_DHD_LIBRARY to its libdhd.so.3 file"}) {}

    int (*get_device_count)() = needed("dhdGetDeviceCount");
    int (*open)() = needed("dhdOpen");
    int (*open_id)(char index) = needed("dhdOpenID");
    int (*close)(char id) = needed("dhdClose");
    int (*stop)(char id) = needed("dhdStop"); // no force, brakes on
    int (*enable_force)(unsigned char on, char id) = needed("dhdEnableForce");
    int (*get_status)(int* status, char id) = needed("dhdGetStatus");
    int (*get_position)(double* x, double* y, double* z, char id) = needed("dhdGetPosition");
    int (*set_force)(double x, double y, double z, char id) = needed("dhdSetForce");
    const char* (*error_get_last_str)() = needed("dhdErrorGetLastStr"); // of the calling thread; static

    // Null where a version of the SDK does not have them.
    void (*get_sdk_version)(int* major, int* minor, int* release, int* revision) = optional("dhdGetSDKVersion");
    const char* (*get_system_name)(char id) = optional("dhdGetSystemName");
    int (*get_system_type)(char id) = optional("dhdGetSystemType");
    int (*get_serial_number)(unsigned short* number, char id) = optional("dhdGetSerialNumber");
    double (*get_max_force)(char id) = optional("dhdGetMaxForce");       // negative: no limit is set
    unsigned (*get_button_mask)(char id) = optional("dhdGetButtonMask"); // one bit each, pressed: 1
    // Devices with an actuated wrist or gripper keep what these were given last; N, N m, N.
    bool (*has_active_wrist)(char id) = optional("dhdHasActiveWrist");
    bool (*has_active_gripper)(char id) = optional("dhdHasActiveGripper");
    int (*set_force_and_torque)(double x, double y, double z, double about_x, double about_y, double about_z,
                                double gripper, char id) = optional("dhdSetForceAndTorqueAndGripperForce");
    int (*emulate_button)(unsigned char on, char id) = optional("dhdEmulateButton"); // button 1: the gripper closed
    int (*enable_expert_mode)() = optional("dhdEnableExpertMode");
    int (*disable_expert_mode)() = optional("dhdDisableExpertMode");
    int (*set_watchdog)(unsigned char time, char id) = optional("dhdSetWatchdog"); // in 125 us; expert

    std::string version() const { // "DHD SDK 3.17.6.0"
        if (!get_sdk_version)
            return "DHD SDK of unknown version";
        int major = 0, minor = 0, release = 0, revision = 0;
        get_sdk_version(&major, &minor, &release, &revision);
        return fmt::format("DHD SDK {}.{}.{}.{}", major, minor, release, revision);
    }
    std::string error() const { // the last one in this thread
        const char* text = error_get_last_str();
        return text && *text ? text : "no reason given";
    }
};

} // namespace forceshade::device
