// The program run as a process: with arguments, surroundings and limits, ended by signals, its output and cost kept.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

struct rusage;

namespace forceshade::testing {

inline constexpr std::uint64_t kMebibyte = 1 << 20;
/// The user nobody, whom files of others are closed to.
inline constexpr uid_t kNobody = 65534;

/// How a process is started. Without changes: the program under test, C locale, no batch system, output captured.
struct Launch {
    std::vector<std::string> arguments{};
    std::filesystem::path folder{};                   // current directory; empty: the caller's
    std::map<std::string, std::string> environment{}; // added to the caller's
    std::filesystem::path program{};                  // empty: the program under test
    std::filesystem::path out{}, error{};             // where stdout and stderr go; empty: captured
    bool closed_out = false, closed_error = false;
    std::optional<std::uint64_t> most_file_bytes{}; // RLIMIT_FSIZE
    std::optional<uid_t> user{};                    // only root can ask for one
    double timeout = 120;                           // s, then the process is killed and the test fails
};

/// Arguments and what follows them.
inline std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& further) {
    arguments.insert(arguments.end(), further.begin(), further.end());
    return arguments;
}

struct Outcome {
    int code = -1; // exit code, or 128 + the signal that ended the process
    std::string out, error;
    double seconds = 0;
    std::uint64_t peak_memory = 0; // bytes resident
};

/// A process that runs until wait() or the end of the object, which kills it.
class Process {
public:
    explicit Process(const Launch& launch);
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    pid_t id() const { return pid_; }
    bool running();
    void send(int signal);
    Outcome wait();

private:
    void reap(int status, const rusage& usage);

    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
    double timeout_;
    pid_t pid_ = -1;
    int out_ = -1, error_ = -1; // captured
    std::optional<Outcome> outcome_;
};

/// Starts a process and waits for it.
Outcome run(const Launch& launch);

/// True if the tests have root's powers (mounts, other users).
bool is_root();

} // namespace forceshade::testing
