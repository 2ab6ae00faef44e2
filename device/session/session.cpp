#include "device/session/session.h"

#include <bit>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "device/backends/devices.h"
#include "host/clock.h"
#include "host/numbers.h"
#include "host/program.h"

namespace forceshade::device {

namespace {

constexpr double kBuffered = 16;   /* s: of samples that wait for the disk */
constexpr double kLongest = 3.2e7; /* s: a year */
constexpr auto kLook = std::chrono::milliseconds(20);

// By name, with units; "none" for a limit that is switched off.
std::vector<std::pair<std::string, std::string>> limits_as_text(const SafetyLimits& limits) {
    const auto text = [](double limit, const char* unit) {
        return std::isinf(limit) ? "none" : fmt::format("{:.6g} {}", limit, unit);
    };
    const auto side = [](double low, double high) { return fmt::format("{:.6g} to {:.6g} mm", 1e3 * low, 1e3 * high); };
    return {{"largest force", text(limits.max_force, "N")},
            {"lasting force", text(limits.continuous_force, "N")},
            {"slew", text(limits.slew, "N/s")},
            {"ramp", text(1000 * limits.ramp, "ms")},
            {"ramp at contact", text(1000 * limits.contact_ramp, "ms")},
            {"speed", text(limits.max_speed, "m/s")},
            {"stale position", text(1000 * limits.stale, "ms")},
            {"watchdog", text(1000 * limits.late, "ms")},
            {"fading out of oscillations", limits.fade ? "on" : "off"},
            {"passivity", limits.passivity > 0 ? text(limits.passivity, "N s/m at most") : "off"},
            {"workspace", std::isinf(limits.low.x) && std::isinf(limits.high.x)
                              ? "none"
                              : fmt::format("x {}, y {}, z {}", side(limits.low.x, limits.high.x),
                                            side(limits.low.y, limits.high.y), side(limits.low.z, limits.high.z))}};
}

double checked_rate(double rate) {
    if (rate >= kSlowestRate && rate <= kFastestRate)
        return rate;
    throw UsageError("the live loop runs at 100 Hz to 10 kHz, not {:.6g} Hz; use --rate \"1 kHz\"", rate);
}

// Errors that do not depend on the device, before one is opened.
const SessionOptions& checked(const SessionOptions& options) {
    if (options.asked_rate)
        checked_rate(*options.asked_rate);
    if (options.real_time)
        return options;
    const bool sim = is_sim(options.device);
    if (!sim && !options.device.starts_with("replay:"))
        throw UsageError("--fast is for sim and replay: {} runs by the clock", options.device);
    if (sim && !options.duration)
        throw UsageError("--fast needs --duration: a simulated hand never stops");
    if (options.view_port)
        throw UsageError("--fast is too fast to watch: leave out --fast or --view");
    return options;
}

std::optional<std::uint64_t> samples_in(std::optional<double> duration, double rate) {
    if (!duration)
        return std::nullopt;
    if (!(*duration * rate >= 0.5 && *duration <= kLongest))
        throw UsageError("--duration: between a sample ({:.6g} ms) and a year ({:.6g} s), got {:.6g} s", 1000 / rate,
                         kLongest, *duration);
    return static_cast<std::uint64_t>(std::llround(*duration * rate));
}

// The present fault, in a few words; empty: none. `withheld`: why the device displays no force, or null.
std::string state_of(const LoopStatus& status, const char* withheld) {
    if (withheld != nullptr)
        return fmt::format("no force: {}", withheld);
    if (status.samples == 0)
        return "waiting for the device";
    const std::uint32_t flags = status.flags;
    if (const std::uint32_t faults = flags & kZeroForceFlags; faults != 0)
        return fmt::format("no force: {}", kSampleFlagNames[static_cast<std::size_t>(std::countr_zero(faults))]);
    return flags & kRamping ? "ramping" : "";
}

// Where the probe is when the device is opened.
glm::dvec3 first_position(BackEnd& device, double patience) {
    const auto end = Clock::now() + std::chrono::duration<double>(std::min(patience, 3600.0));
    do {
        check_interrupt();
        const Reading reading = device.read();
        if (reading.answer == Answer::fresh && is_finite(reading.position) && device.withheld() == nullptr)
            return reading.position;
        device.write(glm::dvec3(0)); // some devices answer only to a command
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } while (Clock::now() < end);
    if (const char* const withheld = device.withheld())
        throw DeviceAbsent("{} displays no force: {}", device.facts().name, withheld);
    throw DeviceAbsent("{} reports no position{}", device.facts().name, error_text_of(device));
}

// A state of the device; changes are reported, at most some 20 of them.
template <typename State> struct Watched {
    State state{}; // without a fault
    std::size_t troubles = 0;

    bool changes(State now) {
        constexpr std::size_t kMost = 20;
        if (std::exchange(state, now) == now || troubles == kMost)
            return false;
        troubles += now != State{};
        return true;
    }
};

SafetyLimits limits_of(const SessionOptions& options, const Scene& scene, const DeviceFacts& facts,
                       std::vector<std::string>& warnings) {
    SafetyLimits limits = options.limits;
    if (limits.passivity == 0)
        limits.passivity = scene.hand.passivity.value_or(0);
    limits.max_force = std::min(options.max_force.value_or(kUnknown), facts.max_force);
    if (std::isinf(limits.max_force) && !options.max_force) {
        limits.max_force = kCautiousForce;
        if (!facts.simulated)
            warnings.push_back(
                fmt::format("the device does not state its largest force: {} N at most; --max-force sets another limit",
                            kCautiousForce));
    }
    limits.continuous_force = options.continuous_force.value_or(facts.continuous_force);
    if (!facts.has_watchdog && !options.without_watchdog && limits.max_force > kUnwatchedForce) {
        limits.max_force = kUnwatchedForce;
        warnings.push_back(fmt::format(
            "{} N at most without the device's watchdog; --without-device-watchdog allows more", kUnwatchedForce));
    }
    limits.low = options.workspace ? options.workspace->first : facts.low;
    limits.high = options.workspace ? options.workspace->second : facts.high;
    return limits;
}

void check_button(const char* flag, unsigned button, const DeviceFacts& facts) {
    if (button > facts.buttons)
        throw UsageError("{} {}: {} reports {}", flag, button, facts.name,
                         facts.buttons == 0 ? "no buttons" : "at most " + numbers::counted(facts.buttons, "button"));
}

class Session {
public:
    explicit Session(const SessionOptions& options)
        : options_(checked(options)), line_(options.quiet), prepared_(options.read()),
          opened_(open_for_loop(options, prepared_)),
          scenes_(
              options.scene, [this] { return read_stable(); }, prepared_, kept_stem(), is_sim(options.device)) {
        for (const std::string& warning : opened_.warnings)
            warn(warning);
        look_at_stability(prepared_);
        if (const std::string manner = manner_text(opened_.settings); !manner.empty())
            line_.say(manner);
        const std::vector<SampleRing*> others = start_readers();
        loop_.emplace(*opened_.device,
                      options_.make_law ? options_.make_law(prepared_, 1 / opened_.settings.rate)
                                        : make_probe_law(prepared_, 1 / opened_.settings.rate),
                      opened_.settings, log_ ? &log_->ring() : nullptr, others);
    }

