// Errors of the outside world, each with the exit code that the command line gives it. Caught once, in main.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace forceshade {

enum class ExitCode : int { ok = 0, failed = 1, usage = 2, no_device = 3, io = 4, interrupted = 130 };

class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const noexcept { return code_; }

private:
    ExitCode code_;
};

/// Configuration or usage: `bump.toml:12:5: stiffness must be positive, got -3 N/m`. Exit 2.
class UsageError : public Error {
public:
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
    template <typename First, typename... More>
    UsageError(fmt::format_string<First, More...> text, First&& first, More&&... more)
        : UsageError(fmt::format(text, std::forward<First>(first), std::forward<More>(more)...)) {}
};

/// Files: missing, unreadable, damaged, disk full. Exit 4.
class IoError : public Error {
public:
    explicit IoError(const std::string& message) : Error(ExitCode::io, message) {}
    template <typename First, typename... More>
    IoError(fmt::format_string<First, More...> text, First&& first, More&&... more)
        : IoError(fmt::format(text, std::forward<First>(first), std::forward<More>(more)...)) {}
};

} // namespace forceshade
