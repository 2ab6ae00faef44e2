#include "device/session/session.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <poll.h>
#include <pthread.h>
#include <span>

namespace forceshade::device {

namespace {

// A signal that is handled here, and its former action.
struct Handled {
    int signal;
    struct sigaction before {};
    bool ours = false;
};

template <typename Wanted> void save(std::span<Handled> signals, Wanted wanted) {
    for (Handled& one : signals) {
        ::sigaction(one.signal, nullptr, &one.before);
        one.ours = wanted(one);
    }
}

// `together`: while one of the signals is handled, the others wait.
void handle(std::span<const Handled> signals, void (*handler)(int), bool together, int flags = 0) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = flags;
    sigemptyset(&action.sa_mask);
    for (const Handled& one : signals)
        if (together)
            sigaddset(&action.sa_mask, one.signal);
    for (const Handled& one : signals)
        if (one.ours)
            ::sigaction(one.signal, &action, nullptr);
}

void restore(std::span<const Handled> signals) {
    for (const Handled& one : signals)
        if (one.ours)
            ::sigaction(one.signal, &one.before, nullptr);
}

template <typename... Signals> std::array<Handled, sizeof...(Signals)> unhandled(Signals... signals) {
    return {Handled{signals}...};
}

constexpr std::size_t kFaults = 6;  // of the deadly ones, the first: handled even if others handle them
constexpr int kHaltTime = 50;       /* ms: that one thread's handler waits for another's */
constexpr int kLoopPatience = 1000; /* ms: with a stuck loop */

auto deadly = unhandled(SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGQUIT, SIGTRAP, SIGUSR1, SIGUSR2, SIGALRM,
                        SIGVTALRM, SIGPROF, SIGXCPU, SIGIO, SIGPWR, SIGSTKFLT);
auto stopping = unhandled(SIGTSTP, SIGTTIN, SIGTTOU); // by the terminal
auto asking = unhandled(SIGINT, SIGTERM, SIGHUP);     // for an end

std::atomic<BackEnd*> guarded = nullptr;
std::atomic<bool> halting = false; // by a handler in some thread, which will end the process
std::atomic<pthread_t> halter{};
std::atomic<LiveLoop*> running = nullptr;
volatile std::sig_atomic_t asked = 0; // for an end, once

// Several threads may fault one after the other: the second one gives the first one time to halt the device, unless it
// is the same one.
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
    restore(deadly);
    ::raise(signal);
}

void suspend(int) {
    const int number = errno;
    LiveLoop* const loop = running.load();
    if (loop != nullptr) {
        loop->suspend(true);
        for (int waited = 0; !loop->is_at_rest() && waited < kLoopPatience; ++waited)
            ::poll(nullptr, 0, 1);
    }
    ::raise(SIGSTOP);
    if (loop != nullptr)
        loop->suspend(false);
    errno = number;
}

bool is_a_function(const struct sigaction& action) {
    return action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN;
}

void stop(int signal) {
    if (LiveLoop* const loop = running.load())
        loop->stop();
    if (asked != 0) {
        std::signal(signal, SIG_DFL);
        halt_and_die(signal);
        return;
    }
    asked = 1;
    for (const Handled& one : asking)
        if (one.signal == signal && is_a_function(one.before))
            one.before.sa_handler(signal); // which gives the signals back to the system
    handle(asking, stop, true);
}

bool is_not_ignored(const Handled& one) {
    return one.before.sa_handler != SIG_IGN; // as it is under nohup
}

} // namespace

Emergency::Emergency(BackEnd& back_end) noexcept {
    halting = false;
    guarded = &back_end;
    save(deadly, [](const Handled& one) { return &one < &deadly[kFaults] || one.before.sa_handler == SIG_DFL; });
    handle(deadly, halt_and_die, false);
}

Emergency::~Emergency() {
    if (guarded.exchange(nullptr) != nullptr)
        restore(deadly);
}

LoopSignals::LoopSignals(LiveLoop& loop) noexcept {
    running = &loop;
    save(stopping, is_not_ignored);
    handle(stopping, suspend, true, SA_RESTART);
    asked = 0;
    save(asking, is_not_ignored);
    for (const Handled& one : asking)
        if (one.before.sa_handler == SIG_DFL)
            asked = 1; // before the loop began
    handle(asking, stop, true);
}

LoopSignals::~LoopSignals() {
    for (const Handled& one : asking)
        if (asked != 0 && is_a_function(one.before)) // a second signal does not wait for the report
            std::signal(one.signal, SIG_DFL);
        else if (one.ours)
            ::sigaction(one.signal, &one.before, nullptr);
    restore(stopping);
    running = nullptr;
}

} // namespace forceshade::device
