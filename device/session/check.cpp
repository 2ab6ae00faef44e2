#include "device/session/session.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>

#include "device/backends/devices.h"
#include "host/clock.h"
#include "host/paths/motions.h"
#include "host/program.h"
#include "host/spelling.h"
#include "shaders/shared/law.h"

namespace forceshade::device {

namespace {

constexpr double kPush = 0.5;        /* N */
constexpr double kPushSlew = 5;      /* N/s: it is there after 0.1 s */
constexpr double kPushTime = 0.4;    /* s */
constexpr double kPauseTime = 0.25;  /* s: without force, before each push */
constexpr double kMeanTime = 0.1;    /* s: of positions, at the end of both */
constexpr double kRunaway = 0.3;     /* m/s: no force at more */
constexpr double kFarthest = 0.03;   /* m: a push that moves the probe this far ends */
constexpr double kYield = 3e-4;      /* m: the least that a push must move the probe */
constexpr double kAlong = 0.7;       // minimum share of the displacement along the push: 45 degrees
constexpr double kRestTime = 1;      /* s */
constexpr double kSteady = 5e-3;     /* m: a probe that is held still stays within */
constexpr double kStall = 0.3;       /* s */
constexpr double kCornersTime = 120; /* s: at most */
constexpr double kButtonTime = 20;   /* s: at most */
constexpr double kPressing = 2e-3;   /* m: into the surface, for the space that a scene needs */
constexpr double kLifting = 10e-3;   /* m: above it */
constexpr double kTolerance = 2e-3;  /* m: of the workspace */
constexpr auto kCheckLook = std::chrono::milliseconds(2);
constexpr const char* kNotHeld = "run it in a terminal, or use --yes while a person holds the device";

// The force of the check, for the loop's thread.
struct Push {
    std::array<std::atomic<double>, 3> force{}; /* N, in the scene's axes */
    std::atomic<double> stall = 0;              /* s: that the next sample takes */

    void set(const glm::dvec3& wanted) noexcept {
        for (int i = 0; i < 3; ++i)
            force[static_cast<std::size_t>(i)].store(wanted[i]);
    }
};

// In place of a scene's law: the same force everywhere.
class PushLaw final : public ProbeLaw {
public:
    explicit PushLaw(Push& push) : push_(push) {}

    bool reaches(const glm::dvec3& probe) const noexcept override { return is_finite(probe); }
    void begin_path() noexcept override {}
    ProbeContact at(const glm::dvec3& probe) noexcept override {
        if (const double stall = push_.stall.exchange(0); stall > 0) // for the watchdog to detect
            sleep_until(now() + static_cast<std::int64_t>(stall * 1e9));
        const glm::dvec3 force(push_.force[0].load(), push_.force[1].load(), push_.force[2].load());
        return {probe, force, force, 0, force == glm::dvec3(0) ? layout::kNoFacet : 0, true};
    }

private:
    Push& push_;
};

// The scene with paths that stay where they begin, held by a spring along every axis: for a simulated hand.
PreparedCase held_still(PreparedCase scene) {
    PathsSpec paths;
    paths.drive = PathDrive::depth;
    paths.depth = fixed_spread(-kLifting);
    paths.length = 0;
    paths.bound = 1;
    scene.one.scene.paths = paths;
    return scene;
}

// m: the box in which a scene has forces, in its axes.
struct Box {
    glm::dvec3 low{kUnknown}, high{-kUnknown};

