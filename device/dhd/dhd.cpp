#include "device/dhd/dhd.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "device/dhd/dhd_library.h"
#include "device/dhd/turn.h"

namespace forceshade::device {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned char kWatchdog = 255;                        // in 125 us: 32 ms, the longest there is
constexpr Clock::duration kGap = std::chrono::milliseconds(30); // after such a pause the watchdog may have bitten
constexpr int kDoorPatience = 20;                               /* ms */
constexpr int kDisplayTime = 2;                                 /* ms: until a force that was written is displayed */
constexpr double kFarthest = 3;                                 /* m: no device reaches further */

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
    const char* complaint() const noexcept override { return complaint_.load(); }

private:
    void learn();
    void check_position();
    void set_watchdog();
    bool display(const glm::dvec3& force) noexcept;
    bool enable_after_pause(Clock::time_point now) noexcept;
    bool done(int answer) noexcept;

    DhdLibrary library_;
    const DhdCalls& calls_ = library_.calls();
    Session session_;
    const char id_;
    DeviceFacts facts_;
    glm::dvec3 position_{0};
    Clock::time_point written_{}; // when a force was taken last
    Door door_;
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
    if (calls_.get_system_type)
        facts_.max_force = stated_force(calls_.get_system_type(id_));
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

// The loop writes forces all the time; should the process stop, the device lets go by itself.
void Dhd::set_watchdog() {
    if (!calls_.enable_expert_mode || !calls_.disable_expert_mode || !calls_.set_watchdog)
        return;
    if (calls_.enable_expert_mode() < 0)
        return;
    calls_.set_watchdog(kWatchdog, id_); // devices without one refuse
    calls_.disable_expert_mode();
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
    const int answer = calls_.get_position(&x, &y, &z, id_);
    const bool told = done(answer);
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

// The device takes no force before it is enabled, nor after its watchdog bit. Only a pause of our own is mended: a
// force that the user switched off at the device stays off.
bool Dhd::enable_after_pause(Clock::time_point now) noexcept {
    return now - written_ <= kGap || done(calls_.enable_force(1, id_));
}

bool Dhd::write(const glm::dvec3& force) noexcept {
    if (!door_.enter())
        return false;
    const Clock::time_point now = Clock::now();
    bool taken = halted_ ? display(glm::dvec3(0)) : enable_after_pause(now) && display(force);
    if (halted_) // perhaps while the force was on its way, and could not come in
        taken = display(glm::dvec3(0)) && taken;
    if (taken)
        written_ = now;
    door_.leave();
    return taken;
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
