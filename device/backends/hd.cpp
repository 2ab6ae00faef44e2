#include <atomic>
#include <cmath>
#include <poll.h>
#include <pthread.h>
#include <string>

#include <fmt/format.h>

#include "device/backends/devices.h"
#include "device/backends/shared_library.h"

namespace forceshade::device {

namespace {

// The C interface of 3D Systems' OpenHaptics HDAPI, as far as it is used: declared here, found in the library at run
// time. Lengths in mm, forces in N, x to the user's right, y up, z towards the user.

struct HdErrorInfo {
    unsigned code = 0;
    int internal_code = 0;
    unsigned device = 0;
};
using HdCallback = unsigned (*)(void* user);

/// Arguments and results of the calls, by their names without HD_.
struct HdValue {
    static constexpr unsigned success = 0, warm_motors = 0x0200, invalid_handle = 0xFFFFFFFF;
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
        : SharedLibrary(
              {"3D Systems OpenHaptics toolkit",
               "FORCESHADE_HD_LIBRARY",
               {"libHD.so", "libHD.so.3.4", "libHD.so.3.5", "libHD.so.3.0", "libHD.so.3"},
               "Install OpenHaptics for Linux and the device's driver from 3D Systems (support.3dsystems.com) and put "
               "the folder of libHD.so into LD_LIBRARY_PATH, or set FORCESHADE_HD_LIBRARY to that file"}) {}

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

constexpr int kFramePatience = 20;    /* ms: for a frame of 1 ms */
constexpr int kEndPatience = 200;     /* ms */
constexpr int kStartPatience = 2000;  /* ms: for the first position */
constexpr int kMostFailures = 100;    // frames without a position at the start
constexpr double kUnknownReach = 0.5; /* m: of a device that states no workspace */
constexpr double kMillimetre = 1e-3;  /* m */
constexpr unsigned kHdButtons = 4;    // that HDAPI names

/// If no force was put for this long, none is displayed: more than three samples of the slowest loop, 100 Hz.
constexpr std::int64_t kHdSilence = 50'000'000; /* ns */

constexpr std::int64_t kCooling = 5'000'000'000;      /* ns: without force after motors were too warm */
constexpr std::int64_t kAskCalibration = 500'000'000; /* ns */
constexpr const char* kWarm = "the device's motors are too warm: let them cool down, forces come back by themselves";
constexpr const char* kUncalibrated = "the device lost its calibration: put its stylus into the inkwell (an arm "
                                      "without one calibrates itself, or starts again at its reset position)";

/// Runs in the vendor's scheduler: reads the position and displays the newest force, once a millisecond.
class Servo {
public:
    struct Frame {
        glm::dvec3 position{0}; /* m, in the world */
        bool valid = false;     // the device gave one
        std::uint32_t buttons = 0;
    };

    /// `style`: by which a calibration that needs it is brought up to date; 0: by none.
    Servo(const HdLibrary& library, unsigned device, int style) noexcept
        : library_(library), device_(device), style_(style) {}

    /// The scheduler's callback, `servo` a Servo. Neither waits nor throws.
    static unsigned tick(void* servo) noexcept { return static_cast<Servo*>(servo)->frame(); }

    /// By the live thread: true and the newest frame, if it is newer than the last.
    bool take(Frame& frame) noexcept { return frames_.take(frame); }

    /// By the live thread: false, with an error text, if the scheduler has not called for as long as kHdSilence.
    bool runs() noexcept {
        if (now() - called_ <= kHdSilence)
            return true;
        error_text_ = "the OpenHaptics scheduler does not run any more";
        return false;
    }

    /// By the live thread: displays a force (N, in the world) from the next frame on. False if the scheduler does not
    /// call any more, or the device refused the last one.
    bool put(const glm::dvec3& force) noexcept {
        commands_.put({force, now()});
        return runs() && displayed_ && (withheld() == nullptr || force == glm::dvec3(0));
    }

    /// As BackEnd's.
    const char* withheld() const noexcept { return withheld_.load(); }

    /// No force from the next frame on until the next put(). From any thread.
    void rest() noexcept { rested_ = now(); }

    /// No force from the next frame on. Waits for that frame up to `most` ms unless called from the scheduler's thread;
    /// from a signal's handler too. True once it is displayed.
    bool halt(int most) noexcept {
        halted_ = true;
        return wait_for(silent_, most);
    }

