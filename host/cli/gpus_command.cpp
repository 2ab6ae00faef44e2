#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/remark.h"

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

int run(const CommonOptions& common) {
    const auto devices = compute::list_devices();
    print_data(common.json ? as_json(devices) : as_text(devices));
    // Without any flag this is the device that a run would take; it throws where there is none.
    const compute::DeviceReport& chosen = compute::choose_device(devices, common.gpu, common.precision == "f64");
    if (!common.quiet)
        remark("a run {} takes {} ({})\n", common.gpu.empty() ? "without --gpu" : "with this --gpu", chosen.index,
               chosen.name);
    return 0;
}

} // namespace

void add_gpus_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    CLI::App* command = program.add_subcommand("gpus", "List the Vulkan devices and why one would be refused");
    command->callback([&] { chosen = [&] { return run(common); }; });
}

} // namespace forceshade
