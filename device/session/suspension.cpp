#include "device/session/suspension.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>

#include <poll.h>

namespace forceshade::device {
namespace {

constexpr std::array kStopping{SIGTSTP, SIGTTIN, SIGTTOU}; // by the terminal
constexpr int kPatience = 1000;                            /* ms: with a loop that does not come round */

std::atomic<LiveLoop*> watched = nullptr;
std::array<struct sigaction, kStopping.size()> before;

void suspend(int) {
    const int number = errno;
    LiveLoop* const loop = watched.load();
    if (loop != nullptr) {
        loop->suspend(true);
        for (int waited = 0; !loop->is_at_rest() && waited < kPatience; ++waited)
            ::poll(nullptr, 0, 1);
    }
    ::raise(SIGSTOP);
    if (loop != nullptr)
        loop->suspend(false);
    errno = number;
}

} // namespace

Suspension::Suspension(LiveLoop& loop) noexcept {
    watched = &loop;
    struct sigaction action {};
    action.sa_handler = suspend;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (const int signal : kStopping)
        sigaddset(&action.sa_mask, signal);
    for (std::size_t i = 0; i < kStopping.size(); ++i) {
        ::sigaction(kStopping[i], nullptr, &before[i]);
        if (before[i].sa_handler != SIG_IGN)
            ::sigaction(kStopping[i], &action, nullptr);
    }
}

Suspension::~Suspension() {
    for (std::size_t i = 0; i < kStopping.size(); ++i)
        ::sigaction(kStopping[i], &before[i], nullptr);
    watched = nullptr;
}

} // namespace forceshade::device
