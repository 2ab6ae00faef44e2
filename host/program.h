// Which program this is.
#pragma once

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {

/// Release and commit, "0.1.0+0123456789ab"; with ".sources-" and a digest where the sources are not the commit's.
std::string version();

// SIGINT, SIGTERM and SIGHUP as a flag that long work asks for, so that it can leave nothing half done.

class Interrupted : public Error {
public:
    Interrupted() : Error(ExitCode::interrupted, "interrupted") {}
};

/// From now on the first SIGINT, SIGTERM or SIGHUP (unless it is ignored, as under nohup) raises the flag; a second one
/// ends the process at once.
void catch_interrupts();

/// Whether the flag is raised.
bool is_interrupted() noexcept;

/// \throws Interrupted once the flag is raised.
void check_interrupt();

// Text for the person at the terminal, on stderr.

/// Formats a text onto stderr. A stderr that takes nothing (closed, or a log on a full disk) stops no work.
template <typename... Arguments> void remark(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
    std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace forceshade