    void add(const glm::dvec3& place) {
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
};

Box needed_box(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    const PathRegion region = path_region(scene.paths.value_or(PathsSpec{}), prepared);
    const SurfaceSpec& surface = scene.surface;
    const bool extruded = surface.kind == SurfaceKind::bump || surface.kind == SurfaceKind::cylinder_bump;
    const double half = surface.width / 2;
    const double rise =
        extruded ? surface.radius - std::sqrt(std::max(0.0, surface.radius * surface.radius - half * half)) : 0;
    Box box;
    for (const double side : {-0.5, 0.5})
        box.add({region.centre[0] + side * region.length, region.centre[1] + (extruded ? 0 : side * region.width),
                 side < 0 ? region.height - kPressing : region.height + rise + kLifting});
    return box;
}

std::string box_text(const glm::dvec3& low, const glm::dvec3& high) {
    const auto side = [&](int i) { return fmt::format("{} {:.0f} to {:.0f}", "xyz"[i], 1e3 * low[i], 1e3 * high[i]); };
    return fmt::format("{}, {}, {} mm", side(0), side(1), side(2));
}

// "+x"
std::string side_name(int axis, double sign) {
    return fmt::format("{}{}", sign < 0 ? "-" : "+", "xyz"[axis]);
}

CheckStep passed(const std::string& found) {
    return {"", CheckResult::passed, found, ""};
}
CheckStep failed(const std::string& found, const std::string& advice) {
    return {"", CheckResult::failed, found, advice};
}
CheckStep skipped(const std::string& found, const std::string& advice) {
    return {"", CheckResult::skipped, found, advice};
}
CheckStep fitting(bool fits, const std::string& found) {
    return fits ? passed(found) : failed(found, "--origin moves the scene, --scale shrinks it");
}
CheckStep absent(const std::string& found) {
    return {"", CheckResult::absent, found, ""};
}

class Check {
public:
    Check(const SessionOptions& options, const PreparedCase& scene, const CheckGuide& guide)
        : guide_(guide), scene_(scene), opened_(open_for_loop(options, held_still(scene))), ring_(1 << 14),
          loop_(*opened_.device, std::make_unique<PushLaw>(push_), settings(), &ring_), emergency_(*opened_.device),
          signals_(loop_) {
        check_.time = utc_now();
        check_.asked_for = options.device;
        check_.facts = opened_.facts;
        check_.manner = manner_text(opened_.settings);
        loop_.start();
    }

    ~Check() {
        push_.set(glm::dvec3(0));
        loop_.stop();
        loop_.join();
        opened_.device->halt();
    }

    DeviceCheck run() {
        try {
            go_through();
        } catch (const DeviceAbsent& gone) {
            add("device", failed(gone.what(), "see that it is on, and its cable"));
        }
        return check_;
    }

private:
    void go_through() {
        for (const std::string& warning : opened_.warnings)
            tell("note: " + warning);
        if (guide_.entered) {
            const char* const button = opened_.settings.dead_man != 0 ? ", with the dead-man's button pressed," : "";
            tell(fmt::format("Hold the probe lightly{} in the middle of its space, and stay there. It will be pushed "
                             "with {} N. Then press Enter.",
                             button, kPush));
            while (!guide_.entered())
                look();
        }
        add("calibration", calibration());
        add("rest", rest());
        add("axes", may_push() ? axes() : not_pushed());
        add("watchdog", may_push() ? watchdog() : not_pushed());
        add("workspace", workspace());
        add("stability", stability());
        add("button", button());
    }

    LoopSettings settings() const {
        LoopSettings settings = opened_.settings;
        SafetyLimits& limits = settings.limits;
        limits.max_force = std::min(limits.max_force, kPush);
        limits.slew = std::min(limits.slew, kPushSlew);
        limits.max_speed = std::min(limits.max_speed, kRunaway);
        settings.clutch = 0;
        settings.real_time = true;
        settings.samples.reset();
        return settings;
    }

    void tell(const std::string& text) const {
        if (guide_.print)
            guide_.print(text);
    }

    void add(const char* name, CheckStep step) {
        step.name = name;
        check_.steps.push_back(std::move(step));
    }

    bool may_push() const { return ready_ && guide_.held; }
    CheckStep not_pushed() const {
        return guide_.held ? skipped("the device is not ready for forces", "see the steps that failed")
                           : skipped("the probe is not held", kNotHeld);
    }

    // Waits a moment and appends the loop's new samples to `seen_`.
    void look() {
        std::this_thread::sleep_for(kCheckLook);
        check_interrupt();
        for (auto some = ring_.look(); !some.empty(); some = ring_.look()) {
            seen_.insert(seen_.end(), some.begin(), some.end());
            ring_.release(some.size());
        }
        if (loop_.end() != LoopEnd::running)
            throw DeviceAbsent("{} is gone{}", opened_.facts.name, error_text_of(*opened_.device));
    }

    // The loop's samples for a while, or until `over` returns true.
    std::vector<LiveSample> watch(
        double time, const std::function<bool()>& over = [] { return false; }) {
        look();
        seen_.clear();
        const auto start = Clock::now();
        do
            look();
        while (seconds_since(start) < time && !over());
        return seen_;
    }

    // m, in the scene's axes but unscaled: the hand's recent position.
    glm::dvec3 mean_place(const std::vector<LiveSample>& samples) const {
        glm::dvec3 sum(0);
        double count = 0;
        for (auto sample = samples.rbegin(); sample != samples.rend() && sample->time > samples.back().time - kMeanTime;
             ++sample) {
            sum += sample->probe;
            ++count;
        }
        return count > 0 ? sum / (count * opened_.settings.mapping.scale) : sum;
    }

