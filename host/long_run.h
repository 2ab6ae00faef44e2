// Long commands: an interrupt ends them within half a second, at any size, and a line on stderr shows their
// progress.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "host/clock.h"

namespace forceshade {

/// While it lives, a run that has not ended by itself 0.3 s after an interrupt (host/program.h), or when a second one
/// comes, is ended: its temporary files are removed, `farewell` and "error: interrupted" are said, and the process
/// exits with 130. Libraries that cannot be stopped (CGAL, drivers, drawing) are left where they are; files that
/// stand under their own names are whole at any moment. Not for what drives a device or talks with a person.
///
/// Unless `quiet`, stderr shows every stage that takes longer than a second: on a terminal a line at its foot, else
/// a line every five seconds. One at a time.
class LongRun {
public:
    explicit LongRun(bool quiet, std::string farewell = "");
    ~LongRun();
    LongRun(const LongRun&) = delete;
    LongRun& operator=(const LongRun&) = delete;

private:
    void watch(const std::stop_token& stop);
    void show_progress();

    bool quiet_, terminal_;
    std::string farewell_;
    Clock::time_point start_ = Clock::now(), shown_ = start_, logged_ = start_;
    std::jthread thread_;
};

/// The stage of a long run, from here to the end of the scope. The outermost stage that is counted gives the bar and
/// the time left, the innermost one the words. Without a LongRun it is not shown. Any thread may have stages.
class Stage {
public:
    /// `what`: "reading bunny.ply". `total` steps of `unit` ("cases"); 0: their number is unknown.
    explicit Stage(std::string what, std::uint64_t total = 0, std::string unit = "");
    ~Stage();
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    /// `done` steps have ended. `now` takes the place of `what`.
    void update(std::uint64_t done, std::string now = "");
    /// `done` steps of `total` have ended, where their number was not known before.
    void update(std::uint64_t done, std::uint64_t total);

private:
    friend std::string progress_line(double seconds, bool bar);
    std::string what_, unit_;
    std::uint64_t total_, done_ = 0;
    double share_ = 0; // of it, at most so far, with what inner stages did of the present step
    Clock::time_point start_ = Clock::now();
};

/// The stages as a line, for a run that began `seconds` ago: "31/51 cases, 0:40 so far, 0:26 left  drawing a.png";
/// empty before the first second of the innermost one that lasts. `bar`: with one before it.
std::string progress_line(double seconds, bool bar);

/// "0:07", "12:40", "3:05:00".
std::string clock_text(double seconds);

// Files that an ended run would leave behind. Hold the lock while you make, rename or remove one.

/// While held, no LongRun ends the process (for a tenth of a second at most).
[[nodiscard]] std::unique_lock<std::timed_mutex> hold_end();
/// The end removes this file or folder, until it is kept. The caller holds the lock.
void remove_at_end(const std::filesystem::path& file);
void keep_at_end(const std::filesystem::path& file);

} // namespace forceshade
