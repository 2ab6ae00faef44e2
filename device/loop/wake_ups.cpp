#include "device/loop/wake_ups.h"

#include <fstream>

#include <fmt/format.h>

namespace forceshade::device {

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

namespace {

// Empty if it cannot be read.
std::string first_line(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

} // namespace

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