    CheckStep stability() const {
        const SceneLimits limits = limits_on(opened_, scene_);
        return limits.stable()
                   ? passed(limits.text())
                   : failed(limits.text(),
                            limits.remedy() + "; --rate is the loop's, [hand] what the limit was computed for");
    }

    CheckStep calibration() {
        watch(0.1);
        const char* const withheld = opened_.device->withheld();
        ready_ = withheld == nullptr;
        if (!ready_)
            return failed(fmt::format("the device displays no force: {}", withheld),
                          "follow that message, then check again");
        return passed(opened_.facts.simulated ? "simulated: nothing to calibrate"
                                              : "the device reports that it is ready");
    }

    CheckStep rest() {
        const std::vector<LiveSample> samples = watch(kRestTime);
        Box way;
        std::size_t bad = 0, outside = 0, stale = 0;
        for (const LiveSample& sample : samples) {
            bad += (sample.flags & (kBadPosition | kFailed)) != 0;
            stale += (sample.flags & kStale) != 0;
            outside += (sample.flags & kOutside) != 0;
            way.add(sample.probe / opened_.settings.mapping.scale);
        }
        const auto fails = [&](const std::string& found, const char* advice) {
            ready_ = false;
            return failed(found, advice);
        };
        if (samples.empty())
            return fails("the device reports no position", "see that it is on, and look at the vendor's own program");
        if (bad > 0)
            return fails(fmt::format("{} of {} samples without a valid position", bad, samples.size()),
                         "look at the vendor's own program, and check the cable");
        if (stale > 0)
            return fails(fmt::format("{} of {} samples with a position older than allowed", stale, samples.size()),
                         "check the load of the machine and of the device's connection; --stale allows more");
        const glm::dvec3 size = way.high - way.low, place = 1e3 * mean_place(samples);
        const double widest = std::max({size.x, size.y, size.z});
        const std::string found = fmt::format("at ({:.1f}, {:.1f}, {:.1f}) mm, within {:.2f} mm for {} s", place.x,
                                              place.y, place.z, 1e3 * widest, kRestTime);
        if (outside > 0)
            return fails(found + ", outside of the device's workspace",
                         "hold it in the middle; --origin and --workspace set the workspace");
        if (widest > kSteady)
            return fails(found, "hold it still; if you did, its sensors or its calibration are faulty");
        return passed(found);
    }

    // m, in the scene's axes: displacement of the hand by a push; `runaway` if the push had to end early.
    glm::dvec3 yield_to(const glm::dvec3& force, bool& runaway) {
        const glm::dvec3 before = mean_place(watch(kPauseTime));
        const double scale = opened_.settings.mapping.scale;
        std::size_t looked_at = 0;
        push_.set(force);
        const std::vector<LiveSample> pushed = watch(kPushTime, [&] {
            for (; looked_at < seen_.size(); ++looked_at) {
                const glm::dvec3 way = seen_[looked_at].probe / scale - before;
                runaway = runaway || (seen_[looked_at].flags & kTooFast) != 0 || magnitude(way) > kFarthest;
            }
            return runaway;
        });
        push_.set(glm::dvec3(0));
        return mean_place(pushed) - before;
    }

    CheckStep axes() {
        tell(fmt::format("It pushes with {} N along x, y and z, in both directions.", kPush));
        std::string found, still, wrong, advice;
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {1.0, -1.0}) {
                glm::dvec3 direction(0);
                direction[axis] = sign;
                bool runaway = false;
                const glm::dvec3 way = yield_to(kPush * direction, runaway);
                const double along = sign * way[axis], size = magnitude(way);
                const std::string name = side_name(axis, sign);
                found += fmt::format("{}{} {:.1f} mm", found.empty() ? "" : ", ", name, 1e3 * along);
                if (runaway) {
                    ready_ = false; // no further pushes
                    return failed(fmt::format("pushed along {} with {} N the probe ran away, and the force was dropped",
                                              name, kPush),
                                  "hold it; if you did, its forces are too large or feed back: do not use it");
                }
                int largest = 0;
                for (int i = 1; i < 3; ++i)
                    largest = std::abs(way[i]) > std::abs(way[largest]) ? i : largest;
                if (size < kYield) {
                    still += (still.empty() ? "" : ", ") + name;
                } else if (along < kAlong * size) {
                    wrong += fmt::format("{}pushed along {} it moved {:.1f} mm along {}", wrong.empty() ? "" : "; ",
                                         name, 1e3 * size, side_name(largest, way[largest]));
                    advice = largest == axis ? "an axis is inverted: the device's set-up (its mount, its basis) is not "
                                               "as forceshade assumes; do not use it like this"
                                             : "the axes are not as assumed: turn the scene with --rotate, or correct "
                                               "the device's set-up (its mount, its basis); do not use it like this";
                }
            }
        if (!wrong.empty())
            return failed(wrong, advice);
        if (!still.empty())
            return failed(fmt::format("it yielded by less than {:.1f} mm along {}", 1e3 * kYield, still),
                          "hold it more lightly; if you did, its forces are off or too weak");
        return passed(fmt::format("{} N moved it by {}", kPush, found));
    }

