#include "device/session/suspension.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>

namespace forceshade::device {
namespace {

std::atomic<LiveLoop*> watched = nullptr;
std::atomic<long> wait_time = 0; /* ns: in which the loop writes zero */
struct sigaction before {};

void suspend(int) {
    const int number = errno;
    LiveLoop* const loop = watched.load();
    if (loop != nullptr)
        loop->suspend(true);
    const timespec time{0, wait_time.load()};
    ::nanosleep(&time, nullptr);
    ::raise(SIGSTOP);
    if (loop != nullptr)
        loop->suspend(false);
    errno = number;
}

} // namespace

Suspension::Suspension(LiveLoop& loop, double period) noexcept {
    constexpr double kPeriods = 5;
    watched = &loop;
    wait_time = static_cast<long>(kPeriods * period * 1e9);
    struct sigaction action {};
    action.sa_handler = suspend;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGTSTP, &action, &before);
}

Suspension::~Suspension() {
    ::sigaction(SIGTSTP, &before, nullptr);
    watched = nullptr;
}

} // namespace forceshade::device
