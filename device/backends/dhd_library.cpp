#include "device/backends/dhd_library.h"

#include <fmt/format.h>

namespace forceshade::device {

namespace {

SoughtLibrary sought() {
    return {"Force Dimension SDK",
            "FORCESHADE_DHD_LIBRARY",
            {"libdhd.so", "libdhd.so.3", "libdrd.so", "libdrd.so.3"},
            "Install the SDK from forcedimension.com and put its lib/release/lin-x86_64-gcc into LD_LIBRARY_PATH, or "
            "set FORCESHADE_DHD_LIBRARY to its libdhd.so.3 file"};
}

} // namespace

DhdLibrary::DhdLibrary() : library_(sought()) {
    library_.load(calls_.get_device_count, "dhdGetDeviceCount");
    library_.load(calls_.open, "dhdOpen");
    library_.load(calls_.open_id, "dhdOpenID");
    library_.load(calls_.close, "dhdClose");
    library_.load(calls_.stop, "dhdStop");
    library_.load(calls_.enable_force, "dhdEnableForce");
    library_.load(calls_.get_status, "dhdGetStatus");
    library_.load(calls_.get_position, "dhdGetPosition");
    library_.load(calls_.set_force, "dhdSetForce");
    library_.load(calls_.error_get_last_str, "dhdErrorGetLastStr");
    library_.load_if_there(calls_.get_sdk_version, "dhdGetSDKVersion");
    library_.load_if_there(calls_.get_system_name, "dhdGetSystemName");
    library_.load_if_there(calls_.get_system_type, "dhdGetSystemType");
    library_.load_if_there(calls_.get_serial_number, "dhdGetSerialNumber");
    library_.load_if_there(calls_.get_max_force, "dhdGetMaxForce");
    library_.load_if_there(calls_.enable_expert_mode, "dhdEnableExpertMode");
    library_.load_if_there(calls_.disable_expert_mode, "dhdDisableExpertMode");
    library_.load_if_there(calls_.set_watchdog, "dhdSetWatchdog");
}

std::string DhdLibrary::software() const {
    if (!calls_.get_sdk_version)
        return "DHD SDK of unknown version";
    int major = 0, minor = 0, release = 0, revision = 0;
    calls_.get_sdk_version(&major, &minor, &release, &revision);
    return fmt::format("DHD SDK {}.{}.{}.{}", major, minor, release, revision);
}

std::string DhdLibrary::error() const {
    const char* text = calls_.error_get_last_str();
    return text && *text ? text : "no reason given";
}

} // namespace forceshade::device
