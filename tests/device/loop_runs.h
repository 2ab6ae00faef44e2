// Loops by the clock on a device that is pressed into a plane.
#pragma once

#include <limits>

#include <gtest/gtest.h>

#include "tests/device/scripted_device.h"

namespace forceshade::device::testing {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline const char* const kPlane = "[force]\nstiffness = \"1 N/mm\"\n";

// In a plane of 1 N/mm, a millimetre deep.
inline Reading deep(std::uint64_t) {
    return at(0, 0, -1e-3);
}

inline LoopSettings real_time(double rate, std::optional<std::uint64_t> samples = {}) {
    LoopSettings settings;
    settings.rate = rate;
    settings.samples = samples;
    settings.limits.ramp = 0;
    settings.limits.late = kUnknown; // a test's machine may be busy
    return settings;
}

// A loop on a device until it ends, all samples kept.
inline LoopRun run_through(BackEnd& device, const LoopSettings& settings, std::size_t room = 1 << 14) {
    SampleRing ring(room);
    LiveLoop loop(device, make_probe_law(prepared_scene(kPlane)), settings, &ring);
    loop.start();
    loop.join();
    const auto kept = ring.look();
    return {{kept.begin(), kept.end()}, loop.counts(), loop.end()};
}

inline void expect_forceless_end(const ScriptedDevice& device) {
    ASSERT_FALSE(device.forces.empty());
    EXPECT_EQ(device.forces.back(), glm::dvec3(0));
}

} // namespace forceshade::device::testing
