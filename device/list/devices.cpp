#include "device/list/devices.h"

#include <fmt/format.h>

#include "device/dhd/dhd.h"
#include "device/hd/hd.h"

namespace forceshade::device {
namespace {

DeviceKind sim() {
    return {"sim", "a simulated hand that holds a simulated device", {"sim"}, {}, {}, {}, {}};
}

DeviceKind replay() {
    return {"replay:FILE", "recorded positions in place of a device", {"replay:FILE"}, {}, {}, {}, {}};
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

std::vector<DeviceKind> list_devices([[maybe_unused]] double wait) {
    return {sim(), replay(),
            kind_of("dhd[:INDEX]", "Force Dimension omega, delta, sigma, lambda; Novint Falcon", look_for_dhd),
            kind_of("hd[:NAME]", "3D Systems Touch, Touch X, Phantom", look_for_hd)};
}

} // namespace forceshade::device
