// The command line. Every error ends here: on stderr, and in an exit code.
#include <csignal>
#include <filesystem>
#include <new>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include <fcntl.h>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/field/mesh_cache.h"
#include "host/output/kept.h"
#include "host/program.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace {

using namespace forceshade;

int parse_and_run(int argc, char** argv) {
    CommandLine program;
    for (const auto add : {add_sweep_command, add_field_command, add_explore_command, add_mesh_command,
                           add_study_command, add_score_command, add_report_command, add_experiment_command,
                           add_live_command, add_device_command, add_init_command, add_schema_command,
                           add_validate_command, add_gpus_command, add_devices_command, add_doctor_command})
        add(program);
    const Command command = program.parse(argc, argv);
    spdlog::set_level(program.common.quiet     ? spdlog::level::err
                      : program.common.verbose ? spdlog::level::debug
                                               : spdlog::level::info);
    spdlog::debug("forceshade {} on {}, at most {} threads", version(), cpu_name(), most_threads());
    if (CommonOptions& common = program.common; !common.log_file.empty()) {
        common.silent = std::exchange(common.quiet, false);
        open_log(common.log_file, common.silent);
        log_line(fmt::format("forceshade {}: {}", version(), fmt::join(std::span(argv + 1, argv + argc), " ")));
    }
    if (!program.common.no_cache)
        keep_meshes_in(default_cache_folder());
    return command();
}

// A stream that the caller has closed would become the first file that is opened, which would get its text.
void occupy_closed_streams() {
    for (const int descriptor : {0, 1, 2})
        if (::fcntl(descriptor, F_GETFD) < 0)
            ::open("/dev/null",
                   descriptor == 2 ? O_WRONLY : O_RDONLY); // writing data to stdout then fails, and says so
}

// A scene may have several errors, a line each; where to read on is none.
int complain(const std::string& message, ExitCode code) {
    std::istringstream lines(message);
    for (std::string line; std::getline(lines, line);)
        print_note("{}{}\n", line.starts_with("see ") ? "" : "error: ", line);
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
