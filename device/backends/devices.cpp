#include "device/backends/devices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "device/backends/haply.h"
#include "host/field/prepared_case.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade::device {

namespace {

std::unique_ptr<BackEnd> open_sim(const PreparedCase& prepared, const std::string& buttons, std::optional<double> rate,
                                  double ramp) {
    const std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    const double chosen = rate ? *rate : paths ? paths->rate : DeviceFacts{}.rate;
    constexpr double kMost = 1e9; // samples
    const double still = ramp > 0 ? std::min(std::ceil(ramp * chosen) + 1, kMost) : 0;
    return make_sim(prepared, chosen, static_cast<std::uint64_t>(still), parse_held_buttons(buttons));
}

DeviceKind find_haply(const std::string& url, double wait) {
    const HaplyFinding found = look_for_haply(url, wait);
    DeviceKind kind;
    kind.place = url;
    if (!found.problem.empty()) {
        kind.problem = fmt::format("no Inverse Service: {}. Install and start the Inverse Service 3.x (haply.co); if "
                                   "it runs elsewhere, use haply:ws://HOST:PORT",
                                   found.problem);
        return kind;
    }
    kind.software = "Inverse Service" + (found.version.empty() ? " of unknown version" : " " + found.version);
    std::vector<std::string> names;
    for (const HaplyDevice& device : found.devices) {
        kind.devices.push_back(fmt::format("haply:{}?device={}", url == HaplyOptions{}.url ? "" : url, device.id));
        names.push_back(fmt::format("{} {} ({})", device.type, device.id, device.status));
    }
    kind.name = fmt::format("{}", fmt::join(names, ", "));
    if (found.devices.empty())
        kind.problem = "the service lists no device: plug one in and switch it on (Haply Hub shows it)";
    return kind;
}

template <typename Find> DeviceKind kind_of(const char* option, const char* what, Find&& find) {
    DeviceKind kind;
    try {
        kind = find();
    } catch (const DeviceAbsent& absent) {
        kind.problem = absent.what();
    }
    kind.option = option;
    kind.what = what;
    return kind;
}

} // namespace

std::unique_ptr<BackEnd> open_device(const std::string& name, const PreparedCase& prepared, std::optional<double> rate,
                                     double ramp) {
    const std::size_t colon = name.find(':');
    const std::string kind = name.substr(0, colon), further = colon == std::string::npos ? "" : name.substr(colon + 1);
    if (kind == "sim")
        return open_sim(prepared, further, rate, ramp);
    if (kind == "replay" && further.empty())
        throw UsageError("--device replay: which file? replay:FILE.csv");
    if (kind == "replay")
        return make_replay(further);
    if (kind == "haply")
        return open_haply(parse_haply(further));
    if (kind == "dhd")
        return open_dhd(further);
    if (kind == "hd")
        return open_hd(further);
    const std::array<std::string, 5> kinds{"sim", "replay", "haply", "dhd", "hd"};
    throw UsageError("--device {}: there are sim[:BUTTONS], replay:FILE, haply[:URL], dhd[:INDEX] or hd[:NAME]{}", name,
                     did_you_mean(kind, kinds));
}

std::vector<DeviceKind> list_devices(const std::string& service, double wait) {
    const std::string url = service.empty() ? HaplyOptions{}.url : service;
    return {{"sim", "a simulated hand that holds a simulated device", {"sim"}, {}, {}, {}, {}},
            {"replay:FILE", "recorded positions in place of a device", {"replay:FILE"}, {}, {}, {}, {}},
            kind_of("haply[:URL]", "Haply Inverse3", [&] { return find_haply(url, wait); }),
            kind_of("dhd[:INDEX]", "Force Dimension omega, delta, sigma, lambda; Novint Falcon", find_dhd),
            kind_of("hd[:NAME]", "3D Systems Touch, Touch X, Phantom", find_hd)};
}

} // namespace forceshade::device
