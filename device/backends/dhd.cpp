#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <poll.h>
#include <string>

#include <fmt/format.h>

#include "device/backends/devices.h"
#include "device/backends/shared_library.h"
#include "host/text.h"

namespace forceshade::device {

namespace {

/// The C interface of Force Dimension's DHD SDK, as far as it is used: declared here, found in the library at run time.
/// Lengths in m, forces in N, x towards the user, y to the user's right, z up. Calls that return an int return a
/// negative one on an error; dhdErrorGetLastStr describes it. A device is named by the number that opening it returned.
/// \throws DeviceAbsent: the library is missing or is a different one.
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

using Clock = std::chrono::steady_clock;

constexpr unsigned char kWatchdog = 255;                        // in 125 us: 32 ms, the maximum
constexpr Clock::duration kGap = std::chrono::milliseconds(30); // after such a pause the watchdog may have bitten
constexpr double kDhdSilence = 0.025;                           /* s: the same for the loop, which must notice first */
constexpr Clock::duration kAsk = std::chrono::milliseconds(20); // between status queries
constexpr int kDoorPatience = 20;                               /* ms */
constexpr int kDisplayTime = 2;                                 /* ms: until a force that was written is displayed */
constexpr unsigned kDhdButtons = 32;                            // the mask's; no device reports how many it has

/// A lock for the vendor's library with short waits only. Unlike a mutex it is safe in a signal's handler: the
/// interrupted thread may be the one inside, and is then not waited for.
class Door {
public:
    bool enter() noexcept {
        pthread_t none{};
        return inside_.compare_exchange_strong(none, ::pthread_self());
    }

    /// Waits up to `most` ms for the thread inside, unless it is the calling thread itself.
    bool enter_within(int most) noexcept {
        for (int waited = 0; !enter(); ++waited) {
            if (inside_.load() == ::pthread_self() || waited >= most)
                return false;
            ::poll(nullptr, 0, 1);
        }
        return true;
    }

