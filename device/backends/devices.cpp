#include "device/backends/devices.h"

#include <fmt/format.h>

#include "device/backends/dhd.h"
#include "device/backends/haply.h"
#include "device/backends/hd.h"

namespace forceshade::device {

namespace {

DeviceKind sim() {
    return {"sim", "a simulated hand that holds a simulated device", {"sim"}, {}, {}, {}, {}};
}

DeviceKind replay() {
    return {"replay:FILE", "recorded positions in place of a device", {"replay:FILE"}, {}, {}, {}, {}};
}

void look_for_service(DeviceKind& kind, const std::string& url, double wait) {
    const HaplyFinding found = look_for_haply(url, wait);
    kind.place = url;
    if (!found.problem.empty()) {
        kind.problem = fmt::format("no Inverse Service: {}. Install and start the Inverse Service 3.x (haply.co); one "
                                   "elsewhere is asked for as haply:ws://HOST:PORT",
                                   found.problem);
        return;
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
}

void look_for_dhd(DeviceKind& kind) {
    const DhdFound found = find_dhd();
    kind.software = found.software;
    kind.place = found.file;
    for (int index = 0; index < found.devices; ++index)
        kind.devices.push_back(fmt::format("dhd:{}", index));
    if (found.devices <= 0)
        kind.problem = fmt::format("no device{}: is it plugged in and powered, and may this user use it (a udev rule "
                                   "for USB)?",
                                   found.complaint.empty() ? "" : " (" + found.complaint + ")");
}

void look_for_hd(DeviceKind& kind) {
    const HdFound found = find_hd();
    kind.software = found.software;
    kind.place = found.file;
    kind.name = found.device;
    kind.problem = found.complaint;
    if (!found.device.empty())
        kind.devices = {"hd"};
}

template <typename Look> DeviceKind kind_of(std::string option, std::string what, Look&& look) {
    DeviceKind kind{std::move(option), std::move(what), {}, {}, {}, {}, {}};
    try {
        look(kind);
    } catch (const DeviceAbsent& absent) {
        kind.problem = absent.what();
    }
    return kind;
}

} // namespace

std::vector<DeviceKind> list_devices(const std::string& service, double wait) {
    const std::string url = service.empty() ? HaplyOptions{}.url : service;
    return {sim(), replay(),
            kind_of("haply[:URL]", "Haply Inverse3", [&](DeviceKind& kind) { look_for_service(kind, url, wait); }),
            kind_of("dhd[:INDEX]", "Force Dimension omega, delta, sigma, lambda; Novint Falcon", look_for_dhd),
            kind_of("hd[:NAME]", "3D Systems Touch, Touch X, Phantom", look_for_hd)};
}

} // namespace forceshade::device
