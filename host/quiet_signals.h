// Threads that signals from outside do not interrupt.
#pragma once

#include <csignal>
#include <pthread.h>

namespace forceshade {

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