    /// As halt(), and that frame is the last. True once it has passed.
    bool end(int most) noexcept {
        halted_ = true;
        ending_ = true;
        return wait_for(ended_, most);
    }

    const char* error_text() const noexcept { return error_text_.load(); }

private:
    struct Command {
        glm::dvec3 force{0};   /* N */
        std::int64_t time = 0; /* ns: when it was put */
    };

    unsigned frame() noexcept {
        const std::int64_t time = now();
        thread_ = ::pthread_self();
        const bool last = ending_;
        library_.begin_frame(device_);
        double at[3]{}; /* mm */
        library_.get_doublev(HdValue::current_position, at);
        const bool valid = succeeded(drained(time));
        int buttons = 0;
        library_.get_integerv(HdValue::current_buttons, &buttons);
        if (drained(time) != HdValue::success) // a device without buttons is not a failure
            buttons = 0;
        const Frame frame{kMillimetre * glm::dvec3(at[0], -at[2], at[1]), valid, static_cast<std::uint32_t>(buttons)};
        commands_.take(command_);
        const bool old = time - command_.time > kHdSilence || command_.time <= rested_;
        const bool silent = halted_; // read as late as possible
        withheld_ = uncalibrated_ ? kUncalibrated : time < cool_ ? kWarm : nullptr;
        const glm::dvec3 force =
            silent || old || !frame.valid || withheld() != nullptr ? glm::dvec3(0) : command_.force;
        const double axes[3]{force.x, force.z, -force.y};
        library_.set_doublev(HdValue::current_force, axes);
        library_.end_frame(device_);
        displayed_ = succeeded(drained(time));
        follow_calibration(time);
        called_ = time;
        frames_.put(frame);
        silent_ = silent;
        thread_ = pthread_t{};
        ended_ = last;
        return last ? HdValue::callback_done : HdValue::callback_continue;
    }

    // As drain_errors(). Warm motors are no failure: forces are withheld until they have cooled down.
    unsigned drained(std::int64_t time) noexcept {
        const unsigned code = library_.drain_errors();
        if (code != HdValue::warm_motors)
            return code;
        cool_ = time + kCooling;
        withheld_ = kWarm;
        return HdValue::success;
    }

    // Positions may leap where it is brought up to date: no force is displayed in the frame before.
    void follow_calibration(std::int64_t time) noexcept {
        if (time - asked_ < kAskCalibration && !updates_)
            return;
        asked_ = time;
        const bool updates = std::exchange(updates_, false);
        if (updates) {
            library_.update_calibration(static_cast<unsigned>(style_));
            drained(time);
        }
        const unsigned state = library_.check_calibration();
        if (drained(time) != HdValue::success)
            return; // asked again
        uncalibrated_ = state != HdValue::calibration_ok;
        updates_ = !updates && state == HdValue::calibration_needs_update && style_ != 0;
    }

    // What failed is kept as the error's text.
    bool succeeded(unsigned code) noexcept {
        if (code != HdValue::success)
            error_text_ = library_.get_error_string(code);
        return code == HdValue::success;
    }

    bool wait_for(const std::atomic<bool>& done, int most) const noexcept {
        if (thread_.load() == ::pthread_self()) // interrupted in a frame, which cannot end meanwhile
            return done;
        for (int waited = 0; !done && waited < most; ++waited)
            ::poll(nullptr, 0, 1);
        return done;
    }

