#include "host/long_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <set>
#include <sys/ioctl.h>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/program.h"

namespace forceshade {
namespace {

constexpr auto kGrace = std::chrono::milliseconds(300);        // to leave in order
constexpr auto kLockPatience = std::chrono::milliseconds(100); // for a thread that makes or renames a file just now

// Never destroyed: threads that are left behind may still ask for them.
std::timed_mutex& end_mutex() {
    static auto* const mutex = new std::timed_mutex;
    return *mutex;
}
std::set<std::filesystem::path>& unfinished() {
    static auto* const files = new std::set<std::filesystem::path>;
    return *files;
}

// The lock is never released, so that no file is made any more.
[[noreturn]] void end_process(const std::string& farewell) {
    std::error_code ignored;
    if (end_mutex().try_lock_for(kLockPatience))
        for (const std::filesystem::path& file : unfinished())
            std::filesystem::remove_all(file, ignored);
    print_note("{}error: interrupted\n", farewell.empty() ? "" : farewell + "\n");
    ::_exit(static_cast<int>(ExitCode::interrupted));
}

} // namespace

std::unique_lock<std::timed_mutex> hold_end() {
    return std::unique_lock(end_mutex());
}

void remove_at_end(const std::filesystem::path& file) {
    unfinished().insert(std::filesystem::absolute(file));
}

void keep_at_end(const std::filesystem::path& file) {
    unfinished().erase(std::filesystem::absolute(file));
}

namespace {

constexpr double kWorthShowing = 1;                         // s that a stage lasts
constexpr double kLogEvery = 60;                            // s between lines of the log, on a terminal
constexpr double kLineEvery = 5;                            // s between lines where there is no terminal
constexpr auto kDrawEvery = std::chrono::milliseconds(200); // on a terminal

std::mutex& stages_mutex() {
    static auto* const mutex = new std::mutex;
    return *mutex;
}
// In the order of their beginning.
std::vector<Stage*>& stages() {
    static auto* const all = new std::vector<Stage*>;
    return *all;
}

std::size_t terminal_width() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

// Cut between characters.
std::string cut(std::string line, std::size_t bytes) {
    if (line.size() <= bytes)
        return line;
    while (bytes > 0 && (static_cast<unsigned char>(line[bytes]) & 0xc0) == 0x80)
        --bytes;
    line.resize(bytes);
    return line;
}

} // namespace

std::string clock_text(double seconds) {
    const auto whole = static_cast<long>(std::lround(std::max(0.0, seconds)));
    if (whole < 3600)
        return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

Stage::Stage(std::string what, std::uint64_t total, std::string unit)
    : what_(std::move(what)), unit_(std::move(unit)), total_(total) {
    const std::lock_guard lock(stages_mutex());
    stages().push_back(this);
}

Stage::~Stage() {
    const std::lock_guard lock(stages_mutex());
    std::erase(stages(), this);
}

void Stage::update(std::uint64_t done, std::string now) {
    const std::lock_guard lock(stages_mutex());
    done_ = std::min(done, total_);
    if (!now.empty())
        what_ = std::move(now);
}

std::string progress_line(double seconds, bool bar) {
    const std::lock_guard lock(stages_mutex());
    Stage* counted = nullptr;
    double inner = 0;
    for (Stage* stage : stages())
        if (stage->total_ > 0 && !counted)
            counted = stage;
        else if (stage->total_ > 0 && inner == 0)
            inner = static_cast<double>(stage->done_) / static_cast<double>(stage->total_);
    const auto lasts = [](const Stage* stage) { return seconds_since(stage->start_) >= kWorthShowing; };
    const auto shown = std::find_if(stages().rbegin(), stages().rend(), lasts);
    if (shown == stages().rend())
        return "";
    if (!counted || !lasts(counted))
        return fmt::format("{}, {} so far", (*shown)->what_, clock_text(seconds));
    const double total = static_cast<double>(counted->total_);
    counted->share_ = std::max(counted->share_, std::min(1.0, (static_cast<double>(counted->done_) + inner) / total));
    const double share = counted->share_, elapsed = seconds_since(counted->start_);
    std::string line = fmt::format(
        "{}/{} {}, {} so far{}  {}", counted->done_, counted->total_, counted->unit_, clock_text(seconds),
        share > 0 ? fmt::format(", {} left", clock_text(elapsed * (1 - share) / share)) : "", stages().back()->what_);
    constexpr std::size_t kBar = 24;
    const auto filled = static_cast<std::size_t>(share * kBar);
    return bar ? fmt::format("[{:=<{}}{:<{}}] {}", "", filled, "", kBar - filled, line) : line;
}

void Stage::update(std::uint64_t done, std::uint64_t total) {
    const std::lock_guard lock(stages_mutex());
    total_ = total;
    done_ = std::min(done, total); // a file may grow
}

LongRun::LongRun(bool quiet, std::string farewell)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), farewell_(std::move(farewell)) {
    // The signals are other threads' to take, so that waiting calls return there.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    watch_interrupts(true);
    thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

LongRun::~LongRun() {
    thread_.request_stop();
    wake_interrupt_watch();
    thread_.join();
    watch_interrupts(false);
    draw_line("");
}

void LongRun::watch(const std::stop_token& stop) {
    while (!stop.stop_requested())
        if (!wait_for_interrupt(kDrawEvery)) {
            if (!quiet_)
                show_progress();
        } else if (is_interrupted()) {
            wait_for_interrupt(kGrace); // or the next one
            if (!stop.stop_requested())
                end_process(farewell_);
        }
}

void LongRun::show_progress() {
    if (terminal_ && seconds_since(logged_) >= kLogEvery) {
        logged_ = Clock::now();
        log_line(progress_line(seconds_since(start_), false));
    }
    if (!terminal_ && seconds_since(shown_) < kLineEvery)
        return;
    shown_ = Clock::now();
    const std::string line = progress_line(seconds_since(start_), terminal_);
    if (terminal_)
        draw_line(cut(line, terminal_width() - 1));
    else if (!line.empty())
        say(line + "\n");
}

} // namespace forceshade
