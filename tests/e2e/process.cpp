#include "tests/e2e/process.h"
#include "tests/places.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace forceshade::testing {
namespace {

// What a shell, a batch system or a desktop may have set and what would change the program's ways.
constexpr const char* kUnset[] = {"LC_ALL",
                                  "LC_NUMERIC",
                                  "LANG",
                                  "LANGUAGE",
                                  "SLURM_ARRAY_TASK_ID",
                                  "SLURM_ARRAY_TASK_COUNT",
                                  "SLURM_ARRAY_TASK_MIN",
                                  "SLURM_ARRAY_TASK_MAX",
                                  "SLURM_PROCID",
                                  "SLURM_STEP_NUM_TASKS"};

std::vector<std::string> environment_of(const Launch& launch) {
    std::map<std::string, std::string> merged;
    for (char** entry = environ; *entry; ++entry) {
        const std::string text = *entry;
        const std::size_t equals = text.find('=');
        merged[text.substr(0, equals)] = text.substr(std::min(text.size(), equals + 1));
    }
    for (const char* name : kUnset)
        merged.erase(name);
    // The software device alone, whatever the machine has: what is expected of bits holds there.
    merged["VK_LOADER_DRIVERS_SELECT"] = "*lvp*";
    for (const auto& [name, value] : launch.environment)
        merged[name] = value;
    std::vector<std::string> texts;
    for (const auto& [name, value] : merged)
        texts.push_back(name + "=" + value);
    return texts;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts)
        pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

int open_output(const std::filesystem::path& path, const char* name) {
    const int descriptor =
        path.empty() ? ::memfd_create(name, MFD_CLOEXEC) : ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0)
        throw std::runtime_error("no file for the output of a process");
    return descriptor;
}

// In the child, between fork and exec: nothing here may allocate.
[[noreturn]] void become(const Launch& launch, int program, int out, int error, char** arguments, char** environment) {
    ::dup2(out, STDOUT_FILENO);
    ::dup2(error, STDERR_FILENO);
    if (launch.closed_out)
        ::close(STDOUT_FILENO);
    if (launch.closed_error)
        ::close(STDERR_FILENO);
    if (launch.most_file_bytes) {
        const rlimit limit{*launch.most_file_bytes, *launch.most_file_bytes};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    const bool there = launch.folder.empty() || ::chdir(launch.folder.c_str()) == 0;
    const bool someone = !launch.user || (::setgid(*launch.user) == 0 && ::setuid(*launch.user) == 0);
    if (there && someone)
        ::fexecve(program, arguments, environment);
    ::_exit(127);
}

std::string content_of(int descriptor) {
    std::string text(static_cast<std::size_t>(std::max<off_t>(0, ::lseek(descriptor, 0, SEEK_END))), '\0');
    const ssize_t got = ::pread(descriptor, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    return text;
}

} // namespace

Process::Process(const Launch& launch) : timeout_(launch.timeout) {
    const std::filesystem::path path =
        launch.program.empty() ? std::filesystem::path(in_build("forceshade")) : launch.program;
    // Opened here, so that another user can run a program that lies in a folder closed to him.
    const int program = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (program < 0)
        throw std::runtime_error("no program " + path.string());
    out_ = open_output(launch.out, "stdout");
    error_ = open_output(launch.error, "stderr");
    std::vector<std::string> arguments{path.filename().string()}, environment = environment_of(launch);
    arguments.insert(arguments.end(), launch.arguments.begin(), launch.arguments.end());
    const std::vector<char*> argument_pointers = pointers_to(arguments);
    const std::vector<char*> environment_pointers = pointers_to(environment);
    pid_ = ::fork();
    if (pid_ == 0)
        become(launch, program, out_, error_, const_cast<char**>(argument_pointers.data()),
               const_cast<char**>(environment_pointers.data()));
    ::close(program);
    if (pid_ < 0)
        throw std::runtime_error("no process");
}

Process::~Process() {
    if (!outcome_) {
        send(SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    ::close(out_);
    ::close(error_);
}

void Process::reap(int status, const rusage& usage) {
    Outcome outcome;
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    outcome.peak_memory = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    outcome_ = outcome;
}

bool Process::running() {
    if (outcome_)
        return false;
    int status = 0;
    rusage usage{};
    if (::wait4(pid_, &status, WNOHANG, &usage) != pid_)
        return true;
    reap(status, usage);
    return false;
}

void Process::send(int signal) {
    if (!outcome_)
        ::kill(pid_, signal);
}

Outcome Process::wait() {
    while (running()) {
        if (std::chrono::duration<double>(Clock::now() - start_).count() > timeout_) {
            ADD_FAILURE() << "a process had not ended after " << timeout_ << " s";
            send(SIGKILL);
            timeout_ += 5;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    outcome_->out = content_of(out_);
    outcome_->error = content_of(error_);
    return *outcome_;
}

Outcome run(const Launch& launch) {
    return Process(launch).wait();
}

bool is_root() {
    return ::geteuid() == 0;
}

} // namespace forceshade::testing
