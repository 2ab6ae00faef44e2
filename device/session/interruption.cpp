#include "device/session/interruption.h"

#include <array>
#include <atomic>
#include <csignal>

#include "device/safety/emergency.h"

namespace forceshade::device {
namespace {

constexpr std::array kAsked{SIGINT, SIGTERM, SIGHUP};

std::atomic<LiveLoop*> stopped = nullptr;
std::array<struct sigaction, kAsked.size()> before;
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
            if (kAsked[i] == signal && is_a_function(before[i]))
                before[i].sa_handler(signal); // which gives the signals back to the system
        take();
    };
    sigemptyset(&action.sa_mask);
    for (const int signal : kAsked)
        sigaddset(&action.sa_mask, signal);
    for (std::size_t i = 0; i < kAsked.size(); ++i)
        if (before[i].sa_handler != SIG_IGN) // as under nohup
            ::sigaction(kAsked[i], &action, nullptr);
}

} // namespace

Interruption::Interruption(LiveLoop& loop) noexcept {
    asked = 0;
    stopped = &loop;
    for (std::size_t i = 0; i < kAsked.size(); ++i) {
        ::sigaction(kAsked[i], nullptr, &before[i]);
        if (before[i].sa_handler == SIG_DFL)
            asked = 1; // before the loop began
    }
    take();
}

// Who has asked once and asks again does not wait for the report.
Interruption::~Interruption() {
    for (std::size_t i = 0; i < kAsked.size(); ++i) {
        if (asked != 0 && is_a_function(before[i]))
            std::signal(kAsked[i], SIG_DFL);
        else
            ::sigaction(kAsked[i], &before[i], nullptr);
    }
    stopped = nullptr;
}

} // namespace forceshade::device
