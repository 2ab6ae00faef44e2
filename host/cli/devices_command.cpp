// forceshade gpus, devices, device check: what there is to compute on and to feel with, and whether it works.
#include <poll.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "device/backends/devices.h"
#include "device/session/session.h"
#include "host/cli/command.h"
#include "host/cli/gpu_report.h"
#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/output/files.h"

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

struct DeviceCommandArguments {
    std::string scene, out;
    bool yes = false;
    DeviceArguments device;
};

// Whether Enter was pressed at the terminal since the last question.
bool enter_pressed() {
    bool pressed = false;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    while (::poll(&input, 1, 0) > 0) {
        char bytes[256];
        const ::ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
        if (count <= 0)
            throw Error(ExitCode::interrupted, "the terminal is gone");
        pressed = pressed || std::string_view(bytes, static_cast<std::size_t>(count)).find('\n') != std::string::npos;
    }
    return pressed;
}

int run(const DeviceCommandArguments& arguments, const CommonOptions& common) {
    if (!arguments.out.empty() && !may_write({arguments.out}, common))
        return 0;
    const Case one = arguments.scene.empty() ? parse_scene("", "scene") : load_scene(arguments.scene, common);
    const device::DeviceCheck check =
        device::check_device(checked_options(arguments.device), CasePreparation().prepare(one),
                             check_guide(arguments.device, arguments.yes, common));
    const std::string json = device::check_json(check).dump(2) + "\n";
    if (!arguments.out.empty())
        write_file_atomically(arguments.out, json);
    print_data(common.json ? json : device::check_text(check));
    return static_cast<int>(check.passed() ? ExitCode::ok : ExitCode::failed);
}

void describe(Options& options, DeviceCommandArguments& arguments) {
    options.optional("SCENE", arguments.scene,
                     "that the device will display (TOML), for the workspace; default: the paper's bump");
    options.optional("--out FILE", arguments.out, "a JSON file of the outcome, for experiment run --check");
    options.flag("--yes", arguments.yes, "a person holds the probe lightly: go on without questions");
    describe_device(options, arguments.device);
    describe_safety(options, arguments.device);
    options.example("device check bump.toml", "the simulated device, to see what a check does")
        .example("device check bump.toml --device sim --yes --out check.json", "kept for experiment run --check");
}

} // namespace

void add_gpus_command(CommandLine& program) {
    program.add("gpus", "List the Vulkan devices and why one would be refused", list_gpus)
        .example("gpus", "the devices, and which one would be taken")
        .example("gpus --json", "the same for a script");
}

void add_devices_command(CommandLine& program) {
    program.add("devices", "List the haptic devices that live could drive here, and why not the others", list_devices)
        .footer("FORCESHADE_DHD_LIBRARY and FORCESHADE_HD_LIBRARY name the file of Force Dimension's and of 3D "
                "Systems' library where the dynamic linker would not find it.")
        .example("devices", "what --device takes here")
        .example("devices --json", "the same for a script");
}

device::CheckGuide check_guide(const DeviceArguments& arguments, bool held, const CommonOptions& common) {
    const bool simulated = arguments.session.device.substr(0, arguments.session.device.find(':')) == "sim";
    const bool terminal = !held && !simulated && ::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1;
    device::CheckGuide guide;
    guide.held = held || simulated || terminal;
    if (terminal)
        guide.entered = enter_pressed;
    if (terminal || !common.quiet)
        guide.print = [](const std::string& text) { print_note("{}\n", text); };
    return guide;
}

void add_device_command(CommandLine& program) {
    program.add_group("device", "Check a haptic device before use")
        .example("device check bump.toml", "the simulated device")
        .example("devices", "the devices that can be checked");
    program.add<DeviceCommandArguments>("device check",
                                        "Check where the probe is, whether 0.5 N along each axis moves it that way, "
                                        "the workspace, the watchdog, the buttons; exit 1 unless all passed",
                                        run, describe);
}

} // namespace forceshade
