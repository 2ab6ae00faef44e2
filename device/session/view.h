// A page for browsers on this machine, in which the force of a run scrolls by over time and over place.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "device/loop/sample.h"
#include "device/run_report/status_line.h"
#include "host/server/page_server.h"

namespace forceshade::device {

/// Constant facts of a run on the page.
struct ViewedRun {
    std::string scene, device; // its file's name; the device's own
    double rate = 0;           /* Hz: as asked for */
    double max_force = 0;      /* N: safety's limit; may be infinite */
};

/// Shows some 2000 samples a second, the largest and the least forces among them.
class LiveView {
public:
    /// Serves the page at `port`, 0 for any that is free, and starts a thread that shows samples until close(). \throws
    /// UsageError if the port cannot be had.
    LiveView(std::uint16_t port, ViewedRun run);
    ~LiveView();
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    std::string address() const;

    /// For the loop. A sample that finds no room there is not shown.
    SampleRing& ring() noexcept { return ring_; }

    /// The status of the run; may be called at any rate.
    void update(const LiveStatus& status);

    /// When no more is put on the ring: shows the rest, and why the run ended.
    void close(const std::string& ended);

private:
    void stop();
    void run(const std::stop_token& stop);
    void add(const LiveSample& sample);
    void show();

    const ViewedRun run_;
    const std::uint64_t together_; // samples of which two are shown
    SampleRing ring_;
    PageServer server_;
    std::mutex mutex_;
    LiveStatus status_; // by the mutex
    // Of the thread alone.
    LiveSample least_, largest_;
    double least_force_ = 0, largest_force_ = 0; /* N */
    std::uint64_t gathered_ = 0;                 // of those together
    std::vector<LiveSample> points_;
    std::chrono::steady_clock::time_point shown_{};
    std::jthread thread_;
};

} // namespace forceshade::device
