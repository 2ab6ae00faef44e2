// Signals from outside are the main thread's business.
#pragma once

#include <csignal>
#include <initializer_list>
#include <pthread.h>

#include "device/loop/live_loop.h"

namespace forceshade::device {

/// While it lives, the calling thread, and every thread that it starts for good, is not interrupted by what a person, a
/// terminal or a batch system sends: their handlers wait, which the live loop's thread must not.
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

// Ctrl-Z does not leave a device with a force that nobody watches over.

/// While it lives, SIGTSTP, and SIGTTIN and SIGTTOU of a terminal that belongs to another job, stop the process once
/// the loop has displayed zero; when it goes on, the force comes up as after the start. (SIGSTOP cannot be caught: what
/// the device does then is its own watchdog's business.) One at a time.
class Suspension {
public:
    explicit Suspension(LiveLoop& loop) noexcept;
    ~Suspension();
    Suspension(const Suspension&) = delete;
    Suspension& operator=(const Suspension&) = delete;
};

// Ctrl-C ends the loop at once, and a second one the process, neither with a force on the device.

/// While it lives, SIGINT, SIGTERM and SIGHUP do what they did (host/program.h) and stop the loop in the handler, so
/// that the next sample is the last. A second one ends the process by the signal, after the device was halted. One at a
/// time, within an Emergency.
class Interruption {
public:
    explicit Interruption(LiveLoop& loop) noexcept;
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;
};

} // namespace forceshade::device
