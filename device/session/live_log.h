// The samples of the live loop as a CSV file that is written while it runs.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>

#include "device/loop/sample.h"
#include "host/scene/scene.h"

namespace forceshade::device {

/// Columns path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet as PathWriter (host/paths/path_files.h) has them, so that
/// `explore` gives the same numbers for the same positions; then cx,cy,cz (N: what was sent to the device), energy (J:
/// given to the hand so far), tick, late_ns, read_ns, compute_ns, write_ns, happened: kSampleFlagNames joined by '+',
/// and scene: the first 16 digits of the SHA-256 of the scene; last, of a device that has some, buttons: the pressed
/// ones, button N as 2^(N - 1), added up.
///
/// The file has its own name from the start, in whole lines, so that a process that dies leaves what it wrote. When the
/// disk is full, further samples are dropped from the ring and counted as lost. A pipe with a slow reader is waited
/// for until the end and 2 s more.
class LiveLog {
public:
    /// Creates the file and starts a thread that writes until close(). \throws IoError; UsageError if it exists and
    /// must not be replaced, or another run writes it.
    LiveLog(const std::filesystem::path& file, SampleRing& ring, Precision precision, bool replace,
            bool with_buttons = false);
    ~LiveLog();
    LiveLog(const LiveLog&) = delete;
    LiveLog& operator=(const LiveLog&) = delete;

    /// When no more is put on the ring: writes the rest to the disk.
    void close();

    std::uint64_t written() const noexcept { return written_.load(std::memory_order_relaxed); } // samples
    std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }       // samples
    /// Why the disk took no more; empty: it took all. After close().
    const std::string& failure() const noexcept { return failure_; }

private:
    void run(const std::stop_token& stop);
    void add(const LiveSample& sample);
    template <typename... Numbers> void add_numbers(Numbers... values);
    void write_out();
    void await_reader();
    void fail(int number);

    using Clock = std::chrono::steady_clock;

    std::filesystem::path path_;
    SampleRing& ring_;
    const bool single_, with_buttons_;
    int descriptor_ = -1;
    std::uint64_t bytes_ = 0;   // whole lines on the disk
    std::uint64_t pending_ = 0; // samples in text_
    std::string text_;
    std::string failure_;
    std::stop_token stop_; // the thread's own
    Clock::time_point patient_until_{};
    std::atomic<std::uint64_t> written_ = 0, lost_ = 0;
    std::jthread thread_;
};

} // namespace forceshade::device