    void leave() noexcept { inside_.store(pthread_t{}); }

private:
    static_assert(std::atomic<pthread_t>::is_always_lock_free);
    std::atomic<pthread_t> inside_{};
};

glm::dvec3 to_world(double x, double y, double z) {
    return {y, -x, z};
}

// Data sheet values of a type of device.
struct Model {
    int first, last; // the SDK's numbers for it, right and left hands
    double force;    /* N: the largest */
    double reach;    /* m: from the middle of the workspace no arm reaches further: the stated width (omega 160 mm,
                        delta 400 mm, sigma 190 mm, lambda 240 mm, Falcon 102 mm) and half of it more, because
                        devices are mounted in different ways */
};
constexpr std::array kModels{
    Model{33, 37, 12, 0.12},         // omega.3, omega.6, omega.7
    Model{60, 60, 8, 0.08},          // Falcon
    Model{63, 64, 20, 0.3},          // delta.3, delta.6
    Model{104, 105, 20, 0.15},       // sigma.7
    Model{106, 107, kUnknown, 0.15}, // others of its size
    Model{108, 109, kUnknown, 0.18}, // lambda.7
};

// Of a type of a later SDK: the arm of its family, as sigma.3 and lambda.3 have it; its largest force is not known.
Model family_of(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, double>, 4> kFamilies{
        {{"omega", 0.12}, {"delta", 0.3}, {"sigma", 0.15}, {"lambda", 0.18}}};
    for (const auto& [family, reach] : kFamilies)
        if (name.starts_with(family))
            return {0, 0, kUnknown, reach};
    return {0, 0, kUnknown, 0.5};
}

// Why a device in this state must not display forces; null: it may, once they are enabled.
const char* objection(const DhdLibrary::Status& status) {
    using Status = DhdLibrary::Status;
    if (status[Status::reset])
        return "the device is not calibrated: put its calibration pole into the pit, or run the SDK's HapticInit";
    if (!status[Status::power])
        return "the device has no power";
    if (!status[Status::connected] || !status[Status::started])
        return "the device's controller is not ready";
    if (status[Status::error])
        return "the device reports an error: switch it off and on again";
    return nullptr;
}

// Why forces are off, without any other fault.
const char* cause_in_words(int cause) {
    switch (cause) {
    case DhdLibrary::button:
        return "forces were switched off by the device's button: press it again";
    case DhdLibrary::velocity:
        return "the device switched its forces off because it was moved too fast: press its button";
    case DhdLibrary::watchdog:
        return "the device's watchdog switched its forces off";
    case DhdLibrary::software:
        return "another program switched the device's forces off";
    case DhdLibrary::dead_man:
        return "the device's dead-man switch is released";
    default: // none reported, or one that cannot occur while we talk to it
        return "the device's forces are off, and it does not say why: press its button";
    }
}

int index_of(std::string_view text) {
    if (const auto index = number_in(text, 0, 127))
        return *index;
    throw UsageError("dhd:{}: a device's index is a whole number from 0 to 127", text);
}

// Opens the device of this index; of -1 the first that is free.
char open_by_index(const DhdLibrary& library, int index) {
    const int count = library.get_device_count();
    if (count <= 0)
        throw DeviceAbsent("{} finds no Force Dimension device ({}): is it plugged in and powered, and may this user "
                           "use it (a udev rule for USB)? Library: {}",
                           library.version(), count < 0 ? library.error() : "0 devices", library.file());
    if (count <= index)
        throw DeviceAbsent("no Force Dimension device {}: {} connected, counted from 0", index, count);
    const int id = index < 0 ? library.open() : library.open_id(static_cast<char>(index));
    if (id < 0)
        throw DeviceAbsent("the Force Dimension device{} cannot be opened: {} ({}, {})",
                           index < 0 ? "" : fmt::format(" {}", index), library.error(), library.version(),
                           library.file());
    return static_cast<char>(id);
}

// Stopped and closed on every way out.
struct OpenDevice {
    const DhdLibrary& library;
    const char id;
    ~OpenDevice() {
        library.stop(id);
        library.close(id);
    }
};

class Dhd final : public BackEnd {
public:
    explicit Dhd(int index) : device_{library_, open_by_index(library_, index)} {
        facts_ = read_facts();
        // It may become ready later: the session goes on without force until then.
        if (!ask(Clock::now()))
            throw DeviceAbsent("{} does not report its status: {}", facts_.name, library_.error());
        check_position();
        set_watchdog();
        prepare_gripper();
    }
    ~Dhd() override {
        halt();
        ::poll(nullptr, 0, kDisplayTime);
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }
    const char* withheld() const noexcept override { return withheld_.load(); }
    const char* error_text() const noexcept override { return error_text_.load(); }
    bool saturated() const noexcept override { return saturated_; }

    Reading read() noexcept override {
        if (!door_.enter())
            return {Answer::repeated, position_, false, buttons_}; // another thread drops the force just now
        double x = NAN, y = NAN, z = NAN;
        const bool asked = ask_when_due(Clock::now());
        const int answer = library_.get_position(&x, &y, &z, id_);
        const bool valid = done(answer) && asked;
        buttons_ = library_.get_button_mask ? library_.get_button_mask(id_) : 0;
        door_.leave();
        if (!valid)
            return {Answer::failed, position_, false};
        if (answer == DhdLibrary::kTimeGuard)
            return {Answer::repeated, position_, false, buttons_};
        const glm::dvec3 position = to_world(x, y, z);
        if (!is_reachable(position)) // in other units, or damaged
            return {Answer::fresh, glm::dvec3(NAN), false, buttons_};
        position_ = position;
        return {Answer::fresh, position_, false, buttons_};
    }

