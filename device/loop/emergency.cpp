#include "device/loop/emergency.h"

#include <array>
#include <atomic>
#include <csignal>
#include <poll.h>
#include <pthread.h>

namespace forceshade::device {

namespace {

constexpr std::array kDeadly{SIGABRT, SIGSEGV, SIGBUS,    SIGFPE,  SIGILL,  SIGSYS, SIGQUIT, SIGTRAP,  SIGUSR1,
                             SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGIO,  SIGPWR,  SIGSTKFLT};
constexpr std::size_t kFaults = 6; // taken whoever else wants them
constexpr int kHaltTime = 50;      /* ms: that one thread's handler waits for another's */

std::atomic<BackEnd*> guarded = nullptr;
std::atomic<bool> halting = false; // by a handler in some thread, which will end the process
std::atomic<pthread_t> halter{};
std::array<struct sigaction, kDeadly.size()> before;
std::array<bool, kDeadly.size()> taken{};

void restore() {
    for (std::size_t i = 0; i < kDeadly.size(); ++i)
        if (taken[i])
            ::sigaction(kDeadly[i], &before[i], nullptr);
}

} // namespace

// Threads may come to grief one upon the other: the second one leaves the first one time for the device, unless it is
// the same one.
void halt_and_die(int signal) {
    if (halting.exchange(true)) {
        for (int waited = 0; guarded.load() != nullptr && halter.load() != ::pthread_self() && waited < kHaltTime;
             ++waited)
            ::poll(nullptr, 0, 1);
    } else {
        halter.store(::pthread_self());
        if (BackEnd* const back_end = guarded.load())
            back_end->halt();
        guarded.store(nullptr);
    }
    restore();
    ::raise(signal);
}

Emergency::Emergency(BackEnd& back_end) noexcept {
    halting = false;
    guarded = &back_end;
    struct sigaction action {};
    action.sa_handler = halt_and_die;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < kDeadly.size(); ++i) {
        ::sigaction(kDeadly[i], nullptr, &before[i]);
        taken[i] = i < kFaults || before[i].sa_handler == SIG_DFL;
        if (taken[i])
            ::sigaction(kDeadly[i], &action, nullptr);
    }
}

Emergency::~Emergency() {
    if (guarded.exchange(nullptr) != nullptr)
        restore();
}

} // namespace forceshade::device
