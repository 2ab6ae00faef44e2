// The devices that the live loop can drive: which of them are here, and how each is opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "device/backends/back_end.h"

namespace forceshade {
struct PreparedCase;
}

namespace forceshade::device {

/// Opens sim[:BUTTONS], replay:FILE, haply[:URL], dhd[:INDEX] or hd[:NAME]. `rate`, Hz: as the user says. `ramp`, s:
/// that forces take to come up, for which a simulated hand holds still. \throws UsageError for another name or a bad
/// file, DeviceAbsent, IoError.
std::unique_ptr<BackEnd> open_device(const std::string& name, const PreparedCase& prepared, std::optional<double> rate,
                                     double ramp);

/// Whether a name is the simulated hand's.
inline bool is_sim(std::string_view name) {
    return name.substr(0, name.find(':')) == "sim";
}

/// A button that a simulated hand holds for a while.
struct HeldButton {
    unsigned button = 0;        // from 1 on
    double from = 0, until = 0; /* s: of the device's own time, from its first sample on */
};

/// One kind of device, found or not.
struct DeviceKind {
    std::string option;               // as it is asked for: "dhd[:INDEX]"
    std::string what;                 // description
    std::vector<std::string> devices; // what can be asked for now: "dhd:0"
    std::string name;                 // of the devices, if the kind reports it: "Touch (serial number 8042)"
    std::string software;             // its driver, with the version; empty: not found
    std::string place;                // the library's file, the service's address; empty: none
    std::string problem;              // why no device was found and what to do about it; empty: one was
};

/// Every kind. Vendors' libraries are loaded and asked; no device moves. Haply's service is asked at its usual address,
/// or at `service` ("ws://..."), for at most `wait` s a step.
std::vector<DeviceKind> list_devices(const std::string& service = {}, double wait = 1);

/// A hand that holds a device, in place of real ones: the closed loop of host/reference/path_step.h in double
/// precision, stepped exactly (laws: sampled stability). The hand follows path 0 of the scene's [paths], and each force
/// written moves it one sample on. A scene without paths: strokes across the feature, pressing 1 N, at 100 mm/s; one
/// whose paths are open: as closed. A recorded path is followed to its end, where the hand rests. A hand that leaves
/// its path by more than `paths.bound`, having fallen off a mesh or been thrown off, begins again. `rate`, Hz: samples
/// a second, in place of the scene's. `still`: samples for which the hand holds still when it begins, while the force
/// may come up. \throws UsageError, IoError as ScenePaths.
std::unique_ptr<BackEnd> make_sim(PreparedCase prepared, double rate, std::uint64_t still = 0,
                                  std::vector<HeldButton> buttons = {});

/// "1@0.5 s..3 s, 2@1 s..1.2 s": which buttons a simulated hand holds, and when. \throws UsageError.
std::vector<HeldButton> parse_held_buttons(std::string_view text);

/// A recording in place of a device, one row of it for each of the loop's samples: positions of a CSV file (PathReader:
/// path, t, x, y, z in any order, as a live log has them), each once, path after path in the order of their first rows,
/// however far its times are apart. Forces are dropped. Its rate is that of its first path, from the first time to the
/// last. It is read whole, 32 bytes a sample. \throws IoError, UsageError as PathReader and PathCensus: times of a path
/// increase.
std::unique_ptr<BackEnd> make_replay(const std::filesystem::path& file);

/// Force Dimension's devices (omega, delta, sigma, lambda; Novint's Falcon), through the vendor's DHD SDK: the one of
/// this index, or with an empty text the first that is free. Its watchdog, where the device has one, drops the force
/// when none was written for 32 ms. A position that cannot be in metres is refused. \throws UsageError for an
/// invalid index, DeviceAbsent without library or device.
std::unique_ptr<BackEnd> open_dhd(std::string_view index);

/// The device does not move. \throws DeviceAbsent without the library.
DeviceKind find_dhd();

/// 3D Systems' devices (Touch, Touch X, Phantom), through the vendor's OpenHaptics HDAPI: the one of this configured
/// name, or with an empty text the default one. The vendor's scheduler displays the forces at 1 kHz, and none if none
/// was written for 50 ms. A device is refused that is not calibrated, or whose position, workspace or largest force
/// cannot be in mm and N. \throws DeviceAbsent without library or device.
std::unique_ptr<BackEnd> open_hd(std::string_view name);

/// Opens the default device for a moment, without any force. \throws DeviceAbsent without the library.
DeviceKind find_hd();

} // namespace forceshade::device