    const HdLibrary& library_;
    const unsigned device_;
    const int style_;
    Newest<Frame> frames_;
    Newest<Command> commands_;
    // The scheduler's.
    Command command_;
    bool uncalibrated_ = false, updates_ = false; // it is to be brought up to date in the next frame
    std::int64_t cool_ = 0, asked_ = now();       /* ns: motors are cool from then on; of the calibration */
    std::atomic<const char*> withheld_ = nullptr;
    std::atomic<std::int64_t> called_ = 0; // ns: when the last frame began
    std::atomic<std::int64_t> rested_ = 0; // ns: when rest() was called last
    std::atomic<pthread_t> thread_{};      // the scheduler's
    std::atomic<bool> displayed_ = true;   // the last frame's force
    std::atomic<bool> halted_ = false, ending_ = false, silent_ = false, ended_ = false;
    std::atomic<const char*> error_text_ = nullptr;
};

// An open device: closed on every way out.
struct Session {
    Session(const HdLibrary& used, const std::string& name) : library(used) {
        library.error(); // clears earlier errors
        device = library.init_device(name.empty() ? nullptr : name.c_str());
        const std::string error = library.error();
        if (device != HdValue::invalid_handle && error.empty()) {
            library.make_current_device(device);
            return;
        }
        if (device != HdValue::invalid_handle)
            library.disable_device(device);
        throw DeviceAbsent("the OpenHaptics device {} cannot be opened: {}; is it plugged in, powered and set up with "
                           "the vendor's Touch_Setup? Library: {}",
                           name.empty() ? "configured as default" : "\"" + name + "\"",
                           error.empty() ? "no reason given" : error, library.file());
    }
    ~Session() { library.disable_device(device); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const HdLibrary& library;
    unsigned device = HdValue::invalid_handle;
};

// The running scheduler with our callback in it: left, stopped and without force on every way out.
class Schedule {
public:
    Schedule(const HdLibrary& library, Servo& servo) : library_(library), servo_(servo) {
        library.enable(HdValue::force_output);
        check("does not enable forces");
        callback_ = library.schedule_asynchronous(&Servo::tick, &servo, HdValue::default_priority);
        check("does not take the callback");
        library.start_scheduler();
        if (const std::string error = library.error(); !error.empty()) {
            leave();
            throw DeviceAbsent("the OpenHaptics scheduler does not start: {}", error);
        }
    }
    ~Schedule() { leave(); }
    Schedule(const Schedule&) = delete;
    Schedule& operator=(const Schedule&) = delete;

private:
    void check(const char* what) {
        if (const std::string error = library_.error(); !error.empty()) {
            library_.disable(HdValue::force_output);
            throw DeviceAbsent("OpenHaptics {}: {}", what, error);
        }
    }

    void leave() {
        const bool ended = servo_.end(kEndPatience);
        library_.stop_scheduler();
        if (!ended)
            library_.unschedule(callback_);
        library_.disable(HdValue::force_output);
        library_.drain_errors();
    }

    const HdLibrary& library_;
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
        : session_(library_, name), facts_(read_facts()), servo_(library_, session_.device, style_in_a_run()),
          schedule_(library_, servo_) {
        await_position();
    }
    ~Hd() override { halt(); }

    const DeviceFacts& facts() const noexcept override { return facts_; }

    // After a frame without a position, read() fails until one has a position again.
    Reading read() noexcept override {
        Servo::Frame frame;
        const bool fresh = servo_.take(frame);
        if (fresh) {
            valid_ = frame.valid;
            buttons_ = frame.buttons;
        }
        if (!valid_ || (!fresh && !servo_.runs()))
            return {Answer::failed, position_, false};
        if (!fresh)
            return {Answer::repeated, position_, false, buttons_};
        position_ = frame.position;
        return {Answer::fresh, position_, false, buttons_};
    }

    bool write(const glm::dvec3& force) noexcept override { return servo_.put(force); }
    void halt() noexcept override { servo_.halt(kFramePatience); }
    void rest() noexcept override { servo_.rest(); }
    const char* error_text() const noexcept override { return servo_.error_text(); }
    const char* withheld() const noexcept override { return servo_.withheld(); }

private:
    DeviceFacts read_facts() const {
        DeviceFacts facts;
        facts.name = name_of(library_);
        facts.software = software_of(library_);
        int pressed = 0;
        library_.get_integerv(HdValue::current_buttons, &pressed);
        facts.buttons = library_.error().empty() ? kHdButtons : 0;
        facts.silence = 0.9e-9 * static_cast<double>(kHdSilence); // the loop's clock and the servo's are read apart
        read_forces(facts);
        read_workspace(facts);
        calibrate(facts);
        return facts;
    }

    bool states(unsigned what, double* values) const {
        library_.get_doublev(what, values);
        return library_.error().empty();
    }

    void read_forces(DeviceFacts& facts) const {
        double most = NAN;
        if (!states(HdValue::nominal_max_force, &most))
            return;
        require_plausible_force(facts.name, most);
        facts.max_force = most;
        double continuous = NAN;
        if (!states(HdValue::nominal_max_continuous_force, &continuous))
            return;
        if (!(continuous >= 0.1 && continuous <= most))
            throw DeviceAbsent(
                "{} states a continuous force of {} N: between 0.1 N and its largest, {} N, is plausible", facts.name,
                continuous, most);
        facts.continuous_force = continuous;
    }

