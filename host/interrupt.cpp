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
}

void check_interrupt() {
    if (interrupted)
        throw Interrupted();
}

} // namespace forceshade