    SessionResult run() {
        {
            const Emergency emergency(*opened_.device);
            const LoopSignals signals(*loop_);
            begun_ = Clock::now();
            loop_->start();
            while (loop_->end() == LoopEnd::running) {
                if (is_interrupted())
                    loop_->stop();
                look_at_scene();
                look_at_device();
                show();
                std::this_thread::sleep_for(kLook);
            }
            loop_->join();
            opened_.device->halt();
        }
        return finish();
    }

private:
    // Each with a ring and a thread of its own, so that a pipe without a reader does not delay the page. All but the
    // log are returned; the log comes last: if one of them fails, no log is left.
    std::vector<SampleRing*> start_readers() {
        const QuietSignals quiet;
        const double rate = opened_.settings.rate;
        std::vector<SampleRing*> others;
        if (options_.send)
            others.push_back(&sender_.emplace(*options_.send, rate).ring());
        if (options_.view_port) {
            const ViewedRun run{options_.scene.filename().string(), opened_.facts.name, rate,
                                opened_.settings.limits.max_force};
            others.push_back(&view_.emplace(*options_.view_port, run).ring());
            print_note("view: {}\n", view_->address()); // even if quiet: the address cannot be guessed
        }
        if (!options_.log.empty()) {
            log_.emplace(options_.log, kBuffered * rate, prepared_.one.scene.precision, options_.replace_log,
                         opened_.facts.buttons > 0);
            scenes_.keep_first();
        }
        return others;
    }

    // Empty: scenes are not kept, because there is no log or it is /dev/null or a pipe.
    std::filesystem::path kept_stem() const {
        std::error_code ignored;
        if (options_.log.empty() || (std::filesystem::exists(options_.log, ignored) &&
                                     !std::filesystem::is_regular_file(options_.log, ignored)))
            return {};
        return options_.log.parent_path() / options_.log.stem();
    }

