#include "device/session/interruption.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <poll.h>

#include "device/loop/emergency.h"

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

namespace {

constexpr std::array kAsked{SIGINT, SIGTERM, SIGHUP};

std::atomic<LiveLoop*> stopped = nullptr;
std::array<struct sigaction, kAsked.size()> before_asked;
volatile std::sig_atomic_t asked = 0;

bool is_a_function(const struct sigaction& action) {
    return action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN;
}

void take() {
    struct sigaction action {};
    action.sa_handler = [](int signal) {
        if (LiveLoop* const loop = stopped.load())
            loop->stop();
        if (asked != 0) {
            std::signal(signal, SIG_DFL);
            halt_and_die(signal);
            return;
        }
        asked = 1;
        for (std::size_t i = 0; i < kAsked.size(); ++i)
            if (kAsked[i] == signal && is_a_function(before_asked[i]))
                before_asked[i].sa_handler(signal); // which gives the signals back to the system
        take();
    };
    sigemptyset(&action.sa_mask);
    for (const int signal : kAsked)
        sigaddset(&action.sa_mask, signal);
    for (std::size_t i = 0; i < kAsked.size(); ++i)
        if (before_asked[i].sa_handler != SIG_IGN) // as under nohup
            ::sigaction(kAsked[i], &action, nullptr);
}

} // namespace

Interruption::Interruption(LiveLoop& loop) noexcept {
    asked = 0;
    stopped = &loop;
    for (std::size_t i = 0; i < kAsked.size(); ++i) {
        ::sigaction(kAsked[i], nullptr, &before_asked[i]);
        if (before_asked[i].sa_handler == SIG_DFL)
            asked = 1; // before the loop began
    }
    take();
}

// Who has asked once and asks again does not wait for the report.
Interruption::~Interruption() {
    for (std::size_t i = 0; i < kAsked.size(); ++i) {
        if (asked != 0 && is_a_function(before_asked[i]))
            std::signal(kAsked[i], SIG_DFL);
        else
            ::sigaction(kAsked[i], &before_asked[i], nullptr);
    }
    stopped = nullptr;
}

} // namespace forceshade::device
