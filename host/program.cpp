#include "host/program.h"

#include <csignal>

#include "forceshade_version.h"

namespace forceshade {

std::string version() {
    return FORCESHADE_VERSION;
}

namespace {

volatile std::sig_atomic_t interrupted = 0;
volatile std::sig_atomic_t hangs_up = 0; // SIGHUP is caught

void raise_flag(int) {
    interrupted = 1;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    if (hangs_up)
        std::signal(SIGHUP, SIG_DFL);
}

} // namespace

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = raise_flag;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    struct sigaction hang_up {};
    if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) {
        hangs_up = 1;
        sigaction(SIGHUP, &action, nullptr);
    }
    // A full disk, a file-size limit or a closed pipe is an error to report, not a reason to die.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

bool is_interrupted() noexcept {
    return interrupted != 0;
}

void check_interrupt() {
    if (interrupted)
        throw Interrupted();
}

} // namespace forceshade
