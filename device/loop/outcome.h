// The results of a run of the live loop.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "device/loop/permissions.h"
#include "device/loop/sample.h"

namespace forceshade::device {

/// Counted by the loop as it runs.
struct LoopCounts {
    std::uint64_t samples = 0;                                // that the law was evaluated for
    std::uint64_t waiting = 0;                                // before the device gave its first position; not logged
    std::uint64_t in_contact = 0;                             // of the samples
    std::uint64_t paths = 0;                                  // begun: scenes, and paths of a recording
    std::array<std::uint64_t, kHappenings.size()> happened{}; // samples, by bit of Happening
    std::uint64_t with(Happening what) const noexcept { return happened[unsigned(std::countr_zero(unsigned(what)))]; }
    std::uint64_t lost = 0;                // samples that the log had no room for
    double largest_force = 0;              /* N: the law's */
    double largest_commanded = 0;          /* N */
    double largest_depth = 0;              /* m */
    double largest_speed = 0;              /* m/s */
    double energy = 0;                     /* J: given to the hand, at the end */
    double largest_energy = 0;             /* J: the most at any time */
    double damped = 0;                     /* J: taken out by the passivity controller */
    Histogram reading, computing, writing; /* ns */
    Histogram late;                        /* ns: after the sample was due; empty as fast as possible */
    Histogram jitter;                      /* ns: how far the time between two samples was from the period; likewise */
    double standstill = 0;                 /* s: of seconds, when the process stood still for so long
                                              that samples did not become due */
    double seconds = 0;                    /* s: by the clock */
};

/// A scene that the loop used.
struct UsedScene {
    std::uint32_t path = 0; // that it began
    std::string toml;       // resolved
    std::string sha256;     // of that
};

struct LiveOutcome {
    std::string scene;             // name of its file
    std::vector<UsedScene> scenes; // what was in it, at the start and after each change
    std::string precision;         // "f32" or "f64"
    std::string device;            // as asked for: "sim", "haply:ws://..."
    DeviceFacts facts;
    double rate = 0;       /* Hz */
    bool real_time = true; // false: as fast as possible
    LoopCounts counts;
    Permissions permissions;
    std::vector<std::pair<std::string, std::string>> limits; // of safety, as text with units: ("max_force", "3 N")
    std::string log;                                         // file name; empty: none was asked for
    std::uint64_t logged = 0;                                // samples in it
    std::string ended;                // why the run ended: "after 60 s", "interrupted", "the device is gone: ..."
    std::vector<std::string> remarks; // what the user should know: refused scenes, losses, ...
};

} // namespace forceshade::device
