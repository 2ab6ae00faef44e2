// The command line. Every error ends here: one line on stderr and an exit code.
#include <csignal>
#include <filesystem>
#include <new>

#include <fcntl.h>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/program.h"

namespace {

using namespace forceshade;

int parse_and_run(int argc, char** argv) {
    CommandLine program;
    for (const auto add : {add_evaluation_commands, add_explore_command, add_mesh_command, add_study_commands,
                           add_experiment_command, add_live_command, add_device_command, add_check_commands})
        add(program);
    const Command command = program.parse(argc, argv);
    spdlog::set_level(program.common.quiet ? spdlog::level::err : spdlog::level::info);
    return command();
}

// A stream that the caller has closed would become the first file that is opened, which would get its text.
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
