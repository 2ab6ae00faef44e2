#include "device/backends/hd.h"

#include <cmath>
#include <poll.h>

#include <fmt/format.h>

#include "device/backends/hd_library.h"
#include "device/backends/hd_servo.h"

namespace forceshade::device {

namespace {

constexpr int kFramePatience = 20;    /* ms: for a frame of 1 ms */
constexpr int kEndPatience = 200;     /* ms */
constexpr int kStartPatience = 2000;  /* ms: for the first position */
constexpr int kMostFailures = 100;    // frames without a position at the start
constexpr double kFarthest = 3;       /* m: no device reaches further */
constexpr double kUnknownReach = 0.5; /* m: of a device that states no workspace */

// An open device: closed on every way out.
class Session {
public:
    Session(const HdLibrary& library, const std::string& name) : calls_(library.calls()) {
        library.error(); // what was before is none of ours
        device_ = calls_.init_device(name.empty() ? nullptr : name.c_str());
        const std::string error = library.error();
        if (device_ == HdValue::invalid_handle || !error.empty())
            refuse(library, name, error);
        calls_.make_current_device(device_);
    }
    ~Session() { calls_.disable_device(device_); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    unsigned device() const { return device_; }

private:
    [[noreturn]] void refuse(const HdLibrary& library, const std::string& name, const std::string& error) {
        if (device_ != HdValue::invalid_handle)
            calls_.disable_device(device_);
        throw DeviceAbsent(
            fmt::format("the OpenHaptics device {} cannot be opened: {}; is it plugged in, powered and set up with the "
                        "vendor's Touch_Setup? Library: {}",
                        name.empty() ? "configured as default" : "\"" + name + "\"",
                        error.empty() ? "no reason given" : error, library.file()));
    }

    const HdCalls& calls_;
    unsigned device_ = HdValue::invalid_handle;
};

// The running scheduler with our callback in it: let go of, stopped and without force on every way out.
class Schedule {
public:
    Schedule(const HdLibrary& library, Servo& servo) : calls_(library.calls()), servo_(servo) {
        calls_.enable(HdValue::force_output);
        check(library, "does not enable forces");
        callback_ = calls_.schedule_asynchronous(&Servo::tick, &servo_, HdValue::default_priority);
        check(library, "does not take the callback");
        calls_.start_scheduler();
        const std::string error = library.error();
        if (error.empty())
            return;
        leave();
        throw DeviceAbsent("the OpenHaptics scheduler does not start: " + error);
    }
    ~Schedule() { leave(); }
    Schedule(const Schedule&) = delete;
    Schedule& operator=(const Schedule&) = delete;

private:
    void check(const HdLibrary& library, const char* what) {
        if (const std::string error = library.error(); !error.empty()) {
            calls_.disable(HdValue::force_output);
            throw DeviceAbsent(fmt::format("OpenHaptics {}: {}", what, error));
        }
    }

    void leave() {
        const bool ended = servo_.end(kEndPatience);
        calls_.stop_scheduler();
        if (!ended)
            calls_.unschedule(callback_);
        calls_.disable(HdValue::force_output);
        drain_errors(calls_);
    }

    const HdCalls& calls_;
    Servo& servo_;
    unsigned long callback_ = 0;
};

std::string software_of(const HdLibrary& library) {
    const std::string version = library.text(HdValue::version);
    const std::string driver = library.text(HdValue::device_driver_version);
    return fmt::format("OpenHaptics HDAPI {}{}", version.empty() ? "of unknown version" : version,
                       driver.empty() ? "" : ", driver " + driver);
}

std::string name_of(const HdLibrary& library) {
    const std::string model = library.text(HdValue::device_model_type);
    const std::string serial = library.text(HdValue::device_serial_number);
    return (model.empty() ? "OpenHaptics device" : model) +
           (serial.empty() ? "" : fmt::format(" (serial number {})", serial));
}

class Hd final : public BackEnd {
public:
    explicit Hd(const std::string& name)
        : session_(library_, name), facts_(learn()), servo_(library_.calls(), session_.device()),
          schedule_(library_, servo_) {
        await_position();
    }
    ~Hd() override { halt(); }

    const DeviceFacts& facts() const noexcept override { return facts_; }
    Reading read() noexcept override;
    bool write(const glm::dvec3& force) noexcept override { return servo_.put(force); }
    void halt() noexcept override { servo_.halt(kFramePatience); }
    void rest() noexcept override { servo_.rest(); }
    const char* complaint() const noexcept override { return servo_.complaint(); }

private:
    DeviceFacts learn() const;
    void learn_force(DeviceFacts& facts) const;
    void learn_workspace(DeviceFacts& facts) const;
    std::string uncalibrated(DeviceFacts& facts) const;
    void calibrate(DeviceFacts& facts) const;
    void await_position();

