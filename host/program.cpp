#include "host/program.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <mutex>
#include <semaphore.h>

#include "forceshade_version.h"
#include "host/clock.h"

namespace forceshade {

std::string version() {
    return FORCESHADE_VERSION;
}

namespace {

volatile std::sig_atomic_t interrupted = 0;
volatile std::sig_atomic_t hangs_up = 0; // SIGHUP is caught
volatile std::sig_atomic_t watched = 0;  // a thread waits for interrupts

sem_t* bell() {
    static sem_t* const semaphore = [] {
        auto* const made = new sem_t;
        sem_init(made, 0, 0);
        return made;
    }();
    return semaphore;
}

void raise_flag(int) {
    const bool first = interrupted == 0;
    interrupted = 1;
    if (watched) {
        const int number = errno;
        sem_post(bell());
        errno = number;
        if (first)
            return;
    }
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    if (hangs_up)
        std::signal(SIGHUP, SIG_DFL);
}

} // namespace

void catch_interrupts() {
    bell(); // made before a handler asks for it
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

void watch_interrupts(bool on) {
    bell();
    watched = on;
    if (on && interrupted)
        sem_post(bell()); // before anybody waited
}

bool wait_for_interrupt(std::chrono::milliseconds time) {
    timespec end{};
    clock_gettime(CLOCK_MONOTONIC, &end);
    const auto nanoseconds = std::chrono::nanoseconds(time).count() + end.tv_nsec;
    end.tv_sec += nanoseconds / 1000000000;
    end.tv_nsec = nanoseconds % 1000000000;
    int result = 0;
    do
        result = sem_clockwait(bell(), CLOCK_MONOTONIC, &end);
    while (result != 0 && errno == EINTR);
    return result == 0;
}

void wake_interrupt_watch() {
    sem_post(bell());
}

namespace {

constexpr auto kStderrPatience = std::chrono::milliseconds(100); // with another thread's text, at the end of a process

// Never destroyed: threads that are left behind may still speak.
std::timed_mutex& stderr_mutex() {
    static auto* const mutex = new std::timed_mutex;
    return *mutex;
}
bool line_drawn = false;
std::FILE* log_file = nullptr; // with everything that is said
bool silent = false;           // stderr gets errors alone

void write_log(std::string_view text) {
    if (!log_file || text.empty())
        return;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        fmt::print(log_file, "{} {}\n", utc_now(), text.substr(begin, end - begin));
        begin = end + 1;
    }
    std::fflush(log_file);
}

void put(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace

void open_log(const std::string& file, bool only) {
    log_file = std::fopen(file.c_str(), "ae");
    if (!log_file)
        throw IoError("cannot write {}: {}; name another --log-file", file, std::strerror(errno));
    silent = only;
}

void say(std::string_view text) {
    const std::unique_lock lock(stderr_mutex(), kStderrPatience);
    write_log(text);
    if (silent && !text.starts_with("error:"))
        return;
    if (std::exchange(line_drawn, false))
        put("\r\033[K");
    put(text);
}

void log_line(std::string_view text) {
    const std::unique_lock lock(stderr_mutex(), kStderrPatience);
    write_log(text);
}

void draw_line(std::string_view text) {
    const std::unique_lock lock(stderr_mutex(), kStderrPatience);
    if (silent)
        return;
    if (std::exchange(line_drawn, !text.empty()) || !text.empty())
        put(fmt::format("\r\033[K{}", text));
}

} // namespace forceshade
