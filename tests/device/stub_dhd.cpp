// A library with the C interface of Force Dimension's DHD SDK and one device behind it that can be told to fail.
#include <limits>
#include <thread>

#include "tests/device/stub.h"

namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> enabled = false;
std::atomic<int> watchdog = 0; // in 125 us
std::atomic<int> cause = 0;    // of forces being off: 1 the button, 3 the watchdog, 4 a program
std::atomic<Clock::time_point> written{};
std::atomic<const char*> last_error = "";
[[maybe_unused]] bool expert = false;

int answer(const char* name, const char* error = "communication error") {
    if (!stub::fails(name))
        return 0;
    last_error = error;
    return -1;
}

void switch_off(int why) {
    if (enabled.exchange(false))
        cause = why;
}

// What the device's own watchdog has done since the last force. Four times as patient as it was told, for a test's
// thread may have to wait for a processor.
void let_watchdog_bite() {
    if (watchdog > 0 && Clock::now() - written.load() > std::chrono::microseconds(500) * watchdog.load())
        switch_off(3);
}

} // namespace

extern "C" {

void stub_reset() {
    stub::reset(0.01, 0.02, 0.03, 8);
    enabled = false;
    watchdog = cause = 0;
}
/// Somebody presses the device's button.
void stub_press() {
    if (enabled)
        switch_off(1);
    else
        enabled = true;
}
/// Why forces are off; 6: the dead-man switch.
void stub_switch_off(int why) {
    enabled = false;
    cause = why;
}
int stub_watchdog() {
    return watchdog;
}

int dhdGetDeviceCount() {
    return answer("dhdGetDeviceCount", "no driver found") < 0 ? -1 : static_cast<int>(stub::state.devices);
}
int dhdOpen() {
    return answer("dhdOpen", "device in use");
}
int dhdOpenID(char id) {
    return answer("dhdOpenID", "device in use") < 0 ? -1 : id;
}
int dhdClose(char) {
    return answer("dhdClose");
}
int dhdStop(char) {
    switch_off(4);
    return answer("dhdStop");
}
int dhdEnableForce(unsigned char on, char) {
    if (answer("dhdEnableForce", "force cannot be enabled") < 0)
        return -1;
    stub::note(on ? "enable 1" : "enable 0");
    enabled = on != 0;
    written = Clock::now();
    return 0;
}
int dhdGetStatus(int* status, char) {
    if (answer("dhdGetStatus") < 0)
        return -1;
    let_watchdog_bite();
    for (int i = 0; i < 17; ++i)
        status[i] = 0;
    status[0] = stub::fails("no power") ? 0 : 1;
    status[1] = 1;
    status[2] = stub::fails("not started") ? 0 : 1;
    status[3] = stub::fails("uncalibrated") ? 1 : 0;
    status[5] = enabled ? 1 : 0;
    status[9] = stub::fails("error") ? 1 : 0;
    status[14] = enabled ? 0 : cause.load();
    return 0;
}
int dhdGetPosition(double* x, double* y, double* z, char) {
    if (answer("dhdGetPosition") < 0)
        return -1;
    *x = stub::state.position[0];
    *y = stub::state.position[1];
    *z = stub::state.position[2];
    if (stub::fails("nan"))
        *y = std::numeric_limits<double>::quiet_NaN();
    if (stub::fails("millimetres")) {
        *x *= 1000;
        *y *= 1000;
        *z *= 1000;
    }
    return stub::fails("time guard") ? 1 : 0;
}
#ifndef STUB_OLD
bool dhdHasActiveWrist(char) {
    return stub::fails("has a wrist");
}
bool dhdHasActiveGripper(char) {
    return stub::fails("has a gripper");
}
int dhdEmulateButton(unsigned char on, char) {
    stub::note(on ? "emulate 1" : "emulate 0");
    return answer("dhdEmulateButton");
}
#endif
#ifndef STUB_WITHOUT_FORCE
int dhdSetForce(double x, double y, double z, char) {
    if (answer("dhdSetForce") < 0)
        return -1;
    if (stub::fails("speed"))
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
    let_watchdog_bite();
    if (stub::fails("button"))
        switch_off(1);
    char text[96];
    std::snprintf(text, sizeof text, "force %.9g %.9g %.9g", x + 0.0, y + 0.0, z + 0.0); // no -0
    stub::note(text);
    if (!enabled && (x != 0 || y != 0 || z != 0)) {
        last_error = "force is not enabled";
        return -1;
    }
    written = Clock::now();
    stub::display(x, y, z);
    return stub::fails("saturation") ? 2 : 0;
}
#ifndef STUB_OLD
int dhdSetForceAndTorqueAndGripperForce(double x, double y, double z, double about_x, double about_y, double about_z,
                                        double gripper, char id) {
    stub::note(about_x == 0 && about_y == 0 && about_z == 0 && gripper == 0 ? "no torque" : "torque");
    return dhdSetForce(x, y, z, id);
}
#endif
#endif
const char* dhdErrorGetLastStr() {
    return last_error;
}

#ifndef STUB_OLD
void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
    *major = 3;
    *minor = 17;
    *release = 6;
    *revision = 1;
}
const char* dhdGetSystemName(char) {
    return stub::fails("dhdGetSystemName") ? nullptr : stub::fails("sigma.3") ? "sigma.3" : "omega.3";
}
int dhdGetSystemType(char) {
    return answer("dhdGetSystemType") < 0 ? -1 : stub::fails("sigma.3") ? 112 : 33;
}
int dhdGetSerialNumber(unsigned short* number, char) {
    *number = 417;
    return answer("dhdGetSerialNumber");
}
double dhdGetMaxForce(char) {
    return stub::fails("dhdGetMaxForce") ? -1 : stub::state.most_force.load();
}
unsigned dhdGetButtonMask(char) {
    return static_cast<unsigned>(stub::state.buttons);
}
int dhdEnableExpertMode() {
    expert = true;
    return answer("dhdEnableExpertMode");
}
int dhdDisableExpertMode() {
    expert = false;
    return answer("dhdDisableExpertMode");
}
int dhdSetWatchdog(unsigned char time, char) {
    if (!expert || answer("dhdSetWatchdog", "expert mode is disabled") < 0)
        return -1;
    watchdog = time;
    return 0;
}
#endif
}
