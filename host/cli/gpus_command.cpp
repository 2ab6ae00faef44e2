// forceshade gpus: the Vulkan devices.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/cli/gpu_report.h"

namespace forceshade {

namespace {

std::string as_json(const std::vector<compute::DeviceReport>& devices) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const compute::DeviceReport& device : devices)
        json.push_back(json_of(device));
    return json.dump(2) + "\n";
}

std::string as_text(const std::vector<compute::DeviceReport>& devices) {
    std::string text;
    for (const compute::DeviceReport& device : devices) {
        text += fmt::format(
            "{}  {}\n   {}, {}, Vulkan {}\n   UUID {}\n   {:.1f} GiB, storage buffers to {:.0f} MiB, {}\n",
            device.index, device.name, device.type, device.driver, device.api, device.uuid,
            static_cast<double>(device.memory) / (1 << 30), static_cast<double>(device.buffer_range) / (1 << 20),
            device.f64 ? "double precision" : "no double precision");
        text +=
            device.refusals.empty() ? "   usable\n" : fmt::format("   refused: {}\n", fmt::join(device.refusals, "; "));
    }
    return text;
}

int list_gpus(const CommonOptions& common) {
    const auto devices = compute::list_devices();
    print_data(common.json ? as_json(devices) : as_text(devices));
    // It throws if no device is usable.
    const compute::DeviceReport& chosen = compute::choose_device(devices, common.gpu, common.precision == "f64");
    note(common, "--{} takes {} ({})\n", common.gpu.empty() ? "engine gpu" : "gpu " + common.gpu, chosen.index,
         chosen.name);
    return 0;
}

} // namespace

void add_gpus_command(CommandLine& program) {
    program.add("gpus", "List the Vulkan devices and why one would be refused", list_gpus)
        .example("gpus", "the devices, and which one would be taken")
        .example("gpus --json", "the same for a script");
}

} // namespace forceshade