    void say(const std::string& text, const char* before = "") {
        remarks_.push_back(text);
        line_.say(before + text);
    }
    void warn(const std::string& text) { say(text, "warning: "); }
    void warn_now(const std::string& text) { warn(fmt::format("{:.3f} s: {}", loop_->status().seconds.load(), text)); }

    // For the loop that runs.
    PreparedCase read_stable() const {
        PreparedCase prepared = options_.read();
        refuse_unstable(limits_on(opened_, prepared).warning(), opened_, options_);
        return prepared;
    }

    void look_at_stability(const PreparedCase& prepared) {
        const SceneLimits limits = limits_on(opened_, prepared);
        stability_ = limits.text();
        if (!loop_) // a stable scene may chatter at edges; a coupling may add energy
            opened_.settings.limits.fade =
                options_.limits.fade && (options_.unstable || !limits.stable() || limits.coupling);
        refuse_unstable(limits.warning(), opened_, options_);
        if (const std::string warning = limits.warning(); !warning.empty())
            warn(warning);
    }

    void look_at_scene() {
        if (!options_.watch)
            return;
        if (const std::optional<SceneChanges::Message> message = scenes_.look(*loop_)) {
            say(message->text, message->refused ? "warning: " : "");
            if (message->used)
                look_at_stability(*message->used);
        }
    }

    // Reports when the device fails or displays no force, why, and when that ends.
    void look_at_device() {
        const LoopStatus& now = loop_->status();
        const bool fails = (now.flags & kFailed) != 0 && now.samples > 0;
        if (fails_.changes(fails))
            warn_now(fails ? "the device fails" + error_text_of(*opened_.device) : "the device answers again");
        const char* const withheld = opened_.device->withheld();
        if (withheld_.changes(withheld))
            warn_now(withheld != nullptr ? fmt::format("no force: {}", withheld) : "the device displays forces again");
    }

    void show() {
        const LoopStatus& now = loop_->status();
        LiveStatus status;
        status.seconds = seconds_since(begun_);
        const double passed = status.seconds - shown_seconds_;
        if (passed > 0.5) {
            rate_ = static_cast<double>(now.samples - shown_samples_) / passed;
            shown_seconds_ = status.seconds;
            shown_samples_ = now.samples;
        }
        status.rate = rate_;
        status.force = now.force;
        status.depth = now.depth;
        status.late = now.overruns;
        status.clamped = now.clamped;
        status.lost = now.lost + (log_ ? log_->lost() : 0);
        status.state = state_of(now, withheld_.state);
        if (view_)
            view_->update(status);
        line_.update(status);
    }

    SessionResult finish() {
        SessionResult result;
        result.end = loop_->end();
        result.interrupted = is_interrupted() && result.end == LoopEnd::stopped;
        result.error_text = error_text_of(*opened_.device);
        opened_.device.reset(); // the device is closed before anything that is slow
        LiveOutcome& outcome = result.outcome;
        outcome.facts = opened_.facts;
        outcome.counts = loop_->counts();
        outcome.permissions = loop_->permissions();
        outcome.ended = result.end == LoopEnd::done             ? "after the requested time"
                        : result.end == LoopEnd::recording_over ? "at the end of the recording"
                        : result.end == LoopEnd::device_gone    ? "because the device was gone" + result.error_text
                                                                : "interrupted";
        if (view_)
            view_->close(outcome.ended);
        if (sender_) {
            sender_->close();
            outcome.sent_to = udp_text(*options_.send);
            outcome.sent = sender_->sent();
            outcome.send_failure = sender_->failure();
        }
        if (log_) {
            log_->close();
            outcome.log = options_.log.filename().string();
            outcome.logged = log_->written();
            outcome.counts.lost += log_->lost();
            result.log_failure = log_->failure();
        }
        outcome.scene = options_.scene.filename().string();
        outcome.scenes = scenes_.used();
        outcome.precision = name_of(prepared_.one.scene.precision);
        outcome.law = options_.law;
        outcome.device = options_.device;
        outcome.rate = opened_.settings.rate;
        outcome.real_time = opened_.settings.real_time;
        outcome.mapping = opened_.settings.mapping;
        outcome.manner = manner_text(opened_.settings);
        outcome.limits = limits_as_text(opened_.settings.limits);
        outcome.stability = stability_;
        const std::uint64_t paths = outcome.counts.paths, again = paths - std::min(paths, outcome.scenes.size());
        if (again > 0 && is_sim(options_.device))
            remarks_.push_back(fmt::format("the simulated hand lost its path {} and began again: it left paths.bound, "
                                           "having fallen off the surface or been thrown off",
                                           again == 1 ? "once" : fmt::format("{} times", again)));
        if (outcome.counts.standstill > 0)
            remarks_.push_back(
                fmt::format("the process stood still for {:.1f} s; the samples of that time did not become due",
                            outcome.counts.standstill));
        if (outcome.counts.lost > 0)
            remarks_.push_back(
                "samples are missing in the log; on a mesh the rest of their paths will not replay to the same forces");
        if (const std::uint64_t all = outcome.counts.samples; all > 0 && outcome.counts.with(kOutside) == all)
            remarks_.push_back("every position lay outside of the workspace, so there was no force at all: does "
                               "--origin put the scene where the hand is, and is --workspace the device's?");
        if (const std::uint64_t faded = outcome.counts.with(kUnstable); faded > 0)
            remarks_.push_back(
                fmt::format("the force drove an oscillation and was faded out, in {} of {} samples: this hand cannot "
                            "hold the scene's stiffness here; a softer scene, a faster loop, or --passivity may help",
                            faded, outcome.counts.samples));
        outcome.remarks = remarks_;
        return result;
    }

