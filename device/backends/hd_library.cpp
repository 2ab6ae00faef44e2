#include "device/backends/hd_library.h"

#include <fmt/format.h>

namespace forceshade::device {

namespace {

SoughtLibrary sought() {
    return {"3D Systems OpenHaptics toolkit",
            "FORCESHADE_HD_LIBRARY",
            {"libHD.so", "libHD.so.3.4", "libHD.so.3.5", "libHD.so.3.0", "libHD.so.3"},
            "Install OpenHaptics for Linux and the device's driver from 3D Systems (support.3dsystems.com) and put the "
            "folder of libHD.so into LD_LIBRARY_PATH, or set FORCESHADE_HD_LIBRARY to that file"};
}

} // namespace

HdLibrary::HdLibrary() : library_(sought()) {
    library_.load(calls_.init_device, "hdInitDevice");
    library_.load(calls_.disable_device, "hdDisableDevice");
    library_.load(calls_.make_current_device, "hdMakeCurrentDevice");
    library_.load(calls_.begin_frame, "hdBeginFrame");
    library_.load(calls_.end_frame, "hdEndFrame");
    library_.load(calls_.enable, "hdEnable");
    library_.load(calls_.disable, "hdDisable");
    library_.load(calls_.get_doublev, "hdGetDoublev");
    library_.load(calls_.set_doublev, "hdSetDoublev");
    library_.load(calls_.get_string, "hdGetString");
    library_.load(calls_.get_error, "hdGetError");
    library_.load(calls_.get_error_string, "hdGetErrorString");
    library_.load(calls_.schedule_asynchronous, "hdScheduleAsynchronous");
    library_.load(calls_.unschedule, "hdUnschedule");
    library_.load(calls_.start_scheduler, "hdStartScheduler");
    library_.load(calls_.stop_scheduler, "hdStopScheduler");
    library_.load(calls_.get_integerv, "hdGetIntegerv");
    library_.load(calls_.check_calibration, "hdCheckCalibration");
    library_.load(calls_.update_calibration, "hdUpdateCalibration");
}

std::string HdLibrary::error() const {
    const unsigned code = drain_errors(calls_);
    if (code == HdValue::success)
        return {};
    const char* text = calls_.get_error_string(code);
    return fmt::format("{} (HDAPI error 0x{:04X})", text && *text ? text : "no reason given", code);
}

std::string HdLibrary::text(unsigned what) const {
    const char* text = calls_.get_string(what);
    return drain_errors(calls_) == HdValue::success && text ? text : "";
}

unsigned drain_errors(const HdCalls& calls) noexcept {
    constexpr int kMost = 32;
    unsigned first = HdValue::success;
    for (int i = 0; i < kMost; ++i) {
        const unsigned code = calls.get_error().code;
        if (code == HdValue::success)
            break;
        first = code;
    }
    return first;
}

} // namespace forceshade::device
