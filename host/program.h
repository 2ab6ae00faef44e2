// Which program this is.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdio>
#include <pthread.h>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {

/// Release and commit, "0.1.0+0123456789ab"; with ".sources-" and a digest where the sources are not the commit's.
std::string version();

// SIGINT, SIGTERM and SIGHUP as a flag that long work checks, so that it leaves no file half written.

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

// For the thread that ends the process when work does not check the flag (host/long_run.h).

/// Whether a thread waits for interrupts; then it gets the second one, and the third ends the process at once.
void watch_interrupts(bool watched);
/// Waits for the next interrupt, or to be woken; false if neither came in time.
bool wait_for_interrupt(std::chrono::milliseconds time);
/// Wakes who waits.
void wake_interrupt_watch();

// Text for the person at the terminal, on stderr.

/// Puts lines onto stderr, above a line of progress. A stderr that fails (closed, or a log on a full disk) does
/// not stop the work.
void say(std::string_view text);

/// From now on these lines also go to the end of this file, a line with the time (UTC) each, and so does progress
/// once a minute. `silent`: only errors go to stderr. \throws IoError.
void open_log(const std::string& file, bool silent);
/// A line for that file alone; ignored without one.
void log_line(std::string_view text);

/// Formats a text and puts it onto stderr.
template <typename... Arguments> void print_note(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    say(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Replaces the line of progress at the foot of the terminal; empty: removes it. One line, shorter than the
/// terminal.
void draw_line(std::string_view text);

// Threads that signals from outside do not interrupt.

/// While it lives, the calling thread, and every thread that it starts for good, is not interrupted by what a person, a
/// terminal or a batch system sends: those signals are the main thread's, whose handlers wait, which the live loop's
/// thread must not.
class QuietSignals {
public:
    QuietSignals() noexcept {
        sigset_t asked;
        sigemptyset(&asked);
        for (const int signal :
             {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGTTIN, SIGTTOU, SIGWINCH, SIGUSR1, SIGUSR2})
            sigaddset(&asked, signal);
        ::pthread_sigmask(SIG_BLOCK, &asked, &before_);
    }
    ~QuietSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    QuietSignals(const QuietSignals&) = delete;
    QuietSignals& operator=(const QuietSignals&) = delete;

private:
    sigset_t before_{};
};

} // namespace forceshade
