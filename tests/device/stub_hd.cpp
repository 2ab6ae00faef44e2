// A library with the C interface of 3D Systems' HDAPI, its own scheduler thread at 1 kHz, and one device behind it that
// can be told to fail. The device goes on displaying the last force when the scheduler stops.
#include <cmath>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/device/stub.h"

namespace {

struct ErrorInfo {
    unsigned code;
    int internal_code;
    unsigned device;
};
using Callback = unsigned (*)(void*);

std::mutex mutex; // of what follows
std::vector<unsigned> errors;
Callback callback = nullptr;
void* user = nullptr;

std::thread thread;
std::atomic<bool> running = false, frozen = false, enabled = false;
std::array<double, 3> wanted{}; // of the frame

bool failed(const char* name, unsigned code = 0x0302) {
    if (!stub::fails(name))
        return false;
    const std::lock_guard lock(mutex);
    errors.push_back(code);
    errors.push_back(0x0402); // a consequence, on top of the cause
    return true;
}

void tick() {
    const auto [call, of] = [] {
        const std::lock_guard lock(mutex);
        return std::pair(callback, user);
    }();
    if (call && call(of) == 0) {
        const std::lock_guard lock(mutex);
        if (callback == call)
            callback = nullptr;
    }
}

void schedule() {
    while (running) {
        if (!frozen)
            tick();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

void stop() {
    running = false;
    if (thread.joinable())
        thread.join();
}

} // namespace

extern "C" {

void stub_reset() {
    stop();
    stub::reset(10, 20, 30, 3.3);
    frozen = enabled = false;
    const std::lock_guard lock(mutex);
    errors.clear();
    callback = nullptr;
}
/// The scheduler's thread goes on and calls nobody.
void stub_freeze(int on) {
    frozen = on != 0;
}

unsigned hdInitDevice(const char* name) {
    if (stub::state.devices < 1 || (name && std::strcmp(name, "Touch") != 0)) {
        const std::lock_guard lock(mutex);
        errors.push_back(0x0303);
        return 0xFFFFFFFF;
    }
    if (failed("hdInitDevice", 0x0300))
        return 0xFFFFFFFF;
    return 7;
}
void hdDisableDevice(unsigned) {
    failed("hdDisableDevice");
}
void hdMakeCurrentDevice(unsigned) {
    failed("hdMakeCurrentDevice");
}
void hdBeginFrame(unsigned device) {
    if (device == 7)
        failed("hdBeginFrame");
    wanted = {};
}
void hdEndFrame(unsigned) {
    if (!failed("warm motors", 0x0200) && !failed("hdEndFrame", 0x0201) && enabled)
        stub::display(wanted[0], wanted[1], wanted[2]);
}
void hdEnable(unsigned what) {
    stub::note("enable");
    if (!failed("hdEnable", 0x0204) && what == 0x4000)
        enabled = true;
}
void hdDisable(unsigned) {
    if (!failed("hdDisable"))
        enabled = false;
}
void hdGetDoublev(unsigned what, double* values) {
    if (what == 0x2050 && !failed("position"))
        for (std::size_t i = 0; i < 3; ++i)
            values[i] = stub::state.position[i];
    if (what == 0x2603 && !failed("largest force"))
        values[0] = stub::state.most_force;
    if (what == 0x2604 && !failed("continuous force"))
        values[0] = stub::state.continuous_force;
    const double box[6]{-210, -110, -85, 210, 205, 130};
    if (what == 0x2550 && !failed("workspace"))
        for (std::size_t i = 0; i < 6; ++i)
            values[i] = stub::state.scale * box[i];
}
#ifndef STUB_WITHOUT_FORCE
void hdSetDoublev(unsigned what, const double* values) {
    if (what == 0x2700 && !failed("hdSetDoublev"))
        wanted = {values[0], values[1], values[2]};
}
#endif
const char* hdGetString(unsigned what) {
    if (failed("hdGetString"))
        return nullptr;
    return what == 0x2500   ? "3.40.0"
           : what == 0x2501 ? "Touch"
           : what == 0x2502 ? "2022.4"
           : what == 0x2504 ? "8042"
                            : nullptr;
}
ErrorInfo hdGetError() {
    if (stub::fails("hdGetError"))
        return {0x0300, 1, 7};
    const std::lock_guard lock(mutex);
    if (errors.empty())
        return {0, 0, 0};
    const unsigned code = errors.back();
    errors.pop_back();
    return {code, -1, 7};
}
const char* hdGetErrorString(unsigned code) {
    constexpr std::pair<unsigned, const char*> kTexts[]{{0x0100, "Invalid enumeration"},
                                                        {0x0200, "Warm motors"},
                                                        {0x0201, "Maximum force exceeded"},
                                                        {0x0204, "Force error"},
                                                        {0x0300, "Device fault"},
                                                        {0x0302, "Communication error"},
                                                        {0x0303, "Communication configuration error"},
                                                        {0x0304, "Timer error"},
                                                        {0x0501, "Scheduler full"}};
    for (const auto& [known, text] : kTexts)
        if (code == known)
            return text;
    return "some error";
}
unsigned long hdScheduleAsynchronous(Callback call, void* of, unsigned short) {
    if (failed("hdScheduleAsynchronous", 0x0501))
        return 0;
    const std::lock_guard lock(mutex);
    callback = call;
    user = of;
    return 1;
}
void hdUnschedule(unsigned long) {
    failed("hdUnschedule");
    const std::lock_guard lock(mutex);
    callback = nullptr;
}
void hdStartScheduler() {
    if (failed("hdStartScheduler", 0x0304) || running)
        return;
    running = true;
    thread = std::thread(schedule);
}
void hdStopScheduler() {
    failed("hdStopScheduler");
    stop();
}
void hdGetIntegerv(unsigned what, int* values) {
    if (what == 0x2000) {
        if (!failed("buttons", 0x0100))
            *values = static_cast<int>(stub::state.buttons);
        return;
    }
    if (!failed("hdGetIntegerv") && what == 0x2555)
        *values = static_cast<int>(stub::state.styles);
}
unsigned hdCheckCalibration() {
    const long answer = stub::state.calibration;
    stub::note("check");
    if (answer == 0x5001)
        stub::state.calibration = 0x5002; // unless it is updated
    return failed("hdCheckCalibration") ? 0 : static_cast<unsigned>(answer);
}
/// Of the styles that the device has, one.
void hdUpdateCalibration(unsigned style) {
    stub::note("calibrate " + std::to_string(style));
    const bool is_one = (style == 1 || style == 2 || style == 4) && (style & stub::state.styles) != 0;
    if (failed("hdUpdateCalibration"))
        return;
    if (is_one)
        stub::state.calibration = 0x5000;
    else {
        const std::lock_guard lock(mutex);
        errors.push_back(0x0100);
    }
}
}
