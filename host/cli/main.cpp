// The command line. Every error ends here: one line on stderr and an exit code.
#include <csignal>
#include <filesystem>
#include <new>
#include <sstream>

#include <fcntl.h>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/reading.h"
#include "host/program.h"
#include "host/scene/value.h"

namespace {

using namespace forceshade;

constexpr const char* kFooter =
    "Every command takes --gpu NAME|UUID|INDEX, --engine gpu|cpu, --precision f32|f64, --max-memory SIZE, --json, "
    "--quiet and --vulkan-validation.\nExit codes: 0 ok, 1 a case failed or a bound was exceeded, 2 usage or "
    "configuration, 3 no "
    "such device, 4 files, "
    "130 interrupted.\nStart with: forceshade sweep --out results/paper";

void add_common_options(CLI::App& program, CommonOptions& common) {
    program
        .add_option("--gpu", common.gpu,
                    "Vulkan device: part of its name, UUID or index (forceshade gpus); default: the software device")
        ->check([](const std::string& name) { return name.empty() ? "an empty name is no device's" : ""; });
    program.add_option("--engine", common.engine, "gpu, or cpu: the oracle on all cores")
        ->check(CLI::IsMember({"gpu", "cpu"}));
    program.add_option("--precision", common.precision, "f32 or f64; default: as the scene says")
        ->check(CLI::IsMember({"f32", "f64"}));
    program.add_option_function<std::string>(
        "--max-memory", [](const std::string& text) { set_memory_limit(parse_memory(text)); },
        "most that a file's contents may take, from what its header announces; default: 4 GiB");
    program.add_flag("--json", common.json, "machine-readable results on stdout");
    program.add_flag("--quiet", common.quiet, "no progress and no remarks on stderr, errors only");
    program.add_flag("--vulkan-validation", common.validation_layers,
                     "run under Vulkan's validation layers; any complaint is an error");
}

// CLI11 would only say that a command is required.
void refuse_unknown_command(const CLI::App& program, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands(nullptr))
        names.push_back(command->get_name());
    if (word.empty() || word.front() == '-' || std::find(names.begin(), names.end(), word) != names.end())
        return;
    const std::string_view meant = nearest(word, names);
    throw UsageError(fmt::format("no command \"{}\"{}; there are {}", word,
                                 meant.empty() ? "" : fmt::format(", did you mean {}?", meant),
                                 fmt::join(names, ", ")));
}

int parse_and_run(int argc, char** argv) {
    CLI::App program("Offline study of haptic force fields, with and without force shading", "forceshade");
    CommonOptions common;
    Command command;
    program.set_version_flag("--version", "forceshade " + version());
    program.require_subcommand(1);
    program.fallthrough();
    program.footer(kFooter);
    add_common_options(program, common);
    add_sweep_command(program, common, command);
    add_field_command(program, common, command);
    add_explore_command(program, common, command);
    add_mesh_command(program, common, command);
    add_study_command(program, common, command);
    add_report_command(program, common, command);
    add_live_command(program, common, command);
    add_validate_command(program, common, command);
    add_gpus_command(program, common, command);
    add_devices_command(program, common, command);
    add_doctor_command(program, common, command);
    add_schema_command(program, common, command);
    if (argc > 1)
        refuse_unknown_command(program, argv[1]);
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        std::ostringstream data, complaint;
        const bool asked_for = program.exit(error, data, complaint) == 0;
        remark("{}", complaint.str());
        print_data(data.str());
        return asked_for ? 0 : static_cast<int>(ExitCode::usage);
    }
    spdlog::set_level(common.quiet ? spdlog::level::err : spdlog::level::info);
    return command();
}

// A stream that the caller has closed would be taken by the first file opened, and that file get its text.
void occupy_closed_streams() {
    for (const int descriptor : {0, 1, 2})
        if (::fcntl(descriptor, F_GETFD) < 0)
            ::open("/dev/null",
                   descriptor == 2 ? O_WRONLY : O_RDONLY); // writing data to stdout then fails, and says so
}

int complain(const char* message, ExitCode code) {
    remark("error: {}\n", message);
    return static_cast<int>(code);
}

} // namespace

int main(int argc, char** argv) {
    occupy_closed_streams();
    spdlog::set_default_logger(spdlog::stderr_color_mt("forceshade"));
    spdlog::set_pattern("%v");
    catch_interrupts();
    try {
        return parse_and_run(argc, argv);
    } catch (const Error& error) {
        return complain(error.what(), error.code());
    } catch (const compute::DeviceError& error) {
        return complain(error.what(), ExitCode::no_device);
    } catch (const std::filesystem::filesystem_error& error) {
        return complain(error.what(), ExitCode::io);
    } catch (const std::bad_alloc&) {
        return complain("out of memory", ExitCode::failed);
    } catch (const std::exception& error) {
        return complain(error.what(), ExitCode::failed);
    }
}
