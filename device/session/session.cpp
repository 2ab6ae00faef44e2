#include "device/session/session.h"

#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "device/loop/emergency.h"
#include "device/report/status_line.h"
#include "device/session/interruption.h"
#include "device/session/live_log.h"
#include "device/session/open_device.h"
#include "device/session/scene_changes.h"
#include "host/program.h"

namespace forceshade::device {

namespace {

std::string force_text(double force) {
    return std::isinf(force) ? "none" : fmt::format("{:.6g} N", force);
}
std::string time_text(double time) {
    return std::isinf(time) ? "none" : fmt::format("{:.6g} ms", 1000 * time);
}

} // namespace

std::vector<std::pair<std::string, std::string>> limits_as_text(const SafetyLimits& limits) {
    std::vector<std::pair<std::string, std::string>> texts{
        {"largest force", force_text(limits.max_force)},
        {"lasting force", force_text(limits.lasting_force)},
        {"slew", std::isinf(limits.slew) ? "none" : fmt::format("{:.6g} N/s", limits.slew)},
        {"ramp", time_text(limits.ramp)},
        {"ramp at contact", time_text(limits.contact_ramp)},
        {"speed", std::isinf(limits.max_speed) ? "none" : fmt::format("{:.6g} m/s", limits.max_speed)},
        {"stale position", time_text(limits.stale)},
        {"watchdog", std::isinf(limits.late) ? "none" : fmt::format("{:.6g} periods", limits.late)},
        {"passivity", limits.passivity ? fmt::format("on, damping up to {:.6g} N s/m", limits.damping) : "off"}};
    const auto side = [](double low, double high) { return fmt::format("{:.6g} to {:.6g} mm", 1e3 * low, 1e3 * high); };
    if (!std::isinf(limits.low.x) || !std::isinf(limits.high.x))
        texts.emplace_back("workspace",
                           fmt::format("x {}, y {}, z {}", side(limits.low.x, limits.high.x),
                                       side(limits.low.y, limits.high.y), side(limits.low.z, limits.high.z)));
    else
        texts.emplace_back("workspace", "none");
    return texts;
}

namespace {

constexpr double kBuffered = 16;   /* s: of samples that wait for the disk */
constexpr double kLongest = 3.2e7; /* s: a year */
constexpr auto kLook = std::chrono::milliseconds(20);

double checked_rate(double rate) {
    if (rate >= kSlowestRate && rate <= kFastestRate)
        return rate;
    throw UsageError(fmt::format("the live loop runs at 100 Hz to 10 kHz, and {:.6g} Hz is asked for; say --rate "
                                 "\"1 kHz\"",
                                 rate));
}

// What is wrong whatever the device says, before one is opened.
const SessionOptions& checked(const SessionOptions& options) {
    if (options.rate)
        checked_rate(*options.rate);
    if (options.real_time)
        return options;
    const bool sim = options.device == "sim";
    if (!sim && !options.device.starts_with("replay:"))
        throw UsageError(fmt::format("--fast is for sim and replay: {} goes by the clock", options.device));
    if (sim && !options.duration)
        throw UsageError("--fast needs --duration: a simulated hand does not tire");
    return options;
}

std::optional<std::uint64_t> samples_in(std::optional<double> duration, double rate) {
    if (!duration)
        return std::nullopt;
    if (!(*duration * rate >= 0.5 && *duration <= kLongest))
        throw UsageError(fmt::format("--duration: between a sample ({:.6g} ms) and a year ({:.6g} s), got {:.6g} s",
                                     1000 / rate, kLongest, *duration));
    return static_cast<std::uint64_t>(std::llround(*duration * rate));
}

// The present trouble, in a few words; empty: none. `withheld`: why the device displays no force, or null.
std::string state_of(const LoopStatus& status, const char* withheld) {
    if (withheld != nullptr)
        return fmt::format("no force: {}", withheld);
    if (status.samples == 0)
        return "waiting for the device";
    const std::uint32_t happened = status.happened;
    for (std::size_t bit = 0; bit < kHappenings.size(); ++bit)
        if ((happened & kForceless) >> bit & 1u)
            return fmt::format("no force: {}", kHappenings[bit]);
    return happened & kRamping ? "ramping" : "";
}

class Session {
public:
    explicit Session(const SessionOptions& options)
        : options_(checked(options)), line_(options.quiet), prepared_(options.read()), device_(opened()),
          back_end_(*device_.back_end),
          scenes_(options.scene, options.read, prepared_, kept_stem(), options.device == "sim") {
        for (const std::string& warning : {device_.warning, back_end_.facts().remark})
            if (!warning.empty())
                remark(warning);
        settings_.rate = checked_rate(options.rate.value_or(device_.rate));
        settings_.real_time = options.real_time;
        settings_.patience = options.patience;
        settings_.cpu = options.cpu;
        settings_.limits = limits();
        settings_.samples = samples_in(options.duration, settings_.rate);
        if (!options.log.empty()) {
            const QuietSignals quiet;
            ring_.emplace(static_cast<std::size_t>(kBuffered * settings_.rate));
            log_.emplace(options.log, *ring_, prepared_.one.scene.precision, options.replace_log);
            scenes_.keep_first();
        }
        loop_.emplace(back_end_, make_live_law(prepared_), settings_, ring_ ? &*ring_ : nullptr);
    }

