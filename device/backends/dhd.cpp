#include "device/backends/dhd.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "device/backends/dhd_library.h"

namespace forceshade::device {

namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned char kWatchdog = 255;                        // in 125 us: 32 ms, the longest there is
constexpr Clock::duration kGap = std::chrono::milliseconds(30); // after such a pause the watchdog may have bitten
constexpr double kSilence = 0.025; /* s: likewise, for the loop, which is to notice first */
constexpr Clock::duration kAsk = std::chrono::milliseconds(20); // between questions for the status
constexpr int kDoorPatience = 20;                               /* ms */
constexpr int kDisplayTime = 2;                                 /* ms: until a force that was written is displayed */
constexpr double kFarthest = 3;                                 /* m: no device reaches further */
constexpr double kUnknownReach = 0.5;                           /* m: of a type that is not known */

glm::dvec3 to_world(double x, double y, double z) {
    return {y, -x, z};
}

// False also for what is no number.
bool is_reachable(const glm::dvec3& at) {
    return std::abs(at.x) <= kFarthest && std::abs(at.y) <= kFarthest && std::abs(at.z) <= kFarthest;
}

// The largest force, N, that the maker states for a type of device (the SDK's numbers for them).
double stated_force(int type) {
    switch (type) {
    case 33: // omega.3
    case 34: // omega.6, right and left
    case 36:
    case 35: // omega.7, right and left
    case 37:
        return 12;
    case 60: // Falcon
        return 8;
    case 63:  // delta.3
    case 64:  // delta.6
    case 104: // sigma.7, right and left
    case 105:
        return 20;
    default:
        return kUnknown;
    }
}

// m: from the middle of the workspace, further than which no arm of a type reaches: what the maker states (omega 160 mm
// wide, delta 400 mm, sigma 190 mm, lambda 240 mm, Falcon 102 mm) and half of it more, for devices stand as they stand.
double reach(int type) {
    switch (type) {
    case 33:
    case 34:
    case 36:
    case 35:
    case 37:
        return 0.12;
    case 60:
        return 0.08;
    case 63:
    case 64:
        return 0.3;
    case 104:
    case 105:
    case 106:
    case 107:
        return 0.15;
    case 108: // lambda.7, right and left
    case 109:
        return 0.18;
    default:
        return kUnknownReach;
    }
}

// Why a device in this state is not to display forces; null: it may, once they are enabled.
const char* objection(const DhdCalls::Status& status) {
    using Status = DhdCalls::Status;
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

// Why forces are off, where nothing else is wrong.
const char* cause_in_words(int cause) {
    switch (cause) {
    case DhdCalls::button:
        return "forces were switched off by the device's button: press it again";
    case DhdCalls::velocity:
        return "the device switched its forces off, for it was moved too fast: press its button";
    case DhdCalls::watchdog:
        return "the device's watchdog switched its forces off";
    case DhdCalls::software:
        return "another program switched the device's forces off";
    case DhdCalls::dead_man:
        return "the device's dead-man switch is released";
    default: // none told, or one that cannot be while we talk to it
        return "the device's forces are off, and it does not say why: press its button";
    }
}

int index_of(std::string_view text) {
    int index = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (error != std::errc{} || end != text.data() + text.size() || index < 0 || index > 127)
        throw UsageError(fmt::format("dhd:{}: a device's index is to be a whole number from 0 on", text));
    return index;
}

// An open device: stopped and closed on every way out.
class Session {
public:
    Session(const DhdLibrary& library, std::string_view index) : calls_(library.calls()) {
        const int wanted = index.empty() ? -1 : index_of(index);
        const int count = calls_.get_device_count();
        if (count <= std::max(wanted, 0))
            throw DeviceAbsent(no_device(library, wanted, count));
        const int id = wanted < 0 ? calls_.open() : calls_.open_id(static_cast<char>(wanted));
        if (id < 0)
            throw DeviceAbsent(fmt::format("the Force Dimension device{} cannot be opened: {} ({}, {})",
                                           wanted < 0 ? "" : fmt::format(" {}", wanted), library.error(),
                                           library.software(), library.file()));
        id_ = static_cast<char>(id);
    }
    ~Session() {
        calls_.stop(id_);
        calls_.close(id_);
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    char id() const { return id_; }

private:
    static std::string no_device(const DhdLibrary& library, int wanted, int count) {
        if (count > 0)
            return fmt::format("no Force Dimension device {}: there {} {}, counted from 0", wanted,
                               count == 1 ? "is" : "are", count);
        return fmt::format("{} finds no Force Dimension device ({}): is it plugged in and powered, and may this user "
                           "use it (a udev rule for USB)? Library: {}",
                           library.software(), count < 0 ? library.error() : "0 devices", library.file());
    }

    const DhdCalls& calls_;
    char id_ = -1;
};

class Dhd final : public BackEnd {
public:
    explicit Dhd(std::string_view index) : session_(library_, index), id_(session_.id()) {
        learn();
        check_status();
        check_position();
        set_watchdog();
    }
    ~Dhd() override {
        halt();
        ::poll(nullptr, 0, kDisplayTime);
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }
    Reading read() noexcept override;
    bool write(const glm::dvec3& force) noexcept override;
    void halt() noexcept override;
    void rest() noexcept override;
    const char* withheld() const noexcept override { return withheld_.load(); }
    const char* complaint() const noexcept override { return complaint_.load(); }

private:
    void learn();
    void check_status();
    void check_position();
    void set_watchdog();
    bool accepts_watchdog();
    bool display(const glm::dvec3& force) noexcept;
    bool ask_when_due(Clock::time_point now) noexcept;
    bool ask(Clock::time_point now) noexcept;
    bool enable() noexcept;
    bool done(int answer) noexcept;

    DhdLibrary library_;
    const DhdCalls& calls_ = library_.calls();
    Session session_;
    const char id_;
    DeviceFacts facts_;
    glm::dvec3 position_{0};
    Clock::time_point written_{}; // when a force was taken last
    Clock::time_point asked_{};   // when the status was told last
    bool on_ = false;             // forces are, by that status
    bool enable_ = false;         // they are off, and we are the ones to switch them on
    bool begun_ = false;          // they were on when we wrote one
    Door door_;
    std::atomic<const char*> withheld_ = nullptr;
    std::atomic<bool> halted_ = false;
    std::atomic<const char*> complaint_ = nullptr;
};

void Dhd::learn() {
    const char* name = calls_.get_system_name ? calls_.get_system_name(id_) : nullptr;
    facts_.name = name && *name ? name : "Force Dimension device";
    unsigned short serial = 0;
    if (calls_.get_serial_number && calls_.get_serial_number(&serial, id_) >= 0)
        facts_.name += fmt::format(" (serial number {})", serial);
    facts_.software = library_.software();
    const int type = calls_.get_system_type ? calls_.get_system_type(id_) : -1;
    facts_.max_force = stated_force(type);
    facts_.silence = kSilence;
    facts_.low = glm::dvec3(-reach(type));
    facts_.high = glm::dvec3(reach(type));
    const double limit = calls_.get_max_force ? calls_.get_max_force(id_) : -1;
    if (limit < 0)
        return;
    if (!(limit >= 0.5 && limit <= 200))
        throw DeviceAbsent(
            fmt::format("{} states a largest force of {} N: between 0.5 N and 200 N is plausible", facts_.name, limit));
    facts_.max_force = std::min(facts_.max_force, limit);
}

void Dhd::check_position() {
    double x = NAN, y = NAN, z = NAN;
    if (calls_.get_position(&x, &y, &z, id_) < 0)
        throw DeviceAbsent(fmt::format("{} tells no position: {}", facts_.name, library_.error()));
    position_ = to_world(x, y, z);
    if (!is_reachable(position_))
        throw DeviceAbsent(
            fmt::format("{} tells the position ({}, {}, {}): its SDK gives metres, and no device reaches "
                        "further than {} m",
                        facts_.name, x, y, z, kFarthest));
}

// What it is not ready for now it may be later: the session goes on without force until then.
void Dhd::check_status() {
    if (!ask(Clock::now()))
        throw DeviceAbsent(fmt::format("{} does not tell its status: {}", facts_.name, library_.error()));
}

bool Dhd::accepts_watchdog() {
    if (!calls_.enable_expert_mode || !calls_.disable_expert_mode || !calls_.set_watchdog ||
        calls_.enable_expert_mode() < 0)
        return false;
    const bool accepted = calls_.set_watchdog(kWatchdog, id_) >= 0;
    calls_.disable_expert_mode();
    return accepted;
}

// The loop writes forces all the time; should the process stop, the device lets go by itself.
void Dhd::set_watchdog() {
    facts_.has_watchdog = accepts_watchdog();
    if (!facts_.has_watchdog)
        facts_.remark = facts_.name + " refuses its watchdog: the last force of a process that is killed stays on";
}

bool Dhd::done(int answer) noexcept {
    if (answer < 0)
        complaint_ = calls_.error_get_last_str();
    return answer >= 0;
}

Reading Dhd::read() noexcept {
    if (!door_.enter())
        return {Answer::held, position_, false}; // another thread takes the force away just now
    double x = NAN, y = NAN, z = NAN;
    const bool asked = ask_when_due(Clock::now());
    const int answer = calls_.get_position(&x, &y, &z, id_);
    const bool told = done(answer) && asked;
    door_.leave();
    if (!told)
        return {Answer::failed, position_, false};
    if (answer == DhdCalls::kTimeGuard)
        return {Answer::held, position_, false};
    const glm::dvec3 position = to_world(x, y, z);
    if (!is_reachable(position)) // in other units, or out of its mind
        return {Answer::fresh, glm::dvec3(NAN), false};
    position_ = position;
    return {Answer::fresh, position_, false};
}

bool Dhd::display(const glm::dvec3& force) noexcept {
    return done(calls_.set_force(-force.y, force.x, force.z, id_));
}

// False: the status is due and not told. Then it is due again.
bool Dhd::ask_when_due(Clock::time_point now) noexcept {
    return (now - asked_ <= kAsk && now - written_ <= kGap) || ask(now);
}

// Forces that are off are switched on where nobody has yet, and where the device's own watchdog took them after a pause
// of ours. What the user, the device or another program switched off stays off.
bool Dhd::ask(Clock::time_point now) noexcept {
    DhdCalls::Status status;
    on_ = enable_ = false;
    asked_ = {};
    if (!done(calls_.get_status(status.values.data(), id_)))
        return false;
    asked_ = now;
    const int cause = status[DhdCalls::Status::force_off_cause];
    const char* why = objection(status);
    if (!why) {
        on_ = status[DhdCalls::Status::force] != 0;
        enable_ = !on_ && (cause == DhdCalls::watchdog || (!begun_ && cause != DhdCalls::button &&
                                                           cause != DhdCalls::dead_man && cause != DhdCalls::velocity));
        why = on_ || (enable_ && !begun_) ? nullptr : cause_in_words(cause);
    }
    withheld_ = why;
    return true;
}

// From zero: the device may still hold the force of before the pause.
bool Dhd::enable() noexcept {
    enable_ = false;
    on_ = display(glm::dvec3(0)) && done(calls_.enable_force(1, id_));
    withheld_ = nullptr;
    if (!on_)
        asked_ = {};
    return on_;
}

bool Dhd::write(const glm::dvec3& force) noexcept {
    if (!door_.enter())
        return false;
    const Clock::time_point now = Clock::now();
    const bool told = !halted_ && ask_when_due(now);
    const bool again = begun_ && enable_; // the device let go meanwhile: the force is to come up from zero
    const bool on = told && (enable_ ? enable() : on_);
    begun_ = begun_ || on;
    const glm::dvec3 wanted = on && !again ? force : glm::dvec3(0);
    const bool shown = display(wanted);
    const bool taken = shown && told && (on || withheld_ != nullptr) && wanted == force;
    if (halted_) // perhaps while the force was on its way, and could not come in
        display(glm::dvec3(0));
    if (shown)
        written_ = now;
    else
        asked_ = {}; // forces may have been switched off meanwhile
    door_.leave();
    return taken && !halted_;
}

// Where the door stays shut, the thread inside takes the force away itself: the one in write() as its last deed, the
// one in read() with its next write(). A device whose thread never comes out again has its watchdog.
void Dhd::halt() noexcept {
    halted_ = true;
    if (!door_.enter_within(kDoorPatience))
        return;
    calls_.set_force(0, 0, 0, id_);
    calls_.stop(id_);
    door_.leave();
}

// A loop that is stuck in the vendor's library itself has the device's watchdog.
void Dhd::rest() noexcept {
    if (!door_.enter())
        return;
    calls_.set_force(0, 0, 0, id_);
    door_.leave();
}

} // namespace

std::unique_ptr<BackEnd> open_dhd(std::string_view index) {
    if (!index.empty())
        index_of(index); // before a library is looked for
    return std::make_unique<Dhd>(index);
}

DhdFound find_dhd() {
    const DhdLibrary library;
    DhdFound found{library.file(), library.software(), library.calls().get_device_count(), {}};
    if (found.devices < 0)
        found.complaint = library.error();
    return found;
}

} // namespace forceshade::device