    const SessionOptions& options_;
    StatusLine line_;
    std::vector<std::string> remarks_;
    std::string stability_;
    PreparedCase prepared_;
    OpenDevice opened_;
    SceneChanges scenes_;
    std::optional<LiveLog> log_;
    std::optional<UdpSender> sender_;
    std::optional<LiveView> view_;
    std::optional<LiveLoop> loop_; // destroyed before its readers
    Watched<bool> fails_;
    Watched<const char*> withheld_; // why the device displays no force
    Clock::time_point begun_ = Clock::now();
    double rate_ = 0, shown_seconds_ = 0; /* Hz, s */
    std::uint64_t shown_samples_ = 0;
};

} // namespace

OpenDevice open_for_loop(const SessionOptions& options, const PreparedCase& prepared) {
    OpenDevice opened;
    {
        // The main thread handles every signal from outside, not the threads that are started here.
        const QuietSignals quiet;
        opened.device = open_device(options.device, prepared, options.asked_rate, options.limits.ramp);
    }
    opened.facts = opened.device->facts();
    check_button("--dead-man", options.dead_man, opened.facts);
    check_button("--clutch", options.clutch, opened.facts);
    if (options.dead_man != 0 && options.dead_man == options.clutch)
        throw UsageError("--dead-man and --clutch: button {} cannot be both", options.clutch);
    LoopSettings& settings = opened.settings = options;
    glm::dvec3& origin = settings.mapping.origin;
    if (options.origin_here)
        origin = first_position(*opened.device, options.patience);
    opened.facts.low -= origin;
    opened.facts.high -= origin;
    if (!opened.facts.remark.empty())
        opened.warnings.push_back(opened.facts.remark);
    settings.rate = checked_rate(options.asked_rate.value_or(opened.facts.rate));
    settings.limits = limits_of(options, prepared.one.scene, opened.facts, opened.warnings);
    settings.limits.fade = options.limits.fade && options.unstable;
    settings.samples = samples_in(options.duration, settings.rate);
    return opened;
}

SceneLimits limits_on(const OpenDevice& opened, const PreparedCase& prepared) {
    const std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    const bool presses = opened.facts.simulated && paths && paths->drive == PathDrive::press;
    return scene_limits(prepared, opened.settings.rate, presses ? paths->press : opened.settings.limits.max_force,
                        opened.settings.mapping.scale);
}

void refuse_unstable(const std::string& warning, const OpenDevice& opened, const SessionOptions& options) {
    if (!warning.empty() && !opened.facts.simulated && !options.unstable)
        throw UsageError("{}; set [hand] to what the device is, or feel it all the same with --unstable", warning);
}

std::string error_text_of(const BackEnd& device) {
    const char* const error_text = device.error_text();
    return error_text != nullptr ? fmt::format(": {}", error_text) : "";
}

std::string manner_text(const LoopSettings& settings) {
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
    if (settings.mapping.origin != glm::dvec3(0) || !settings.mapping.is_plain())
        add("mapping: " + mapping_text(settings.mapping));
    if (settings.dead_man != 0)
        add(fmt::format("force only while button {} is held", settings.dead_man));
    if (settings.clutch != 0)
        add(fmt::format("the hand moves alone while button {} is held", settings.clutch));
    return text;
}

SessionResult run_session(const SessionOptions& options) {
    return Session(options).run();
}

} // namespace forceshade::device
