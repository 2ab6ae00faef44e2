// A device that does what a test says, and scenes for the live loop.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "device/loop/live_loop.h"
#include "host/field/prepared_case.h"
#include "host/scene/study.h"

namespace forceshade::device::testing {

inline PreparedCase prepared_scene(const std::string& text, Precision precision = Precision::f64,
                                   const std::filesystem::path& folder = {}) {
    const std::vector<Override> replaced{{"run.precision", precision == Precision::f32 ? "f32" : "f64"}};
    return CasePreparation().prepare(parse_scene(text, "scene.toml", folder, replaced));
}

/// Nothing is limited, nothing comes up slowly: what the law gives is displayed.
inline SafetyLimits no_limits() {
    SafetyLimits limits;
    limits.max_force = limits.slew = limits.max_speed = limits.stale = limits.late = kUnknown;
    limits.ramp = limits.contact_ramp = 0;
    limits.fade = false;
    return limits;
}

/// Answers come from a function of the number of the question; forces are kept.
class ScriptedDevice final : public BackEnd {
public:
    using Script = std::function<Reading(std::uint64_t)>;
    /// `most`: forces that are kept.
    ScriptedDevice(Script script, std::size_t most, bool simulated = true) : script_(std::move(script)) {
        facts_.name = "script";
        facts_.simulated = simulated;
        forces.reserve(most);
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }
    Reading read() noexcept override { return script_(questions_++); }
    bool write(const glm::dvec3& force) noexcept override {
        if (forces.size() < forces.capacity())
            forces.push_back(force);
        if (forces.size() == slow_write)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        return takes_forces;
    }
    const char* withheld() const noexcept override { return reason; }
    void halt() noexcept override { halted = true; }
    void rest() noexcept override { ++rests; }
    const char* error_text() const noexcept override { return nullptr; }
    /// s: lets go of a force after such a pause.
    void lets_go_after(double silence) { facts_.silence = silence; }

    std::vector<glm::dvec3> forces; /* N */
    std::atomic<bool> halted = false, takes_forces = true;
    std::atomic<const char*> reason = nullptr; // why forces are withheld
    std::size_t slow_write = SIZE_MAX;         // which force takes 100 ms, counted from 1
    std::atomic<int> rests = 0;

private:
    Script script_;
    std::uint64_t questions_ = 0;
    DeviceFacts facts_;
};

/// What a loop came to.
struct LoopRun {
    std::vector<LiveSample> samples;
    LoopCounts counts;
    LoopEnd end = LoopEnd::running;
};

/// As fast as possible, with room for every sample.
inline LoopRun run_fast(BackEnd& back_end, const PreparedCase& prepared, LoopSettings settings) {
    settings.real_time = false;
    SampleRing ring(*settings.samples);
    LiveLoop loop(back_end, make_probe_law(prepared), settings, &ring);
    loop.start();
    loop.join();
    const auto kept = ring.look();
    return {{kept.begin(), kept.end()}, loop.counts(), loop.end()};
}

inline LoopRun run_fast(BackEnd& back_end, const PreparedCase& prepared, std::uint64_t samples,
                        const SafetyLimits& limits, double rate = 1000) {
    LoopSettings settings;
    settings.rate = rate;
    settings.samples = samples;
    settings.limits = limits;
    return run_fast(back_end, prepared, settings);
}

/// m: how far the probe's z goes over a share of the samples.
inline double swing(const std::vector<LiveSample>& samples, double from, double to) {
    const auto count = static_cast<double>(samples.size());
    double low = kUnknown, high = -kUnknown;
    for (auto i = static_cast<std::size_t>(from * count); i < static_cast<std::size_t>(to * count); ++i) {
        low = std::min(low, samples[i].probe.z);
        high = std::max(high, samples[i].probe.z);
    }
    return high - low;
}

inline Reading at(double x, double y, double z) {
    return {Answer::fresh, {x, y, z}, false};
}

} // namespace forceshade::device::testing