    bool write(const glm::dvec3& force) noexcept override {
        if (!door_.enter())
            return false;
        const Clock::time_point now = Clock::now();
        const bool has_status = !halted_ && ask_when_due(now);
        const bool again = begun_ && enable_; // the device dropped the force meanwhile: it ramps up from zero
        const bool on = has_status && (enable_ ? enable() : on_);
        begun_ = begun_ || on;
        const glm::dvec3 wanted = on && !again ? force : glm::dvec3(0);
        const bool shown = display(wanted);
        const bool accepted = shown && has_status && (on || withheld_ != nullptr) && wanted == force;
        if (halted_) // perhaps while the force was being sent, and could not enter
            display(glm::dvec3(0));
        if (shown)
            written_ = now;
        else
            asked_ = {}; // forces may have been switched off meanwhile
        door_.leave();
        return accepted && !halted_;
    }

    // If the door stays shut, the thread inside drops the force itself: in write() before it leaves, in read() with its
    // next write(). If that thread never leaves, the device's watchdog drops the force.
    void halt() noexcept override {
        halted_ = true;
        if (!door_.enter_within(kDoorPatience))
            return;
        send(glm::dvec3(0));
        library_.stop(id_);
        door_.leave();
    }

    // If the loop is stuck in the vendor's library itself, the device's watchdog drops the force.
    void rest() noexcept override {
        if (!door_.enter())
            return;
        send(glm::dvec3(0));
        door_.leave();
    }

private:
    DeviceFacts read_facts() const {
        DeviceFacts facts;
        const char* name = library_.get_system_name ? library_.get_system_name(id_) : nullptr;
        facts.name = name && *name ? name : "Force Dimension device";
        unsigned short serial = 0;
        if (library_.get_serial_number && library_.get_serial_number(&serial, id_) >= 0)
            facts.name += fmt::format(" (serial number {})", serial);
        facts.software = library_.version();
        const int type = library_.get_system_type ? library_.get_system_type(id_) : -1;
        const auto known = std::find_if(kModels.begin(), kModels.end(), [type](const Model& model) {
            return model.first <= type && type <= model.last;
        });
        const Model model = known == kModels.end() ? family_of(name ? name : "") : *known;
        facts.max_force = model.force;
        facts.silence = kDhdSilence;
        facts.buttons = library_.get_button_mask ? kDhdButtons : 0;
        facts.low = glm::dvec3(-model.reach);
        facts.high = glm::dvec3(model.reach);
        const double limit = library_.get_max_force ? library_.get_max_force(id_) : -1;
        if (limit < 0)
            return facts;
        require_plausible_force(facts.name, limit);
        facts.max_force = std::min(facts.max_force, limit);
        return facts;
    }

    void check_position() {
        double x = NAN, y = NAN, z = NAN;
        if (library_.get_position(&x, &y, &z, id_) < 0)
            throw DeviceAbsent("{} reports no position: {}", facts_.name, library_.error());
        position_ = to_world(x, y, z);
        if (!is_reachable(position_))
            throw DeviceAbsent(
                "{} reported the position ({}, {}, {}): its SDK gives metres, and no device reaches further than {} m",
                facts_.name, x, y, z, kReachOfDevices);
    }

    // The loop writes forces all the time; if the process stops, the device drops the force by itself.
    void set_watchdog() {
        facts_.has_watchdog = false;
        if (library_.enable_expert_mode && library_.disable_expert_mode && library_.set_watchdog &&
            library_.enable_expert_mode() >= 0) {
            facts_.has_watchdog = library_.set_watchdog(kWatchdog, id_) >= 0;
            library_.disable_expert_mode();
        }
        if (!facts_.has_watchdog)
            facts_.remark = facts_.name + " refuses its watchdog: the last force of a process that is killed stays on";
    }

    // A gripper that is closed is button 1.
    void prepare_gripper() {
        const bool gripper = library_.has_active_gripper && library_.has_active_gripper(id_);
        const bool wrist = library_.has_active_wrist && library_.has_active_wrist(id_);
        actuated_ = (gripper || wrist) && library_.set_force_and_torque;
        if (gripper && !(library_.emulate_button && library_.emulate_button(1, id_) >= 0) && facts_.remark.empty())
            facts_.remark = facts_.name + " does not report its gripper as a button";
    }

