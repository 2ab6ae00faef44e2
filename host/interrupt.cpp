#include "host/interrupt.h"

#include <csignal>

namespace forceshade {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void raise_flag(int) {
    interrupted = 1;
}

} // namespace

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = raise_flag;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // A full disk, a file-size limit or a closed pipe is an error to report, not a reason to die.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

void check_interrupt() {
    if (interrupted)
        throw Interrupted();
}

} // namespace forceshade
