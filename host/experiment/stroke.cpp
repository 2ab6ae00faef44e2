#include "host/experiment/stroke.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "device/backends/devices.h"
#include "host/error.h"
#include "host/field/case_law.h"
#include "host/paths/motions.h"
#include "host/reference/path_step.h"

namespace forceshade::experiment {
namespace {

using device::LiveSample;

constexpr double kLonger = 1.5;  // a stroke's length over the feature's width
constexpr double kMargins = 1.2; // of a region's length over the feature's width

// What was felt of a pass from one side of the feature to the other.
void add_pass(const Feature& feature, std::vector<LiveSample> pass, std::vector<StrokeSignals>& passes) {
    const std::size_t all = pass.size();
    std::erase_if(pass, [](const LiveSample& sample) { return !(sample.force.z > 0); });
    if (pass.size() < 4 || pass.size() < all / 2)
        return;
    if (pass.back().probe.x < pass.front().probe.x)
        std::ranges::reverse(pass);
    StrokeSignals signals;
    signals.width = feature.width;
    const LiveSample* before = &pass.front();
    for (const LiveSample& now : pass) {
        if (!(now.probe.x > before->probe.x))
            continue; // held up
        const double x = now.probe.x - feature.centre.x;
        if (std::abs(x) <= feature.width / 2) {
            signals.x.push_back(x);
            signals.force.push_back(now.force.x / now.force.z);
            signals.path.push_back(-(now.probe.z - before->probe.z) / (now.probe.x - before->probe.x));
        }
        before = &now;
    }
    if (signals.x.size() >= 3 && signals.x.front() < 0 && signals.x.back() > 0)
        passes.push_back(std::move(signals));
}

} // namespace

Feature feature_of(const PreparedCase& stimulus) {
    PathsSpec plain;
    plain.drive = PathDrive::depth; // a mesh's box, not what a hand that presses dares
    const PathRegion region = path_region(plain, stimulus);
    return {{region.centre[0], region.centre[1]}, region.length / kMargins};
}

Manner manner_of(const Scene& scene) {
    Manner manner;
    if (!scene.paths)
        return manner;
    manner.rate = scene.paths->rate;
    manner.press = scene.paths->press;
    const Spread& speed = scene.paths->speed;
    manner.speed = speed.shape == Spread::Shape::uniform ? 0.5 * (speed.low + speed.high) : speed.value;
    return manner;
}

PreparedCase stroked(PreparedCase stimulus, const Manner& manner) {
    const Feature feature = feature_of(stimulus);
    const bool falls = stimulus.images.mesh != nullptr; // off its rim
    PathsSpec paths;
    paths.count = 1;
    paths.rate = manner.rate;
    paths.loop = PathLoop::closed;
    paths.drive = PathDrive::press;
    paths.press = manner.press;
    paths.speed = fixed_spread(manner.speed);
    paths.centre = std::array{feature.centre.x, feature.centre.y};
    paths.length = (falls ? 1 : kLonger) * feature.width;
    paths.width = 0;
    paths.steps = static_cast<std::uint64_t>(std::ceil(manner.passes * *paths.length / manner.speed * manner.rate)) + 1;
    stimulus.one.scene.paths = paths;
    return stimulus;
}

std::vector<LiveSample> stroke(const PreparedCase& stimulus, const Manner& manner) {
    PreparedCase prepared = stroked(stimulus, manner);
    prepared.one.scene.precision = Precision::f64;
    const std::unique_ptr<ProbeLaw> law = make_probe_law(prepared, 1 / manner.rate);
    law->couple(1, 1 / manner.rate);
    const auto hand = device::make_sim(prepared, manner.rate);
    std::vector<LiveSample> samples(prepared.one.scene.paths->steps);
    std::size_t path = 0;
    const std::uint64_t digest = scene_id(stimulus);
    for (LiveSample& sample : samples) {
        const device::Reading reading = hand->read();
        if (reading.begins_path) {
            ++path;
            law->begin_path();
        }
        const ProbeContact found = law->at(reading.position);
        sample.tick = static_cast<std::uint64_t>(&sample - samples.data());
        sample.time = static_cast<double>(sample.tick) / manner.rate;
        sample.path = static_cast<std::uint32_t>(path);
        sample.scene = digest;
        sample.flags = found.finished ? 0U : std::uint32_t(device::kUnfinished);
        sample.probe = reading.position;
        sample.proxy = found.proxy;
        sample.force = found.force;
        sample.commanded = found.coupled;
        sample.depth = found.depth;
        sample.facet = found.facet;
        hand->write(sample.commanded);
    }
    return samples;
}

std::vector<StrokeSignals> passes_over(const Feature& feature, const std::vector<LiveSample>& samples) {
    std::vector<StrokeSignals> passes;
    std::vector<LiveSample> pass; // since the probe was last beside the feature
    int from = 0;                 // on which side
    for (const LiveSample& sample : samples) {
        const double x = sample.probe.x - feature.centre.x;
        const int side = x < -feature.width / 2 ? -1 : x > feature.width / 2 ? 1 : 0;
        if (side != 0 && side == -from)
            add_pass(feature, std::exchange(pass, {}), passes);
        if (side != 0) {
            from = side;
            pass.clear();
        }
        pass.push_back(sample);
    }
    return passes;
}

std::vector<StrokeSignals> passes_of(const PreparedCase& stimulus) {
    return passes_over(feature_of(stimulus), stroke(stimulus, manner_of(stimulus.one.scene)));
}

Cues mean_cues(const std::vector<StrokeSignals>& passes, const ObserverParameters& observer) {
    if (passes.empty())
        throw UsageError("no stroke crossed the stimulus in contact, so that nothing was felt of it");
    Cues mean;
    for (const StrokeSignals& pass : passes) {
        const Cues cues = cues_of(pass, level_of(observer));
        const auto add = [&](double Cues::*cue) { mean.*cue += cues.*cue / static_cast<double>(passes.size()); };
        for (const auto cue :
             {&Cues::force_jump, &Cues::path_jump, &Cues::force_level, &Cues::path_level, &Cues::steepest, &Cues::base})
            add(cue);
    }
    return mean;
}

Shares answer_shares(const std::vector<StrokeSignals>& passes, const ObserverParameters& observer) {
    return shares_of(mean_cues(passes, observer), observer);
}

} // namespace forceshade::experiment
