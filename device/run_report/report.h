// The report at the end of a run: as text for the terminal, as JSON for a program, and as files with a page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "device/loop/live_loop.h"
#include "device/loop/real_time.h"
#include "device/loop/sample.h"

namespace forceshade::device {

/// A scene that the loop used.
struct UsedScene {
    std::uint32_t path = 0; // that it began
    std::string toml;       // resolved
    std::string sha256;     // of that
};

/// A run and its results.
struct LiveOutcome {
    std::string scene;             // name of its file
    std::vector<UsedScene> scenes; // what was in it, at the start and after each change
    std::string precision;         // "f32" or "f64"
    std::string law;               // whose forces, if not the scene's own: "renderer mine"
    std::string device;            // as asked for: "sim", "haply:ws://..."
    DeviceFacts facts;
    Mapping mapping;
    std::string manner;    // mapping and buttons (manner_text); empty: the device's space is the scene's
    double rate = 0;       /* Hz */
    bool real_time = true; // false: as fast as possible
    LoopCounts counts;
    Permissions permissions;
    std::vector<std::pair<std::string, std::string>> limits; // of safety, as text with units: ("max_force", "3 N")
    std::string stability;                                   // SceneLimits::text of the last scene
    std::string log;                                         // file name; empty: none was asked for
    std::uint64_t logged = 0;                                // samples in it
    std::string sent_to;                                     // "udp:127.0.0.1:5005"; empty: nowhere
    std::uint64_t sent = 0;                                  // samples that went there, of all
    std::string send_failure;                                // why others did not; empty: there was no room
    std::string ended;                // why the run ended: "after 60 s", "interrupted", "the device is gone: ..."
    std::vector<std::string> remarks; // notes for the user: refused scenes, losses, ...
};

/// Some 25 lines of at most 100 columns.
std::string report_text(const LiveOutcome& outcome);

/// "60000 samples in 60 s at 1 kHz", or as fast as possible; one sentence, for the page too.
std::string pace_text(const LiveOutcome& outcome, std::string_view micro = "u");
/// "3 samples late (0.005 %), 0 of them by our own computing"; as fast as possible none can be.
std::string lateness_text(const LiveOutcome& outcome);
/// "clamped 12, ramping 200" without the late ones; "none".
std::string events_text(const LoopCounts& counts);
/// The largest values: "force 3.2 N by the law, 3 N commanded; ..."
std::string extremes_text(const LoopCounts& counts, std::string_view micro = "u");
/// "1.2 mJ given to the hand at the end, ..."
std::string energy_text(const LoopCounts& counts, std::string_view micro = "u");

/// Never throws on a device's texts: bad UTF-8 becomes U+FFFD.
nlohmann::ordered_json report_json(const LiveOutcome& outcome);

/// The times of the samples, and force, direction and position of those in `log`, if there is a log.
std::string live_page(const LiveOutcome& outcome, const std::filesystem::path& log = {});

/// STEM.txt, STEM.json and STEM.html, each whole or not at all. Throws IoError.
void write_live_report(const LiveOutcome& outcome, const std::filesystem::path& stem,
                       const std::filesystem::path& log = {});

} // namespace forceshade::device