    // The loop stands still while it pushes: when it wakes the force must be gone, and the hand back.
    CheckStep watchdog() {
        const glm::dvec3 before = mean_place(watch(kPauseTime));
        push_.set({0, 0, kPush});
        const std::vector<LiveSample> pushed = watch(kPushTime);
        const glm::dvec3 yielded = mean_place(pushed) - before;
        push_.stall = kStall;
        const std::vector<LiveSample> after = watch(2 * kStall);
        push_.set(glm::dvec3(0));
        const auto late = std::ranges::find_if(after, [](const LiveSample& s) { return (s.flags & kTooLate) != 0; });
        if (late == after.end() || late->commanded != glm::dvec3(0))
            return failed(fmt::format("the loop stood still for {} s and pushed on", kStall),
                          "set a watchdog: --watchdog \"20 ms\"");
        const auto woken = std::find_if(late, after.end(), [&](const LiveSample& s) { return s.tick > late->tick; });
        const double scale = opened_.settings.mapping.scale;
        const glm::dvec3 left = woken == after.end() ? yielded : woken->probe / scale - before;
        std::string found = fmt::format("the loop stood still for {} s and then displayed no force", kStall);
        if (opened_.facts.simulated)
            return passed(found + "; a simulated device has no watchdog of its own");
        if (!opened_.facts.has_watchdog)
            return failed(found + "; but the device refuses a watchdog of its own",
                          "the last force of a killed program stays on: 0.5 N at most, or use another driver");
        found += fmt::format("; the probe moved back from {:.1f} mm to {:.1f} mm meanwhile", 1e3 * magnitude(yielded),
                             1e3 * magnitude(left));
        if (magnitude(yielded) < kYield)
            return skipped("the probe did not yield, so the force cannot be observed", "see axes");
        if (magnitude(left) > 0.5 * magnitude(yielded))
            return failed(found, "the force stays on while the program is stopped: do not use it with more than 0.5 N");
        return passed(found);
    }

    CheckStep workspace() {
        const Mapping& mapping = opened_.settings.mapping;
        const Box needed = needed_box(scene_);
        const std::string needs = "the scene needs " + box_text(needed.low, needed.high);
        if (!guide_.entered) { // as the device states it
            const SafetyLimits& limits = opened_.settings.limits;
            Box corners;
            for (unsigned corner = 0; corner < 8; ++corner)
                corners.add(mapping.to_hand({corner & 1u ? needed.low.x : needed.high.x,
                                             corner & 2u ? needed.low.y : needed.high.y,
                                             corner & 4u ? needed.low.z : needed.high.z}));
            const bool fits = glm::all(glm::lessThanEqual(limits.low, corners.low)) &&
                              glm::all(glm::lessThanEqual(corners.high, limits.high));
            const std::string stated = std::isinf(limits.low.x)
                                           ? "the device states no limits"
                                           : "the device states " + box_text(limits.low, limits.high);
            return fitting(fits, fmt::format("{}; {}", needs, stated));
        }
        tell("Move the probe to every corner of its space, up and down, left and right, to you and away. Then press "
             "Enter.");
        Box reached;
        std::size_t looked_at = 0;
        watch(kCornersTime, [&] {
            for (; looked_at < seen_.size(); ++looked_at)
                if ((seen_[looked_at].flags & (kBadPosition | kFailed | kOutside)) == 0)
                    reached.add(seen_[looked_at].probe);
            return guide_.entered();
        });
        const double tolerance = kTolerance * mapping.scale;
        const bool fits = glm::all(glm::lessThanEqual(reached.low - tolerance, needed.low)) &&
                          glm::all(glm::lessThanEqual(needed.high, reached.high + tolerance));
        return fitting(fits, fmt::format("{}; it reached {}", needs, box_text(reached.low, reached.high)));
    }

