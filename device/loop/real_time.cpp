#include "device/loop/real_time.h"

#include <cerrno>
#include <cstdint>
#include <fcntl.h>
#include <fstream>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "host/arenas.h"

namespace forceshade::device {

namespace {

std::string reason(int number) {
    return std::generic_category().message(number);
}

Permissions::One priority() {
    const int refused = raise_priority(kLoopPriority);
    if (refused == 0)
        return {"SCHED_FIFO", true, fmt::format("priority {}", kLoopPriority)};
    return {"SCHED_FIFO", false,
            reason(refused) + ": needs root, CAP_SYS_NICE, or rtprio in /etc/security/limits.conf; other processes may "
                              "make samples late"};
}

// Also locks pages that are touched later, unless they could run into a limit.
Permissions::One locked_memory() {
    share_arenas();
    if (::mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
        void* const probe =
            ::mmap(nullptr, std::size_t(64) << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (probe != MAP_FAILED) {
            ::munmap(probe, std::size_t(64) << 20);
            return {"memory lock", true, "all pages, present and future"};
        }
        ::munlockall();
        if (::mlockall(MCL_CURRENT) == 0)
            return {"memory lock", true, "present pages"};
    }
    return {"memory lock", false,
            reason(errno) + ": needs root, CAP_IPC_LOCK, or memlock in /etc/security/limits.conf; swapping may make "
                            "samples late"};
}

// Until the process ends: the file must stay open.
Permissions::One awake_processors() {
    constexpr std::int32_t kLongest = 0; // us, to wake up from an idle state
    static const int file = ::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
    if (file >= 0 && ::write(file, &kLongest, sizeof kLongest) == sizeof kLongest)
        return {"idle states", true, "none that takes time to wake from (/dev/cpu_dma_latency)"};
    return {"idle states", false,
            reason(errno) + ": /dev/cpu_dma_latency needs root; a processor that sleeps deeply may wake the loop late"};
}

std::optional<int> last_allowed() {
    const std::vector<int> allowed = allowed_cpus();
    return allowed.empty() ? std::nullopt : std::optional(allowed.back());
}

Permissions::One pinned(std::optional<int> cpu, bool first_come) {
    const std::optional<int> chosen = cpu ? cpu : first_come ? last_allowed() : std::nullopt;
    if (!chosen)
        return {"CPU pinning", false, "without SCHED_FIFO it would only wait for its CPU; --cpu N pins it anyway"};
    cpu_set_t one;
    CPU_ZERO(&one);
    if (*chosen >= 0 && *chosen < CPU_SETSIZE)
        CPU_SET(static_cast<std::size_t>(*chosen), &one);
    if (const int refused = ::pthread_setaffinity_np(::pthread_self(), sizeof one, &one); refused != 0)
        return {"CPU pinning", false, fmt::format("CPU {}: {}", *chosen, reason(refused))};
    return {"CPU pinning", true, fmt::format("CPU {}", *chosen)};
}

// Empty if it cannot be read.
std::string first_line(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

} // namespace

std::vector<int> allowed_cpus() {
    std::vector<int> allowed;
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) == 0)
        for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
            if (CPU_ISSET(cpu, &set))
                allowed.push_back(cpu);
    return allowed;
}

Permissions ask_for_real_time(std::optional<int> cpu) {
    ::prctl(PR_SET_TIMERSLACK, 1UL); // ns; the default is 50 us for threads without SCHED_FIFO
    Permissions permissions;
    permissions.all.push_back(priority());
    const bool first_come = permissions.all.front().granted;
    permissions.all.push_back(locked_memory());
    permissions.all.push_back(pinned(cpu, first_come));
    permissions.all.push_back(awake_processors());
    return permissions;
}

WakeUps measure_wake_ups(double rate, double seconds) noexcept {
    WakeUps wake_ups;
    wake_ups.period = 1 / rate;
    const double period = 1e9 / rate;
    const auto periods = static_cast<std::uint64_t>(seconds * rate);
    const std::int64_t begin = now();
    for (std::uint64_t i = 1; i <= periods; ++i) {
        const std::int64_t due = begin + static_cast<std::int64_t>(static_cast<double>(i) * period);
        sleep_until(due);
        const std::int64_t late = now() - due;
        wake_ups.late.add(late);
        wake_ups.lost += static_cast<double>(late) >= period;
    }
    return wake_ups;
}

std::vector<Permissions::One> real_time_settings() {
    std::vector<Permissions::One> all;
    const bool preemptible = first_line("/sys/kernel/realtime") == "1";
    all.push_back(
        {"kernel", preemptible,
         preemptible ? "PREEMPT_RT" : "no PREEMPT_RT (Debian: linux-image-rt-amd64): drivers may hold the loop up"});
    const std::string runtime = first_line("/proc/sys/kernel/sched_rt_runtime_us");
    if (!runtime.empty())
        all.push_back({"real-time throttling", runtime == "-1",
                       runtime == "-1"
                           ? "off"
                           : fmt::format("a thread with SCHED_FIFO gets {} us of each second at most; a loop "
                                         "needs less (sysctl kernel.sched_rt_runtime_us=-1)",
                                         runtime)});
    const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
    if (!governor.empty())
        all.push_back({"governor", governor == "performance",
                       governor == "performance" ? governor
                                                 : governor + ": the processor slows down between samples (cpupower "
                                                              "frequency-set -g performance)"});
    const std::size_t cores = allowed_cpus().size();
    const std::string load = first_line("/proc/loadavg");
    all.push_back({"free cores", cores > 1,
                   fmt::format("{}, of which the loop takes one; load {}", cores, load.substr(0, load.find(' ')))});
    return all;
}

} // namespace forceshade::device
