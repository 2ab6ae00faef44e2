// Which program this is.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>
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

// For who ends the process in the place of work that does not ask (host/long_run.h).

/// Whether somebody waits for interrupts; then the second one is theirs, and the third ends the process at once.
void watch_interrupts(bool watched);
/// Waits for the next interrupt, or to be woken; false if neither came in time.
bool wait_for_interrupt(std::chrono::milliseconds time);
/// Wakes who waits.
void wake_interrupt_watch();

// Text for the person at the terminal, on stderr.

/// Puts lines onto stderr, above the line of progress if there is one. A stderr that takes nothing (closed, or a log on
/// a full disk) stops no work.
void say(std::string_view text);

/// From now on what is said also goes to the end of this file, a line with the time (UTC) each, and so does progress
/// once a minute. `silent`: of it only errors go to stderr. \throws IoError.
void open_log(const std::string& file, bool silent);
/// A line for that file alone; nothing without one.
void log_line(std::string_view text);

/// Formats a text onto stderr.
template <typename... Arguments> void remark(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    say(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Replaces the line of progress at the foot of the terminal; empty: there is none. One line, shorter than the
/// terminal.
void draw_line(std::string_view text);

} // namespace forceshade