    // One of the device's, or the one that switches its forces off: pressed and released.
    CheckStep button() {
        const unsigned dead_man = opened_.settings.dead_man;
        if (opened_.facts.buttons == 0)
            return absent("the device reports no buttons");
        if (!guide_.held)
            return not_pushed();
        const std::string which = dead_man != 0
                                      ? fmt::format("the dead-man's button, {},", dead_man)
                                      : std::string("a button of the device, or that which switches its forces off,");
        tell(fmt::format("Press and release {} within {} s{}.", which, kButtonTime,
                         guide_.entered && dead_man == 0 ? "; press Enter if the device has none" : ""));
        const char* const before = opened_.device->withheld();
        std::uint32_t pressed = 0;
        bool off = false, held = false, released = false, none = false;
        watch(kButtonTime, [&] {
            const std::uint32_t now = loop_.status().buttons;
            const std::uint32_t wanted = dead_man != 0 ? now & button_bit(dead_man) : now;
            const bool is_off = dead_man == 0 && opened_.device->withheld() != before;
            held = held || wanted != 0 || is_off;
            pressed |= wanted;
            off = off || is_off;
            released = held && wanted == 0 && !is_off;
            none = !held && dead_man == 0 && guide_.entered && guide_.entered();
            return released || none;
        });
        if (none)
            return absent("the device has none, says the person who holds it");
        if (!held)
            return failed(std::string("none was seen pressed"),
                          "see that the grip is awake and paired, and look at the vendor's own program");
        if (!released)
            return failed("it was seen pressed but not released",
                          "see whether it sticks; the forces stay off while it is held");
        std::string seen = off ? "the device's force button" : "";
        for (unsigned number = 1; number <= 32; ++number)
            if ((pressed & button_bit(number)) != 0)
                seen += fmt::format("{}button {}", seen.empty() ? "" : ", ", number);
        return passed(seen + " was seen pressed and released");
    }

    const CheckGuide& guide_;
    const PreparedCase& scene_;
    Push push_;
    OpenDevice opened_;
    SampleRing ring_;
    LiveLoop loop_;
    Emergency emergency_;
    LoopSignals signals_;
    std::vector<LiveSample> seen_;
    DeviceCheck check_;
    bool ready_ = true; // for forces
};

const char* result_name(CheckResult result) {
    constexpr std::array names{"passed", "failed", "skipped", "absent"};
    return names[static_cast<std::size_t>(result)];
}

} // namespace

bool DeviceCheck::passed() const noexcept {
    return std::ranges::all_of(steps, [](const CheckStep& step) {
        return step.result == CheckResult::passed || step.result == CheckResult::absent;
    });
}

DeviceCheck check_device(const SessionOptions& options, const PreparedCase& scene, const CheckGuide& guide) {
    if (options.device.starts_with("replay:"))
        throw UsageError("a recording cannot be pushed: check sim, haply, dhd or hd");
    return Check(options, scene, guide).run();
}

std::string check_text(const DeviceCheck& check) {
    std::string text = fmt::format("{}, {}{}\n", printable(check.facts.name), printable(check.facts.software),
                                   check.manner.empty() ? "" : "; " + check.manner);
    for (const CheckStep& step : check.steps) {
        text += fmt::format("{:<8} {}: {}\n", result_name(step.result), step.name, printable(step.found));
        if (!step.advice.empty())
            text += fmt::format("         {}\n", step.advice);
    }
    return text;
}

nlohmann::ordered_json check_json(const DeviceCheck& check) {
    nlohmann::ordered_json json{{"version", version()},
                                {"time", check.time},
                                {"device",
                                 {{"asked_for", printable(check.asked_for)},
                                  {"name", printable(check.facts.name)},
                                  {"software", printable(check.facts.software)}}},
                                {"manner", check.manner},
                                {"passed", check.passed()},
                                {"steps", nlohmann::ordered_json::array()}};
    for (const CheckStep& step : check.steps)
        json["steps"].push_back({{"name", step.name},
                                 {"result", result_name(step.result)},
                                 {"found", printable(step.found)},
                                 {"advice", step.advice}});
    return json;
}

} // namespace forceshade::device
