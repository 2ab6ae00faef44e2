// A library to be preloaded: after LEAP_AFTER seconds of the process's life the wall clock, whoever asks for it, is an
// hour ahead; other clocks go on. The file LEAP_WITNESS is written when the library is loaded.
#include <cstdlib>
#include <ctime>

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

namespace {

constexpr time_t kLeap = 3600; /* s */

double monotonic() {
    timespec time{};
    ::syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

const double begun = monotonic();
const double leap_after = [] {
    if (const char* const witness = std::getenv("LEAP_WITNESS"))
        ::close(::open(witness, O_WRONLY | O_CREAT, 0600));
    const char* const text = std::getenv("LEAP_AFTER");
    return text ? std::atof(text) : 0.0;
}();

time_t leap() {
    return monotonic() - begun > leap_after ? kLeap : 0;
}

} // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
    const long answer = ::syscall(SYS_clock_gettime, clock, time);
    if (answer == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
        time->tv_sec += leap();
    return int(answer);
}

int gettimeofday(timeval* time, void*) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    time->tv_sec = now.tv_sec;
    time->tv_usec = now.tv_nsec / 1000;
    return 0;
}

time_t time(time_t* place) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (place != nullptr)
        *place = now.tv_sec;
    return now.tv_sec;
}
}