    bool done(int answer) noexcept {
        if (answer < 0)
            error_text_ = library_.error_get_last_str();
        return answer >= 0;
    }

    // A wrist and a gripper with motors get none of it.
    int send(const glm::dvec3& force) noexcept {
        return actuated_ ? library_.set_force_and_torque(-force.y, force.x, force.z, 0, 0, 0, 0, id_)
                         : library_.set_force(-force.y, force.x, force.z, id_);
    }

    bool display(const glm::dvec3& force) noexcept {
        const int answer = send(force);
        saturated_ = answer == DhdLibrary::kMotorSaturated;
        return done(answer);
    }

    // False: the status is due and was not reported. It stays due.
    bool ask_when_due(Clock::time_point now) noexcept {
        return (now - asked_ <= kAsk && now - written_ <= kGap) || ask(now);
    }

    // Switches forces on that were never on, or that the device's own watchdog dropped after a pause of ours. Forces
    // that the user, the device or another program switched off stay off.
    bool ask(Clock::time_point now) noexcept {
        DhdLibrary::Status status;
        on_ = enable_ = false;
        asked_ = {};
        if (!done(library_.get_status(status.values.data(), id_)))
            return false;
        asked_ = now;
        const int cause = status[DhdLibrary::Status::force_off_cause];
        const char* why = objection(status);
        if (!why) {
            on_ = status[DhdLibrary::Status::force] != 0;
            const bool others =
                cause == DhdLibrary::button || cause == DhdLibrary::dead_man || cause == DhdLibrary::velocity;
            enable_ = !on_ && (cause == DhdLibrary::watchdog || (!begun_ && !others));
            why = on_ || (enable_ && !begun_) ? nullptr : cause_in_words(cause);
        }
        withheld_ = why;
        return true;
    }

    // From zero: the device may still hold the force of before the pause.
    bool enable() noexcept {
        enable_ = false;
        on_ = display(glm::dvec3(0)) && done(library_.enable_force(1, id_));
        withheld_ = nullptr;
        if (!on_)
            asked_ = {};
        return on_;
    }

    const DhdLibrary library_;
    const OpenDevice device_;
    const char id_ = device_.id;
    DeviceFacts facts_;
    glm::dvec3 position_{0};
    std::uint32_t buttons_ = 0;   // of the last reading
    Clock::time_point written_{}; // when a force was accepted last
    Clock::time_point asked_{};   // when the status was reported last
    bool on_ = false;             // forces are, by that status
    bool enable_ = false;         // they are off, and we must switch them on
    bool begun_ = false;          // they were on when we wrote one
    bool actuated_ = false;       // the wrist or the gripper is, too
    bool saturated_ = false;      // the motors give less than was written last
    Door door_;
    std::atomic<const char*> withheld_ = nullptr;
    std::atomic<bool> halted_ = false;
    std::atomic<const char*> error_text_ = nullptr;
};

} // namespace

std::unique_ptr<BackEnd> open_dhd(std::string_view index) {
    return std::make_unique<Dhd>(index.empty() ? -1 : index_of(index)); // before a library is looked for
}

DeviceKind find_dhd() {
    const DhdLibrary library;
    DeviceKind kind;
    kind.software = library.version();
    kind.place = library.file();
    const int count = library.get_device_count();
    const std::string error_text = count < 0 ? " (" + library.error() + ")" : "";
    for (int index = 0; index < count; ++index)
        kind.devices.push_back(fmt::format("dhd:{}", index));
    if (count <= 0)
        kind.problem = fmt::format(
            "no device{}: is it plugged in and powered, and may this user use it (a udev rule for USB)?", error_text);
    return kind;
}

} // namespace forceshade::device
