// forceshade devices: the haptic devices.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "device/backends/devices.h"
#include "host/cli/command.h"

namespace forceshade {

namespace {

using device::DeviceKind;

std::string as_json(const std::vector<DeviceKind>& kinds) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const DeviceKind& kind : kinds)
        json.push_back({{"option", kind.option},
                        {"what", kind.what},
                        {"devices", kind.devices},
                        {"name", kind.name},
                        {"software", kind.software},
                        {"place", kind.place},
                        {"problem", kind.problem}});
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"; // names are the vendors'
}

std::string as_text(const std::vector<DeviceKind>& kinds) {
    std::string text;
    for (const DeviceKind& kind : kinds) {
        text += fmt::format("{:<12} {}\n", kind.option, kind.what);
        if (!kind.place.empty())
            text += fmt::format("   {}{}{}\n", kind.software, kind.software.empty() ? "" : ", ", kind.place);
        if (!kind.devices.empty())
            text += fmt::format("   there: --device {}{}\n", fmt::join(kind.devices, ", "),
                                kind.name.empty() ? "" : ", " + kind.name);
        if (!kind.problem.empty())
            text += fmt::format("   not there: {}\n", kind.problem);
    }
    return text;
}

int list_devices(const CommonOptions& common) {
    const std::vector<DeviceKind> kinds = device::list_devices();
    print_data(common.json ? as_json(kinds) : as_text(kinds));
    return 0;
}

} // namespace

void add_devices_command(CommandLine& program) {
    program.add("devices", "List the haptic devices that live could drive here, and why not the others", list_devices)
        .footer("FORCESHADE_DHD_LIBRARY and FORCESHADE_HD_LIBRARY name the file of Force Dimension's and of 3D "
                "Systems' library where the dynamic linker would not find it.")
        .example("devices", "what --device takes here")
        .example("devices --json", "the same for a script");
}

} // namespace forceshade
