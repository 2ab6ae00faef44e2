// forceshade gpus.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/program.h"

namespace forceshade {
namespace {

std::string as_json(const std::vector<compute::DeviceReport>& devices) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const compute::DeviceReport& device : devices)
        json.push_back({{"index", device.index},
                        {"name", device.name},
                        {"uuid", device.uuid},
                        {"type", device.type},
                        {"driver", device.driver},
                        {"vulkan", device.api},
                        {"f64", device.f64},
                        {"int64", device.int64},
                        {"memory_bytes", device.memory},
                        {"storage_buffer_bytes", device.buffer_range},
                        {"subgroup", device.subgroup},
                        {"refused", device.refusals}});
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
    if (!common.quiet)
        print_note("--{} takes {} ({})\n", common.gpu.empty() ? "engine gpu" : "gpu " + common.gpu, chosen.index,
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
