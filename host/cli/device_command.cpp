// forceshade device check: whether a haptic device works.
#include <poll.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/session/session.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/output/files.h"

namespace forceshade {

namespace {

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
