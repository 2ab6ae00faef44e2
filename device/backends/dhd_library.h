// The C interface of Force Dimension's DHD SDK, as far as it is used: declared here, found in the library at run time.
// Lengths in m, forces in N, x towards the user, y to the user's right, z up.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "device/backends/shared_library.h"

namespace forceshade::device {

/// Calls that return an int return a negative one on an error, about which dhdErrorGetLastStr knows more. A device is
/// named by the number that opening it returned.
struct DhdCalls {
    static constexpr int kTimeGuard = 1; // dhdGetPosition: asked too soon, this is the position of before

    /// What dhdGetStatus tells, by index: 1 or 0, but for the cause. Versions of the SDK have 15 to 17 of them.
    struct Status {
        static constexpr std::size_t power = 0, connected = 1, started = 2, reset = 3, force = 5, error = 9,
                                     force_off_cause = 14;
        std::array<int, 64> values{};
        int operator[](std::size_t index) const { return values[index]; }
    };
    enum ForceOffCause : int { none, button, velocity, watchdog, software, disconnected, dead_man };

    int (*get_device_count)();
    int (*open)();
    int (*open_id)(char index);
    int (*close)(char id);
    int (*stop)(char id); // no force, brakes on
    int (*enable_force)(unsigned char on, char id);
    int (*get_status)(int* status, char id);
    int (*get_position)(double* x, double* y, double* z, char id);
    int (*set_force)(double x, double y, double z, char id);
    const char* (*error_get_last_str)(); // of the calling thread; static

    // Null where a version of the SDK does not have them.
    void (*get_sdk_version)(int* major, int* minor, int* release, int* revision);
    const char* (*get_system_name)(char id);
    int (*get_system_type)(char id);
    int (*get_serial_number)(unsigned short* number, char id);
    double (*get_max_force)(char id); // negative: no limit is set
    int (*enable_expert_mode)();
    int (*disable_expert_mode)();
    int (*set_watchdog)(unsigned char time, char id); // in 125 us; expert
};

/// The loaded library.
class DhdLibrary {
public:
    /// \throws DeviceAbsent: not there, or not what it should be.
    DhdLibrary();

    const DhdCalls& calls() const { return calls_; }
    const std::string& file() const { return library_.file(); }
    std::string software() const; // "DHD SDK 3.17.6.0"
    std::string error() const;    // what it complained of last in this thread

private:
    SharedLibrary library_;
    DhdCalls calls_{};
};

} // namespace forceshade::device
