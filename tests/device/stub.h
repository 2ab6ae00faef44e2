// What the stubs of the vendors' libraries have in common: which calls fail, and the record of every force.
//
// A test in the same process steers a stub by the functions named stub_...; a test that runs the program sets
//   STUB_FAIL=dhdOpen,dhdGetPosition@100+50   calls that fail, from the first or from the hundredth after the first
//                                          push on, for good or 50 times
//   STUB_POSITION=0.01,0.02,0.03           in the vendor's units and axes
//   STUB_DEVICES=0                         how many devices there are
//   STUB_BUTTONS=2                         which buttons are pressed
//   STUB_HAND=1                            how the hand yields that holds it, as stub_hand
//   STUB_RECORD=FILE                       each force displayed is a line of seconds, x, y, z there, even if the
//                                          process dies next
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

// Each stub its own: nothing here may be shared between libraries.
namespace stub {
namespace {

struct Call {
    std::atomic<const char*> name = nullptr;
    std::atomic<long> made = 0, first_failing = 0, end_failing = 0;
    std::atomic<long> after_push = 0, times_after_push = 0; // how it fails once the device pushes
};

struct State {
    std::array<Call, 48> calls{};
    std::array<std::atomic<double>, 3> position{0.01, 0.02, 0.03};
    std::array<std::atomic<double>, 3> force{};
    std::atomic<long> forces = 0; // displayed
    std::atomic<bool> pushes = false;
    std::atomic<long> devices = 1;
    std::atomic<double> most_force = 8, scale = 1; // N; of the workspace
    std::atomic<long> calibration = 0x5000;
    std::atomic<long> styles = 2;                // of calibration
    std::atomic<double> continuous_force = 0.88; // N
    std::atomic<long> buttons = 0;               // pressed, as the vendor's mask
    std::atomic<long> hand = 0;                  // how one that holds the device yields: see stub_hand
    std::array<double, 3> rest{};                // where it does, in the vendor's units
    std::mutex order_mutex;
    std::string order; // of the calls that matter to the hand
    std::atomic<int> record = -1;
};

State state;

Call& call(const char* name) {
    for (Call& entry : state.calls) {
        const char* nobody = nullptr;
        if (entry.name.compare_exchange_strong(nobody, name) || std::strcmp(nobody, name) == 0)
            return entry;
    }
    std::abort();
}

/// Counts a call; true if it is to fail.
bool fails(const char* name) {
    Call& entry = call(name);
    const long number = ++entry.made;
    return number >= entry.first_failing && number < entry.end_failing;
}

/// In the vendor's units and axes.
void place(double x, double y, double z) {
    state.position[0] = x;
    state.position[1] = y;
    state.position[2] = z;
}

void fail(Call& entry, long from, long count) {
    entry.first_failing = entry.made + from;
    entry.end_failing = entry.made + from + count;
}

/// Remembers that something was called.
void note(const std::string& call) {
    const std::lock_guard lock(state.order_mutex);
    if (state.order.size() < 100'000)
        state.order += call + ";";
}

/// A soft hand, 2 mm a newton, goes where the force pushes it, or elsewhere. Of devices in metres.
void yield_to(double x, double y, double z) {
    constexpr double kGive = 2e-3;
    const std::array<double, 3> force{x, y, z};
    for (std::size_t i = 0; i < 3 && state.hand != 0; ++i) {
        const bool pushed = x != 0 || y != 0 || z != 0;
        if (state.hand == 5)
            state.position[i] = state.position[i] + kGive * force[i]; // 0.5 N: a metre a second
        else if (state.hand != 4 || pushed)
            state.position[i] = state.rest[i] + kGive * (state.hand == 2 ? force[(i + 1) % 3] : force[i]) *
                                                    (state.hand == 3 && i == 2 ? -1 : 1);
    }
}

void display(double x, double y, double z) {
    state.force[0] = x;
    state.force[1] = y;
    state.force[2] = z;
    ++state.forces;
    if ((x != 0 || y != 0 || z != 0) && !state.pushes.exchange(true))
        for (Call& entry : state.calls)
            if (entry.after_push > 0)
                fail(entry, entry.after_push, entry.times_after_push);
    yield_to(x, y, z);
    if (state.record < 0)
        return;
    const double time = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    char line[128];
    const int length = std::snprintf(line, sizeof line, "%.6f %.9g %.9g %.9g\n", time, x, y, z);
    if (::write(state.record, line, static_cast<std::size_t>(length)) != length)
        std::abort();
}

/// The same text, for as long as the library.
const char* kept(std::string_view name) {
    static std::mutex mutex;
    static auto& names = *new std::set<std::string, std::less<>>;
    const std::lock_guard lock(mutex);
    return names.emplace(name).first->c_str();
}

void fail(std::string_view name, long from, long count) {
    fail(call(kept(name)), from, count);
}

void fail_as_told(std::string_view list) {
    while (!list.empty()) {
        const std::string_view item = list.substr(0, list.find(','));
        list.remove_prefix(std::min(list.size(), item.size() + 1));
        const std::size_t at = item.find('@');
        const std::size_t plus = item.find('+');
        const long from = at == item.npos ? 1 : std::atol(std::string(item.substr(at + 1)).c_str());
        const long count = plus == item.npos ? 1L << 40 : std::atol(std::string(item.substr(plus + 1)).c_str());
        Call& entry = call(kept(item.substr(0, at)));
        if (from == 1) {
            fail(entry, from, count);
        } else {
            entry.times_after_push = count;
            entry.after_push = from;
        }
    }
}

void record_to(const char* file) {
    if (state.record >= 0)
        ::close(state.record);
    state.record = file ? ::open(file, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600) : -1;
}

void hold(long hand) {
    for (std::size_t i = 0; i < 3; ++i)
        state.rest[i] = state.position[i];
    state.hand = hand;
}

/// One device that does what it should, with nobody's hand on it.
void reset(double x, double y, double z, double most_force) {
    for (Call& entry : state.calls)
        entry.made = entry.first_failing = entry.end_failing = 0;
    state.hand = state.buttons = 0;
    state.devices = 1;
    state.scale = 1;
    state.most_force = most_force;
    state.continuous_force = 0.88;
    state.calibration = 0x5000;
    state.styles = 2;
    display(0, 0, 0);
    state.forces = 0;
    place(x, y, z);
    record_to(nullptr);
    const std::lock_guard lock(state.order_mutex);
    state.order.clear();
}

/// Run when the library is loaded.
const bool set_up = [] {
    double x = 0, y = 0, z = 0;
    if (const char* text = std::getenv("STUB_FAIL"))
        fail_as_told(text);
    if (const char* text = std::getenv("STUB_RECORD"))
        record_to(text);
    if (const char* text = std::getenv("STUB_DEVICES"))
        state.devices = std::atol(text);
    if (const char* text = std::getenv("STUB_BUTTONS"))
        state.buttons = std::atol(text);
    if (const char* text = std::getenv("STUB_POSITION"); text && std::sscanf(text, "%lf,%lf,%lf", &x, &y, &z) == 3)
        place(x, y, z);
    if (const char* text = std::getenv("STUB_HAND"))
        hold(std::atol(text));
    return true;
}();

} // namespace
} // namespace stub

extern "C" {

/// Back to one device at (0.01, 0.02, 0.03) m or (10, 20, 30) mm that does what it should.
void stub_reset();

/// `name` fails from its next call but `from` - 1 on, `count` times.
void stub_fail(const char* name, long from, long count) {
    stub::fail(name, from, count);
}
long stub_calls(const char* name) {
    return stub::call(stub::kept(name)).made;
}
void stub_position(double x, double y, double z) {
    stub::place(x, y, z);
}

/// The force that the device displays, in the vendor's axes.
void stub_force(double* force) {
    for (std::size_t i = 0; i < 3; ++i)
        force[i] = stub::state.force[i];
}
long stub_forces() {
    return stub::state.forces;
}
void stub_devices(long devices) {
    stub::state.devices = devices;
}
void stub_most_force(double force) {
    stub::state.most_force = force;
}
void stub_scale(double scale) {
    stub::state.scale = scale;
}
void stub_calibration(long answer) {
    stub::state.calibration = answer;
}
void stub_styles(long styles) {
    stub::state.styles = styles;
}
/// 0: a rock. 1: a soft hand; 2: as if the axes were others; 3: as if the third one was inverted; 4: one that stays
/// where it was pushed; 5: one that runs away.
void stub_hand(long hand) {
    stub::hold(hand);
}
void stub_buttons(long mask) {
    stub::state.buttons = mask;
}
void stub_continuous_force(double force) {
    stub::state.continuous_force = force;
}

/// The calls since the last question, each followed by a semicolon: "force 0 0 1;enable 1;".
const char* stub_order() {
    const std::lock_guard lock(stub::state.order_mutex);
    static std::string told;
    told = std::exchange(stub::state.order, {});
    return told.c_str();
}
void stub_record(const char* file) {
    stub::record_to(file);
}
}
