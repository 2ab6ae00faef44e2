#include "device/safety/emergency.h"

#include <array>
#include <atomic>
#include <csignal>

namespace forceshade::device {
namespace {

constexpr std::array<int, 7> kDeadly{SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGQUIT};

std::atomic<BackEnd*> guarded = nullptr;
std::array<struct sigaction, kDeadly.size()> before;

void halt_and_die(int signal) {
    if (BackEnd* const back_end = guarded.exchange(nullptr))
        back_end->halt();
    for (std::size_t i = 0; i < kDeadly.size(); ++i)
        ::sigaction(kDeadly[i], &before[i], nullptr);
    ::raise(signal);
}

} // namespace

Emergency::Emergency(BackEnd& back_end) noexcept {
    guarded = &back_end;
    struct sigaction action {};
    action.sa_handler = halt_and_die;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < kDeadly.size(); ++i)
        ::sigaction(kDeadly[i], &action, &before[i]);
}

Emergency::~Emergency() {
    if (guarded.exchange(nullptr) == nullptr)
        return;
    for (std::size_t i = 0; i < kDeadly.size(); ++i)
        ::sigaction(kDeadly[i], &before[i], nullptr);
}

} // namespace forceshade::device