    SessionResult run() {
        SessionResult result;
        {
            const Emergency emergency(back_end_);
            const Suspension suspension(*loop_);
            const Interruption interruption(*loop_);
            start_quietly();
            while (loop_->end() == LoopEnd::running) {
                if (is_interrupted())
                    loop_->stop();
                look_at_scene();
                show();
                std::this_thread::sleep_for(kLook);
            }
            loop_->join();
            back_end_.halt();
        }
        result.end = loop_->end();
        result.interrupted = is_interrupted() && result.end == LoopEnd::stopped;
        finish(result);
        return result;
    }

private:
    // Threads that are started have every signal from outside left to the main one.
    OpenDevice open_quietly() const {
        const QuietSignals quiet;
        return open_device(options_.device, prepared_, options_.rate, options_.limits.ramp);
    }

    OpenDevice opened() const {
        OpenDevice device = open_quietly();
        device.back_end = place_device(std::move(device.back_end), options_.placement, options_.patience);
        return device;
    }

    void start_quietly() {
        const QuietSignals quiet;
        begun_ = Clock::now();
        loop_->start();
    }

    SafetyLimits limits() {
        SafetyLimits limits = options_.limits;
        const DeviceFacts& facts = back_end_.facts();
        limits.max_force = std::min(options_.max_force.value_or(kUnknown), facts.max_force);
        if (std::isinf(limits.max_force) && !options_.max_force) {
            limits.max_force = kCautiousForce;
            if (!facts.simulated)
                remark(fmt::format("the device does not say how much force it displays: {} N at most; --max-force says "
                                   "another limit",
                                   kCautiousForce));
        }
        limits.lasting_force = options_.lasting_force.value_or(facts.lasting_force);
        if (!facts.has_watchdog && !options_.without_watchdog && limits.max_force > kUnwatchedForce) {
            limits.max_force = kUnwatchedForce;
            remark(
                fmt::format("{} N at most without the device's watchdog; --without-device-watchdog displays more all "
                            "the same",
                            kUnwatchedForce));
        }
        limits.low = options_.workspace ? options_.workspace->first : facts.low;
        limits.high = options_.workspace ? options_.workspace->second : facts.high;
        return limits;
    }

    // Empty: there is no log that scenes could be kept beside; /dev/null and pipes have no place beside them.
    std::filesystem::path kept_stem() const {
        std::error_code ignored;
        if (options_.log.empty() || (std::filesystem::exists(options_.log, ignored) &&
                                     !std::filesystem::is_regular_file(options_.log, ignored)))
            return {};
        return options_.log.parent_path() / options_.log.stem();
    }

    void remark(const std::string& text) {
        remarks_.push_back(text);
        line_.say("warning: " + text);
    }

    void look_at_scene() {
        if (!options_.watch)
            return;
        const std::optional<SceneChanges::Said> said = scenes_.look(*loop_);
        if (said && said->refused)
            remark(said->text);
        else if (said) {
            remarks_.push_back(said->text);
            line_.say(said->text);
        }
    }

    // When the device began to display no force, and why, and when it displays one again.
    void watch_readiness() {
        constexpr std::size_t kMost = 20; // remarks
        const char* const withheld = back_end_.withheld();
        if (std::exchange(withheld_, withheld) == withheld || reasons_ == kMost)
            return;
        reasons_ += withheld != nullptr ? 1 : 0;
        const double time = loop_->status().seconds.load();
        remark(withheld != nullptr ? fmt::format("{:.3f} s: no force: {}", time, withheld)
                                   : fmt::format("{:.3f} s: the device displays forces again", time));
    }