    void read_workspace(DeviceFacts& facts) const {
        facts.low = glm::dvec3(-kUnknownReach);
        facts.high = glm::dvec3(kUnknownReach);
        double box[6]{NAN, NAN, NAN, NAN, NAN, NAN}; /* mm */
        if (!states(HdValue::max_workspace_dimensions, box))
            return;
        for (int axis = 0; axis < 3; ++axis) {
            const double size = box[3 + axis] - box[axis];
            if (!(size >= 20 && size <= 6000))
                throw DeviceAbsent("{} states the workspace ({}, {}, {}) to ({}, {}, {}): its API gives millimetres, "
                                   "and a side between 20 mm and 6000 mm is plausible",
                                   facts.name, box[0], box[1], box[2], box[3], box[4], box[5]);
        }
        facts.low = kMillimetre * glm::dvec3(box[0], -box[5], box[1]);
        facts.high = kMillimetre * glm::dvec3(box[3], -box[2], box[4]);
    }

    // Before forces are enabled.
    void calibrate(DeviceFacts& facts) const {
        if (const std::string why = why_uncalibrated(facts); !why.empty())
            throw DeviceAbsent("{} is not calibrated ({}): put its stylus into the inkwell (an arm without one into "
                               "its reset position), or run the vendor's Touch_Diagnostic, and try again",
                               facts.name, why);
    }

    // The device states a set of them and accepts one: the last that it has.
    int calibration_style() const {
        int styles = 0, chosen = 0;
        library_.get_integerv(HdValue::calibration_style, &styles);
        for (const int style :
             {HdValue::calibrate_by_reset, HdValue::calibrate_in_inkwell, HdValue::calibrate_by_itself})
            if (styles & style)
                chosen = style;
        return chosen;
    }

    // Where a hand holds it, it stands at no reset position.
    int style_in_a_run() const {
        const int style = calibration_style();
        return library_.error().empty() && style != HdValue::calibrate_by_reset ? style : 0;
    }

    // Empty: it is calibrated, perhaps by us.
    std::string why_uncalibrated(DeviceFacts& facts) const {
        unsigned state = library_.check_calibration();
        std::string error = library_.error();
        if (error.empty() && state == HdValue::calibration_needs_update) {
            const int chosen = calibration_style();
            if (error = library_.error(); !error.empty() || chosen == 0)
                return "it does not state how: " + error;
            library_.update_calibration(static_cast<unsigned>(chosen));
            error = library_.error();
            state = library_.check_calibration();
            if (const std::string further = library_.error(); error.empty())
                error = further;
            if (chosen == HdValue::calibrate_by_reset)
                facts.remark = facts.name + " calibrated as if it stood at its reset position: put it there and start "
                                            "again if it stood elsewhere";
        }
        if (!error.empty())
            return error;
        return state == HdValue::calibration_ok                   ? ""
               : state == HdValue::calibration_needs_manual_input ? "it waits to be placed"
                                                                  : "also after an update";
    }

    void await_position() {
        Servo::Frame frame;
        int failures = 0;
        for (int waited = 0; !frame.valid && waited < kStartPatience && failures < kMostFailures; ++waited) {
            ::poll(nullptr, 0, 1);
            failures += servo_.take(frame) && !frame.valid ? 1 : 0;
        }
        if (!frame.valid) {
            const char* why = servo_.error_text();
            throw DeviceAbsent("{} reports no position: {}", facts_.name, why ? why : "its scheduler does not run");
        }
        const glm::dvec3& at = frame.position;
        if (!is_reachable(at))
            throw DeviceAbsent("{} reported the position ({}, {}, {}) mm: no device reaches further than {} m",
                               facts_.name, 1e3 * at.x, 1e3 * at.z, -1e3 * at.y, kReachOfDevices);
        position_ = at;
    }

    const HdLibrary library_;
    const Session session_;
    const DeviceFacts facts_;
    Servo servo_;
    const Schedule schedule_;
    glm::dvec3 position_{0};
    std::uint32_t buttons_ = 0; // of the newest frame
    bool valid_ = true;         // it had a position
};

} // namespace

std::unique_ptr<BackEnd> open_hd(std::string_view name) {
    return std::make_unique<Hd>(std::string(name));
}

DeviceKind find_hd() {
    const HdLibrary library;
    DeviceKind kind;
    kind.place = library.file();
    kind.software = "OpenHaptics HDAPI";
    try {
        const Session session(library, {});
        kind.software = software_of(library);
        kind.name = name_of(library);
        kind.devices = {"hd"};
    } catch (const DeviceAbsent& absent) {
        kind.problem = absent.what();
    }
    return kind;
}

} // namespace forceshade::device