    const HdLibrary library_;
    Session session_;
    const DeviceFacts facts_;
    Servo servo_;
    Schedule schedule_;
    glm::dvec3 position_{0};
    bool told_ = true; // the newest frame had a position
};

DeviceFacts Hd::learn() const {
    DeviceFacts facts;
    facts.name = name_of(library_);
    facts.software = software_of(library_);
    facts.silence = 0.9e-9 * static_cast<double>(kSilence); // the loop's clock and the servo's are read apart
    learn_force(facts);
    learn_workspace(facts);
    calibrate(facts);
    return facts;
}

void Hd::learn_force(DeviceFacts& facts) const {
    double most = NAN;
    library_.calls().get_doublev(HdValue::nominal_max_force, &most);
    if (!library_.error().empty())
        return;
    if (!(most >= 0.5 && most <= 200))
        throw DeviceAbsent(
            fmt::format("{} states a largest force of {} N: between 0.5 N and 200 N is plausible", facts.name, most));
    facts.max_force = most;
    double lasting = NAN;
    library_.calls().get_doublev(HdValue::nominal_max_continuous_force, &lasting);
    if (!library_.error().empty())
        return;
    if (!(lasting >= 0.1 && lasting <= most))
        throw DeviceAbsent(fmt::format("{} states a continuous force of {} N: between 0.1 N and its largest, {} N, is "
                                       "plausible",
                                       facts.name, lasting, most));
    facts.lasting_force = lasting;
}

void Hd::learn_workspace(DeviceFacts& facts) const {
    facts.low = glm::dvec3(-kUnknownReach);
    facts.high = glm::dvec3(kUnknownReach);
    double box[6]{NAN, NAN, NAN, NAN, NAN, NAN}; /* mm */
    library_.calls().get_doublev(HdValue::max_workspace_dimensions, box);
    if (!library_.error().empty())
        return;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = box[3 + axis] - box[axis];
        if (!(size >= 20 && size <= 6000))
            throw DeviceAbsent(
                fmt::format("{} states the workspace ({}, {}, {}) to ({}, {}, {}): its API gives millimetres, and "
                            "a side between 20 mm and 6000 mm is plausible",
                            facts.name, box[0], box[1], box[2], box[3], box[4], box[5]));
    }
    facts.low = 1e-3 * glm::dvec3(box[0], -box[5], box[1]);
    facts.high = 1e-3 * glm::dvec3(box[3], -box[2], box[4]);
}

// In words, why not; empty: it is calibrated.
std::string Hd::uncalibrated(DeviceFacts& facts) const {
    const HdCalls& calls = library_.calls();
    unsigned state = calls.check_calibration();
    std::string error = library_.error();
    if (error.empty() && state == HdValue::calibration_needs_update) {
        int styles = 0, chosen = 0; // the device states a set of them and takes one: the last that it has
        calls.get_integerv(HdValue::calibration_style, &styles);
        for (const int style :
             {HdValue::calibrate_by_reset, HdValue::calibrate_in_inkwell, HdValue::calibrate_by_itself})
            if (styles & style)
                chosen = style;
        if (error = library_.error(); !error.empty() || chosen == 0)
            return "it does not state how: " + error;
        calls.update_calibration(static_cast<unsigned>(chosen));
        error = library_.error();
        state = calls.check_calibration();
        if (const std::string further = library_.error(); error.empty())
            error = further;
        if (chosen == HdValue::calibrate_by_reset)
            facts.remark = facts.name + " took the place where it stood for its reset position: start again with it "
                                        "there if it was elsewhere";
    }
    if (!error.empty())
        return error;
    return state == HdValue::calibration_ok                   ? ""
           : state == HdValue::calibration_needs_manual_input ? "it waits to be placed"
                                                              : "it says so after an update, too";
}

// Before forces are enabled.
void Hd::calibrate(DeviceFacts& facts) const {
    if (const std::string why = uncalibrated(facts); !why.empty())
        throw DeviceAbsent(fmt::format("{} is not calibrated ({}): put its stylus into the inkwell (an arm without one "
                                       "into its reset position), or run the vendor's Touch_Diagnostic, and try again",
                                       facts.name, why));
}

void Hd::await_position() {
    Servo::Frame frame;
    int failures = 0;
    for (int waited = 0; !frame.told && waited < kStartPatience && failures < kMostFailures; ++waited) {
        ::poll(nullptr, 0, 1);
        failures += servo_.take(frame) && !frame.told ? 1 : 0;
    }
    if (!frame.told) {
        const char* why = servo_.complaint();
        throw DeviceAbsent(
            fmt::format("{} tells no position: {}", facts_.name, why ? why : "its scheduler does not run"));
    }
    const glm::dvec3& at = frame.position;
    const auto reached = [](double along) { return std::abs(along) <= kFarthest; }; // and is a number
    if (!reached(at.x) || !reached(at.y) || !reached(at.z))
        throw DeviceAbsent(fmt::format("{} tells the position ({}, {}, {}) mm: no device reaches further than {} m",
                                       facts_.name, 1e3 * at.x, 1e3 * at.z, -1e3 * at.y, kFarthest));
    position_ = at;
}

// Until a frame has a position again, that it had none is the newest there is to know.
Reading Hd::read() noexcept {
    Servo::Frame frame;
    const bool fresh = servo_.take(frame);
    if (fresh)
        told_ = frame.told;
    if (!told_ || (!fresh && !servo_.runs()))
        return {Answer::failed, position_, false};
    if (!fresh)
        return {Answer::held, position_, false};
    position_ = frame.position;
    return {Answer::fresh, position_, false};
}

} // namespace

std::unique_ptr<BackEnd> open_hd(std::string_view name) {
    return std::make_unique<Hd>(std::string(name));
}

HdFound find_hd() {
    const HdLibrary library;
    HdFound found{library.file(), "OpenHaptics HDAPI", {}, {}};
    try {
        const Session session(library, {});
        found.software = software_of(library);
        found.device = name_of(library);
    } catch (const DeviceAbsent& absent) {
        found.complaint = absent.what();
    }
    return found;
}

} // namespace forceshade::device