    // When the device went, and when it came back.
    void watch_device() {
        constexpr std::size_t kMost = 20; // remarks
        const LoopStatus& now = loop_->status();
        const bool fails = (now.happened & kFailed) != 0 && now.samples > 0;
        if (std::exchange(failed_, fails) == fails || failures_ == kMost)
            return;
        failures_ += fails ? 1 : 0;
        const char* const complaint = back_end_.complaint();
        if (fails)
            remark(fmt::format("{:.3f} s: the device fails{}{}", now.seconds.load(), complaint != nullptr ? ": " : "",
                               complaint != nullptr ? complaint : ""));
        else
            remark(fmt::format("{:.3f} s: the device answers again", now.seconds.load()));
    }

    void show() {
        const LoopStatus& now = loop_->status();
        watch_device();
        watch_readiness();
        LiveStatus status;
        status.seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
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
        status.state = state_of(now, withheld_);
        line_.update(status);
    }

    void finish(SessionResult& result) {
        const char* const complaint = back_end_.complaint();
        result.complaint = complaint != nullptr ? complaint : "";
        LiveOutcome& outcome = result.outcome;
        outcome.facts = back_end_.facts();
        device_.back_end.reset(); // the device is let go before anything that takes time
        outcome.counts = loop_->counts();
        outcome.permissions = loop_->permissions();
        if (log_) {
            log_->close();
            outcome.log = options_.log.filename().string();
            outcome.logged = log_->written();
            outcome.counts.lost += log_->lost();
            result.log_failure = log_->failure();
        }
        outcome.scene = options_.scene.filename().string();
        outcome.scenes = scenes_.taken();
        outcome.precision = prepared_.one.scene.precision == Precision::f32 ? "f32" : "f64";
        outcome.device = options_.device;
        outcome.rate = settings_.rate;
        outcome.real_time = settings_.real_time;
        outcome.limits = limits_as_text(settings_.limits);
        outcome.ended = ending(result);
        const std::uint64_t again =
            outcome.counts.paths - std::min<std::uint64_t>(outcome.counts.paths, outcome.scenes.size());
        if (again > 0 && options_.device == "sim")
            remarks_.push_back(fmt::format("the simulated hand lost its path {} and began again: it left paths.bound, "
                                           "having fallen off the surface or been thrown off",
                                           again == 1 ? "once" : fmt::format("{} times", again)));
        if (outcome.counts.standstill > 0)
            remarks_.push_back(
                fmt::format("the process stood still for {:.1f} s; the samples of that time did not become "
                            "due",
                            outcome.counts.standstill));
        if (outcome.counts.lost > 0)
            remarks_.push_back(
                "samples are missing in the log; on a mesh the rest of their paths does not replay to the "
                "same forces");
        outcome.remarks = remarks_;
    }

    static std::string ending(const SessionResult& result) {
        switch (result.end) {
        case LoopEnd::done:
            return "after the time that was asked for";
        case LoopEnd::recording_over:
            return "at the end of the recording";
        case LoopEnd::device_gone:
            return "because the device was gone" + (result.complaint.empty() ? "" : ": " + result.complaint);
        case LoopEnd::running:
        case LoopEnd::stopped:
            break;
        }
        return "interrupted";
    }

    using Clock = std::chrono::steady_clock;
    const SessionOptions& options_;
    StatusLine line_;
    std::vector<std::string> remarks_;
    PreparedCase prepared_;
    OpenDevice device_;
    BackEnd& back_end_;
    SceneChanges scenes_;
    LoopSettings settings_;
    std::optional<SampleRing> ring_;
    std::optional<LiveLog> log_;
    std::optional<LiveLoop> loop_; // before the log goes
    bool failed_ = false;
    const char* withheld_ = nullptr; // why the device displays no force
    std::size_t failures_ = 0, reasons_ = 0;
    Clock::time_point begun_ = Clock::now();
    double rate_ = 0, shown_seconds_ = 0; /* Hz, s */
    std::uint64_t shown_samples_ = 0;
};

} // namespace

SessionResult run_session(const SessionOptions& options) {
    return Session(options).run();
}

} // namespace forceshade::device
