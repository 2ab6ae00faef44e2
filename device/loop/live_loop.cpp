#include "device/loop/live_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "host/program.h"
#include "shaders/shared/law.h"

namespace forceshade::device {

namespace {

// "-y", or "(0.8660, 0.5000, 0.0000)" if it is not along an axis.
std::string direction_text(const glm::dvec3& direction) {
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(direction[axis]) == 1)
            return fmt::format("{}{}", direction[axis] < 0 ? "-" : "", "xyz"[axis]);
    return fmt::format("({:.4f}, {:.4f}, {:.4f})", direction.x, direction.y, direction.z);
}

double seconds(std::int64_t time) noexcept {
    return static_cast<double>(time) * 1e-9;
}

std::int32_t short_time(std::int64_t time) noexcept {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(time, 0, 2'147'483'647));
}

void raise_to(double& largest, double value) noexcept {
    largest = value > largest ? value : largest;
}

constexpr double kBeyondAnyLimit = std::numeric_limits<double>::quiet_NaN(); // even an infinite one

} // namespace

std::string mapping_text(const Mapping& mapping) {
    const glm::dvec3 origin = 1e3 * mapping.origin + 0.0; // no -0
    std::string text = fmt::format("origin at ({:.6g}, {:.6g}, {:.6g}) mm", origin.x, origin.y, origin.z);
    if (mapping.turn != glm::dmat3(1))
        text += fmt::format(", scene's x, y, z along the device's {}, {}, {}", direction_text(mapping.turn[0]),
                            direction_text(mapping.turn[1]), direction_text(mapping.turn[2]));
    if (mapping.scale != 1)
        text += fmt::format("; {0:.6g} m of the scene in a metre of the device: springs feel {0:.6g} times as stiff",
                            mapping.scale);
    return text;
}

glm::dmat3 turn_about(int axis, double angle) {
    constexpr double kQuarter = std::numbers::pi / 2;
    const double quarters = angle / kQuarter, whole = std::round(quarters);
    double sine = std::sin(angle), cosine = std::cos(angle);
    if (std::abs(quarters - whole) < 1e-12) {
        constexpr double kSines[]{0, 1, 0, -1};
        const int quarter = static_cast<int>(std::fmod(std::fmod(whole, 4) + 4, 4));
        sine = kSines[quarter];
        cosine = kSines[(quarter + 1) % 4];
    }
    const int next = (axis + 1) % 3, after = (axis + 2) % 3;
    glm::dmat3 turn(1);
    turn[next] = glm::dvec3(0);
    turn[after] = glm::dvec3(0);
    turn[next][next] = cosine;
    turn[next][after] = sine;
    turn[after][next] = -sine;
    turn[after][after] = cosine;
    return turn;
}

Watchdog::Watchdog(BackEnd& back_end, std::int64_t patience)
    : back_end_(back_end), patience_(patience), fed_(now()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Watchdog::~Watchdog() = default;

void Watchdog::run(const std::stop_token& stop) noexcept {
    constexpr std::int64_t kLongest = kSecond / 20; // between checks of `stop`
    raise_priority(kWatchdogPriority);
    while (!stop.stop_requested()) {
        const std::int64_t fed = fed_.load(std::memory_order_relaxed), time = now();
        if (time - fed > patience_)
            back_end_.rest(); // repeatedly: the loop's thread may be in the vendor's library
        sleep_until(std::min(std::max(fed + patience_, time + patience_ / 4), time + kLongest));
    }
}

struct LiveLoop::Turn {
    LiveSample sample;
    Situation now;
    bool suspended = false;
    std::int64_t due = 0, begin = 0, end = 0; /* ns */
};

LiveLoop::LiveLoop(BackEnd& back_end, std::unique_ptr<ProbeLaw> law, const LoopSettings& settings, SampleRing* log,
                   std::vector<SampleRing*> others)
    : back_end_(back_end), settings_(settings), period_(1 / settings.rate), log_(log), others_(std::move(others)),
      laws_(std::move(law)), safety_(settings.limits, period_), counts_(std::make_unique<LoopCounts>()) {}

LiveLoop::~LiveLoop() {
    stop();
    join();
}

void LiveLoop::start() {
    const QuietSignals quiet;
    thread_ = std::thread([this] { run(); });
}

void LiveLoop::join() {
    if (thread_.joinable())
        thread_.join();
    watchdog_.reset();
}

std::int64_t LiveLoop::due(std::uint64_t tick) const noexcept {
    return first_due_ + static_cast<std::int64_t>(static_cast<double>(tick) * (1e9 / settings_.rate));
}

// Before the first sample: may allocate, and may be refused.
void LiveLoop::ask_for_permissions() noexcept {
    if (!settings_.real_time)
        return;
    try {
        permissions_ = ask_for_real_time(settings_.cpu);
        const double patience = std::max(settings_.limits.late, period_);
        if (std::isfinite(patience))
            watchdog_.emplace(back_end_, static_cast<std::int64_t>(std::min(patience, 1e6) * 1e9));
    } catch (...) { // no memory, no thread: the loop runs without permissions, and the report lists none
    }
}

void LiveLoop::run() noexcept {
    ask_for_permissions();
    laws_.present().couple(settings_.mapping.scale, period_);
    start_ = first_due_ = woken_ = now();
    computed_ = computed_so_far();
    for (; !is_over(); ++tick_) {
        Turn turn;
        wait_until_due(turn);
        if (read_position(turn)) {
            display_force(turn);
            record(turn);
        } else
            skip(turn);
        if (turn.suspended)
            at_rest_.store(true);
    }
    back_end_.write(glm::dvec3(0));
    counts_->seconds = seconds(now() - start_);
    counts_->energy = safety_.energy();
    counts_->damped = safety_.damped();
    LoopEnd still = LoopEnd::running;
    end_.compare_exchange_strong(still, LoopEnd::stopped, std::memory_order_release);
}

bool LiveLoop::is_over() noexcept {
    LoopEnd still = LoopEnd::running;
    if (settings_.samples && tick_ >= *settings_.samples)
        end_.compare_exchange_strong(still, LoopEnd::done, std::memory_order_release);
    return stop_.load(std::memory_order_relaxed) || end_.load(std::memory_order_relaxed) != LoopEnd::running;
}

void LiveLoop::wait_until_due(Turn& turn) noexcept {
    turn.due = due(tick_);
    if (settings_.real_time)
        sleep_until(turn.due);
    turn.begin = now();
    if (watchdog_)
        watchdog_->feed(turn.begin);
    turn.suspended = suspended_.load();
    if (turn.suspended)
        turn.now.late = kBeyondAnyLimit;
    if (!settings_.real_time)
        return;
    turn.sample.late = turn.begin - turn.due;
    if (seconds(turn.sample.late) > settings_.standstill) { // catching up would only keep the device busy
        counts_->standstill += seconds(turn.sample.late);
        first_due_ += turn.sample.late;
    }
    if (!turn.suspended)
        turn.now.late = seconds(turn.sample.late);
    counts_->late.add(turn.sample.late);
    if (tick_ > 0)
        counts_->jitter.add(std::abs((turn.begin - woken_) - (turn.due - due(tick_ - 1))));
    woken_ = turn.begin;
}

void LiveLoop::begin_path(Turn& turn) noexcept {
    if (!begun_)
        return;
    ++path_;
    turn.sample.flags |= kNewPath;
}

// False: there has been no position yet.
bool LiveLoop::read_position(Turn& turn) noexcept {
    if (laws_.update()) {
        laws_.present().couple(settings_.mapping.scale, period_);
        laws_.present().begin_path();
        begin_path(turn);
        status_.law_path.store(path_, std::memory_order_relaxed);
        status_.laws.fetch_add(1, std::memory_order_release);
        safety_.restart_ramp(); // its surface may lie high above the probe
    }
    Reading reading = back_end_.read();
    reading.position -= settings_.mapping.origin;
    const std::int64_t read = now();
    turn.sample.reading = short_time(read - turn.begin);
    turn.now.time = settings_.real_time ? seconds(read - start_) : static_cast<double>(tick_) / settings_.rate;
    turn.now.answer = reading.answer;
    turn.now.withheld = back_end_.withheld() != nullptr;
    if (reading.answer == Answer::ended) {
        end_.store(LoopEnd::recording_over, std::memory_order_release);
        return false;
    }
    const bool given = reading.answer == Answer::fresh || (reading.answer == Answer::repeated && begun_);
    look_at_buttons(turn, reading);
    const bool clutched = (turn.now.held_back & kClutched) != 0;
    if (given && clutched_ && !clutched && is_finite(reading.position)) { // the hand's position now is the probe's
        clutch_offset_ = reading.position - settings_.mapping.to_hand(probe_);
        clutched_ = false;
    }
    const glm::dvec3 probe = clutched && begun_ ? probe_ : probe_at(reading.position);
    turn.now.is_position = given && is_finite(reading.position) && laws_.present().reaches(probe);
    path_begins_ = path_begins_ || reading.begins_path; // with the next position, if this one is invalid
    if (turn.now.is_position) {
        turn.now.begins_path = std::exchange(path_begins_, false);
        if (turn.now.begins_path && begun_) {
            laws_.present().begin_path();
            begin_path(turn);
        }
        hand_ = reading.position;
        probe_ = probe;
        clutched_ = clutched;
        begun_ = true;
    }
    const double passed = turn.now.time - std::exchange(last_time_, turn.now.time);
    // A pause of the process does not count as a missing device.
    gone_ = given && begun_ && accepted_ ? 0 : gone_ + std::min(passed, 0.1 * settings_.patience);
    if (gone_ > settings_.patience)
        end_.store(LoopEnd::device_gone, std::memory_order_release);
    turn.now.probe = hand_;
    return begun_;
}

glm::dvec3 LiveLoop::probe_at(const glm::dvec3& hand) const noexcept {
    return settings_.clutch == 0 ? settings_.mapping.to_scene(hand) : settings_.mapping.to_scene(hand - clutch_offset_);
}

// If the device reports no buttons, none is pressed: the dead man's is released, the clutch keeps its state.
void LiveLoop::look_at_buttons(Turn& turn, const Reading& reading) noexcept {
    const bool known = reading.answer == Answer::fresh || reading.answer == Answer::repeated;
    const std::uint32_t pressed = known ? reading.buttons : 0;
    turn.sample.buttons = pressed;
    if (settings_.dead_man != 0 && (pressed & button_bit(settings_.dead_man)) == 0)
        turn.now.held_back |= kDeadMan;
    if (settings_.clutch != 0 && (known ? (pressed & button_bit(settings_.clutch)) != 0 : clutched_))
        turn.now.held_back |= kClutched;
}

// The force of the law, limited by safety, written to the device. A sample that is too late, or whose force comes after
// the device dropped the last one, has none, and the next force ramps up from zero.
void LiveLoop::display_force(Turn& turn) noexcept {
    LiveSample& sample = turn.sample;
    const auto is_late = [&](std::int64_t time) {
        return settings_.real_time && seconds(time - turn.due) > settings_.limits.late;
    };
    const std::int64_t begin = now();
    ProbeLaw& law = laws_.present();
    const ProbeContact contact =
        law.reaches(probe_) ? law.at(probe_) : ProbeContact{probe_, {}, {}, 0, layout::kNoFacet, true}; // a new law's
    sample.flags |= contact.finished ? 0u : kUnfinished;
    glm::dvec3 force = safety_.limit(turn.now, settings_.mapping.force_to_device(contact.coupled),
                                     contact.facet != layout::kNoFacet, sample.flags);
    const std::int64_t end = now();
    const bool device_timed_out =
        settings_.real_time && written_ != 0 && seconds(end - written_) > back_end_.facts().silence;
    if (device_timed_out || is_late(end)) {
        sample.flags |= kTooLate;
        safety_.drop_force();
        force = glm::dvec3(0);
    }
    sample.computing = short_time(end - begin);
    sample.probe = probe_;
    sample.proxy = contact.proxy;
    sample.force = contact.force;
    sample.depth = contact.depth;
    sample.facet = contact.facet;
    sample.scene = law.scene;
    sample.energy = safety_.energy();
    accepted_ = back_end_.write(force);
    turn.end = written_ = now();
    sample.commanded = accepted_ ? settings_.mapping.force_to_scene(force) : glm::dvec3(0);
    sample.flags |= accepted_ ? 0u : kFailed;
    sample.flags |= back_end_.saturated() ? kSaturated : 0u;
    const bool late = is_late(turn.end);
    sample.flags |= late ? kTooLate : 0u; // the watchdog has let the device rest meanwhile
    if (!accepted_ || late)
        safety_.drop_force();
    sample.writing = short_time(turn.end - end);
}

void LiveLoop::skip(const Turn& turn) noexcept {
    back_end_.write(glm::dvec3(0));
    written_ = now();
    computed_ = computed_so_far();
    if (turn.now.answer == Answer::ended)
        return;
    ++counts_->waiting;
    status_.waiting.store(counts_->waiting, std::memory_order_relaxed);
    status_.seconds.store(turn.now.time, std::memory_order_relaxed);
}

void LiveLoop::record(Turn& turn) noexcept {
    LiveSample& sample = turn.sample;
    sample.tick = tick_;
    sample.path = path_;
    sample.time = turn.now.time;
    if (settings_.real_time) {
        const std::int64_t computed = computed_so_far(), period = due(tick_ + 1) - turn.due;
        const bool too_long = computed - computed_ > period && turn.end - turn.begin > period;
        if (turn.end > due(tick_ + 1))
            sample.flags |= too_long ? kOverrun | kOwnOverrun : kOverrun;
        computed_ = computed;
    }
    LoopCounts& counts = *counts_;
    ++counts.samples;
    counts.in_contact += sample.facet != layout::kNoFacet;
    counts.paths = path_ + 1u;
    for (std::size_t i = 0; i < kSampleFlagNames.size(); ++i)
        counts.flags[i] += sample.flags >> i & 1u;
    raise_to(counts.largest_force, magnitude(sample.force));
    raise_to(counts.largest_commanded, magnitude(sample.commanded));
    raise_to(counts.largest_depth, sample.depth);
    raise_to(counts.largest_speed, safety_.speed());
    raise_to(counts.largest_energy, sample.energy);
    counts.reading.add(sample.reading);
    counts.computing.add(sample.computing);
    counts.writing.add(sample.writing);
    if (log_ != nullptr)
        while (!log_->put(sample)) {
            if (settings_.real_time || stop_.load(std::memory_order_relaxed)) {
                ++counts.lost;
                break;
            }
            sleep_until(now() + 50'000);
        }
    for (SampleRing* const ring : others_)
        ring->put(sample);
    publish(sample);
}

void LiveLoop::publish(const LiveSample& sample) noexcept {
    constexpr auto relaxed = std::memory_order_relaxed;
    status_.samples.store(counts_->samples, relaxed);
    status_.overruns.store(counts_->with(kOverrun), relaxed);
    status_.clamped.store(counts_->with(kClamped), relaxed);
    status_.lost.store(counts_->lost, relaxed);
    status_.flags.store(sample.flags, relaxed);
    status_.buttons.store(sample.buttons, relaxed);
    status_.seconds.store(sample.time, relaxed);
    status_.force.store(magnitude(sample.commanded), relaxed);
    status_.depth.store(sample.depth, relaxed);
    status_.energy.store(sample.energy, relaxed);
}

} // namespace forceshade::device
