// What a run of the live loop looks like in between.
#pragma once

#include <cstdint>
#include <string>

namespace forceshade::device {

struct LiveStatus {
    double seconds = 0;        /* s since the start, by the clock */
    double rate = 0;           /* Hz: samples in the last while, by the clock */
    double force = 0;          /* N: commanded, its magnitude */
    double depth = 0;          /* m */
    std::uint64_t late = 0;    // samples: overruns
    std::uint64_t clamped = 0; // samples
    std::uint64_t lost = 0;    // samples that the log had no room for
    std::string state;         // in a word or two: "waiting for the device"; empty: all is well
};

} // namespace forceshade::device
